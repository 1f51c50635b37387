//! Curves by strain rate under prescribed strain.

use super::super::fibre::FibreLaw;
use super::super::history::FibreHistory;
use super::super::{Absorption, Curve};
use super::{RateCurves, RateCurvesError, RateHistory};
use crate::lane::one;

const AVERAGING_STRAIN: f64 = 0.01;
const RATES: [f64; 3] = [0.04, 4.0, 100.0];

fn curves() -> [Curve; 3] {
    [
        Curve::new(vec![[0.26, 8.4e6], [0.84, 20e6], [1.39, 29.3e6]]).unwrap(),
        // Softer at first: curves may cross.
        Curve::new(vec![[0.36, 8.4e6], [0.84, 24e6], [1.2, 29e6]]).unwrap(),
        Curve::new(vec![[0.03, 8.4e6], [0.2, 20e6], [0.75, 29e6]]).unwrap(),
    ]
}

fn family() -> RateCurves {
    RateCurves::new(RATES.into_iter().zip(curves()).collect(), AVERAGING_STRAIN).unwrap()
}

/// A fibre set under prescribed strain.
struct Fibre {
    law: RateCurves,
    absorption: Absorption,
    history: RateHistory<1>,
    strain: f64,
    stress: f64,
    /// By the trapezoidal rule from the stresses, J/m³.
    work: f64,
}

impl Fibre {
    fn new(law: RateCurves, share: f64) -> Fibre {
        let (absorption, history) = (Absorption::new(share), RateHistory::virgin());
        Fibre { law, absorption, history, strain: 0.0, stress: 0.0, work: 0.0 }
    }

    /// Strains to `strain` at `rate` (1/s) in steps of 10⁻⁵.
    fn to(&mut self, strain: f64, rate: f64) {
        let steps = ((strain - self.strain).abs() / 1e-5).ceil();
        let (from, step) = (self.strain, (strain - self.strain) / steps);
        for k in 1..=steps as usize {
            self.strain_to(from + k as f64 * step, step.abs() / rate);
        }
    }

    fn strain_to(&mut self, strain: f64, dt: f64) {
        let stress = self.law.stress(self.absorption.at(one(strain)), &mut self.history, dt)[0];
        self.work += 0.5 * (self.stress + stress) * (strain - self.strain);
        (self.strain, self.stress) = (strain, stress);
    }

    fn energy(&self) -> [f64; 2] {
        let (stored, absorbed) = self.law.energy(self.absorption.at(one(self.strain)), &self.history);
        [stored[0], absorbed[0]]
    }
}

#[test]
fn stress_is_interpolated_in_the_logarithm_of_the_rate() {
    let [slow, middle, fast] = curves();
    for strain in [0.01, 0.2, 0.5, 0.9] {
        let expected = [
            (0.001, slow.stress(strain)),
            (0.04, slow.stress(strain)),
            (0.4, 0.5 * (slow.stress(strain) + middle.stress(strain))),
            (4.0, middle.stress(strain)),
            (20.0, 0.5 * (middle.stress(strain) + fast.stress(strain))),
            (100.0, fast.stress(strain)),
            (1e4, fast.stress(strain)),
        ];
        for (rate, stress) in expected {
            let mut fibre = Fibre::new(family(), 0.9);
            fibre.to(strain, rate);
            assert!((fibre.stress / stress - 1.0).abs() < 1e-9, "{strain} at {rate}: {} for {stress}", fibre.stress);
            assert!((family().stress_at(strain, rate) / stress - 1.0).abs() < 1e-12);
        }
    }
    let mut fibre = Fibre::new(family(), 0.9);
    fibre.to(0.1, 0.4);
    let strain: crate::lane::Lane<1> = family().break_strain(&fibre.history);
    assert!((strain[0] - 0.5 * (1.39 + 1.2)).abs() < 1e-9, "{strain:?}");
}

#[test]
fn the_rate_is_averaged_over_growth_and_constant_below_the_largest_strain() {
    let mut fibre = Fibre::new(family(), 0.5);
    fibre.to(0.1, 1.0);
    let rate = |fibre: &Fibre| 1.0 / fibre.history.slowness[0];
    assert!((rate(&fibre) - 1.0).abs() < 1e-9);
    let held = fibre.history;
    fibre.to(0.05, 300.0);
    fibre.to(0.0999, 0.01);
    assert_eq!(fibre.history, held);
    // 1/r goes to the new slowness as e^(−growth/ℓ).
    fibre.to(0.1, 10.0);
    fibre.to(0.11, 10.0);
    let expected = 0.1 + 0.9 * (-1.0_f64).exp();
    assert!((1.0 / rate(&fibre) - expected).abs() < 1e-3, "{}", 1.0 / rate(&fibre));
}

#[test]
fn mounting_counts_as_the_lowest_rate() {
    let mut fibre = Fibre::new(family(), 0.9);
    fibre.strain_to(0.1, 0.0);
    assert!((fibre.stress / curves()[0].stress(0.1) - 1.0).abs() < 1e-12);
    let [stored, absorbed] = fibre.energy();
    assert!(((stored + absorbed) / curves()[0].energy(0.1) - 1.0).abs() < 1e-12);
}

/// Equal curves at several rates: the same bits of stress and slope as one curve, and the same energy.
#[test]
fn equal_curves_give_the_bits_of_one() {
    let curve = &curves()[2];
    let same = RateCurves::new(RATES.map(|rate| (rate, curve.clone())).to_vec(), AVERAGING_STRAIN).unwrap();
    let absorption = Absorption::new(0.8896);
    let (mut history, mut peak) = (RateHistory::virgin(), one(0.0));
    for (strain, dt) in [(0.1, 0.0), (0.11, 1e-3), (0.1, 1e-3), (0.3, 1e-2), (0.2999, 1e-4), (0.5, 1e-3), (-0.1, 1.0)] {
        let strain = one(strain);
        let found = same.stress(absorption.at(strain), &mut history, dt);
        assert_eq!(found, absorption.stress(curve, strain, &mut peak));
        let slope = absorption.largest_slope(curve, strain, peak, 0.005);
        assert_eq!(same.largest_slope(absorption.at(strain), &history, 0.005), slope);
        assert_eq!(same.break_strain(&history), one(curve.end()));
        let (stored, absorbed) = same.energy(absorption.at(strain), &history);
        let expected = absorption.energy(curve, strain, peak);
        assert!((stored[0] - expected.0[0]).abs() <= 1e-12 * expected.1[0].max(1.0));
        assert!((absorbed[0] - expected.1[0]).abs() <= 1e-12 * expected.1[0].max(1.0));
    }
}

/// Stored and absorbed energy are the work done, over three decades of rates.
#[test]
fn energy_equals_work() {
    for share in [0.0, 0.3, 0.8896] {
        let mut fibre = Fibre::new(family(), share);
        let mut largest = 0.0_f64;
        for (strain, rate) in [
            (0.05, 200.0),
            (0.1, 0.02),
            (0.12, 50.0),
            (0.06, 1.0),
            (0.3, 5.0),
            (0.1, 9.0),
            (0.5, 0.5),
            (0.7, 80.0),
            (0.0, 3.0),
        ] {
            fibre.to(strain, rate);
            largest = largest.max(fibre.work);
            let [stored, absorbed] = fibre.energy();
            let error = (stored + absorbed - fibre.work).abs() / largest;
            assert!(error < 1e-6, "D {share}, at {strain}: {error}");
            assert!(stored >= 0.0 && absorbed >= -1e-9 * largest, "D {share}, at {strain}: {stored}, {absorbed}");
        }
    }
}

/// Unloading returns 1 − D of the energy of the curve at the rate of the peak, at most the work done.
#[test]
fn unloading_returns_its_share_and_at_most_the_work_done() {
    for share in [0.0, 0.3, 0.8896] {
        for (slow, fast) in [(2.0, 2.0), (0.04, 100.0), (100.0, 0.04)] {
            let mut fibre = Fibre::new(family(), share);
            fibre.to(0.2, slow);
            fibre.to(0.3, fast);
            let rate = 1.0 / fibre.history.slowness[0];
            let log_rate = fibre.law.log_rate(one(1.0 / rate));
            let (work, curve) = (fibre.work, fibre.law.peak_energy(log_rate, &fibre.history)[0]);
            fibre.to(0.0, 1.0);
            let returned = work - fibre.work;
            let expected = ((1.0 - share) * curve).min(work);
            let off = (returned - expected).abs();
            assert!(off < 1e-4 * work, "D {share}, {slow} to {fast}: {returned} for {expected}");
        }
    }
}

/// The bound on the slope holds for every step within its range, at any rate, on loading and unloading.
#[test]
fn the_slope_is_bounded_at_any_rate() {
    const RANGE: f64 = 0.005;
    for share in [0.0, 0.5, 0.8896] {
        for (before, until) in [(0.001, 0.004), (0.04, 0.02), (0.5, 0.1), (30.0, 0.3), (1000.0, 0.6), (0.04, 0.8)] {
            let mut fibre = Fibre::new(family(), share);
            fibre.to(until, before);
            for back in [0.0, 0.002, 0.01] {
                fibre.to(until - back, 1.0);
                let bound = fibre.law.largest_slope(fibre.absorption.at(one(fibre.strain)), &fibre.history, RANGE)[0];
                for rate in [1e-3, 0.1, 7.0, 69.0, 1e4] {
                    for sign in [1.0, -1.0] {
                        let mut moved = Fibre { law: fibre.law.clone(), ..fibre };
                        let (step, start) = (1e-5, moved.strain);
                        for k in 1..=(RANGE / step) as usize {
                            // ∂σ/∂ε of this step, from two strains reached in the same time.
                            let strain = start + sign * step * (k as f64 - 0.5);
                            let at = |strain: f64| {
                                let mut history = moved.history;
                                moved.law.stress(moved.absorption.at(one(strain)), &mut history, step / rate)[0]
                            };
                            let slope = (at(strain + 1e-8) - at(strain - 1e-8)) / 2e-8;
                            let is_bounded = slope <= bound * (1.0 + 1e-6) + 1.0;
                            assert!(is_bounded, "D {share}, {before} then {rate}: {slope} over {bound}");
                            moved.strain_to(strain, step / rate);
                        }
                    }
                }
            }
        }
    }
}

/// The change of stress where growth begins slowly is bounded by the slope times the strain of that time.
#[test]
fn stress_changes_within_the_slope_where_growth_begins() {
    for until in [0.002, 0.1, 0.5] {
        for rate in [0.1, 7.0, 1000.0] {
            let mut fibre = Fibre::new(family(), 0.9);
            fibre.to(until, rate);
            let bound = fibre.law.largest_slope(fibre.absorption.at(one(until)), &fibre.history, 0.005)[0];
            for dt in [1e-6, 5e-5] {
                let stress =
                    fibre.law.stress(fibre.absorption.at(one(until + 1e-12)), &mut fibre.history.clone(), dt)[0];
                let step = (stress - fibre.stress).abs();
                assert!(step <= bound * rate * dt + 1.0, "{until} at {rate}, {dt} s: {step}");
            }
        }
    }
}

#[test]
fn invalid_curves_are_refused() {
    let [slow, _, fast] = curves();
    let late = Curve::new(vec![[0.1, 0.0], [0.2, 1e6]]).unwrap();
    let cases = [
        (vec![], AVERAGING_STRAIN, RateCurvesError::Empty),
        (vec![(0.0, slow.clone())], AVERAGING_STRAIN, RateCurvesError::InvalidRate { index: 0, rate: 0.0 }),
        (
            vec![(4.0, slow.clone()), (4.0, fast.clone())],
            AVERAGING_STRAIN,
            RateCurvesError::RateNotIncreasing { index: 1, rate: 4.0, previous: 4.0 },
        ),
        (vec![(4.0, slow.clone()), (5.0, late)], AVERAGING_STRAIN, RateCurvesError::NoInitialSlope { index: 1 }),
        (vec![(4.0, slow), (5.0, fast)], 0.0, RateCurvesError::InvalidAveragingStrain { strain: 0.0 }),
    ];
    for (curves, averaging_strain, error) in cases {
        assert_eq!(RateCurves::new(curves, averaging_strain), Err(error));
    }
}

/// The mean of two families with other rates, and of a family with a single curve.
#[test]
fn the_mean_of_two_families_has_the_mean_of_their_stresses() {
    let [slow, middle, _] = curves();
    // 1/(1/49) is not 49: a rate is found again as it was given.
    let other = RateCurves::new(vec![(4.0, middle.clone()), (49.0, slow.clone())], AVERAGING_STRAIN).unwrap();
    let single = RateCurves::from(middle);
    for [first, second] in [[&family(), &other], [&family(), &single], [&single, &other], [&other, &other]] {
        let mean = <RateCurves as FibreLaw>::mean(first, second, 0.8);
        for rate in [0.01, 0.04, 1.0, 4.0, 30.0, 49.0, 70.0, 200.0] {
            for strain in [0.02, 0.3, 0.7, 1.3, 2.0] {
                let expected = 0.4 * (first.stress_at(strain, rate) + second.stress_at(strain, rate));
                let found = mean.stress_at(strain, rate);
                assert!((found / expected - 1.0).abs() < 1e-12, "{found} for {expected} at {strain}, {rate} 1/s");
            }
        }
    }
}
