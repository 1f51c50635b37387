//! An array job of Slurm that computes a sweep.

use std::path::PathBuf;

use clap::Args;

use super::{Failure, Shared, check_new, print, write_new};
use crate::{complete, sweep};
use base::diagnostic::shown_path;
use base::shell::quoted;
use scene::scenario::Document;
use study::sweep::Sweep;

#[derive(Debug, Args)]
pub(super) struct SlurmArgs {
    /// The file to write; an existing file is not replaced
    path: PathBuf,
    /// The scenario, with a table [variation]
    #[arg(long, value_name = "SCENARIO", add = complete::scenarios())]
    scenario: PathBuf,
    /// Number of runs, in place of `variation.samples`
    #[arg(short = 'n', long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    samples: Option<u32>,
    /// Number of tasks, which share the runs
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    tasks: u32,
}

pub(super) fn write(args: &SlurmArgs, shared: &Shared) -> Result<(), Failure> {
    let SlurmArgs { path, scenario, samples, tasks } = args;
    check_new(path)?;
    let document = Document::read(scenario)?;
    let samples = samples.map(|samples| samples as usize);
    Sweep::prepare(&document, samples).map_err(|error| sweep::refused(&error, &document))?;
    let runs = samples.map(|samples| format!(" -n {samples}")).unwrap_or_default();
    write_new(path, &script(&format!("{}{runs}", quoted(&scenario.display().to_string())), *tasks))?;
    if shared.quiet {
        return Ok(());
    }
    let path = shown_path(path);
    print(&format!("wrote {path}; try: sbatch {path}   (computes the runs); sh {path}   (then writes the results)"))
}

/// The script: `sweep` is the scenario and the number of runs, as words of the shell. Nothing of it stands in a comment, which a
/// line break in a name would end.
fn script(sweep: &str, tasks: u32) -> String {
    format!(
        r#"#!/bin/sh
# A sweep of droptower as an array job of Slurm. In this folder, which the nodes must see too:
#   sbatch FILE   computes the runs; submitted again, those that are missing
#   sh FILE       gathers the results, once no task is left in `squeue --me`
#SBATCH --job-name=droptower
#SBATCH --array=1-{tasks}             # number of tasks; each takes runs that nobody has begun
#SBATCH --cpus-per-task=16      # cores of a task, all on one node
#SBATCH --nodes=1
#SBATCH --time=60               # minutes; short tasks start sooner
##SBATCH --account=film-lab     # who pays, if the centre asks; remove one # to use it
##SBATCH --partition=standard   # the queue; `sinfo` lists them
#SBATCH --requeue               # a task goes on after its node failed
#SBATCH --open-mode=append
set -- sweep {sweep}
if [ -n "$SLURM_ARRAY_TASK_ID" ]; then
    exec droptower "$@" --shard "$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_MAX" --threads "$SLURM_CPUS_PER_TASK"
fi
exec droptower "$@" --merge
"#
    )
}
