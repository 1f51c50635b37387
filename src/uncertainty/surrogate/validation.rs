//! How many terms: cross-validation of a pursuit.

use super::pursuit::Pursuit;

/// Terms without an improvement after which no further one is tried.
const TERMS_TRIED: usize = 25;

/// Number of terms with the least sum of squared errors over all folds, and that error.
///
/// The pursuits of all folds go on in step. Sample `order[i]` is left out in fold i modulo `folds`.
pub(super) fn cross_validated(columns: &[Vec<f64>], outputs: &[f64], order: &[usize], folds: usize) -> (usize, f64) {
    let parts: Vec<(Vec<usize>, usize)> = (0..folds).map(|fold| rows_of_fold(order, fold, folds)).collect();
    let arranged = |values: &[f64], rows: &[usize]| rows.iter().map(|&row| values[row]).collect::<Vec<f64>>();
    let of_folds: Vec<Vec<Vec<f64>>> =
        parts.iter().map(|(rows, _)| columns.iter().map(|column| arranged(column, rows)).collect()).collect();
    let mut pursuits: Vec<Pursuit> = of_folds
        .iter()
        .zip(&parts)
        .map(|(columns, (rows, fitted))| Pursuit::new(columns, arranged(outputs, rows), *fitted))
        .collect();
    let mut best = (0, f64::INFINITY);
    for terms in 1.. {
        // All go a step, also where one of them is at its end.
        let ended = pursuits.iter_mut().map(Pursuit::step).filter(|further| !further).count();
        if ended > 0 || terms > best.0 + TERMS_TRIED {
            break;
        }
        let error = pursuits.iter().map(Pursuit::prediction_error).sum();
        if error < best.1 {
            best = (terms, error);
        }
    }
    best
}

/// Rows of a fold, those that are fitted first, and their number.
fn rows_of_fold(order: &[usize], fold: usize, folds: usize) -> (Vec<usize>, usize) {
    let places = |left_out: bool| (0..order.len()).filter(move |place| (place % folds == fold) == left_out);
    let rows: Vec<usize> = places(false).chain(places(true)).map(|place| order[place]).collect();
    (rows, places(false).count())
}
