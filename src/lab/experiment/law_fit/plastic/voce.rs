//! Voce's hardening and the ratios of yield stress, by least squares.

use crate::experiment::descent::descend;
use membrane::material::Voce;

/// A measured point: which ratio it has (none along MD), plastic strain, true stress (Pa), weight.
pub(super) struct Point {
    pub(super) ratio: Option<usize>,
    pub(super) strain: f64,
    pub(super) stress: f64,
    pub(super) weight: f64,
}

/// Voce's law and ratios of the logarithms of σ_0, σ_s − σ_0, b and the ratios R.
fn law(logs: &[f64]) -> (Voce, Vec<f64>) {
    // Logarithms of σ_0, σ_s − σ_0 and b: whatever the descent tries hardens and does not fall.
    let of: Vec<f64> = logs.iter().map(|log| log.exp()).collect();
    (Voce { initial: of[0], saturation: of[0] + of[1], rate: of[2] }, of[3..].to_vec())
}

/// T/T_measured − 1 with T = R σ_y(R E_p) of all points (theory.md, equation 268), weighted.
fn residuals(points: &[Point], logs: &[f64]) -> Vec<f64> {
    let (Voce { initial, saturation, rate }, ratios) = law(logs);
    let residual = |point: &Point| {
        let ratio = point.ratio.map_or(1.0, |place| ratios[place]);
        let left = (saturation - initial) * (-rate * ratio * point.strain).exp();
        point.weight * (ratio * (saturation - left) / point.stress - 1.0)
    };
    points.iter().map(residual).collect()
}

/// Voce's law and `ratios` ratios; none where no descent converges.
pub(super) fn fit(points: &[Point], ratios: usize) -> Option<(Voce, Vec<f64>)> {
    let along: Vec<&Point> = points.iter().filter(|point| point.ratio.is_none()).collect();
    let lowest = along.iter().map(|point| point.stress).fold(f64::INFINITY, f64::min);
    let highest = along.iter().map(|point| point.stress).fold(0.0, f64::max);
    let longest = along.iter().map(|point| point.strain).fold(0.0, f64::max);
    // Several starts: fast and slow saturation.
    let starts = [1.0, 3.0, 10.0, 30.0].map(|turns| {
        let mut logs = vec![0.0; 3 + ratios];
        logs[0] = lowest.ln();
        logs[1] = (highest - lowest).max(0.01 * highest).ln();
        logs[2] = (turns / longest).ln();
        logs
    });
    let descents = starts.into_iter().map(|logs| descend(logs, &|logs| residuals(points, logs)));
    let converged = descents.filter(|descent| descent.converged);
    let best = converged.min_by(|a, b| a.squares.total_cmp(&b.squares))?;
    Some(law(&best.unknowns))
}
