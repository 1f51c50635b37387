//! `droptower signal hic`: the head injury criterion of an acceleration.

use clap::Args;
use serde::Serialize;

use super::acceleration::AccelerationArgs;
use super::remarks::Remarks;
use crate::argument::milliseconds;
use crate::{Failure, Shared, print_figures};
use base::diagnostic::Diagnostic;
use base::number::clean_time;
use base::units::STANDARD_GRAVITY;
use lab::signal::hic::{LONG_WINDOW, dummy_equivalent, head_injury_criterion};

#[derive(Debug, Args)]
pub(crate) struct HicArgs {
    #[command(flatten)]
    pub acceleration: AccelerationArgs,
    /// Longest interval, ms; 15 and 36 are usual
    #[arg(long, value_name = "MS", default_value_t = 15.0, value_parser = milliseconds)]
    pub window: f64,
}

#[derive(Serialize)]
struct Figures {
    hic: f64,
    window_ms: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    hic_d: Option<f64>,
    t1_s: f64,
    t2_s: f64,
    duration_ms: f64,
    mean_g: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    filter_class: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    until_ms: Option<f64>,
    #[serde(flatten)]
    remarks: Remarks,
}

pub(super) fn run(args: &HicArgs, shared: &Shared) -> Result<(), Failure> {
    let figures = figures(args)?;
    print_figures(shared, &figures, || text(args, &figures))
}

fn figures(args: &HicArgs) -> Result<Figures, Diagnostic> {
    let read = args.acceleration.read()?;
    let found = head_injury_criterion(&read.series, 1e-3 * args.window);
    let found = found.map_err(|error| args.acceleration.mistake(error))?;
    Ok(Figures {
        hic: found.value,
        window_ms: args.window,
        hic_d: (args.window == 1e3 * LONG_WINDOW).then(|| dummy_equivalent(found.value)),
        t1_s: clean_time(found.start),
        t2_s: clean_time(found.end),
        duration_ms: clean_time(1e3 * (found.end - found.start)),
        mean_g: found.mean / STANDARD_GRAVITY,
        filter_class: args.acceleration.class,
        until_ms: args.acceleration.until,
        remarks: (&read.annotations).into(),
    })
}

fn text(args: &HicArgs, figures: &Figures) -> String {
    let Figures { hic, window_ms, t1_s, t2_s, duration_ms, mean_g, .. } = figures;
    let of_head_form = figures.hic_d.map(|hic_d| format!("HIC(d) {hic_d:.3}, were it of a free-motion head form\n"));
    let text = format!(
        "HIC{window_ms}  {hic:.3}  {mean_g:.2} g over {duration_ms:.3} ms, from {t1_s:.6} s to {t2_s:.6} s, {}\n{}{}",
        args.acceleration.treated(),
        of_head_form.unwrap_or_default(),
        figures.remarks.lines()
    );
    text.trim_end().to_owned()
}
