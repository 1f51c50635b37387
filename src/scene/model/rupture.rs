//! `[specimen.material.rupture]`: a limit in the unit of its criterion, which a law can have.

use super::ModelDiagnostics;
use crate::scenario::{self, Level, RatePoint, TriaxialPoint};
use base::number::significant;
use base::units::Rate;
use membrane::material::{Criterion, Law, Limit, Rupture};

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
    let limits = Limits { criterion, place: &place };
    let (criterion, limit) = match (rupture.limit, &rupture.triaxiality, &rupture.rate) {
        (Some(limit), None, None) => (criterion, Limit::One(limits.value(limit, "limit", mistakes)?)),
        (None, Some(points), None) => (criterion, Limit::ByTriaxiality(limits.by_triaxiality(points, mistakes)?)),
        (None, None, Some(points)) => (criterion, Limit::ByRate(limits.by_rate(points, mistakes)?)),
        (None, None, None) if criterion == Criterion::FibreStrain => (Criterion::Break, Limit::One(1.0)),
        (None, None, None) => {
            let message = "a rupture criterion needs its limit";
            let hint = "give `limit`, or points in `triaxiality` or `rate`; a fabric with the criterion `strain` alone has \
                        that of its curves";
            mistakes.report_with(&place, message, hint);
            return None;
        }
        _ => {
            let message = "`limit`, `triaxiality` and `rate` exclude each other";
            mistakes.report_with(&place, message, "keep one of them");
            return None;
        }
    };
    let fracture_energy = rupture.energy.map_or(0.0, |energy| energy.0);
    Some(Rupture { criterion, limit, fracture_energy })
}

/// Reads limits of one criterion.
struct Limits<'a> {
    criterion: Criterion,
    /// Key path of the table.
    place: &'a str,
}

impl Limits<'_> {
    /// The value of a limit, in SI.
    fn value(&self, level: Level, key: &str, mistakes: &mut ModelDiagnostics<'_>) -> Option<f64> {
        let is_strain = matches!(self.criterion, Criterion::Strain | Criterion::FibreStrain);
        if is_strain && matches!(level, Level::Quantity(_)) {
            let message = "the limit of a strain is a number without unit";
            let hint =
                "write it like 1.2, for film that is 2.2 times as long; or use the criterion `stress` or `energy`";
            mistakes.report_with(&format!("{}.{key}", self.place), message, hint);
            return None;
        }
        Some(level.value())
    }

    fn by_triaxiality(&self, points: &[TriaxialPoint], mistakes: &mut ModelDiagnostics<'_>) -> Option<Vec<[f64; 2]>> {
        let mut out: Vec<[f64; 2]> = vec![];
        for (index, TriaxialPoint(at, level)) in points.iter().enumerate() {
            let value = self.value(*level, &format!("triaxiality.{index}.1"), mistakes)?;
            if let Some([before, _]) = out.last().filter(|[before, _]| before >= at) {
                let hint = format!("{} follows {}", significant(*at, 4), significant(*before, 4));
                let key = format!("{}.triaxiality.{index}", self.place);
                mistakes.report_with(&key, "the triaxiality does not increase", hint);
                return None;
            }
            out.push([*at, value]);
        }
        Some(out)
    }

    fn by_rate(&self, points: &[RatePoint], mistakes: &mut ModelDiagnostics<'_>) -> Option<Vec<[f64; 2]>> {
        let mut out: Vec<[f64; 2]> = vec![];
        for (index, RatePoint(at, level)) in points.iter().enumerate() {
            let value = self.value(*level, &format!("rate.{index}.1"), mistakes)?;
            if let Some([before, _]) = out.last().filter(|[before, _]| *before >= at.0.ln()) {
                let hint = format!("{at} follows {}; list the slowest first", Rate(before.exp()));
                let key = format!("{}.rate.{index}", self.place);
                mistakes.report_with(&key, "the rates do not increase", hint);
                return None;
            }
            out.push([at.0.ln(), value]);
        }
        Some(out)
    }
}
