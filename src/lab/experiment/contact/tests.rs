use super::*;
use crate::signal::Series;

const STEP: f64 = 1e-4;
const CONTACT: f64 = 0.48317;
const NET: f64 = 8.6;
const ZERO: ZeroOffset = ZeroOffset { samples: 1, deviation: 0.05 };

/// Falls with NET from t = 0; from CONTACT on −9.8 + 400 u + 3000 u² m/s².
fn acceleration(t: f64) -> f64 {
    let u = t - CONTACT;
    if u < 0.0 { -NET } else { -9.8 + 400.0 * u + 3000.0 * u * u }
}

fn place(t: f64) -> f64 {
    let u = t - CONTACT;
    if u < 0.0 {
        return 0.5 * NET * (CONTACT * CONTACT - t * t);
    }
    -NET * CONTACT * u - 4.9 * u * u + 400.0 / 6.0 * u.powi(3) + 250.0 * u.powi(4)
}

fn sampled(f: impl Fn(f64) -> f64) -> Series {
    let time: Vec<f64> = (0..5500).map(|i| f64::from(i) * STEP).collect();
    let values: Vec<f64> = time.iter().map(|t| f(*t)).collect();
    Series::new(time, values)
}

fn laser(t: f64) -> f64 {
    let place = place(t);
    if (-0.035..0.015).contains(&place) { place } else { f64::NAN }
}

#[test]
fn a_clean_laser_gives_contact_and_speed() {
    let acceleration = sampled(acceleration);
    for ideal in [0.2, 0.4515, 0.48, 0.5] {
        let contact = by_laser(|_| acceleration.clone(), &sampled(laser), 0.0, ideal).unwrap();
        assert!((contact.time - CONTACT).abs() < 2e-6, "{contact:?}");
        assert!((contact.velocity + NET * CONTACT).abs() < 1e-3, "{contact:?}");
        assert!(contact.laser_residual.unwrap() < 1e-6, "{contact:?}");
    }
}

#[test]
fn lasers_without_usable_samples_are_refused() {
    let acceleration = sampled(acceleration);
    let found = |laser: Series| by_laser(|_| acceleration.clone(), &laser, 0.0, 0.45).unwrap_err();
    assert!(matches!(found(sampled(|_| f64::NAN)), ContactError::LaserWithoutSamples { .. }));
    assert_eq!(found(sampled(|t| -laser(t))), ContactError::LaserReversed);
    assert!(matches!(found(sampled(|t| laser(t) + 0.7)), ContactError::NoCrossing { .. }));
}

#[test]
fn a_fall_of_which_height_or_speed_is_known_gives_them_too() {
    let known = [FallCondition::Height(0.5 * NET * CONTACT * CONTACT), FallCondition::Speed(NET * CONTACT)];
    for (known, wrong) in known.into_iter().flat_map(|known| [0.0, 0.02, -0.03].map(|wrong| (known, wrong))) {
        let fall = |offset: f64| sampled(|t| acceleration(t) + wrong - offset);
        let ClosedFall { contact, offset, .. } = by_fall(fall, known, ZERO).unwrap();
        assert!((contact.time - CONTACT).abs() < STEP, "{contact:?}");
        assert!((contact.velocity / (-NET * CONTACT) - 1.0).abs() < 5e-4, "{contact:?}");
        assert!((offset - wrong).abs() < 5e-3, "{offset}");
    }
}

#[test]
fn a_height_or_speed_that_the_fall_does_not_reach_is_refused() {
    let fall = |known| by_fall(|offset| sampled(|t| acceleration(t) - offset), known, ZERO);
    assert_eq!(fall(FallCondition::Height(9.0)), Err(ContactError::HeightNotCovered { height: 9.0 }));
    assert_eq!(fall(FallCondition::Speed(9.0)), Err(ContactError::SpeedNotReached { speed: 9.0 }));
}

/// The guide goes on rubbing less and less, without an impact; and one whose force falls off.
#[test]
fn a_slow_rise_is_not_an_onset() {
    let known = FallCondition::Height(1.0);
    for end in [0.0, -40.0] {
        let after = |t: f64| if t < CONTACT { 0.0 } else { end * (t - CONTACT) };
        let found = by_fall(|offset| sampled(|t| 0.5 * t - NET + after(t) - offset), known, ZERO);
        assert!(matches!(found, Err(ContactError::NoOnset { .. })), "{end}: {found:?}");
    }
}

/// So slow that a wrong height leaves the onset within the search: only the offset shows it.
#[test]
fn an_offset_beyond_the_scatter_of_the_rest_is_refused() {
    let time = 0.15;
    let height = 0.5 * NET * time * time;
    let zero = ZeroOffset { samples: 100, deviation: 0.1 };
    let close = |share: f64| {
        let fall = |offset: f64| sampled(|t| acceleration(t + CONTACT - time) - offset);
        by_fall(fall, FallCondition::Height(share * height), zero)
    };
    assert!(!close(1.0).unwrap().doubtful);
    assert!(close(1.007).unwrap().doubtful);
    for share in [0.98, 1.02] {
        assert!(matches!(close(share), Err(ContactError::NotClosed { .. })), "{share}: {:?}", close(share));
    }
}
