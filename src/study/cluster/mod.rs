//! Jobs of clusters: many tasks of one command, submitted to a scheduler and watched.
//!
//! Queueing, placing and requeueing are the scheduler's work. Nothing here knows what the command computes.

mod hyperqueue;
mod job;
mod resources;
mod slurm;

use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde::{Deserialize, Serialize};
use thiserror::Error;

use base::file;
use base::shell::quoted;

pub use job::{Job, JobError, Submission};
pub use resources::Resources;

/// A scheduler of a cluster.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Scheduler {
    /// Slurm, by `sbatch` and `squeue`.
    Slurm,
    /// HyperQueue, by `hq`.
    HyperQueue,
}

/// A submission: tasks of one command, which differ by their number.
#[derive(Debug)]
pub struct Batch<'a> {
    /// Name in the queue.
    pub name: &'a str,
    /// Number of tasks.
    pub tasks: usize,
    /// Where the command runs.
    pub working_folder: &'a Path,
    /// Where the script and what the tasks print are written.
    pub folder: &'a Path,
    /// The resources of one task.
    pub resources: &'a Resources,
    /// The command, in which [`TASK`] stands for the number of the task, from one.
    pub command: &'a [String],
}

/// Stands for the number of a task in a command.
pub const TASK: &str = "{task}";

/// The states of the tasks of a submission.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Tasks {
    /// Number of tasks that wait.
    pub waiting: usize,
    /// Number of tasks that run.
    pub running: usize,
    /// Why the first one waits, in the scheduler's words.
    pub reason: Option<String>,
}

/// Why a scheduler cannot be used.
#[derive(Debug, Error)]
pub enum SchedulerError {
    /// Its program cannot be started.
    #[error("cannot start `{program}`: {source}")]
    Start {
        /// The program.
        program: &'static str,
        /// Error of the operating system.
        source: io::Error,
    },
    /// Its program refused.
    #[error("`{program}` failed: {message}")]
    Refused {
        /// The program.
        program: &'static str,
        /// Its output.
        message: String,
    },
    /// The output of its program cannot be read.
    #[error("`{program}` printed what is not understood: {text}")]
    Answer {
        /// The program.
        program: &'static str,
        /// Its output.
        text: String,
    },
    /// The script cannot be written.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// The script.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
}

impl Scheduler {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Scheduler::Slurm => "Slurm",
            Scheduler::HyperQueue => "HyperQueue",
        }
    }

    /// Submits a batch; the scheduler's name of it.
    ///
    /// # Errors
    /// The scheduler is not there or refuses, or the script cannot be written.
    pub fn submit(self, batch: &Batch<'_>) -> Result<String, SchedulerError> {
        match self {
            Scheduler::Slurm => slurm::submit(batch),
            Scheduler::HyperQueue => hyperqueue::submit(batch),
        }
    }

    /// The tasks of a submission that have not ended.
    ///
    /// # Errors
    /// The scheduler is not there, or its answer is not understood.
    pub fn tasks(self, id: &str) -> Result<Tasks, SchedulerError> {
        match self {
            Scheduler::Slurm => slurm::tasks(id),
            Scheduler::HyperQueue => hyperqueue::tasks(id),
        }
    }

    /// The command that a user gives to end a submission.
    pub fn cancel_command(self, id: &str) -> String {
        match self {
            Scheduler::Slurm => format!("scancel {id}"),
            Scheduler::HyperQueue => format!("hq job cancel {id}"),
        }
    }
}

/// The command of a task, in which `number` stands for its number, as a line of a script. It takes the place of the shell,
/// so that signals reach it.
fn command_line(batch: &Batch<'_>, number: &str) -> String {
    let part = |text: &str| if text.is_empty() { String::new() } else { quoted(text) };
    let words = batch.command.iter().map(|word| match word.split_once(TASK) {
        Some((before, after)) => format!("{}{number}{}", part(before), part(after)),
        None => quoted(word),
    });
    format!("exec {}\n", words.collect::<Vec<_>>().join(" "))
}

/// The output of a command of the scheduler.
fn answer(program: &'static str, command: &mut Command) -> Result<String, SchedulerError> {
    let Output { status, stdout, stderr } =
        command.output().map_err(|source| SchedulerError::Start { program, source })?;
    if !status.success() {
        let message = String::from_utf8_lossy(&stderr).trim().to_owned();
        return Err(SchedulerError::Refused { program, message });
    }
    Ok(String::from_utf8_lossy(&stdout).trim().to_owned())
}

/// Writes the script of a batch, an executable of the shell.
fn write_script(batch: &Batch<'_>, text: &str) -> Result<PathBuf, SchedulerError> {
    let path = batch.folder.join("job.sh");
    let written = file::replace(&path, text.as_bytes());
    written.map_err(|source| SchedulerError::Write { path: path.clone(), source })?;
    Ok(path)
}
