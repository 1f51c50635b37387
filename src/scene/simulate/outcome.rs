//! The outcome of a run.

use std::time::Duration;

use serde::{Deserialize, Serialize};

use super::film::Film;
use super::motion::FaceMotion;
use super::rates::RateHistogram;
use super::snapshot::Snapshot;
use super::warning::Warning;
use lab::signal::Recording;
use membrane::engine::{AddedMass, Relaxation, Surface, Torn};
use membrane::lane::Width;

/// The outcome of a run. It is serialized without its pictures: snapshots, topology and surfaces.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Outcome {
    /// Channels of `signals.csv`, in its order, without the filtered one (that is post-processing).
    pub signals: Recording,
    /// The energy audit, sampled with the signals: one channel a term, J.
    pub energies: Recording,
    /// States of films and impactors over time.
    #[serde(skip)]
    pub snapshots: Vec<Snapshot>,
    /// Topology of the films, one entry a face.
    pub films: Vec<Film>,
    /// The motion of the face that is compared with a field.
    pub motion: Option<FaceMotion>,
    /// Surfaces of the impactors that move in the snapshots, and after them that of the frame's bars, if there are any.
    #[serde(skip)]
    pub impactors: Vec<Surface>,
    /// Strain increments by strain rate.
    pub rates: RateHistogram,
    /// Findings that put figures in doubt.
    pub warnings: Vec<Warning>,
    /// Time at which the first element failed, s.
    pub rupture_time: Option<f64>,
    /// Largest |ΣE − E₀| over the energy exchanged.
    pub energy_balance_error: f64,
    /// Largest ratio of the film's kinetic energy to the energy that it took up, from a tenth of its maximum on (only
    /// quasi-static loadings).
    pub kinetic_share: Option<f64>,
    /// Energy lost to damping over the energy that the film took up (only quasi-static loadings).
    pub damping_share: Option<f64>,
    /// Change of an inflated film's deflection over the last tenth of the test, over the deflection; none after a
    /// rupture.
    pub settling: Option<f64>,
    /// How the film came to equilibrium before the test; none where nothing holds it.
    pub relaxation: Option<Relaxation>,
    /// Factor on the film's mass that the run used (only quasi-static loadings).
    pub mass_scaling: Option<f64>,
    /// Mass added to the small elements of each face; empty where none was asked for.
    pub added_mass: Vec<AddedMass>,
    /// Largest penetration over the radius of an impactor.
    pub penetration: Option<f64>,
    /// Tears at the end; only of film with a rupture criterion of its own.
    pub torn: Option<Torn>,
    /// Largest growth of the temperature of film that does not tear, before it first breaks, K; only of film that warms up.
    pub warming: Option<f64>,
    /// Number of elements.
    pub elements: usize,
    /// Memory of the engine's own arrays, bytes.
    pub bytes: usize,
    /// Number of threads.
    pub threads: usize,
    /// Vector instructions of its kernels.
    pub instructions: Width,
    /// Number of steps.
    pub steps: u64,
    /// Mean time step, s.
    pub time_step: f64,
    /// Wall time, of all parts where the run was interrupted.
    pub wall: Duration,
}
