//! The formats in which results are also written, on request.

use clap::Args;

/// What a run writes beside its usual files.
#[derive(Clone, Copy, Debug, Default, Args)]
pub(super) struct Formats {
    /// Also write the snapshots for ParaView: film.pvd, impactor.pvd, frame.pvd (the bars) and springs.pvd, with strain, stress and thickness
    #[arg(long)]
    pub vtu: bool,
    /// Also write the snapshots for ParaView, all of them in one file: film.vtkhdf, impactor.vtkhdf, frame.vtkhdf and springs.vtkhdf
    #[arg(long)]
    pub vtkhdf: bool,
}

impl Formats {
    /// Whether snapshots need what ParaView shows: stresses, velocities, fibres.
    pub(super) fn need_detail(self) -> bool {
        self.vtu || self.vtkhdf
    }
}
