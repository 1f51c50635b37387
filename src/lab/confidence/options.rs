//! Options of confidence intervals.

use super::noise::{Colour, Misfit};

/// Options of confidence intervals.
#[derive(Clone, Debug, PartialEq)]
pub struct ConfidenceOptions {
    /// Names of the parameters.
    pub names: Vec<String>,
    /// Assumed noise of the residuals.
    pub colour: Colour,
    /// Whether intervals are symmetric in the logarithm, as for multipliers.
    pub relative: bool,
    /// An assumed error of each part of the residuals, or one for all, instead of the noise that the residuals show.
    pub misfit: Option<Vec<Misfit>>,
    /// Standard deviations of Gaussian priors of fitted parameters about the estimate, in their units; none for
    /// parameters that only the residuals determine, and for those behind the end. (127) of docs/methods.md.
    pub prior: Vec<Option<f64>>,
    /// Standard deviations of parameters that the fit held at their values, in their units; none for fitted ones, and
    /// for those behind the end. (126) of docs/methods.md.
    pub held: Vec<Option<f64>>,
}

impl ConfidenceOptions {
    /// Coloured noise and absolute intervals of parameters without priors.
    pub fn new(names: Vec<String>) -> ConfidenceOptions {
        ConfidenceOptions {
            names,
            colour: Colour::Coloured,
            relative: false,
            misfit: None,
            prior: vec![],
            held: vec![],
        }
    }

    /// The parameters that the fit held, and their standard deviations.
    pub(super) fn held(&self) -> impl Iterator<Item = (usize, f64)> {
        self.held.iter().enumerate().filter_map(|(index, deviation)| Some((index, (*deviation)?)))
    }

    /// The options without the parameters that the fit held.
    pub(super) fn of_fitted(&self) -> ConfidenceOptions {
        let is_fitted = |index: usize| self.held.get(index).copied().flatten().is_none();
        let names = self.names.iter().enumerate().filter(|(index, _)| is_fitted(*index));
        let prior = self.prior.iter().enumerate().filter(|(index, _)| is_fitted(*index));
        ConfidenceOptions {
            names: names.map(|(_, name)| name.clone()).collect(),
            prior: prior.map(|(_, deviation)| *deviation).collect(),
            held: vec![],
            ..self.clone()
        }
    }
}
