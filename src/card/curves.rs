//! Curves in a table, for solvers whose cards are not known here: resultants, force per width of the layers that an element
//! stands for, over engineering strain, as VPS' material 151 takes them in the study of the LLDPE film.

use super::film::Draft;
use super::layout::whole;
use super::loss::Loss;
use base::diagnostic::Diagnostic;

/// The table without its head: one block of two columns a curve, one below the other.
pub(super) fn write(draft: &mut Draft<'_>) -> Result<String, Diagnostic> {
    let (film, request) = (draft.film, draft.request);
    let curves = draft.fabric_curves(true)?;
    draft.lose_beside_the_law();
    draft.losses.extend((curves.absorption > 0.0).then_some(Loss::Absorption { share: curves.absorption }));
    let width = film.material.thickness * f64::from(request.layers) / request.system.resultant();
    let [_, length, _, force, _] = request.system.words();
    let mut text = format!("curve,rate_per_{},strain,resultant_{force}_per_{length}\n", request.system.words()[2]);
    let [md, td] = &curves.fibres;
    let named = md.iter().map(|curve| ("md", curve)).chain(td.iter().map(|curve| ("td", curve)));
    for (name, (rate, curve)) in named {
        let rate = rate.map(|rate| whole(rate * request.system.time())).unwrap_or_default();
        for [strain, stress] in &curve.points {
            text += &format!("{name},{rate},{},{}\n", whole(*strain), whole(stress * width));
        }
    }
    for [angle, stress] in &curves.shear.points {
        text += &format!("shear,,{},{}\n", whole(*angle), whole(stress * width));
    }
    Ok(text)
}
