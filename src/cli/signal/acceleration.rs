//! The acceleration of an injury measure, filtered first where asked.

use clap::Args;

use super::input::{self, Chosen, Input};
use crate::argument::milliseconds;
use base::diagnostic::{Diagnostic, shown_path};
use base::number::significant;
use base::units::Acceleration;
use lab::signal::filter::{self, Standard};
use lab::signal::{Annotations, Series};

#[derive(Clone, Debug, Args)]
pub(crate) struct AccelerationArgs {
    #[command(flatten)]
    pub input: Input,
    /// Filter with this channel frequency class first (ISO 6487), e.g. 1000
    #[arg(long, value_name = "CFC", value_parser = input::class)]
    pub class: Option<f64>,
    /// Use the record up to this time alone, ms of its own clock: UN R94 leaves out the rebound of the head
    #[arg(long, value_name = "MS", value_parser = milliseconds, allow_hyphen_values = true)]
    pub until: Option<f64>,
}

/// The acceleration, m/s².
pub(crate) struct Read {
    pub series: Series,
    /// Comments of its file, and what its reading reports.
    pub annotations: Annotations,
}

impl AccelerationArgs {
    /// The acceleration asked for.
    pub(crate) fn read(&self) -> Result<Read, Diagnostic> {
        let Chosen { channel, mut annotations } = self.input.read_as(Acceleration::DIMENSION)?;
        let Some(class) = self.class else {
            return Ok(Read { series: self.part(channel.series)?, annotations });
        };
        annotations.warnings.extend(input::filtered_before(&channel));
        annotations.warnings.extend(input::unusual_class(class));
        let series = filter::channel(&channel.series, class, Standard::Iso6487).map_err(|error| self.mistake(error))?;
        Ok(Read { series: self.part(series)?, annotations })
    }

    /// The samples up to `until`. The filter comes first, so that the cut does not affect it.
    fn part(&self, series: Series) -> Result<Series, Diagnostic> {
        let Some(until) = self.until else { return Ok(series) };
        let ([first, .., last] | [first @ last]) = series.time() else { return Ok(series) };
        if 1e-3 * until > *first {
            return Ok(series.window([f64::NEG_INFINITY, 1e-3 * until]));
        }
        let [until, first, last] = [until, 1e3 * first, 1e3 * last].map(|time| significant(time, 6));
        Err(self
            .mistake(format!("the record begins at {first} ms and ends at {last} ms, none of it before {until} ms")))
    }

    /// A diagnostic of an error in the channel.
    pub(crate) fn mistake(&self, error: impl std::fmt::Display) -> Diagnostic {
        Diagnostic::new(format!("{}: {error}", shown_path(&self.input.path)))
    }

    /// How it was filtered and cut, for the terminal.
    pub(crate) fn treated(&self) -> String {
        let filter = self.class.map_or_else(|| "no filter".into(), |class| format!("CFC {class}"));
        self.until.map_or(filter.clone(), |until| format!("{filter}, up to {until} ms"))
    }
}
