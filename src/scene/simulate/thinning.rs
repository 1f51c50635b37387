//! Plastic film that strains on in one row of elements before it reaches its limit.

use membrane::material::Hardening;

/// Steps in which a flow curve is searched.
const STEPS: u32 = 2000;

/// Equivalent plastic strain up to `most` from which film thins by itself even in equibiaxial tension, where it does so
/// last: dσ/dp = σ/2 (Swift, J. Mech. Phys. Solids 1, 1952).
pub(super) fn thins_from(hardening: &Hardening, most: f64) -> Option<f64> {
    let step = most / f64::from(STEPS);
    let thins = |strain: &f64| {
        let [stress, next] = [*strain, strain + step].map(|strain| hardening.stress(strain));
        2.0 * (next - stress) < stress * step
    };
    (0..STEPS).map(|place| step * f64::from(place)).find(thins)
}

#[cfg(test)]
mod tests {
    use super::*;
    use membrane::material::{FlowCurve, Voce};

    #[test]
    fn a_saturating_film_thins_where_swift_says() {
        let (initial, saturation, rate) = (8e6, 20e6, 8.0);
        let found = thins_from(&Hardening::Voce(Voce { initial, saturation, rate }), 1.0).unwrap();
        let expected = (2.0 * (saturation - initial) * (rate + 0.5) / saturation).ln() / rate;
        assert!((found - expected).abs() < 2e-3, "{found} for {expected}");
    }

    #[test]
    fn film_that_stiffens_does_not() {
        let curve = FlowCurve::new(&[[0.0, 8e6], [0.5, 20e6], [1.0, 40e6]]).unwrap();
        assert_eq!(thins_from(&Hardening::Table(curve), 0.9), None);
    }
}
