//! Voce's hardening and the ratios of yield stress, by least squares.

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
// The version of nalgebra that the crate uses.
use nalgebra_of_lm::{DMatrix, DVector, Dyn, Owned};

use crate::material::Voce;

/// A measured point: which ratio it has (none along MD), plastic strain, true stress (Pa), weight.
pub(super) struct Point {
    pub(super) ratio: Option<usize>,
    pub(super) strain: f64,
    pub(super) stress: f64,
    pub(super) weight: f64,
}

/// T = R σ_y(R E_p) of all points (theory.md, equation 268), in the logarithms of σ_0, σ_s − σ_0, b and the ratios R.
struct Problem<'a> {
    points: &'a [Point],
    logs: DVector<f64>,
}

impl Problem<'_> {
    fn voce(&self) -> (Voce, f64) {
        let [initial, rise, rate] = [0, 1, 2].map(|k| self.logs[k].exp());
        (Voce { initial, saturation: initial + rise, rate }, rise)
    }

    fn ratio(&self, point: &Point) -> f64 {
        point.ratio.map_or(1.0, |place| self.logs[3 + place].exp())
    }
}

impl LeastSquaresProblem<f64, Dyn, Dyn> for Problem<'_> {
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;
    type ParameterStorage = Owned<f64, Dyn>;

    fn set_params(&mut self, logs: &DVector<f64>) {
        self.logs.copy_from(logs);
    }

    fn params(&self) -> DVector<f64> {
        self.logs.clone()
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        let (voce, rise) = self.voce();
        let residual = |point: &Point| {
            let ratio = self.ratio(point);
            let left = rise * (-voce.rate * ratio * point.strain).exp();
            point.weight * (ratio * (voce.saturation - left) / point.stress - 1.0)
        };
        let residuals = DVector::from_iterator(self.points.len(), self.points.iter().map(residual));
        residuals.iter().all(|residual| residual.is_finite()).then_some(residuals)
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        let (voce, rise) = self.voce();
        let mut jacobian = DMatrix::zeros(self.points.len(), self.logs.len());
        for (row, point) in self.points.iter().enumerate() {
            let ratio = self.ratio(point);
            let scale = point.weight / point.stress;
            let growth = voce.rate * ratio * point.strain;
            let left = rise * (-growth).exp();
            jacobian[(row, 0)] = scale * ratio * voce.initial;
            jacobian[(row, 1)] = scale * ratio * (rise - left);
            jacobian[(row, 2)] = scale * ratio * left * growth;
            if let Some(place) = point.ratio {
                jacobian[(row, 3 + place)] = scale * ratio * (voce.saturation - left + left * growth);
            }
        }
        Some(jacobian)
    }
}

/// Voce's law and `ratios` ratios; none where the descent does not converge.
pub(super) fn fit(points: &[Point], ratios: usize) -> Option<(Voce, Vec<f64>)> {
    let along: Vec<&Point> = points.iter().filter(|point| point.ratio.is_none()).collect();
    let lowest = along.iter().map(|point| point.stress).fold(f64::INFINITY, f64::min);
    let highest = along.iter().map(|point| point.stress).fold(0.0, f64::max);
    let longest = along.iter().map(|point| point.strain).fold(0.0, f64::max);
    // Several starts: fast and slow saturation.
    let starts = [1.0, 3.0, 10.0, 30.0].map(|turns| {
        let mut logs = DVector::zeros(3 + ratios);
        logs[0] = lowest.ln();
        logs[1] = (highest - lowest).max(0.01 * highest).ln();
        logs[2] = (turns / longest).ln();
        logs
    });
    let descents = starts.into_iter().map(|logs| LevenbergMarquardt::new().minimize(Problem { points, logs }));
    let converged = descents.filter(|(_, report)| report.termination.was_successful());
    let (best, _) = converged.min_by(|a, b| a.1.objective_function.total_cmp(&b.1.objective_function))?;
    Some((best.voce().0, best.logs.iter().skip(3).map(|log| log.exp()).collect()))
}
