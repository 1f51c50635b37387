//! The acceleration that an injury measure is taken of, filtered first where asked.

use clap::Args;

use super::input::Input;
use crate::cli::faults;
use crate::diagnostic::{Diagnostic, shown_path};
use crate::signal::Series;
use crate::signal::filter::{self, Standard};
use crate::units::Acceleration;

#[derive(Clone, Debug, Args)]
pub struct AccelerationArgs {
    #[command(flatten)]
    pub input: Input,
    /// Filter with this channel frequency class first (ISO 6487), e.g. 1000
    #[arg(long, value_name = "CFC")]
    pub class: Option<f64>,
}

/// What was read, in m/s².
pub struct Read {
    pub series: Series,
    pub notes: Vec<String>,
}

impl AccelerationArgs {
    /// The acceleration asked for.
    pub fn read(&self) -> Result<Read, Diagnostic> {
        let chosen = self.input.read()?;
        let series = chosen.channel.quantity(Acceleration::DIMENSION).cloned();
        let series = series.map_err(|error| faults::quantity(&self.input.path, &error))?;
        let mut notes = chosen.notes;
        let Some(class) = self.class else {
            return Ok(Read { series, notes });
        };
        if let Some(before) = filtered_class(&chosen.channel.name) {
            notes.push(format!("`{}` says that it was filtered with CFC {before} before", chosen.channel.name));
        }
        let series = filter::channel(&series, class, Standard::Iso6487).map_err(|error| self.mistake(error))?;
        Ok(Read { series, notes })
    }

    /// What is wrong with the channel.
    pub fn mistake(&self, error: impl std::fmt::Display) -> Diagnostic {
        Diagnostic::new(format!("{}: {error}", shown_path(&self.input.path)))
    }

    /// How it was filtered, to be read by people.
    pub fn filtered(&self) -> String {
        self.class.map_or_else(|| "as recorded".into(), |class| format!("CFC {class}"))
    }
}

/// The class that the last letter of an ISO-MME channel code stands for (ISO/TS 13499); none where it names no filter.
fn filtered_class(name: &str) -> Option<u16> {
    let code = name.len() == 16 && name.bytes().all(|byte| byte.is_ascii_uppercase() || byte.is_ascii_digit());
    match name.bytes().last().filter(|_| code)? {
        b'A' => Some(1000),
        b'B' => Some(600),
        b'C' => Some(180),
        b'D' => Some(60),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn channel_codes_say_what_filtered_them() {
        for (name, class) in [
            ("11NECKUP00H3MOYB", Some(600)),
            ("11HEAD0000H3ACXA", Some(1000)),
            ("11HEAD0000H3ACX0", None),
            ("accelA", None),
        ] {
            assert_eq!(filtered_class(name), class, "{name}");
        }
    }
}
