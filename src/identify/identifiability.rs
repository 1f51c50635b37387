//! What can be known from the residuals and what cannot, in plain words.
//!
//! Directions in the logarithms of the parameters are the right singular vectors of ∂r/∂ln x (Belsley, Kuh and Welsch,
//! *Regression Diagnostics*, 1980). One that the noise hides is practically not identifiable, one that no residual feels
//! structurally (Raue et al., Bioinformatics 25, 2009).

use super::confidence::Confidence;
use super::tangent::Tangent;

/// Factor by which a combination must be able to change within its interval of 95 % to count as not identifiable.
const TOO_WIDE: f64 = 1.5;

/// Share of the strongest combination's effect below which one rests on details of model and sensor, whatever the noise.
/// Condition indices from 30 to 100 tell of moderate to strong relations (Belsley, Kuh and Welsch 1980).
const TOO_WEAK: f64 = 0.01;

/// Correlation of two parameters beyond which it is told.
const TOO_CORRELATED: f64 = 0.95;

/// Exponents below this share of the largest are left out of a combination's name.
const MINOR: f64 = 0.1;

/// Independent residuals for each parameter below which, and share of all residuals below which, they are rather the model's
/// error than noise.
const FEW: f64 = 10.0;
const DEPENDENT: f64 = 1.0 / 3.0;

/// Standard errors by which a further step may move a parameter of a finished search.
const UNFINISHED: f64 = 0.5;

/// A combination Π x_j^{v_j} of the parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Direction {
    /// v, of length one.
    pub exponents: Vec<f64>,
    /// Half the width of the interval of 95 % of Σ v_j ln x_j.
    pub half_width: f64,
    /// Its singular value over the largest.
    pub share: f64,
}

impl Direction {
    /// The largest exponent, with its sign.
    fn leading(&self) -> f64 {
        self.exponents.iter().copied().max_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(1.0)
    }

    /// The factor by which the combination may change, its leading exponent being one.
    fn factor(&self) -> f64 {
        (self.half_width / self.leading().abs()).exp()
    }

    /// The combination in the field's words, such as `k1·ke^-0.8`. A parameter at zero has no logarithm: its own change
    /// takes that place.
    fn name(&self, names: &[String], x: &[f64]) -> String {
        let leading = self.leading();
        let factor = |((exponent, name), x): ((&f64, &String), &f64)| {
            let sign = if *x < 0.0 { -1.0 } else { 1.0 };
            let exponent = (10.0 * sign * exponent / leading).round() / 10.0;
            let base = if *x == 0.0 { format!("exp({name})") } else { name.clone() };
            (exponent.abs() >= MINOR).then(|| if exponent == 1.0 { base } else { format!("{base}^{exponent}") })
        };
        self.exponents.iter().zip(names).zip(x).filter_map(factor).collect::<Vec<_>>().join("·")
    }
}

/// What the user should know before trusting an estimate.
pub(super) fn warnings(confidence: &Confidence, tangent: &Tangent) -> Vec<String> {
    let mut warnings: Vec<String> = confidence.directions.iter().filter_map(|d| weakness(d, confidence)).collect();
    warnings.extend(correlations(confidence));
    warnings.extend(scarcity(confidence));
    warnings.extend(exactness(tangent));
    warnings.extend(tangent.one_sided.iter().map(|place| {
        let name = &confidence.names[*place];
        format!("the slope along {name} is one-sided (bound or failed trial): its interval holds on that side at best")
    }));
    warnings.extend(unfinished(confidence));
    warnings
}

fn weakness(direction: &Direction, confidence: &Confidence) -> Option<String> {
    let name = direction.name(&confidence.names, &confidence.x);
    let factor = direction.factor();
    if direction.share == 0.0 {
        return Some(format!("{name} is not identifiable: it may change at will, the curves do not change with it"));
    }
    if factor > TOO_WIDE {
        let factor = if factor < 1e3 { format!("{factor:.1}") } else { format!("{factor:.0e}") };
        return Some(format!(
            "{name} is not identifiable: it may change by a factor {factor} while the curves change less than their noise"
        ));
    }
    (direction.share < TOO_WEAK).then(|| {
        let weaker = 1.0 / direction.share;
        format!(
            "{name} is hardly identifiable: the curves feel it {weaker:.0} times less than what they feel most, so small \
             errors of model or sensor decide it"
        )
    })
}

fn correlations(confidence: &Confidence) -> Vec<String> {
    let names = &confidence.names;
    let pairs = (0..names.len()).flat_map(|i| (i + 1..names.len()).map(move |j| (i, j)));
    let told = |(i, j): (usize, usize)| {
        let correlation = confidence.correlation[(i, j)];
        (correlation.abs() > TOO_CORRELATED).then(|| {
            let way = if correlation > 0.0 { "together" } else { "against each other" };
            format!("{} and {} are correlated by {correlation:.3}: they change {way}", names[i], names[j])
        })
    };
    pairs.filter_map(told).collect()
}

fn scarcity(confidence: &Confidence) -> Option<String> {
    let Confidence { samples, effective_samples: effective, .. } = *confidence;
    let parameters = confidence.names.len();
    let told = effective < FEW * parameters as f64 && effective < DEPENDENT * samples as f64;
    told.then(|| {
        format!(
            "the {samples} residuals hang together so much that they count as {effective:.1} for {parameters} parameters: they \
             are rather the model's error than noise, and intervals do not hold what a wrong model is wrong by"
        )
    })
}

fn exactness(tangent: &Tangent) -> Option<String> {
    (tangent.norm() <= tangent.bend || tangent.norm() == 0.0).then(|| {
        "the residuals are no larger than what the model itself does beside the estimate (its roughness, its curvature over the \
         step of the differences): the intervals mean that, not the scatter of measurements"
            .into()
    })
}

fn unfinished(confidence: &Confidence) -> Vec<String> {
    let told = |(name, step): (&String, &f64)| {
        (step.abs() > UNFINISHED).then(|| {
            format!("{name} is not at its minimum: a further step would move it by {:.1} standard errors", step.abs())
        })
    };
    confidence.names.iter().zip(&confidence.unfinished).filter_map(told).collect()
}
