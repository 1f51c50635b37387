//! `[specimen.material.rupture]`: a limit in the unit of its criterion, which a law can have.

use super::ModelDiagnostics;
use crate::scenario::{self, Level};
use membrane::material::{Criterion, Law, Rupture};

/// The rupture of film with `law` written in the material at `path`; none where there is none or it is invalid.
pub(super) fn check(
    written: &scenario::Material,
    law: &Law,
    path: &str,
    mistakes: &mut ModelDiagnostics<'_>,
) -> Option<Rupture> {
    let rupture = written.rupture.as_ref()?;
    let place = if path.is_empty() { "rupture".to_owned() } else { format!("{path}.rupture") };
    let is_fabric = matches!(law, Law::Fabric(_) | Law::RateFabric(_));
    if written.fabric.as_ref().is_some_and(|fabric| fabric.break_scatter > 0.0) {
        let message = "film with a rupture criterion of its own cannot also break layer by layer";
        mistakes.report_with(&place, message, "leave `fabric.break_scatter` out, or `rupture`");
        return None;
    }
    let criterion = match rupture.criterion {
        scenario::RuptureCriterion::Strain if is_fabric => Criterion::FibreStrain,
        scenario::RuptureCriterion::Strain => Criterion::Strain,
        scenario::RuptureCriterion::Stress => Criterion::Stress,
        scenario::RuptureCriterion::Energy => Criterion::Energy,
    };
    let (criterion, limit) = match rupture.limit {
        Some(Level::Quantity(_)) if matches!(criterion, Criterion::Strain | Criterion::FibreStrain) => {
            let message = "the limit of a strain is a number without unit";
            let hint =
                "write it like 1.2, for film that is 2.2 times as long; or use the criterion `stress` or `energy`";
            mistakes.report_with(&format!("{place}.limit"), message, hint);
            return None;
        }
        Some(limit) => (criterion, limit.value()),
        None if criterion == Criterion::FibreStrain => (Criterion::Break, 1.0),
        None => {
            let message = "a rupture criterion needs its limit";
            let hint = "give `limit`; a fabric with the criterion `strain` alone has that of its curves";
            mistakes.report_with(&place, message, hint);
            return None;
        }
    };
    let fracture_energy = rupture.energy.map_or(0.0, |energy| energy.0);
    Some(Rupture { criterion, limit, fracture_energy })
}
