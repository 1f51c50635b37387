//! The fourth stage: the motion with the friction of the guide, and with intervals of what its time constant decides.

use super::integrated::Integrated;
use super::result::Intervals;
use super::time_constant;
use crate::experiment::Warning;
use crate::experiment::absorption::{Body, film_absorption};
use crate::experiment::contact::Contact;
use crate::signal::column;
use crate::signal::column::Column;
use membrane::engine::GuideFriction;

/// A motion that is evaluated together with the others that the recording admits.
pub(super) struct Evaluated {
    /// The motion with the best time constant.
    pub motion: Integrated,
    /// Intervals of 95 %.
    pub intervals: Option<Intervals>,
    /// Friction of the guide in the fall.
    pub guide_friction: Option<GuideFriction>,
    /// D of the film alone.
    pub film_absorption: Option<f64>,
    /// Reports of sources that disagree.
    pub warnings: Vec<Warning>,
}

impl Evaluated {
    /// Evaluates a `motion` beside those at the `ends` of the interval of its time constant, with the `friction` that
    /// all of them admit.
    pub(super) fn new(
        motion: Integrated,
        ends: &[Integrated],
        friction: Option<GuideFriction>,
        body: Body,
        warnings: Vec<Warning>,
    ) -> Evaluated {
        let guide_friction = friction.filter(|friction| friction.constant >= 0.0 && friction.per_speed >= 0.0);
        let channel = |column: Column| motion.signals.channel(column.name);
        let film_absorption = guide_friction.as_ref().and_then(|friction| {
            film_absorption(body, friction, channel(column::VELOCITY)?, channel(column::DISPLACEMENT)?).ok()
        });
        Evaluated { intervals: intervals(&motion, ends), guide_friction, film_absorption, warnings, motion }
    }

    /// A motion without a time constant, and so without friction and intervals.
    pub(super) fn without_intervals(motion: Integrated) -> Evaluated {
        Evaluated { motion, intervals: None, guide_friction: None, film_absorption: None, warnings: Vec::new() }
    }

    /// First contact.
    pub(super) fn contact(&self) -> &Contact {
        self.motion.contact()
    }
}

/// The intervals about a motion that those at the `ends` span; none without ends.
fn intervals(motion: &Integrated, ends: &[Integrated]) -> Option<Intervals> {
    let motions = || std::iter::once(motion).chain(ends);
    let span = |of: &dyn Fn(&Integrated) -> Option<f64>| {
        let values = motions().map(of).collect::<Option<Vec<f64>>>()?;
        Some([f64::INFINITY, f64::NEG_INFINITY].map(|start: f64| match start > 0.0 {
            true => values.iter().copied().fold(start, f64::min),
            false => values.iter().copied().fold(start, f64::max),
        }))
    };
    let deepest = |motion: &Integrated| Some(motion.signals.series(column::DISPLACEMENT.name)?.smallest()?[1]);
    (!ends.is_empty()).then_some(())?;
    let speed = -motion.contact().velocity;
    let [low, high] = span(&|motion| Some(-motion.contact().velocity))?;
    let scatter = time_constant::INTERVAL * motion.contact().speed_error.unwrap_or(0.0);
    let widened = |end: f64, sign: f64| speed + sign * (end - speed).hypot(scatter);
    Some(Intervals {
        time_constant: span(&Integrated::time_constant)?,
        impact_speed: [widened(low, -1.0), widened(high, 1.0)],
        displacement: span(&deepest)?,
        energy_absorption: span(&|motion| motion.energy_absorption.ok()),
    })
}
