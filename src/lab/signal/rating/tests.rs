use std::f64::consts::PI;

use super::*;

fn sampled_at(step: f64, [from, to]: [f64; 2], f: impl Fn(f64) -> f64) -> Series {
    let count = ((to - from) / step + 0.5) as usize;
    let time: Vec<f64> = (0..=count).map(|i| from + i as f64 * step).collect();
    let values: Vec<f64> = time.iter().map(|t| f(*t)).collect();
    Series::new(time, values)
}

fn at_10_khz(f: impl Fn(f64) -> f64) -> Series {
    sampled_at(1e-4, [0.0, 0.0999], f)
}

fn pulse(t: f64) -> f64 {
    100.0 * (-((t - 0.05) / 0.008).powi(2)).exp()
}

#[test]
fn a_curve_follows_itself() {
    for curve in [at_10_khz(pulse), at_10_khz(|t| (2.0 * PI * 100.0 * t).sin()), at_10_khz(|t| 5.0 + t)] {
        let rating = rate(&curve, &curve).unwrap();
        assert_eq!([rating.corridor, rating.phase, rating.magnitude, rating.slope], [1.0; 4]);
        assert!((rating.overall - 1.0).abs() < 1e-15 && rating.grade == Grade::Excellent && rating.shift == 0.0);
        assert!(rating.warnings.is_empty() && rating.samples == 1000, "{rating:?}");
    }
}

#[test]
fn a_shifted_curve_only_loses_phase_and_corridor() {
    for late in [37, -52] {
        let rating = rate(&at_10_khz(pulse), &at_10_khz(|t| pulse(t - 1e-4 * f64::from(late)))).unwrap();
        assert!((rating.shift - 1e-4 * f64::from(late)).abs() < 1e-12, "{rating:?}");
        assert!((rating.phase - (200.0 - f64::from(late).abs()) / 200.0).abs() < 1e-12);
        assert!(rating.magnitude > 1.0 - 1e-9 && rating.slope > 1.0 - 1e-9 && rating.corridor < 1.0);
    }
}

#[test]
fn a_constant_offset_costs_corridor_and_magnitude_by_their_closed_forms() {
    let (size, offset) = (2.0, 0.5);
    let sine = |t: f64| size * (2.0 * PI * 10.0 * t).sin();
    let rating = rate(&at_10_khz(sine), &at_10_khz(|t| sine(t) + offset)).unwrap();
    let largest = at_10_khz(sine).largest().unwrap()[1];
    let exact = ((0.5 - offset / largest) / 0.45f64).powi(2);
    assert!((rating.corridor - exact).abs() < 1e-12, "{rating:?} for {exact}");
    assert!(rating.phase == 1.0 && rating.slope > 1.0 - 1e-9);
    let inside = rate(&at_10_khz(sine), &at_10_khz(|t| sine(t) + 0.049 * largest)).unwrap();
    assert_eq!(inside.corridor, 1.0);
    let outside = rate(&at_10_khz(sine), &at_10_khz(|t| sine(t) - 0.51 * largest)).unwrap();
    assert_eq!(outside.corridor, 0.0);
}

#[test]
fn a_scaled_curve_costs_slope_and_corridor_by_their_closed_forms() {
    let rating = rate(&at_10_khz(pulse), &at_10_khz(|t| 1.2 * pulse(t))).unwrap();
    assert_eq!((rating.phase, rating.shift), (1.0, 0.0));
    assert!((rating.slope - (2.0 - 0.2) / 2.0).abs() < 1e-12, "{rating:?}");
    let peak = at_10_khz(pulse).largest().unwrap()[1];
    let score = |[_, value]: [f64; 2]| match 0.2 * value / peak {
        d if d < 0.05 => 1.0,
        d => ((0.5 - d) / 0.45f64).powi(2),
    };
    let corridor = at_10_khz(pulse).samples().map(score).sum::<f64>() / 1000.0;
    assert!((rating.corridor - corridor).abs() < 1e-12);
    // Warping does not reduce the difference of a peak that is too high, nor does it increase it.
    assert!(rating.magnitude >= 0.6 - 1e-12 && rating.magnitude < 1.0);
}

#[test]
fn opposite_curves_are_rated_zero() {
    let rating = rate(&at_10_khz(pulse), &at_10_khz(|t| -3.0 * pulse(t))).unwrap();
    assert_eq!((rating.magnitude, rating.slope, rating.grade), (0.0, 0.0, Grade::Poor));
}

#[test]
fn grades_are_those_of_the_specification() {
    use Grade::*;
    let found = [1.0, 0.941, 0.94, 0.81, 0.80, 0.59, 0.58, 0.0].map(Grade::from_rating);
    assert_eq!(found, [Excellent, Excellent, Good, Good, Fair, Fair, Poor, Poor]);
}

#[test]
fn other_rates_and_spans_are_brought_together_and_reported() {
    let (fine, late) = (sampled_at(1e-6, [0.0, 0.1], pulse), sampled_at(1e-4, [0.005, 0.095], pulse));
    let rating = rate(&fine, &late).unwrap();
    assert_eq!(rating.samples, 901);
    assert!(rating.overall > 1.0 - 1e-6, "{rating:?}");
    let curve = Curve::Reference;
    assert_eq!(rating.warnings, [Warning::CurveResampled { curve, samples: 100_001, from: 0.005, to: 0.095 }]);
    let cut = rate(&at_10_khz(pulse), &late).unwrap();
    assert_eq!(cut.warnings, [Warning::CurveCut { curve, from: 0.005, to: 0.095 }]);
}

#[test]
fn a_constant_comparison_is_noted() {
    let rating = rate(&at_10_khz(pulse), &at_10_khz(|_| 3.0)).unwrap();
    assert_eq!(rating.warnings, [Warning::ConstantCurve]);
}

/// The whole matrix, and the way back through it.
fn by_matrix(reference: &[f64], comparison: &[f64], band: usize) -> [f64; 2] {
    let n = reference.len();
    let mut cost = vec![vec![f64::INFINITY; n]; n];
    let at = |cost: &Vec<Vec<f64>>, i: isize, j: isize| {
        if i < 0 || j < 0 { f64::INFINITY } else { cost[i as usize][j as usize] }
    };
    let from = |cost: &Vec<Vec<f64>>, i: usize, j: usize| {
        let (i, j) = (i as isize, j as isize);
        let steps = [(i - 1, j), (i, j - 1), (i - 1, j - 1)];
        steps.into_iter().reduce(|a, b| if at(cost, b.0, b.1) < at(cost, a.0, a.1) { b } else { a }).unwrap()
    };
    for i in 0..n {
        for j in i.saturating_sub(band)..(i + band + 1).min(n) {
            let (before_i, before_j) = from(&cost, i, j);
            let before = if i == 0 && j == 0 { 0.0 } else { at(&cost, before_i, before_j) };
            cost[i][j] = before + (comparison[i] - reference[j]).powi(2);
        }
    }
    let (mut i, mut j, mut sums) = (n - 1, n - 1, [0.0, 0.0]);
    loop {
        sums = [sums[0] + (comparison[i] - reference[j]).abs(), sums[1] + reference[j].abs()];
        if i == 0 && j == 0 {
            return sums;
        }
        let (before_i, before_j) = from(&cost, i, j);
        (i, j) = (before_i as usize, before_j as usize);
    }
}

#[test]
fn running_sums_are_those_along_the_path() {
    for (n, band) in [(9, 0), (12, 1), (57, 5), (58, 5), (130, 12), (40, 39)] {
        let reference: Vec<f64> = (0..n).map(|i| (0.11 * i as f64).sin() + 0.1 * (i * i % 7) as f64).collect();
        let comparison: Vec<f64> = (0..n).map(|i| (0.12 * i as f64 - 0.2).sin() + 0.1 * (i * i % 5) as f64).collect();
        let expected = by_matrix(&reference, &comparison, band);
        for width in Width::available() {
            let found = warped(width, &reference, &comparison, band);
            assert!(
                found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12 * b),
                "{n}, {band}: {found:?} {expected:?}"
            );
        }
    }
}

#[test]
fn ties_of_paths_are_broken_as_specified() {
    // Plateaus make ties everywhere.
    let reference: Vec<f64> = (0..60).map(|i| f64::from(i / 13)).collect();
    let comparison: Vec<f64> = (0..60).map(|i| f64::from((i + 4) / 11) - 0.5).collect();
    for band in [3, 5, 20] {
        assert_eq!(warped(Width::best(), &reference, &comparison, band), by_matrix(&reference, &comparison, band));
    }
}
