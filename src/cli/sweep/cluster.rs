//! `droptower sweep --on`: runs computed by tasks of a cluster.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::thread::sleep;
use std::time::{Duration, Instant};

use super::progress::Progress;
use super::{On, SweepArgs, Task, failed};
use crate::{Failure, Shared};
use base::diagnostic::{Diagnostic, shown_path};
use base::file;
use scene::scenario::Document;
use study::cluster::{Batch, Job, JobError, Resources, Scheduler, SchedulerError, Submission, TASK};
use study::store::evaluations::{Key, STALE};

/// Time between two looks at the records.
const LOOK: Duration = Duration::from_secs(1);

/// Time between two questions to the scheduler.
const ASK: Duration = Duration::from_secs(5);

/// Questions without an answer after which the scheduler is taken for gone.
const MOST_FAILURES: usize = 60;

/// Submissions one after the other that compute nothing after which nothing more is submitted.
const MOST_IDLE: usize = 3;

/// A cluster, and what a task on it may use.
pub(super) struct Cluster {
    scheduler: Scheduler,
    resources: Resources,
}

impl Cluster {
    /// The cluster whose resources are in the file.
    pub(super) fn read(on: On, path: &Path) -> Result<Cluster, Failure> {
        let scheduler = match on {
            On::Slurm => Scheduler::Slurm,
            On::HyperQueue => Scheduler::HyperQueue,
        };
        let document = Document::read_cluster(path)?;
        Ok(Cluster { scheduler, resources: Resources::check(&document, scheduler)? })
    }

    /// Lets tasks compute all runs, and waits for them; the number of runs that were done before the first of them.
    pub(super) fn compute(&self, task: &Task, args: &SweepArgs, shared: &Shared) -> Result<usize, Failure> {
        let keys = task.sweep.keys().map_err(|error| failed(&error))?;
        let keys = keys.into_iter().flatten().map(|keys| keys.figures).collect();
        let study = task.sweep.digest().map_err(|error| failed(&error))?.to_string();
        let folder = job_folder(&task.place);
        let progress = Progress::new(task.sweep.len(), shared);
        let refused = HashMap::new();
        let mut watch = Watch { cluster: self, task, args, keys, refused, folder, progress: &progress };
        let mut job = watch.job(study)?;
        if job.submissions.is_empty() {
            watch.refused = watch.keys.iter().map(|key| (*key, task.evaluations.store().refusals(*key))).collect();
        }
        let found = watch.until_done(&mut job);
        progress.finish();
        found
    }
}

/// The folder of the job of results in `place`: beside it, since results are replaced as a whole.
fn job_folder(place: &Path) -> PathBuf {
    let mut name = place.file_name().unwrap_or_default().to_owned();
    name.push(".job");
    place.with_file_name(name)
}

/// A study while its tasks compute it.
struct Watch<'a> {
    cluster: &'a Cluster,
    task: &'a Task,
    args: &'a SweepArgs,
    /// Keys of the runs that can start.
    keys: Vec<Key>,
    /// How often each was refused before the job, for causes that may have passed.
    refused: HashMap<Key, usize>,
    folder: PathBuf,
    progress: &'a Progress,
}

impl Watch<'_> {
    /// The job of the study that is under way, or a new one.
    fn job(&self, study: String) -> Result<Job, Failure> {
        let scheduler = self.cluster.scheduler;
        let Some(job) = Job::read(&self.folder).map_err(|error| unkept(&error))? else {
            return Ok(Job { scheduler, study, submissions: vec![] });
        };
        let Some(last) = job.submissions.last() else { return Ok(Job { scheduler, study, submissions: vec![] }) };
        let is_same = job.study == study && job.scheduler == scheduler;
        let tasks = job.scheduler.tasks(&last.id).map_err(|error| refused(&error))?;
        let is_over = tasks.waiting + tasks.running == 0;
        match (is_same, is_over) {
            (true, false) => {
                self.progress.note(&format!("job {} of {} is taken up", last.id, scheduler.name()));
                Ok(job)
            }
            (_, true) => Ok(Job { scheduler, study, submissions: vec![] }),
            (false, false) => {
                let name = shown_path(&self.folder);
                let mistake = Diagnostic::new(format!("job {} in {name} computes another study", last.id));
                let end = job.scheduler.cancel_command(&last.id);
                Err(mistake.hint(format!("end it by `{end}`, or give another --out")).into())
            }
        }
    }

    /// Runs that are done: those that the job was refused for a cause that may pass as well, or it would never end.
    fn done(&self) -> Result<usize, Failure> {
        let store = self.task.evaluations.store();
        store.refresh().map_err(|error| failed(&self.task.evaluations.failed(error)))?;
        let was_refused = |key: &Key| store.refusals(*key) > self.refused.get(key).copied().unwrap_or_default();
        Ok(self.keys.iter().filter(|key| store.contains(**key) || was_refused(key)).count())
    }

    /// Submits what is missing, and waits.
    fn until_done(&mut self, job: &mut Job) -> Result<usize, Failure> {
        let before = self.done()?;
        let before = job.submissions.first().map_or(before, |first| first.done);
        let (mut asked, mut failures): (Option<Instant>, usize) = (None, 0);
        loop {
            let done = self.done()?;
            self.progress.reached(done, before);
            self.task.page.note_reached(self.keys.len(), done, before);
            if done == self.keys.len() {
                return Ok(before);
            }
            if self.task.stop.requested.is_cancelled() {
                return Err(self.left(job, done));
            }
            if asked.is_none_or(|at| at.elapsed() >= ASK) {
                asked = Some(Instant::now());
                match self.advance(job) {
                    Ok(()) => failures = 0,
                    // A scheduler may be restarted meanwhile.
                    Err(Advance::Scheduler(error)) if failures < MOST_FAILURES && !job.submissions.is_empty() => {
                        if failures == 0 {
                            self.progress.note(&format!("{error}; asked again"));
                        }
                        failures += 1;
                    }
                    Err(Advance::Scheduler(error)) => return Err(refused(&error)),
                    Err(Advance::Failure(failure)) => return Err(failure),
                }
            }
            sleep(LOOK);
        }
    }

    /// Asks the scheduler for the tasks; where there are none, submits what is missing.
    fn advance(&self, job: &mut Job) -> Result<(), Advance> {
        if let Some(last) = job.submissions.last() {
            let tasks = self.cluster.scheduler.tasks(&last.id)?;
            if tasks.waiting + tasks.running > 0 {
                self.progress.tasks(&last.id, &tasks);
                return Ok(());
            }
            self.settle()?;
        }
        let done = self.done()?;
        if done == self.keys.len() {
            return Ok(());
        }
        let idle = job.submissions.iter().rev().take_while(|submission| submission.done == done).count();
        if idle >= MOST_IDLE {
            return Err(self.stuck(done).into());
        }
        let tasks = usize::from(self.cluster.resources.nodes).min(self.keys.len() - done);
        file::own_folder(&self.folder).map_err(|source| {
            Failure::output(Diagnostic::new(format!("cannot write {}: {source}", shown_path(&self.folder))))
        })?;
        let working_folder = std::env::current_dir()
            .map_err(|error| Failure::output(Diagnostic::new(format!("cannot tell the working folder: {error}"))))?;
        let folder = std::path::absolute(&self.folder).unwrap_or_else(|_| self.folder.clone());
        let command = self.command(tasks, &job.study);
        let id = self.cluster.scheduler.submit(&Batch {
            name: &self.task.sweep.model().name,
            tasks,
            working_folder: &working_folder,
            folder: &folder,
            resources: &self.cluster.resources,
            command: &command,
        })?;
        job.submissions.push(Submission::new(id.clone(), tasks, done));
        job.write(&self.folder).map_err(|error| Advance::from(unkept(&error)))?;
        let missing = self.keys.len() - done;
        let scheduler = self.cluster.scheduler.name();
        self.progress.note(&format!("{missing} runs submitted to {scheduler}: job {id}, {tasks} tasks"));
        Ok(())
    }

    /// Waits until no claim of a task that was lost holds any more.
    fn settle(&self) -> Result<(), Failure> {
        let begin = Instant::now();
        let is_missing = |done: usize| done < self.keys.len();
        while begin.elapsed() < STALE && is_missing(self.done()?) && !self.task.stop.requested.is_cancelled() {
            sleep(LOOK);
        }
        Ok(())
    }

    /// The command of a task.
    fn command(&self, tasks: usize, study: &str) -> Vec<String> {
        let (resources, args) = (&self.cluster.resources, self.args);
        let this = || std::env::current_exe().map_or_else(|_| "droptower".into(), |path| path.display().to_string());
        let program = match &resources.program {
            Some(program) => program.clone(),
            None if resources.container.is_empty() => this(),
            None => "droptower".into(),
        };
        let mut words = resources.container.clone();
        words.extend([program, "sweep".into(), args.scenario.display().to_string()]);
        words.extend(args.changes.words());
        let mut option = |name: &str, value: String| words.extend([name.to_owned(), value]);
        if let Some(samples) = args.samples {
            option("-n", samples.to_string());
        }
        option("--store", args.store.display().to_string());
        option("--shard", format!("{TASK}/{tasks}"));
        option("--stop-after", format!("{} s", resources.working_time().floor()));
        option("--threads", resources.cores.to_string());
        option("--study", study.to_owned());
        words.push("--quiet".into());
        words
    }

    /// The failure of this program where it ends before the job.
    fn left(&self, job: &Job, done: usize) -> Failure {
        let all = self.keys.len();
        let Some(last) = job.submissions.last() else {
            return Failure::output(Diagnostic::new("ended before anything was submitted"));
        };
        let mistake = Diagnostic::new(format!(
            "{done} of {all} runs are done; job {} of {} goes on without this program",
            last.id,
            job.scheduler.name()
        ));
        let end = job.scheduler.cancel_command(&last.id);
        Failure::output(mistake.hint(format!("the same command takes it up; `{end}` ends it")))
    }

    fn stuck(&self, done: usize) -> Failure {
        let missing = self.keys.len() - done;
        let message = format!("{missing} of {} runs are missing, and the last tasks computed none", self.keys.len());
        let logs = shown_path(&self.folder.join("task-1.log"));
        Failure::output(Diagnostic::new(message).hint(format!("see what a task printed: {logs}")))
    }
}

/// Why the job does not go on.
enum Advance {
    Scheduler(SchedulerError),
    Failure(Failure),
}

impl From<SchedulerError> for Advance {
    fn from(error: SchedulerError) -> Advance {
        Advance::Scheduler(error)
    }
}

impl From<Failure> for Advance {
    fn from(failure: Failure) -> Advance {
        Advance::Failure(failure)
    }
}

fn refused(error: &SchedulerError) -> Failure {
    Failure::output(Diagnostic::new(error.to_string()))
}

fn unkept(error: &JobError) -> Failure {
    Failure::output(Diagnostic::new(error.to_string()))
}
