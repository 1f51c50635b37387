//! From the readings of the sensors to contact, speed, travel and energies.
//!
//! A drop passes through stages, each a value that the next consumes: the [`Levelled`] reading, a
//! [`Corrected`](super::corrected::Corrected) acceleration with its contact, the
//! [`Integrated`](super::integrated::Integrated) motion, the [`Evaluated`](super::evaluated::Evaluated) drop with
//! friction and intervals, the [`Screened`] one without figures that the sensor's range falsifies, the [`Drop`].

use super::error::DropError;
use super::laser::Cleaned;
use super::levelled::Levelled;
use super::result::Drop;
use super::screened::Screened;
use super::tower::{Correction, KnownContact, Reduction, Tower};
use crate::experiment::contact::SpeedSource;
use crate::signal::filter::{ChannelFilter, Standard};
use crate::signal::resample::{self, ResampleError};
use crate::signal::{Series, gap};

/// Reduces the `acceleration` that was read (m/s², upward) and, where there is one, the `laser`'s distance from the
/// film's upper face (m, upward; `NaN` out of range). Both have one clock and start with the impactor at rest.
pub fn reduce(
    acceleration: &Series,
    laser: Option<&Series>,
    tower: &Tower,
    reduction: &Reduction,
) -> Result<Drop, DropError> {
    check(tower, reduction)?;
    let reading = even(acceleration)?;
    if let (Some(class), Some(step)) = (reduction.class, resample::common_step(reading.time())) {
        ChannelFilter::new(class, step, Standard::Iso6487)?;
    }
    let cleaned = laser.map(Cleaned::from_laser);
    let levelled = Levelled::find(&reading, cleaned.as_ref().map(|cleaned| &cleaned.series), tower, reduction)?;
    let evaluated = match reduction.correction {
        Correction::Coupling { time_constant } => levelled.by_coupling(time_constant),
        Correction::Ramp => levelled.by_ramp(),
    }?;
    // A laser that is not used needs no report.
    let cleaned = cleaned.as_ref().filter(|_| evaluated.contact().speed_from == SpeedSource::Laser);
    let screened = Screened::new(evaluated, &reading, cleaned.and_then(Cleaned::warning));
    Ok(screened.into_drop(&reading, levelled.release()))
}

fn check(tower: &Tower, reduction: &Reduction) -> Result<(), DropError> {
    let mut values =
        vec![("mass", tower.body.mass), ("gravity", tower.body.gravity), ("height", tower.height.metres())];
    if let Correction::Coupling { time_constant: Some(given) } = reduction.correction {
        values.push(("time constant", given));
    }
    if let Some(KnownContact { speed, .. }) = reduction.contact {
        values.push(("impact speed", speed));
    }
    let wrong = values.into_iter().find(|(_, value)| value.is_nan() || *value <= 0.0 || value.is_infinite());
    wrong.map_or(Ok(()), |(what, value)| Err(DropError::NotPositive { what, value }))
}

/// The reading on equal steps.
pub(super) fn even(acceleration: &Series) -> Result<Series, DropError> {
    if let Some(gap) = gap::first(acceleration) {
        return Err(DropError::NotMeasured(gap));
    }
    let count = acceleration.len();
    if count < 2 {
        return Err(ResampleError::TooShort { count }.into());
    }
    if resample::common_step(acceleration.time()).is_some() {
        return Ok(acceleration.clone());
    }
    Ok(resample::uniform(acceleration, median_step(acceleration.time()))?)
}

/// s; a few times that are written twice or left out do not change it.
fn median_step(time: &[f64]) -> f64 {
    let mut steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let middle = steps.len() / 2;
    *steps.select_nth_unstable_by(middle, f64::total_cmp).1
}
