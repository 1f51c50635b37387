//! The acceleration of an injury measure, filtered first where asked.

use clap::Args;

use super::input::{self, Chosen, Input};
use crate::diagnostic::{Diagnostic, shown_path};
use crate::signal::filter::{self, Standard};
use crate::signal::{Annotations, Series};
use crate::units::Acceleration;

#[derive(Clone, Debug, Args)]
pub(crate) struct AccelerationArgs {
    #[command(flatten)]
    pub input: Input,
    /// Filter with this channel frequency class first (ISO 6487), e.g. 1000
    #[arg(long, value_name = "CFC", value_parser = input::class)]
    pub class: Option<f64>,
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
            return Ok(Read { series: channel.series, annotations });
        };
        annotations.warnings.extend(input::filtered_before(&channel));
        annotations.warnings.extend(input::unusual_class(class));
        let series = filter::channel(&channel.series, class, Standard::Iso6487).map_err(|error| self.mistake(error))?;
        Ok(Read { series, annotations })
    }

    /// What is wrong with the channel.
    pub(crate) fn mistake(&self, error: impl std::fmt::Display) -> Diagnostic {
        Diagnostic::new(format!("{}: {error}", shown_path(&self.input.path)))
    }

    /// How it was filtered, for the terminal.
    pub(crate) fn filtered(&self) -> String {
        self.class.map_or_else(|| "no filter".into(), |class| format!("CFC {class}"))
    }
}
