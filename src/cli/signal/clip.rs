//! `droptower signal clip`: the level that an acceleration holds for 3 ms.

use clap::{Args, ValueEnum};
use serde::Serialize;

use super::acceleration::AccelerationArgs;
use super::remarks::Remarks;
use crate::argument::milliseconds;
use crate::{Failure, Shared, print_figures};
use base::diagnostic::Diagnostic;
use base::number::clean_time;
use base::units::STANDARD_GRAVITY;
use lab::signal::Warning;
use lab::signal::clip::{Counting, clip};

#[derive(Debug, Args)]
pub(crate) struct ClipArgs {
    #[command(flatten)]
    pub acceleration: AccelerationArgs,
    /// How long the level is held, ms
    #[arg(long, value_name = "MS", default_value_t = 3.0, value_parser = milliseconds)]
    pub duration: f64,
    /// Whether intervals add up (49 CFR 571.208, UN R94) or one has to last
    #[arg(long, value_enum, default_value_t)]
    pub counting: CountingArg,
}

#[derive(Clone, Copy, Debug, Default, Serialize, ValueEnum)]
#[serde(rename_all = "lowercase")]
pub(crate) enum CountingArg {
    /// All intervals together
    #[default]
    Cumulative,
    /// The longest unbroken interval
    Contiguous,
}

impl From<CountingArg> for Counting {
    fn from(counting: CountingArg) -> Counting {
        match counting {
            CountingArg::Cumulative => Counting::Cumulative,
            CountingArg::Contiguous => Counting::Contiguous,
        }
    }
}

#[derive(Serialize)]
struct Figures {
    clip_g: f64,
    clip_m_s2: f64,
    counting: CountingArg,
    duration_ms: f64,
    start_s: f64,
    end_s: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    filter_class: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    until_ms: Option<f64>,
    #[serde(flatten)]
    remarks: Remarks,
}

pub(super) fn run(args: &ClipArgs, shared: &Shared) -> Result<(), Failure> {
    let figures = figures(args)?;
    print_figures(shared, &figures, || text(args, &figures))
}

fn figures(args: &ClipArgs) -> Result<Figures, Diagnostic> {
    let mut read = args.acceleration.read()?;
    let found = clip(&read.series, 1e-3 * args.duration, args.counting.into());
    let found = found.map_err(|error| args.acceleration.mistake(error))?;
    if found.level <= 0.0 {
        read.annotations.warnings.push(Warning::NoPositiveLevel);
    }
    Ok(Figures {
        clip_g: found.level / STANDARD_GRAVITY,
        clip_m_s2: found.level,
        counting: args.counting,
        duration_ms: args.duration,
        start_s: clean_time(found.start),
        end_s: clean_time(found.end),
        filter_class: args.acceleration.class,
        until_ms: args.acceleration.until,
        remarks: (&read.annotations).into(),
    })
}

fn text(args: &ClipArgs, figures: &Figures) -> String {
    let Figures { clip_g, duration_ms, start_s, end_s, .. } = figures;
    let counting = match args.counting {
        CountingArg::Cumulative => "cumulative",
        CountingArg::Contiguous => "contiguous",
    };
    let text = format!(
        "{duration_ms} ms clip  {clip_g:.3} g  {counting}, between {start_s:.6} s and {end_s:.6} s, {}\n{}",
        args.acceleration.treated(),
        figures.remarks.lines()
    );
    text.trim_end().to_owned()
}
