use super::Curve;
use crate::error::{Error, refusal};

/// The differences √w (σ − σ_e)/√(Σ w σ_e²) of `curve` from `reference` at the samples of the reference, with the
/// weights w of the trapezoidal rule over strain (methods.md, equation 162). Their norm is the relative error over
/// strain; samples that lie close count no more than others.
pub fn relative_residuals(curve: &Curve, reference: &Curve) -> Result<Vec<f64>, Error> {
    let weights = weights(reference.strain());
    let size: f64 = weights.iter().zip(reference.stress()).map(|(w, expected)| w * expected * expected).sum();
    if size == 0.0 {
        return Err(refusal!("the reference has no stress anywhere"));
    }
    let residual = |([strain, expected], w): ([f64; 2], &f64)| {
        let found = curve
            .stress_at(strain)
            .ok_or_else(|| refusal!("the curve has no stress at the strain {strain}, where the reference has one"))?;
        Ok((w / size).sqrt() * (found - expected))
    };
    reference.samples().zip(&weights).map(residual).collect()
}

/// Weights of samples at `strain` in the trapezoidal rule.
fn weights(strain: &[f64]) -> Vec<f64> {
    let mut weights = vec![0.0; strain.len()];
    for k in 1..strain.len() {
        let half = 0.5 * (strain[k] - strain[k - 1]);
        weights[k - 1] += half;
        weights[k] += half;
    }
    weights
}

#[cfg(test)]
mod tests {
    use super::*;

    fn norm(curve: &Curve, reference: &Curve) -> f64 {
        relative_residuals(curve, reference).unwrap().iter().map(|r| r * r).sum::<f64>().sqrt()
    }

    /// σ = a ε against σ_e = ε: the relative error is a − 1, however the samples lie.
    #[test]
    fn close_samples_have_no_more_weight() {
        let even: Vec<f64> = (0..=10).map(|k| 0.1 * f64::from(k)).collect();
        let dense: Vec<f64> = (0..=100).map(|k| 1e-4 * f64::from(k * k)).collect();
        for strains in [even, dense] {
            let reference = Curve::new(strains.clone(), strains.clone()).unwrap();
            let curve = Curve::new(vec![0.0, 2.0], vec![0.0, 2.2]).unwrap();
            assert!((norm(&curve, &reference) - 0.1).abs() < 1e-12);
        }
        // A constant difference is that difference over the root mean square of the reference, here 1/√3 but for the
        // samples.
        let strains: Vec<f64> = (0..=1000).map(|k| 1e-3 * f64::from(k)).collect();
        let reference = Curve::new(strains.clone(), strains.clone()).unwrap();
        let curve = Curve::new(vec![0.0, 1.0], vec![0.01, 1.01]).unwrap();
        assert!((norm(&curve, &reference) - 0.01 * 3.0_f64.sqrt()).abs() < 1e-6);
    }

    #[test]
    fn curves_without_common_strain_are_refused() {
        let curve = |strain: f64, stress: f64| Curve::new(vec![0.0, strain], vec![0.0, stress]).unwrap();
        let refused = |curve, reference| relative_residuals(&curve, &reference).unwrap_err().to_string();
        let short = refused(curve(0.5, 1.0), curve(1.0, 1.0));
        assert_eq!(short, "the curve has no stress at the strain 1, where the reference has one");
        assert_eq!(refused(curve(1.0, 1.0), curve(1.0, 0.0)), "the reference has no stress anywhere");
    }
}
