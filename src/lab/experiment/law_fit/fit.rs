//! The fit of a law to tests.

use super::{DataSet, FitError, FitOptions, LawChoice, LawFit, hyperelastic};

/// Fits the law to the `sets` and predicts the stresses of `predicted`.
pub fn fit_law(
    choice: LawChoice,
    sets: &[DataSet],
    predicted: &[DataSet],
    options: &FitOptions,
) -> Result<LawFit, FitError> {
    if !sets.iter().any(|set| set.weight > 0.0) {
        return Err(FitError::NoData);
    }
    if let Some(stretch) = options.stable_to.filter(|stretch| !(stretch.is_finite() && *stretch > 1.0)) {
        return Err(FitError::StableTo(stretch));
    }
    match choice {
        LawChoice::Hyperelastic(energy) => hyperelastic::fit(energy, sets, predicted, options),
    }
}
