//! The submissions of a study: `job.json` in the folder of its job.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::Scheduler;
use base::file::{self, FileError};

/// File of a job in its folder.
const FILE: &str = "job.json";

/// Most bytes of that file.
const MOST_BYTES: u64 = 1 << 20;

/// A study on a cluster.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Job {
    /// Who runs it.
    pub scheduler: Scheduler,
    /// Digest of the study.
    pub study: String,
    /// All submissions, the last one last.
    pub submissions: Vec<Submission>,
}

/// Tasks that were submitted at once.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Submission {
    /// The scheduler's name of them.
    pub id: String,
    /// Their number.
    pub tasks: usize,
    /// Runs of the study that were done by then.
    pub done: usize,
    /// When, s since 1970.
    pub time_s: u64,
}

/// Why a job cannot be kept.
#[derive(Debug, Error)]
pub enum JobError {
    /// Its file cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The cause.
        source: FileError,
    },
    /// Its file does not hold a job.
    #[error("{} holds no job: {source}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// The cause.
        source: serde_json::Error,
    },
    /// Its file cannot be written.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
}

impl Submission {
    /// One of now.
    pub fn new(id: String, tasks: usize, done: usize) -> Submission {
        let since = SystemTime::now().duration_since(UNIX_EPOCH);
        Submission { id, tasks, done, time_s: since.map_or(0, |since| since.as_secs()) }
    }
}

impl Job {
    /// The job in `folder`; none where there is none.
    ///
    /// # Errors
    /// Its file cannot be read or holds something else.
    pub fn read(folder: &Path) -> Result<Option<Job>, JobError> {
        let path = folder.join(FILE);
        let text = match file::read_text(&path, MOST_BYTES) {
            Ok(text) => text,
            Err(FileError::NotFound) => return Ok(None),
            Err(source) => return Err(JobError::Read { path, source }),
        };
        serde_json::from_str(&text).map(Some).map_err(|source| JobError::Content { path, source })
    }

    /// Writes it to `folder`, which is made where there is none.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn write(&self, folder: &Path) -> Result<(), JobError> {
        let path = folder.join(FILE);
        let written = || {
            fs::create_dir_all(folder)?;
            file::replace(&path, &serde_json::to_vec_pretty(self).map_err(io::Error::other)?)
        };
        written().map_err(|source| JobError::Write { path: path.clone(), source })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_job_is_read_as_it_was_written() {
        let folder = tempfile::tempdir().unwrap();
        let inner = folder.path().join("a.job");
        assert_eq!(Job::read(&inner).unwrap(), None);
        let submissions = vec![Submission::new("17".into(), 4, 0), Submission::new("18".into(), 2, 150)];
        let job = Job { scheduler: Scheduler::Slurm, study: "ab".into(), submissions };
        job.write(&inner).unwrap();
        assert_eq!(Job::read(&inner).unwrap(), Some(job));
        fs::write(inner.join(FILE), "{").unwrap();
        assert!(matches!(Job::read(&inner), Err(JobError::Content { .. })));
    }
}
