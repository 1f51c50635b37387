//! From the readings of the sensors to contact, speed, travel and energies: a recording, a fit of its model, the figures.

use super::channels::Clipping;
use super::fit::{self, Fit};
use super::model::{Model, Unknowns, of};
use super::recording::Recorded;
use super::release::{self, GravityRamp, Release};
use super::result::{Contact, Drop, Intervals, Landmarks, SpeedSource};
use super::{Class, Correction, Known, Reduction, Tower};
use crate::error::{Error, Kind, refusal};
use crate::experiment::absorption::{energy_absorption, film_absorption as film_absorption_by, first_impact};
use crate::experiment::{Warning, coupling};
use crate::signal::column::Column;
use crate::signal::filter::{self, ChannelFilter, Standard};
use crate::signal::{Recording, Series, column, gap, resample};
use base::number::significant;
use membrane::engine::GuideFriction;

/// Largest time between samples of a drop, s.
const SLOWEST: f64 = 5e-3;
/// Classes of the filter, of which the highest that the rate allows is taken.
const CLASSES: [f64; 4] = [1000.0, 600.0, 180.0, 60.0];
/// Standard deviations by which what is known pulls, or colour of what is left, from which on the recording is asked
/// without it.
const PULLS: f64 = 3.0;
const MISFIT: f64 = 2.0;
/// Length of the means of the fall, s, and by how much one may be off the model, m/s²: a tenth of gravity. Guides rub by less.
const FALL_BIN: f64 = 0.01;
const OFF_FALL: f64 = 1.0;
/// The same of the onset of the force, of which film is off by less than a tenth.
const ONSET_BIN: f64 = 0.004;
const OFF_ONSET: f64 = 0.1;
/// Sum of squares, over the colour, and share of the value by which what is known contradicts the recording.
const CONTRADICTS: f64 = 25.0;
const DIFFERS: f64 = 0.01;
/// Time (s) and standard deviations by which the contact with the laser is another one than that without it.
const CONTACT_APART: f64 = 3e-4;
const CONTACT_DEVIATIONS: f64 = 3.0;
/// Excess over the speed of the free fall below which it is none: standard gravity is right to 0.3 %, half of it in the speed.
const LEAST_EXCESS: f64 = 1e-3;
/// Friction over the weight and its deviation where the recording alone is to tell it.
const ANY_FRICTION: [f64; 2] = [0.0, 0.3];

/// Reduces the `acceleration` that was read (m/s², upward) and, where there is one, the `laser`'s distance from the
/// film's upper face (m, upward; `NaN` out of range). Both have one clock and start with the impactor at rest.
pub fn reduce(
    acceleration: &Series,
    laser: Option<&Series>,
    tower: &Tower,
    reduction: &Reduction,
) -> Result<Drop, Error> {
    check(tower, reduction)?;
    let reading = even(acceleration)?;
    let step = resample::common_step(reading.time()).unwrap_or(f64::INFINITY);
    if step > SLOWEST {
        let step = significant(step, 6);
        return Err(refusal!(
            "acceleration: its samples are {step} s apart, too far for an impact; are the times in milliseconds?"
        )
        .with_hint("name all columns with their units: --columns \"time [ms],accel [g]\""));
    }
    let (class, of_rate) = class(reduction.class, step)?;
    let explained = Explained::find(&reading, step, laser, tower, reduction)?;
    finish(&explained, tower, reduction, class, of_rate)
}

fn check(tower: &Tower, reduction: &Reduction) -> Result<(), Error> {
    let mut values = vec![("mass", Some(tower.body.mass)), ("gravity", Some(tower.body.gravity))];
    values.extend([("height", tower.height), ("impact speed", reduction.speed)]);
    values.extend([
        ("error of the height", reduction.height_error),
        ("error of the impact speed", reduction.speed_error),
        ("error of the time of contact", reduction.contact_error),
    ]);
    values.push(("error of the guide's friction", reduction.guide_friction.map(|[_, error]| error)));
    if let Correction::Coupling { time_constant } = reduction.correction {
        values.push(("time constant", time_constant));
    }
    let values = values.into_iter().filter_map(|(what, value)| Some((what, value?)));
    let wrong = values.into_iter().find(|(_, value)| value.is_nan() || *value <= 0.0 || value.is_infinite());
    let refused =
        |(what, value): (&str, f64)| refusal!("the {what} is {}, but must be positive", significant(value, 6));
    wrong.map_or(Ok(()), |wrong| Err(refused(wrong)))?;
    let is_known = tower.height.is_some() || reduction.speed.is_some() || reduction.contact_time.is_some();
    is_known.then_some(()).ok_or_else(|| refusal!("neither height, impact speed nor time of contact is known"))
}

/// The reading on equal steps.
pub(super) fn even(acceleration: &Series) -> Result<Series, Error> {
    gap::check(acceleration).map_err(|gap| Error::from(gap).about("acceleration"))?;
    let count = acceleration.len();
    if count < 2 {
        return Err(resample::too_short(count).about("acceleration"));
    }
    if resample::common_step(acceleration.time()).is_some() {
        return Ok(acceleration.clone());
    }
    // A few times that are written twice or left out do not change the median.
    resample::uniform(acceleration, gap::usual_step(acceleration.time())).map_err(|error| error.about("acceleration"))
}

/// The class for samples `step` (s) apart, and the note that the rate allows no higher one.
fn class(class: Class, step: f64) -> Result<(Option<f64>, Option<Warning>), Error> {
    let allowed = |class: f64| ChannelFilter::new(class, step, Standard::Iso6487).map(|_| class);
    match class {
        Class::None => Ok((None, None)),
        Class::Given(class) => {
            let class = allowed(class).map_err(|error| error.about("acceleration"))?;
            Ok((Some(class), None))
        }
        Class::OfRate => {
            let class = CLASSES.into_iter().find(|class| allowed(*class).is_ok());
            let is_lower = class != Some(CLASSES[0]);
            Ok((class, is_lower.then_some(Warning::ClassOfRate { class, rate: 1.0 / step })))
        }
    }
}

/// A recording with the fit that explains it, and what was left out for that.
pub(super) struct Explained {
    pub known: Known,
    pub recorded: Recorded,
    pub fit: Fit,
    /// The recording without its laser and the fit of that, where the contact is another one.
    blind: Option<(Recorded, Fit)>,
    disagreement: Option<Warning>,
}

impl Explained {
    /// The fit of a `reading` with samples `step` (s) apart.
    pub(super) fn find(
        reading: &Series,
        step: f64,
        laser: Option<&Series>,
        tower: &Tower,
        reduction: &Reduction,
    ) -> Result<Explained, Error> {
        let recorded = Recorded::find(reading, laser, tower.body.gravity)?;
        let known = Known::new(tower, reduction, step);
        let mut explained = explain(recorded, known, tower, laser.is_some())?;
        let Explained { known, recorded, fit, .. } = &explained;
        let model = recorded.model(known, tower.body.gravity);
        let [contact, _] = model.contact(&fit.best);
        let released = fit.best[of::RELEASE] + fit.best[of::DURATION];
        if let Some(time) = model.leaves(&fit.best, [released, contact], FALL_BIN, [OFF_FALL, 0.0]) {
            let before = significant(1e3 * (contact - time), 3);
            return Err(refusal!(
                "acceleration: the reading leaves the fall at {time:.4} s, {before} ms before the contact at {contact:.4} s \
                 that the rest of it shows: the impactor touched something there, or height, time constant, mass or column \
                 are others"
            ));
        }
        if let Some(time) = model.leaves(&fit.best, [contact, recorded.onset_end], ONSET_BIN, [OFF_FALL, OFF_ONSET]) {
            return Err(refusal!(
                "acceleration: from the contact at {contact:.4} s on no force that grows with the travel explains the reading \
                 at {time:.4} s: the impactor met something else first, or twice, or height, time constant, mass or column \
                 are others"
            ));
        }
        explained.compare_laser(tower.body.gravity);
        Ok(explained)
    }

    /// Keeps the fit without the laser where the contacts of both differ by more than their errors.
    fn compare_laser(&mut self, gravity: f64) {
        let made = self.blind.take();
        let Explained { known, recorded, fit, .. } = &*self;
        let is_known = known.height.is_some() || known.speed.is_some() || known.contact_time.is_some();
        if !is_known {
            return;
        }
        let Some((blind, other)) = made.or_else(|| blind(recorded, known, gravity)) else { return };
        let contact_of = |recorded: &Recorded, fit: &Fit| {
            let model = recorded.model(known, gravity);
            [model.contact(&fit.best)[0], deviations(&model, fit)[2]]
        };
        let [[laser, of_laser], [force, of_force]] = [contact_of(recorded, fit), contact_of(&blind, &other)];
        if (laser - force).abs() > CONTACT_APART.max(CONTACT_DEVIATIONS * of_laser.hypot(of_force)) {
            self.blind = Some((blind, other));
        }
    }
}

/// The recording without its laser and the fit of that; none where there is no laser.
fn blind(recorded: &Recorded, known: &Known, gravity: f64) -> Option<(Recorded, Fit)> {
    let blind = recorded.has_laser().then(|| recorded.clone().without_laser())?;
    let fit = Fit::find(&blind.model(known, gravity), &blind.first_guess(known, gravity))?;
    Some((blind, fit))
}

/// Fits the recording with all that is known; where that contradicts it, without the height or the laser if both are
/// there. In one piece, since every step weighs the same three fits.
fn explain(recorded: Recorded, known: Known, tower: &Tower, sees_laser: bool) -> Result<Explained, Error> {
    let gravity = tower.body.gravity;
    let no_fit = || {
        let (from, to) = (recorded.start(), recorded.onset_end);
        let error = refusal!(
            "acceleration: no rest, release, fall and impact explain the reading between {from:.4} s and {to:.4} s; check \
             column and unit"
        );
        if sees_laser { error.with_hint("leave out the laser: --without-laser") } else { error }
    };
    let fit = |recorded: &Recorded, known: &Known| {
        Fit::find(&recorded.model(known, gravity), &recorded.first_guess(known, gravity))
    };
    let all = fit(&recorded, &known).ok_or_else(no_fit)?;
    let pull = recorded.model(&known, gravity).pull(&all.best);
    if pull < PULLS && all.colour < MISFIT {
        return Ok(Explained { known, recorded, fit: all, blind: None, disagreement: None });
    }
    // Without them friction may be anything.
    let friction = known.friction.or(Some(ANY_FRICTION));
    let unknown = Known { height: None, speed: None, contact_time: None, friction, ..known };
    let free = fit(&recorded, &unknown).ok_or_else(no_fit)?;
    let mut blind = blind(&recorded, &known, gravity);
    // What is left of the best of them is noise.
    let colour = blind.iter().map(|(_, fit)| fit.colour).fold(free.colour.min(all.colour), f64::min);
    let evidence =
        |recorded: &Recorded, known: &Known, fit: &Fit| recorded.model(known, gravity).evidence(&fit.best) / colour;
    let of_all = evidence(&recorded, &known, &all);
    let excess = of_all - evidence(&recorded, &unknown, &free);
    let model = recorded.model(&unknown, gravity);
    let [contact, speed] = model.contact(&free.best);
    let contradicts = |(blind, without): &mut (Recorded, Fit)| {
        let gained = of_all - evidence(blind, &known, without) - recorded.laser_rows() as f64 / colour;
        gained > excess.max(0.0) + CONTRADICTS
    };
    if let Some((blind, without)) = blind.take_if(contradicts) {
        let reached = blind.model(&known, gravity).contact(&without.best)[1];
        let disagreement = Some(Warning::LaserSpeedDiffers { reached, laser: speed });
        return Ok(Explained { known, recorded: blind, fit: without, blind: None, disagreement });
    }
    let deviations = deviations(&model, &free);
    let stated = [
        known.height.map(|[stated, by]| ("height", "m", model.height(&free.best), deviations[0].hypot(by), stated)),
        known.speed.map(|[stated, by]| ("impact speed", "m/s", speed, deviations[1].hypot(by), stated)),
        known.contact_time.map(|[stated, by]| ("time of contact", "s", contact, deviations[2].hypot(by), stated)),
    ];
    let differs = |(what, _, found, deviation, stated): &(&str, &str, f64, f64, f64)| {
        let least = if *what == "time of contact" { 1e-3 } else { DIFFERS * stated };
        (found - stated).abs() > least.max(4.0 * deviation)
    };
    let other = stated.into_iter().flatten().find(differs).filter(|_| excess > CONTRADICTS);
    match other {
        None => Ok(Explained { known, recorded, fit: all, blind, disagreement: None }),
        Some((what, unit, found, _, stated)) if recorded.has_laser() => {
            let disagreement = Some(Warning::DropHeightDiffers { what, unit, found, stated });
            Ok(Explained { known: unknown, recorded, fit: free, blind: None, disagreement })
        }
        Some((what, unit, found, deviation, stated)) => {
            let [found, error, stated] =
                [(found, 4), (2.0 * deviation, 2), (stated, 6)].map(|(value, digits)| significant(value, digits));
            Err(refusal!(
                "acceleration: the fall that was recorded has {what} {found} ± {error} {unit}, not {stated} {unit}; check the \
                 {what}, the column and its unit"
            )
            .with_hint(
                "a height is measured from the impactor's lowest point to the film; --height \"1 m +- 5 mm\" allows for an \
                 error",
            ))
        }
    }
}

/// Standard deviations of height (m), impact speed (m/s) and time of contact (s).
fn deviations(model: &Model<'_>, fit: &Fit) -> [f64; 3] {
    let draws = fit.draws(model);
    let deviation = |value: &dyn Fn(&Unknowns) -> f64| {
        let count = draws.len().max(1) as f64;
        let mean = draws.iter().map(value).sum::<f64>() / count;
        (draws.iter().map(|draw| (value(draw) - mean).powi(2)).sum::<f64>() / count).sqrt()
    };
    [
        deviation(&|draw| model.height(draw)),
        deviation(&|draw| model.contact(draw)[1]),
        deviation(&|draw| model.contact(draw)[0]),
    ]
}

/// The drop of a recording that is explained: signals from contact on, what follows from them, and every doubt, in one place
/// since most figures are withheld by one rule, that of an accelerometer at the end of its range.
pub(super) fn finish(
    explained: &Explained,
    tower: &Tower,
    reduction: &Reduction,
    class: Option<f64>,
    of_rate: Option<Warning>,
) -> Result<Drop, Error> {
    let Explained { known, recorded, fit, blind, disagreement } = explained;
    let model = &recorded.model(known, tower.body.gravity);
    let Tower { body, .. } = *tower;
    let best = &fit.best;
    let [time, speed] = model.contact(best);
    let laser_residual = recorded.has_laser().then(|| model.laser_residual(best));
    let speed_from = match (recorded.has_laser(), tower.height) {
        (true, _) => SpeedSource::Laser,
        (false, Some(_)) => SpeedSource::Fall,
        (false, None) => SpeedSource::Given,
    };
    let contact = Contact { time, velocity: -speed, laser_residual, speed_from };
    let levelled = recorded.levelled(best);
    let (acceleration, ramp) = match reduction.correction {
        Correction::Coupling { .. } => (coupling::restored(&levelled, best[of::INVERSE]), None),
        Correction::Ramp => {
            let ramp = GravityRamp::fit(&levelled, recorded.release.flank)?;
            let ramped = levelled.samples().map(|[t, r]| r + ramp.mirrored(t, time));
            (levelled.with_values(ramped.collect()), Some(ramp))
        }
    };
    let filtered = match class {
        Some(class) => {
            filter::channel(&acceleration, class, Standard::Iso6487).map_err(|error| error.about("acceleration"))?
        }
        None => acceleration.clone(),
    };
    let signals = release::signals(&acceleration, &filtered, &contact, body)?;
    let channel = |column: Column| signals.channel(column.name).unwrap_or_default();
    let [velocity, displacement] = [channel(column::VELOCITY), channel(column::DISPLACEMENT)];
    let travelled = &displacement[..first_impact(displacement)];
    // A peak that is cut off is missing in every later speed, and so in the energy after the rebound.
    let clipping = Clipping::find(&recorded.reading, time);
    let absorption = energy_absorption(body, velocity, displacement);
    let is_whole = clipping.is_none();
    let draws = fit.draws(model);
    let intervals = ramp.is_none().then(|| fit::intervals(recorded, model, fit, &draws, body)).flatten();
    let other = blind.as_ref().filter(|_| intervals.is_some()).and_then(|(recorded, fit)| {
        let model = recorded.model(known, body.gravity);
        fit::intervals(recorded, &model, fit, &fit.draws(&model), body)
    });
    let contact_differs = blind.as_ref().map(|(recorded, fit)| Warning::LaserContactDiffers {
        laser: time,
        force: recorded.model(known, body.gravity).contact(&fit.best)[0],
        held: other.is_some(),
    });
    let intervals = intervals.map(|all| other.iter().fold(all, Intervals::with));
    // The figures are of the whole reading, the intervals of its means; what there is no figure of has none.
    let rebounds = absorption.ok().filter(|_| is_whole);
    let intervals = intervals.map(|all| Intervals {
        displacement: holding(all.displacement, travelled.iter().copied().fold(0.0, f64::min)),
        energy_absorption: all.energy_absorption.zip(rebounds).map(|(ends, value)| holding(ends, value)),
        rebound_speed: all.rebound_speed.filter(|_| rebounds.is_some()),
        ..all
    });
    let friction = Friction::of(best, &draws, model, body.mass * body.gravity);
    let guide_friction = ramp.is_none().then(|| friction.guide.clone()).flatten();
    let film_absorption = guide_friction.as_ref().filter(|_| is_whole);
    let film_absorption =
        film_absorption.and_then(|guide| film_absorption_by(body, guide, velocity, displacement).ok());
    let may_be_dc = intervals.as_ref().and_then(|all| all.time_constant).filter(|ends| ends[1].is_infinite());
    let time_constant = ramp.is_none().then(|| match may_be_dc {
        Some(_) => f64::INFINITY,
        None => 1.0 / best[of::INVERSE],
    });
    let ideal_speed = tower.height.map_or(model.speed, |height| (2.0 * body.gravity * height).sqrt());
    let warnings = [
        friction.faster(tower.height.filter(|_| known.height.is_some())),
        without_laser(speed_from),
        absorption.err().filter(|_| is_whole).map(|reason| Warning::NoEnergyAbsorption { reason }),
        may_be_dc.map(|[at_least, _]| Warning::DcCoupled { at_least }),
        friction.changes(),
        recorded.held_laser(),
        clipping.map(|clipping| saturated(&clipping, &signals)),
    ];
    let warnings = [of_rate, disagreement.clone(), contact_differs].into_iter().chain(warnings).flatten().collect();
    let mut drop = Drop {
        release: best[of::RELEASE],
        contact,
        acceleration,
        ideal_speed,
        time_constant,
        intervals,
        guide_friction,
        ramp,
        offset: best[of::OFFSET],
        noise: recorded.noise,
        class,
        energy_absorption: rebounds,
        film_absorption,
        total_energy_drift: release::drift(channel(column::TOTAL_ENERGY)),
        clipped_from: clipping.map(|clipping| clipping.start - time),
        signals,
        warnings,
    };
    let doubts = release::warnings(&drop, &recorded.reading, recorded.release.rest_end);
    drop.warnings.extend(doubts);
    Ok(drop)
}

/// An interval that holds the figure of the whole reading, too.
fn holding([low, high]: [f64; 2], value: f64) -> [f64; 2] {
    [low.min(value), high.max(value)]
}

/// The friction of the guide in the fall.
struct Friction {
    guide: Option<GuideFriction>,
    /// At the release and at contact, N, where it surely grows with the speed.
    ends: Option<[f64; 2]>,
    /// Friction over the weight, and its upper end of 95 %.
    share: [f64; 2],
}

impl Friction {
    /// Share of the friction that grows with the speed from which on it does so, at the lower end of 95 %.
    const GROWS: f64 = 0.05;

    fn of(best: &Unknowns, draws: &[Unknowns], model: &Model<'_>, weight: f64) -> Friction {
        let ends = |of: usize| fit::ends(draws.iter().map(|draw| draw[of]).collect(), best[of]);
        let (friction, share) = (best[of::FRICTION], best[of::OF_SPEED]);
        let grows = !draws.is_empty() && ends(of::OF_SPEED)[0] > Friction::GROWS && ends(of::FRICTION)[0] > 0.0;
        let guide = match grows {
            true => GuideFriction {
                constant: weight * friction * (1.0 - share),
                per_speed: weight * friction * share / model.speed,
                curve: vec![],
            },
            // On average over the height, at which the speed is two thirds of the last one.
            false => GuideFriction { constant: weight * friction * (1.0 - share / 3.0), ..GuideFriction::default() },
        };
        Friction {
            ends: grows.then_some([guide.constant, weight * friction]),
            guide: (friction >= 0.0).then_some(guide),
            share: [friction, if draws.is_empty() { friction } else { ends(of::FRICTION)[1] }],
        }
    }

    /// Friction only lowers the speed, beyond what gravity differs by from place to place. A `height` (m) that is not used
    /// says nothing.
    fn faster(&self, height: Option<f64>) -> Option<Warning> {
        let [friction, most] = self.share;
        let height = height.filter(|_| most < 0.0 && -0.5 * friction > LEAST_EXCESS)?;
        Some(Warning::FasterThanFreeFall { excess: -0.5 * friction, height })
    }

    fn changes(&self) -> Option<Warning> {
        self.ends.map(|friction| Warning::GuideFrictionChanges { friction })
    }
}

/// The report that there was no laser.
fn without_laser(speed_from: SpeedSource) -> Option<Warning> {
    match speed_from {
        SpeedSource::Laser => None,
        SpeedSource::Fall => Some(Warning::NoLaser),
        SpeedSource::Given => Some(Warning::NoLaserNoHeight),
    }
}

/// The report of a reading at the end of the range, with the extremes that may therefore be exceeded.
fn saturated(clipping: &Clipping, signals: &Recording) -> Warning {
    let extreme = |name: &str, of: fn(&Series) -> Option<[f64; 2]>| of(&signals.series(name)?).map(|[_, value]| value);
    Warning::Saturated {
        reading: clipping.level,
        start: clipping.start,
        duration: clipping.duration,
        peak: extreme(column::ACCELERATION_FILTERED.name, Series::largest).unwrap_or(f64::NAN),
        deepest: turning_point(signals).unwrap_or(f64::NAN),
    }
}

/// Where (m) the impactor first stops to descend. With a deceleration that is read too low it does so later and deeper.
fn turning_point(signals: &Recording) -> Option<f64> {
    let turns = signals.channel(column::VELOCITY.name)?.iter().position(|velocity| *velocity >= 0.0)?;
    signals.channel(column::DISPLACEMENT.name)?.get(turns).copied()
}

impl Landmarks {
    /// What an `acceleration` (m/s²) shows under `gravity` (m/s²) although its reduction failed with this `error`.
    pub fn of_failed(acceleration: &Series, gravity: f64, error: &Error) -> Landmarks {
        let found = even(acceleration).ok().and_then(|reading| Release::find(&reading, gravity).ok());
        let found = found.map_or_else(Landmarks::default, |release| Landmarks {
            release: Some(release.flank[0]),
            impact: Some(release.impact),
            ..Landmarks::default()
        });
        match *error.kind() {
            Kind::NoRelease(impact) => Landmarks { impact: Some(impact), ..found },
            Kind::NoRest(release) => Landmarks { release: Some(release), ..found },
            _ => found,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::Channel;

    /// From 4 m/s at a deceleration of 100 m/s² the impactor turns after 40 ms, 80 mm down; then it falls.
    #[test]
    fn a_clipped_drop_is_bounded_by_where_it_first_turns() {
        let time: Vec<f64> = (0..200).map(|i| 1e-3 * f64::from(i)).collect();
        let motion =
            |t: f64| if t < 0.05 { (100.0 * t - 4.0, 50.0 * t * t - 4.0 * t) } else { (1.0 - 9.81 * t, -2.0 * t) };
        let turning = |time: Vec<f64>| {
            let (velocity, displacement) = time.iter().map(|t| motion(*t)).unzip();
            let channel = |name: Column, values| Channel { name: name.name.into(), values };
            let channels = vec![channel(column::VELOCITY, velocity), channel(column::DISPLACEMENT, displacement)];
            turning_point(&Recording { time, channels })
        };
        assert_eq!(turning(time[..30].to_vec()), None);
        assert!((turning(time).unwrap() + 0.08).abs() < 1e-3);
    }

    #[test]
    fn only_a_surely_faster_fall_over_a_used_height_is_reported() {
        let of = |share, height| Friction { guide: None, ends: None, share }.faster(height);
        assert!(of([-0.02, -0.01], Some(1.0)).is_some());
        // The interval holds the free fall; noise; a height that is not used.
        for (share, height) in [([-0.02, 0.01], Some(1.0)), ([-1e-5, -1e-6], Some(1.0)), ([-0.02, -0.01], None)] {
            assert_eq!(of(share, height), None);
        }
    }
}
