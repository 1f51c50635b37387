use crate::error::{Error, Kind, refusal};
use crate::signal::interpolated;
use base::budget::Numbers;

/// Largest decrease of strain, as a share of its range, that counts as jitter of jaws or extensometer.
pub const JITTER: f64 = 0.01;

/// Nominal stress over engineering strain of a coupon, or the mean of several. Cheap to clone.
///
/// Strain increases from sample to sample.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    strain: Numbers,
    stress: Numbers,
    merged: usize,
}

impl Curve {
    /// The curve through samples of `strain` and `stress` (Pa).
    ///
    /// Where strain does not increase, neighbouring samples are merged to their mean until it does (the pooling of
    /// isotonic regression, Barlow et al. 1972), as long as it goes back by no more than [`JITTER`] of its range.
    ///
    /// # Errors
    /// There are not as many stresses as strains, one is not finite, strain goes back further, or fewer than two samples
    /// are left.
    pub fn new(strain: Vec<f64>, stress: Vec<f64>) -> Result<Curve, Error> {
        if strain.len() != stress.len() {
            return Err(lengths(strain.len(), stress.len()));
        }
        if let Some(index) = strain.iter().zip(&stress).position(|(e, s)| !(e.is_finite() && s.is_finite())) {
            return Err(refusal!("sample {} of the curve is not finite", index + 1));
        }
        check_forward(&strain)?;
        let pools = pooled(&strain, &stress);
        if pools.len() < 2 {
            return Err(too_short());
        }
        let merged = strain.len() - pools.len();
        let (strain, stress) = pools.iter().map(|pool| (pool.strain, pool.stress)).unzip::<_, _, Vec<_>, Vec<_>>();
        Ok(Curve { strain: strain.into(), stress: stress.into(), merged })
    }

    /// Engineering strain, increasing.
    pub fn strain(&self) -> &[f64] {
        &self.strain
    }

    /// Nominal stress, Pa.
    pub fn stress(&self) -> &[f64] {
        &self.stress
    }

    /// How many samples were merged into their neighbours because strain did not increase.
    pub fn merged(&self) -> usize {
        self.merged
    }

    /// Strain and stress, sample by sample.
    pub fn samples(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.strain.iter().zip(self.stress.iter()).map(|(e, s)| [*e, *s])
    }

    /// Strains of the first and the last sample.
    pub fn range(&self) -> [f64; 2] {
        [self.strain[0], self.strain[self.strain.len() - 1]]
    }

    /// Stress (Pa) at `strain`, linear between samples; none outside of them.
    pub fn stress_at(&self, strain: f64) -> Option<f64> {
        interpolated(&self.strain, &self.stress, strain)
    }

    /// Stress (Pa) at `strain`, linear between samples; beyond the last, on the line through the last two; none before
    /// the first.
    pub fn continued(&self, strain: f64) -> Option<f64> {
        let last = self.strain.len() - 1;
        let beyond = strain - self.strain[last];
        if beyond <= 0.0 {
            return self.stress_at(strain);
        }
        let slope = (self.stress[last] - self.stress[last - 1]) / (self.strain[last] - self.strain[last - 1]);
        Some(self.stress[last] + beyond * slope)
    }

    /// The samples with `from <= strain <= to`; none where fewer than two are left.
    pub fn within(&self, [from, to]: [f64; 2]) -> Option<Curve> {
        let start = self.strain.partition_point(|e| *e < from);
        let end = self.strain.partition_point(|e| *e <= to).max(start);
        let (strain, stress) = (self.strain[start..end].into(), self.stress[start..end].into());
        (end - start >= 2).then_some(Curve { strain, stress, merged: self.merged })
    }

    /// Resultant stress σ_h = σ·h (N/m) of a membrane of the thickness h (m), sample by sample (equation 3).
    pub fn resultant(&self, thickness: f64) -> Vec<f64> {
        self.stress.iter().map(|stress| stress * thickness).collect()
    }

    /// The curve shifted along strain so that its elastic line goes through the origin: the toe compensation of ASTM
    /// D882 for slack and seating. `slope` and `intercept` (Pa) are those of the line, see [`super::Modulus`].
    pub fn toe_compensated(&self, slope: f64, intercept: f64) -> Curve {
        let toe = -intercept / slope;
        Curve { strain: self.strain.iter().map(|strain| strain - toe).collect(), ..self.clone() }
    }
}

/// Refuses so many strains for so many stresses.
pub(super) fn lengths(strain: usize, stress: usize) -> Error {
    refusal!("{strain} strains for {stress} stresses")
}

/// Refuses fewer than two samples.
pub(crate) fn too_short() -> Error {
    refusal!("a curve needs two samples of different strain")
}

fn check_forward(strain: &[f64]) -> Result<(), Error> {
    let smallest = strain.iter().copied().fold(f64::INFINITY, f64::min);
    let largest = strain.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let most = JITTER * (largest - smallest);
    let mut before = f64::NEG_INFINITY;
    for (index, strain) in strain.iter().copied().enumerate() {
        if strain < before - most {
            let sample = index + 1;
            let error = refusal!("strain goes back at sample {sample}: {strain} after {before}");
            return Err(error.with_kind(Kind::GoesBack(sample)));
        }
        before = before.max(strain);
    }
    Ok(())
}

/// The mean of neighbouring samples.
struct Pool {
    strain: f64,
    stress: f64,
    count: f64,
}

impl Pool {
    fn join(&mut self, other: &Pool) {
        let count = self.count + other.count;
        let mean = |own: f64, others: f64| (own * self.count + others * other.count) / count;
        *self = Pool { strain: mean(self.strain, other.strain), stress: mean(self.stress, other.stress), count };
    }
}

fn pooled(strain: &[f64], stress: &[f64]) -> Vec<Pool> {
    let mut pools: Vec<Pool> = Vec::with_capacity(strain.len());
    for (strain, stress) in strain.iter().copied().zip(stress.iter().copied()) {
        let mut pool = Pool { strain, stress, count: 1.0 };
        while let Some(mut last) = pools.pop_if(|last| last.strain >= pool.strain) {
            last.join(&pool);
            pool = last;
        }
        pools.push(pool);
    }
    pools
}

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

    #[test]
    fn jitter_is_merged_to_its_mean_and_counted() {
        let strain = vec![0.0, 0.501, 0.499, 1.0, 1.0];
        let curve = Curve::new(strain, vec![0.0, 4.0, 6.0, 9.0, 11.0]).unwrap();
        assert_eq!((curve.strain(), curve.stress()), ([0.0, 0.5, 1.0].as_slice(), [0.0, 5.0, 10.0].as_slice()));
        assert_eq!(curve.merged(), 2);
    }

    #[test]
    fn a_curve_extends_along_its_last_piece_only() {
        let curve = Curve::new(vec![0.1, 0.2, 0.4], vec![1.0, 3.0, 4.0]).unwrap();
        let found = [0.05, 0.1, 0.3, 0.4, 0.6].map(|strain| curve.continued(strain));
        assert_eq!(found[..2], [None, Some(1.0)]);
        for (found, expected) in found[2..].iter().zip([3.5, 4.0, 5.0]) {
            assert!((found.unwrap() - expected).abs() < 1e-12, "{found:?} for {expected}");
        }
    }

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
