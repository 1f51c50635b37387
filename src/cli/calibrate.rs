//! `droptower calibrate`: a study in a file, tests and parameters and what follows, without a script.

use std::path::PathBuf;
use std::sync::Arc;

use clap::Args;

use super::changes::Changes;
use super::complete;
use super::farm::ShardArgs;
use super::given::Given;
use super::script::{self, ScriptArgs};
use super::{Failure, Shared};
use study::calibrate::StudyFile;
use study::store;

#[derive(Clone, Debug, Args)]
pub(super) struct CalibrateArgs {
    /// The study: tests, parameters, predictions (`droptower new study study.toml`)
    #[arg(value_name = "STUDY", add = complete::scenarios())]
    path: PathBuf,
    #[command(flatten)]
    changes: Changes,
    /// Find mistakes in the study without running it
    #[arg(long)]
    check: bool,
    /// Folder for the results, in place of runs/<name of the study>
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replace results of another study in the same folder
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    farm: ShardArgs,
    /// Folder of the evaluations that are never computed twice
    #[arg(long, value_name = "DIR", default_value = store::EVALUATIONS)]
    store: PathBuf,
}

pub(super) fn run(args: &CalibrateArgs, shared: &Shared) -> Result<(), Failure> {
    let study = Some(Arc::new(StudyFile::read(&args.path)?));
    let CalibrateArgs { path, changes, check, out, force, farm, store } = args.clone();
    let given = Given { scenario: None, arg: Vec::new(), changes };
    let script =
        ScriptArgs { path: Some(path), help: false, list: false, check, given, out, force, farm, store, study };
    script::run(&script, shared)
}
