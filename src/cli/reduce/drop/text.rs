//! The figures of a drop on the terminal and its page.

use base::number::significant;
use base::units::STANDARD_GRAVITY;
use lab::experiment::Warning;
use lab::experiment::drop::{Drop, Figures, Input, SpeedSource, Tower};
use membrane::engine::GuideFriction;

/// Words and value of each figure.
pub(super) fn rows(tower: &Tower, drop: &Drop, figures: &Figures) -> Vec<(&'static str, String)> {
    let bounds = drop.warnings.iter().find_map(|warning| match warning {
        Warning::Saturated { peak, deepest, .. } => Some([*peak, *deepest]),
        _ => None,
    });
    let withheld = "withheld (accelerometer at the end of its range)";
    let or_none = |value: Option<String>| value.unwrap_or_else(|| "none".into());
    let peak = figures.peak_acceleration_m_s2.zip(figures.time_of_peak_acceleration_s);
    let travel = figures.peak_displacement_m.zip(figures.time_of_peak_displacement_s);
    let from = match (figures.speed_from, figures.laser_residual_m) {
        (SpeedSource::Laser, Some(residual)) => format!("laser, residual {:.3} mm", 1e3 * residual),
        (SpeedSource::Laser, None) => "laser".into(),
        (SpeedSource::Fall, _) => "fall and onset of the force".into(),
        (SpeedSource::Given, _) => "what was given".into(),
    };
    let correction = match (drop.time_constant, figures.ramp_duration_s) {
        (Some(time_constant), _) => coupling(time_constant, figures.time_constant_interval_s),
        (None, duration) => format!("gravity ramp of {}", or_none(duration.map(|d| format!("{:.1} ms", 1e3 * d)))),
    };
    let mut rows = vec![
        ("tower", conditions(tower)),
        ("release", format!("{:.5} s on the recording's clock", figures.release_time_s)),
        (
            "contact",
            format!(
                "{:.5} s{} on the recording's clock",
                figures.contact_time_s,
                interval_of(figures.contact_time_interval_s, 1.0, 5)
            ),
        ),
        (
            "impact speed",
            format!(
                "{:.3} m/s{} (ideal fall {:.3}), from {from}",
                figures.impact_velocity_m_s,
                interval_of(figures.impact_velocity_interval_m_s, 1.0, 3),
                figures.ideal_velocity_m_s,
            ),
        ),
        (
            "peak deceleration",
            match bounds {
                Some([at_least, _]) => {
                    format!("at least {:.2} g (accelerometer at the end of its range)", at_least / STANDARD_GRAVITY)
                }
                None => or_none(peak.map(|(a, t)| format!("{:.2} g at {:.1} ms", a / STANDARD_GRAVITY, 1e3 * t))),
            },
        ),
        (
            "displacement",
            match (travel, bounds) {
                (None, Some([_, deepest])) => {
                    format!("{:.1} mm at the lowest (accelerometer at the end of its range)", 1e3 * deepest)
                }
                (travel, _) => or_none(travel.map(|(d, t)| {
                    let interval = interval_of(figures.peak_displacement_interval_m, 1e3, 1);
                    format!("{:.1} mm{interval} at {:.1} ms", 1e3 * d, 1e3 * t)
                })),
            },
        ),
        ("energy", energy(figures, bounds.is_some())),
        (
            "energy absorbed",
            match (figures.energy_absorption, bounds) {
                (None, Some(_)) => withheld.into(),
                (absorbed, _) => or_none(absorbed.map(|d| {
                    let interval = interval_of(figures.energy_absorption_interval, 100.0, 1);
                    format!("{:.1} %{interval}", 100.0 * d)
                })),
            },
        ),
        ("guide friction", or_none(figures.guide_friction.as_ref().map(|friction| guide(friction, figures)))),
        ("filtering", format!("changes the total energy by {:.4} % at most", 100.0 * figures.total_energy_drift)),
        ("correction", correction),
    ];
    let rebound = figures.rebound_velocity_m_s.zip(figures.time_of_rebound_s);
    let rebound = rebound.map(|(speed, time)| {
        let interval = interval_of(figures.rebound_velocity_interval_m_s, 1.0, 3);
        format!("{speed:.3} m/s{interval} at {:.1} ms", 1e3 * time)
    });
    rows.insert(6, ("rebound", or_none(rebound)));
    if let Some((input, share)) = figures.widest_input.zip(figures.widest_share) {
        rows.push(("intervals", "95 % by noise, zero, coupling, friction, height, release and onset".into()));
        rows.push(("widest by", widest(input, share)));
    }
    rows
}

/// Mass and height.
fn conditions(tower: &Tower) -> String {
    let mass = significant(tower.body.mass, 6);
    match tower.height {
        Some(height) => format!("{mass} kg from {} m", significant(height, 6)),
        None => format!("{mass} kg, height unknown"),
    }
}

/// The coupling of the sensor.
fn coupling(time_constant: f64, interval: Option<[Option<f64>; 2]>) -> String {
    match (time_constant.is_finite(), interval) {
        (true, Some([Some(low), Some(high)])) => {
            let interval = interval_of(Some([low, high]), 1e3, 1);
            format!("AC coupling, time constant {:.1} ms{interval}", 1e3 * time_constant)
        }
        (true, _) => format!("AC coupling, time constant {:.1} ms", 1e3 * time_constant),
        (false, Some([Some(low), _])) => format!("DC-coupled, or a time constant above {} s", significant(low, 2)),
        (false, _) => "DC-coupled".into(),
    }
}

/// The input that widens the interval of the travel most, and what narrows it.
fn widest(input: Input, share: f64) -> String {
    let (what, narrower) = match input {
        Input::Offset => ("zero of the sensor", "a longer rest before the release, or a laser"),
        Input::Coupling => ("coupling of the sensor", "--time-constant from its data sheet, or a laser"),
        Input::Friction => ("friction of the guide", "--guide-friction, or a laser"),
        Input::Height => ("height of fall", "--height with a smaller error, or a laser"),
        Input::Release => ("time of the release", "a faster release, or a laser"),
        Input::Onset => ("onset of the force", "a laser, or less noise"),
        Input::Laser => ("zero of the laser", "a laser that is zeroed on the film"),
    };
    format!("{what}, {:.0} % of the travel's; narrower with {narrower}", 100.0 * share)
}

/// An interval after its figure, times `factor`: ` [149.9 .. 150.5]`; nothing where there is none.
fn interval_of(interval: Option<[f64; 2]>, factor: f64, decimals: usize) -> String {
    let shown = |[low, high]: [f64; 2]| format!(" [{:.decimals$} .. {:.decimals$}]", low * factor, high * factor);
    interval.map_or_else(String::new, shown)
}

/// Friction of the guide, what it does to the absorption, and its line of a scenario.
fn guide(friction: &GuideFriction, figures: &Figures) -> String {
    let speed = figures.impact_velocity_m_s;
    let force = match friction.per_speed == 0.0 {
        true => format!("{:.1} N in the fall", friction.constant),
        false => format!("{:.1} N at the release, {:.1} N at contact", friction.constant, friction.force_at(speed)),
    };
    let film = figures.film_energy_absorption.map(|d| format!("; going on, the film absorbs {:.1} %", 100.0 * d));
    let per_speed =
        (friction.per_speed != 0.0).then(|| format!(", per_speed = \"{} N s/m\"", significant(friction.per_speed, 3)));
    format!(
        "{force}{}\n  {:<18} impactor.guide_friction = {{ constant = \"{} N\"{} }}",
        film.unwrap_or_default(),
        "",
        significant(friction.constant, 3),
        per_speed.unwrap_or_default(),
    )
}

/// Energies of impactor and film.
fn energy(figures: &Figures, is_clipped: bool) -> String {
    let joule = |energy: Option<f64>| energy.map_or_else(|| "none".into(), |energy| format!("{energy:.2} J"));
    let at_contact = joule(figures.impact_energy);
    match (figures.peak_absorbed_energy, figures.final_absorbed_energy) {
        (None, None) if is_clipped => format!("{at_contact} at contact; absorbed by the film: withheld"),
        (most, last) => {
            format!("{at_contact} at contact; absorbed by the film {} at most, {} at the end", joule(most), joule(last))
        }
    }
}
