//! `droptower store`: the evaluations that are never computed twice.

use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, Subcommand};
use serde_json::json;

use crate::{Failure, Shared, args, print_figures};
use base::diagnostic::{Diagnostic, shown_path};
use base::number::{grouped, wall_time};
use study::evaluate::build_name;
use study::store::evaluations::{BuildFigures, Pruned};
use study::store::{self, EvaluationStore};

#[derive(Debug, Subcommand)]
pub(crate) enum StoreCommand {
    /// List the evaluations: how many, how large, of which build of droptower
    List(Folder),
    /// Remove evaluations of other builds of droptower, which this one does not use, or others
    Prune(PruneArgs),
}

#[derive(Debug, Args)]
pub(crate) struct Folder {
    /// Folder of the evaluations
    #[arg(long, value_name = "DIR", default_value = store::EVALUATIONS)]
    pub store: PathBuf,
}

#[derive(Debug, Args)]
pub(crate) struct PruneArgs {
    #[command(flatten)]
    pub folder: Folder,
    /// Remove what is older than this ("720 h"), of this build too
    #[arg(long, value_name = "TIME")]
    pub older_than: Option<String>,
    /// Remove all
    #[arg(long, conflicts_with = "older_than")]
    pub all: bool,
}

pub(crate) fn run(command: &StoreCommand, shared: &Shared) -> Result<(), Failure> {
    match command {
        StoreCommand::List(folder) => list(folder, shared),
        StoreCommand::Prune(args) => prune(args, shared),
    }
}

fn list(folder: &Folder, shared: &Shared) -> Result<(), Failure> {
    let builds = EvaluationStore::list(&folder.store).map_err(|error| {
        Failure::output(Diagnostic::new(format!("cannot read {}: {error}", shown_path(&folder.store))))
    })?;
    print_figures(shared, &builds, || {
        let lines = builds.iter().map(|BuildFigures { path, build, evaluations, bytes, runs, run_bytes, age_s }| {
            // A folder of another build is named, since `prune` removes it.
            let whose = match build == build_name() {
                true => "of this build".to_owned(),
                false => format!("of another build, in {}", shown_path(path)),
            };
            format!(
                "{whose}: figures of {} runs and {} whole runs, {} kB, {} old",
                grouped(*evaluations as u64),
                grouped(*runs as u64),
                grouped((bytes + run_bytes).div_ceil(1024)),
                wall_time(*age_s)
            )
        });
        let sum = |of: fn(&BuildFigures) -> usize| grouped(builds.iter().map(|build| of(build) as u64).sum());
        let total = format!(
            "in all {} runs, which no command computes again; `droptower store prune` removes those of other builds",
            sum(|build| build.evaluations + build.runs)
        );
        if builds.is_empty() {
            return format!("no runs are kept in {}", shown_path(&folder.store));
        }
        let lines: Vec<String> = lines.chain([total]).collect();
        lines.join("\n")
    })
}

fn prune(args: &PruneArgs, shared: &Shared) -> Result<(), Failure> {
    let least = args.older_than.as_deref().map(|text| args::time("--older-than", text)).transpose()?;
    let is_wanted = |build: &str, age: Duration| match least {
        _ if args.all => true,
        Some(least) => age.as_secs_f64() > least,
        None => build != build_name(),
    };
    let folder = &args.folder.store;
    let pruned = EvaluationStore::prune(folder, is_wanted).map_err(|error| {
        Failure::output(Diagnostic::new(format!("cannot remove evaluations in {}: {error}", shown_path(folder))))
    })?;
    let Pruned { removed, left, spared } = pruned;
    print_figures(shared, &json!({ "removed": removed, "left": left, "of_the_last_minute": spared }), || {
        let why = if spared > 0 {
            format!(" ({} of the last minute, which may be in use)", grouped(spared as u64))
        } else {
            String::new()
        };
        format!("{} evaluations removed, {} left{why}", grouped(removed as u64), grouped(left as u64))
    })
}
