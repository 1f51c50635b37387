//! How much of a film is stretched in both directions at once.

use membrane::engine::ElementStrain;

/// Larger principal strain from which an element counts.
const STRAINED: f64 = 0.02;

/// Smaller principal strain over the larger one from which an element is under biaxial load.
const RATIO: f64 = 0.2;

/// Part of the volume of all that is not broken.
pub(super) fn biaxial_share(strains: &[ElementStrain]) -> f64 {
    let intact = || strains.iter().filter(|strain| strain.volume > 0.0 && !strain.has_failed());
    let volume = |strain: &ElementStrain| strain.volume;
    let biaxial: f64 = intact().filter(|strain| is_biaxial(strain)).map(volume).sum();
    let all: f64 = intact().map(volume).sum();
    if all > 0.0 { biaxial / all } else { 0.0 }
}

fn is_biaxial(strain: &ElementStrain) -> bool {
    let [md, td, shear] = strain.strain;
    let [c11, c22, c12] = [(1.0 + md).powi(2), (1.0 + td).powi(2), (1.0 + md) * (1.0 + td) * shear.sin()];
    let (mean, half) = (0.5 * (c11 + c22), (0.5 * (c11 - c22)).hypot(c12));
    let [larger, smaller] = [mean + half, mean - half].map(|square| square.max(0.0).sqrt() - 1.0);
    larger > STRAINED && smaller > RATIO * larger
}

#[cfg(test)]
mod tests {
    use super::*;

    fn strained(strain: [f64; 3], volume: f64) -> ElementStrain {
        ElementStrain { strain, volume, left: [1.0; 2], ..ElementStrain::default() }
    }

    #[test]
    fn the_share_is_that_of_both_principal_strains() {
        let cases = [
            ([0.1, 0.1, 0.0], true),
            ([0.1, 0.01, 0.0], false),
            ([0.01, 0.01, 0.0], false),
            ([0.3, -0.1, 0.0], false),
            // A strip that is pulled at 45 degrees: its fibres are strained alike, but by shear.
            ([0.1, 0.1, 0.19], false),
        ];
        for (strain, expected) in cases {
            assert_eq!(is_biaxial(&strained(strain, 1.0)), expected, "{strain:?}");
        }
        let film = [strained([0.1, 0.1, 0.0], 1.0), strained([0.1, 0.0, 0.0], 3.0), strained([0.5, 0.5, 0.0], 0.0)];
        assert!((biaxial_share(&film) - 0.25).abs() < 1e-12);
        assert_eq!(biaxial_share(&[]), 0.0);
    }
}
