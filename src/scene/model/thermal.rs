//! `[specimen.material.thermal]`: heat of film that absorbs energy.

use super::ModelDiagnostics;
use crate::scenario;
use membrane::material::Thermal;

/// The heating of film that is written in the material at `path`; none where there is none or it is invalid.
pub(super) fn check(written: &scenario::Material, path: &str, mistakes: &mut ModelDiagnostics<'_>) -> Option<Thermal> {
    let thermal = written.thermal?;
    let place = if path.is_empty() { "thermal".to_owned() } else { format!("{path}.thermal") };
    let absorbs = written.plastic.is_some()
        || !written.prony.is_empty()
        || written.fabric.as_ref().is_some_and(|fabric| fabric.absorption > 0.0);
    if !absorbs {
        let message = "film that absorbs no energy does not warm up";
        let hint = "give `fabric.absorption`, `prony` or a `plastic` law, or leave `thermal` out";
        mistakes.report_with(&place, message, hint);
        return None;
    }
    let fabric_by_rate = written.fabric.as_ref().is_some_and(|f| f.md.rates.is_some() || f.td.rates.is_some());
    let plastic_by_rate = written.plastic.as_ref().is_some_and(|plastic| plastic.hardening.rates.is_some());
    if fabric_by_rate || plastic_by_rate {
        let message =
            "film with curves by strain rate cannot also warm up: those of high rates have their heat in them";
        mistakes.report_with(&place, message, "leave `thermal` out, or give the slowest curve alone");
        return None;
    }
    // The ranges were checked before.
    let capacity = written.density.0 * thermal.heat.0;
    (capacity > 0.0).then_some(Thermal { capacity, softening: thermal.softening.0 })
}
