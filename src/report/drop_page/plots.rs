//! Plots of recorded drops: the reading with its landmarks, and the motion from contact on.

use super::super::figure::G;
use super::drop_test::DropTest;
use lab::experiment::drop::{Drop, Landmarks};
use lab::signal::column::{self, Column};
use lab::signal::{Channel, Recording, Series};
use plot::{Curve, Mark, Plot, outline};

/// Times before first contact and after it that are shown, as multiples of the time from contact to the lowest point.
const BEFORE: f64 = 0.5;
const AFTER: f64 = 3.0;

/// Most samples of a signal of one of many tests.
const MOST_SAMPLES: usize = 4000;

/// Axes of the recording's clock and of accelerations.
const CLOCK: &str = "time of the recording (s)";
const ACCELERATION: &str = "acceleration (g)";

/// Axis of the time after first contact, and of that before it.
const TIME: &str = "time from contact (ms)";

/// The acceleration over the whole recording as it was read, with the landmarks that were found; none of a recording that
/// could not be read.
pub fn reading(test: &DropTest) -> Option<Plot> {
    let channels = test.channels.as_ref()?;
    let read = Curve::line("as read", channels.acceleration.samples().map(|[time, value]| [time, value / G]));
    let marks = marks(&test.landmarks, |time| time);
    Some(Plot { marks, ..Plot::new("The recording", [CLOCK, ACCELERATION], vec![read]) })
}

/// [`reading`], with the corrected acceleration over it where there is one.
pub(super) fn whole(test: &DropTest) -> Option<Plot> {
    let mut plot = reading(test)?;
    let corrected = test.outcome.as_ref().ok().map(|drop| {
        let samples = drop.acceleration.samples().map(|[time, value]| [time, value / G]);
        Curve::line("corrected", samples)
    });
    plot.curves.extend(corrected);
    Some(plot)
}

/// The laser over the whole recording, with the landmarks that were found.
pub(super) fn laser(test: &DropTest) -> Option<Plot> {
    let laser = test.channels.as_ref()?.laser.as_ref()?;
    let curve = Curve::line("laser", laser.samples().map(|[time, value]| [time, 1e3 * value]));
    let marks = marks(&test.landmarks, |time| time);
    Some(Plot { marks, ..Plot::new("Height over the film", [CLOCK, "height (mm)"], vec![curve]) })
}

fn marks(landmarks: &Landmarks, place: impl Fn(f64) -> f64) -> Vec<Mark> {
    let mark = |(name, time): (&str, f64)| Mark { label: name.into(), at: place(time) };
    landmarks.named().into_iter().map(mark).collect()
}

/// Acceleration, velocity, displacement and energies about the impact, and force over travel.
pub(super) fn impact(test: &DropTest, drop: &Drop) -> Vec<Plot> {
    let marks = marks(&test.landmarks, |time| 1e3 * (time - drop.contact.time));
    let over_time = |title: &str, axis: &str, curves: Vec<Curve>| Plot {
        marks: marks.clone(),
        ..Plot::new(title, [TIME, axis], curves)
    };
    let [velocity, displacement] = drop.motion();
    let shown = Shown::of(drop);
    let mut places = vec![Curve::line("integrated", shown.of_clock(&displacement, 1e3))];
    let laser = test.channels.as_ref().and_then(|channels| channels.laser.as_ref());
    places.extend(laser.map(|laser| Curve::line("laser", shown.of_clock(laser, 1e3)).dashed()));
    places.extend(lowest_point(drop));
    let named = |name: &str, column: Column| Curve::line(name, shown.of_column(&drop.signals, column, 1.0));
    vec![
        over_time("Acceleration", ACCELERATION, vec![acceleration("filtered", drop)]),
        over_time("Velocity", column::VELOCITY.axis, vec![Curve::line("integrated", shown.of_clock(&velocity, 1.0))]),
        over_time("Displacement", column::DISPLACEMENT.axis, places),
        force_over_travel(vec![force("M(a + g)", test, drop)]),
        over_time(
            "Energies",
            column::KINETIC_ENERGY.axis,
            vec![
                named("kinetic", column::KINETIC_ENERGY),
                named("absorbed by the film", column::ABSORBED_ENERGY),
                named("total", column::TOTAL_ENERGY),
            ],
        ),
    ]
}

/// The interval of the lowest point, as a line where it is.
fn lowest_point(drop: &Drop) -> Option<Curve> {
    let ([time, _], intervals) = drop.lowest_point().zip(drop.intervals.as_ref())?;
    Some(Curve::line("lowest point, 95 %", intervals.displacement.map(|place| [1e3 * time, 1e3 * place])))
}

/// Curves of several drops over each other, aligned at first contact: acceleration, displacement and force over travel.
pub(super) fn overlaid(drops: &[(&str, &DropTest, &Drop)]) -> Vec<Plot> {
    let curves = |of: &dyn Fn(&str, &DropTest, &Drop) -> Curve| {
        drops.iter().map(|(name, test, drop)| of(name, test, drop)).collect::<Vec<_>>()
    };
    let contact = vec![Mark { label: "contact".into(), at: 0.0 }];
    let place = |name: &str, _: &DropTest, drop: &Drop| {
        Curve::line(name, Shown::of(drop).of_column(&drop.signals, column::DISPLACEMENT, 1e3))
    };
    vec![
        Plot {
            marks: contact,
            ..Plot::new("Acceleration", [TIME, ACCELERATION], curves(&|name, _, drop| acceleration(name, drop)))
        },
        Plot::new("Displacement", [TIME, column::DISPLACEMENT.axis], curves(&place)),
        force_over_travel(curves(&force)),
    ]
}

/// A small plot of each test: of a drop the acceleration about its impact, else the reading.
pub(super) fn each(name: &str, test: &DropTest) -> Option<Plot> {
    let plot = match &test.outcome {
        Ok(drop) => impact(test, drop).into_iter().next(),
        Err(_) => reading(test),
    };
    plot.map(|plot| Plot { title: name.to_owned(), ..plot })
}

/// The filtered acceleration, and before contact the corrected one, in g over the time from contact in ms.
fn acceleration(name: &str, drop: &Drop) -> Curve {
    let shown = Shown::of(drop);
    let before = shown.of_clock(&drop.acceleration, 1.0 / G).into_iter().filter(|[time, _]| *time < 0.0);
    let after = shown.of_column(&drop.signals, column::ACCELERATION_FILTERED, 1.0 / G);
    Curve::line(name, before.chain(after))
}

/// The force on the impactor, M(a + g) of the filtered acceleration, over its travel below first contact.
fn force(name: &str, test: &DropTest, drop: &Drop) -> Curve {
    let shown = Shown::of(drop);
    let Some(tower) = test.tower else { return Curve::line(name, []) };
    let places = shown.of_column(&drop.signals, column::DISPLACEMENT, -1e3);
    let accelerations = shown.of_column(&drop.signals, column::ACCELERATION_FILTERED, 1.0);
    let force = |acceleration: f64| tower.body.mass * (acceleration + tower.body.gravity);
    Curve::line(name, places.iter().zip(&accelerations).map(|(place, a)| [place[1], force(a[1])]))
}

fn force_over_travel(curves: Vec<Curve>) -> Plot {
    Plot::new("Force on the impactor over travel", ["travel below first contact (mm)", "force (N)"], curves)
}

impl DropTest {
    /// The test with no more samples than plots of many tests show, so that many fit into memory; figures and landmarks
    /// are those of the whole recording.
    pub fn lightened(mut self) -> DropTest {
        if let Some(channels) = &mut self.channels {
            channels.acceleration = outlined(&channels.acceleration);
            channels.laser = channels.laser.as_ref().map(outlined);
        }
        if let Ok(drop) = &mut self.outcome {
            let [_, end] = Shown::of(drop).range;
            drop.acceleration = outlined(&drop.acceleration);
            drop.signals = every_so_many(&drop.signals, end);
        }
        self
    }
}

/// The outline of a signal.
fn outlined(signal: &Series) -> Series {
    let points = outline(&signal.samples().collect::<Vec<_>>(), MOST_SAMPLES);
    let column = |axis: usize| points.iter().map(|point| point[axis]).collect::<Vec<f64>>();
    Series::new(column(0), column(1))
}

/// Samples at equal steps up to the time `end`, s.
fn every_so_many(signals: &Recording, end: f64) -> Recording {
    let count = signals.time.partition_point(|time| *time <= end);
    let step = count.div_ceil(MOST_SAMPLES).max(1);
    let thin = |values: &[f64]| values[..count].iter().step_by(step).copied().collect::<Vec<f64>>();
    let channel = |channel: &Channel| Channel { name: channel.name.clone(), values: thin(&channel.values) };
    Recording { time: thin(&signals.time), channels: signals.channels.iter().map(channel).collect() }
}

/// The part of a drop about its impact.
struct Shown {
    /// First contact on the recording's clock, s.
    contact: f64,
    /// From and to, s from contact.
    range: [f64; 2],
}

impl Shown {
    fn of(drop: &Drop) -> Shown {
        let last = drop.signals.time.last().copied().unwrap_or(0.0);
        let lowest = drop.lowest_point().map_or(last / AFTER, |[time, _]| time);
        Shown { contact: drop.contact.time, range: [-BEFORE * lowest, AFTER * lowest] }
    }

    /// A signal of the recording's clock, times `factor`, over the time from contact in ms.
    fn of_clock(&self, signal: &Series, factor: f64) -> Vec<[f64; 2]> {
        let window = signal.window(self.range.map(|time| self.contact + time));
        window.samples().map(|[time, value]| [1e3 * (time - self.contact), factor * value]).collect()
    }

    /// A column of signals from contact on, times `factor`, over that time in ms.
    fn of_column(&self, signals: &Recording, column: Column, factor: f64) -> Vec<[f64; 2]> {
        let series = signals.series(column.name).unwrap_or_else(|| Series::new([], []));
        series.window(self.range).samples().map(|[time, value]| [1e3 * time, factor * value]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_signals_keep_their_extremes_and_steps() {
        let time: Vec<f64> = (0..100_000).map(|i| f64::from(i) * 1e-6).collect();
        let mut values: Vec<f64> = time.iter().map(|t| (100.0 * t).sin()).collect();
        values[54_321] = 9.0;
        let signal = outlined(&Series::new(time.as_slice(), values.as_slice()));
        assert!(signal.len() <= MOST_SAMPLES && signal.largest() == Some([time[54_321], 9.0]), "{}", signal.len());
        let signals = Recording { time: time.clone(), channels: vec![Channel { name: "a".into(), values }] };
        let light = every_so_many(&signals, 0.08);
        let step = light.time[1] - light.time[0];
        assert!((MOST_SAMPLES / 2..=MOST_SAMPLES).contains(&light.time.len()), "{}", light.time.len());
        assert!(light.time.windows(2).all(|pair| (pair[1] - pair[0] - step).abs() < 1e-9));
        let [first, last] = [light.time[0], light.time[light.time.len() - 1]];
        assert!(first == 0.0 && last <= 0.08 && last > 0.08 - step, "{first} {last}");
        assert_eq!(light.channels[0].values.len(), light.time.len());
    }
}
