//! `droptower store`: the evaluations that are never computed twice.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use serde_json::json;

use crate::{Failure, Shared, print_figures};
use base::diagnostic::{Diagnostic, Source, Span, shown_path};
use base::number::{grouped, wall_time};
use base::units::Time;
use study::evaluate::build_name;
use study::store::evaluations::SegmentFigures;
use study::store::{self, EvaluationStore};

#[derive(Debug, Subcommand)]
pub(crate) enum StoreCommand {
    /// List the files of evaluations: how many, how large, of which build of droptower
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
    /// Remove files to which nothing was added for this time ("720 h"), of this build too
    #[arg(long, value_name = "TIME")]
    pub older_than: Option<String>,
    /// Remove all
    #[arg(long, conflicts_with = "older_than")]
    pub all: bool,
}

/// Time for which a file must be still before it is removed: a process may be writing it.
const STILL_S: f64 = 60.0;

pub(crate) fn run(command: &StoreCommand, shared: &Shared) -> Result<(), Failure> {
    match command {
        StoreCommand::List(folder) => list(folder, shared),
        StoreCommand::Prune(args) => prune(args, shared),
    }
}

fn segments(folder: &Folder) -> Result<Vec<SegmentFigures>, Failure> {
    EvaluationStore::list(&folder.store).map_err(|error| {
        Failure::output(Diagnostic::new(format!("cannot read {}: {error}", shown_path(&folder.store))))
    })
}

fn list(folder: &Folder, shared: &Shared) -> Result<(), Failure> {
    let segments = segments(folder)?;
    print_figures(shared, &segments, || {
        let lines = segments.iter().map(|segment| {
            let build = match segment.build.as_deref() {
                Some(build) if build == build_name() => "this build".to_owned(),
                Some(build) => format!("droptower {build}"),
                None => "no build: damaged".to_owned(),
            };
            let SegmentFigures { path, evaluations, bytes, runs, run_bytes, age_s, .. } = segment;
            format!(
                "{}: figures of {} runs and {} whole runs, {} kB, {} old, of {build}",
                shown_path(path),
                grouped(*evaluations as u64),
                grouped(*runs as u64),
                grouped((bytes + run_bytes).div_ceil(1024)),
                wall_time(*age_s)
            )
        });
        let sum = |of: fn(&SegmentFigures) -> usize| grouped(segments.iter().map(|segment| of(segment) as u64).sum());
        let total = format!(
            "in all figures of {} runs and {} whole runs, which no command computes again; `droptower store prune` removes those of other builds",
            sum(|segment| segment.evaluations),
            sum(|segment| segment.runs)
        );
        let lines: Vec<String> = lines.chain([total]).collect();
        lines.join("\n")
    })
}

fn prune(args: &PruneArgs, shared: &Shared) -> Result<(), Failure> {
    let age = args.older_than.as_deref().map(age).transpose()?;
    let is_wanted = |segment: &&SegmentFigures| match age {
        _ if args.all => true,
        Some(age) => segment.age_s > age,
        None => segment.build.as_deref() != Some(build_name()),
    };
    // A process may still write the others.
    let is_still = |segment: &&SegmentFigures| segment.age_s > STILL_S;
    let segments = segments(&args.folder)?;
    let meant: Vec<&SegmentFigures> = segments.iter().filter(is_wanted).filter(is_still).collect();
    for segment in &meant {
        EvaluationStore::remove(&args.folder.store, &segment.path).map_err(|error| {
            Failure::output(Diagnostic::new(format!("cannot remove {}: {error}", shown_path(&segment.path))))
        })?;
    }
    let removed = meant.iter().map(|segment| segment.evaluations).sum::<usize>();
    let left = segments.iter().map(|segment| segment.evaluations).sum::<usize>() - removed;
    let spared = segments.iter().filter(is_wanted).filter(|segment| !is_still(segment));
    let spared = spared.map(|segment| segment.evaluations).sum::<usize>();
    print_figures(shared, &json!({ "removed": removed, "left": left, "of_the_last_minute": spared }), || {
        let why = if spared > 0 {
            format!(" ({} of the last minute, which may be in use)", grouped(spared as u64))
        } else {
            String::new()
        };
        format!("{} evaluations removed, {} left{why}", grouped(removed as u64), grouped(left as u64))
    })
}

/// The time of `--older-than`, s.
fn age(text: &str) -> Result<f64, Failure> {
    let source = Source::unfiled("--older-than", text.to_owned());
    Time::DIMENSION.parse(text).map_err(|error| {
        Diagnostic::new(error.to_string()).at(&Span::new(&source, 0..text.len())).hint(error.hint()).into()
    })
}
