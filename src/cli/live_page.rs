//! `progress.html`: the page of a batch of runs while they run, written beside its results.

use std::io;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use crate::failure::Failure;
use crate::shell::command_line;
use base::diagnostic::shown_path;
use base::periodic;
use report::{Counts, Pace, PageTime, StudyCall, StudyProgress, StudyState};
use study::evaluate::{Evaluations, RunEvent};
use study::identify::SearchEvent;
use study::store::ProgressFolder;
use study::sweep;

/// Time between two looks whether there is news.
const TICK: Duration = Duration::from_millis(250);

/// Least time between two writes.
const EVERY: Duration = Duration::from_secs(2);

/// Time after which the page is written without news: whoever reads it learns that the process lives.
const SILENCE: Duration = Duration::from_secs(10);

/// The page of a batch. Cheap to clone.
#[derive(Clone)]
pub(super) struct LivePage(Arc<Parts>);

struct Parts {
    folder: ProgressFolder,
    began: Instant,
    progress: Mutex<StudyProgress>,
    /// Whether there is news since the last write.
    is_news: AtomicBool,
    beat: AtomicU64,
    written: Mutex<Written>,
    /// Prints a line about the page.
    tell: Box<dyn Fn(&str) + Send + Sync>,
}

/// What was written. Whoever writes holds its lock, so that nothing is written after the end.
#[derive(Default)]
struct Written {
    last: Option<Instant>,
    has_failed: bool,
    has_ended: bool,
}

impl LivePage {
    /// The page of a batch of this name in `folder`. Nothing is written before it [begins](LivePage::begin), or runs or
    /// trials are asked for; `tell` prints where it is then.
    pub(super) fn new(name: &str, folder: ProgressFolder, tell: impl Fn(&str) + Send + Sync + 'static) -> LivePage {
        let call = StudyCall {
            name: name.to_owned(),
            command: command_line(),
            folder: std::env::current_dir().map(|folder| folder.display().to_string()).unwrap_or_default(),
            stop: cfg!(unix).then(|| format!("kill -INT {}", std::process::id())),
        };
        LivePage(Arc::new(Parts {
            folder,
            began: Instant::now(),
            progress: Mutex::new(StudyProgress::new(call)),
            is_news: AtomicBool::new(true),
            beat: AtomicU64::new(0),
            written: Mutex::default(),
            tell: Box::new(tell),
        }))
    }

    /// Writes the page for the first time, and prints where it is.
    pub(super) fn begin(&self) {
        let mut written = self.written();
        if written.last.is_some() || written.has_ended {
            return;
        }
        // What cannot be removed shows where the page is written.
        let _ = self.0.folder.forget_stop();
        (self.0.tell)(&format!("{} shows how far it is", shown_path(self.0.folder.page())));
        self.write(&mut written);
    }

    /// Does `work` while the page is written whenever there is news.
    pub(super) fn during<T>(&self, work: impl FnOnce() -> T) -> T {
        periodic::during(TICK, || self.renew(), work)
    }

    fn renew(&self) {
        if !self.has_begun() {
            if self.progress().has_begun() {
                self.begin();
            }
            return;
        }
        let mut written = self.written();
        let silence = written.last.map_or(SILENCE, |last| last.elapsed());
        let is_due = silence >= SILENCE || (silence >= EVERY && self.0.is_news.load(Ordering::Relaxed));
        if is_due && !written.has_ended {
            self.write(&mut written);
        }
    }

    fn has_begun(&self) -> bool {
        self.written().last.is_some()
    }

    fn write(&self, written: &mut Written) {
        self.0.is_news.store(false, Ordering::Relaxed);
        let time = PageTime {
            elapsed: self.elapsed(),
            written_ms: SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |time| time.as_millis() as u64),
            beat: self.0.beat.fetch_add(1, Ordering::Relaxed),
            silence: SILENCE.as_secs_f64(),
        };
        // A copy, so that nobody who has news waits for the page.
        let progress = self.progress().clone();
        let page = self.0.folder.write_page(&progress.page(time));
        written.last = Some(Instant::now());
        self.check(written, page);
    }

    /// The page is no result: that it cannot be written is told once, and the batch goes on.
    fn check(&self, written: &mut Written, done: io::Result<()>) {
        let Err(error) = done else { return };
        if !std::mem::replace(&mut written.has_failed, true) {
            (self.0.tell)(&format!("cannot write {}: {error}", shown_path(self.0.folder.page())));
        }
    }

    /// How many runs wait, run, are done or failed, and the pace of a sweep.
    pub(super) fn runs(&self) -> (Counts, Option<Pace>) {
        self.progress().runs(self.elapsed())
    }

    /// Time since the batch began, s.
    pub(super) fn elapsed(&self) -> f64 {
        self.0.began.elapsed().as_secs_f64()
    }

    fn change(&self, change: impl FnOnce(&mut StudyProgress)) {
        change(&mut self.progress());
        self.0.is_news.store(true, Ordering::Relaxed);
    }

    /// Takes note of a run.
    pub(super) fn note_run(&self, event: &RunEvent<'_>) {
        let elapsed = self.elapsed();
        self.change(|progress| progress.note_run(event, elapsed));
    }

    /// Takes note of a search.
    pub(super) fn note_search(&self, event: &SearchEvent<'_>) {
        self.change(|progress| progress.note_search(event));
    }

    /// Takes note of a message.
    pub(super) fn note_message(&self, message: &str) {
        self.change(|progress| progress.note_message(message));
    }

    /// Begins the page of a sweep whose runs are ranked by a figure.
    pub(super) fn begin_sweep(&self, ranked: &str) {
        self.change(|progress| progress.begin_sweep(ranked));
        self.begin();
    }

    /// Takes note of a run of a sweep.
    pub(super) fn note_sweep(&self, event: &sweep::Event<'_>, evaluations: &Evaluations) {
        let figures = |place: usize, evaluation: &study::evaluate::Evaluation| {
            self.change(|progress| progress.note_figures(place, evaluation));
        };
        match event {
            sweep::Event::Computed(place, evaluation) => figures(*place, evaluation),
            sweep::Event::Taken(place, keys) => {
                // A record that cannot be read is a failure of the sweep, which reads it in the end.
                if let Ok(Some(evaluation)) = evaluations.record(*keys) {
                    figures(*place, &evaluation);
                }
            }
            sweep::Event::Left(remaining) => self.change(|progress| progress.set_left(*remaining)),
            sweep::Event::Refused(..) => {}
        }
    }

    /// Says that nothing begins any more.
    pub(super) fn stopping(&self) {
        self.change(|progress| progress.set_state(StudyState::Stopping));
        let mut written = self.written();
        if written.last.is_some() && !written.has_ended {
            self.write(&mut written);
        }
    }

    /// Ends the page of a batch that was stopped. Of several ends the first counts.
    pub(super) fn stopped(&self) {
        self.end(StudyState::Stopped);
    }

    /// Ends the page of a batch without results; one that had asked for nothing leaves none.
    pub(super) fn failed(&self, failure: &Failure) {
        if !self.progress().has_begun() {
            return self.discard();
        }
        let causes: Vec<&str> = failure.diagnostics.iter().map(|one| one.message.as_str()).collect();
        self.end(StudyState::Failed(causes.join("; ")));
    }

    fn end(&self, state: StudyState) {
        let mut written = self.written();
        if std::mem::replace(&mut written.has_ended, true) {
            return;
        }
        self.change(|progress| progress.set_state(state));
        if written.last.is_some() {
            self.write(&mut written);
        }
    }

    /// Makes the page lead to the results, which are stored; one of a batch that asked for nothing is removed.
    pub(super) fn ended(&self, name: &str) {
        if self.has_begun() && !self.progress().has_begun() {
            return self.discard();
        }
        let mut written = self.written();
        if !std::mem::replace(&mut written.has_ended, true) {
            let ended = self.0.folder.end(|address| report::ended_page(name, address));
            self.check(&mut written, ended);
        }
    }

    /// Removes the page of one of several processes.
    pub(super) fn discard(&self) {
        let mut written = self.written();
        if !std::mem::replace(&mut written.has_ended, true) && written.last.is_some() {
            let removed = self.0.folder.discard();
            self.check(&mut written, removed);
        }
    }

    /// The folder of the page.
    pub(super) fn folder(&self) -> &ProgressFolder {
        &self.0.folder
    }

    /// What is known so far, for a program.
    pub(super) fn summary(&self) -> serde_json::Map<String, serde_json::Value> {
        self.progress().summary()
    }

    fn progress(&self) -> MutexGuard<'_, StudyProgress> {
        base::lock(&self.0.progress)
    }

    fn written(&self) -> MutexGuard<'_, Written> {
        base::lock(&self.0.written)
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use study::store::evaluations::Share;

    fn page(folder: &std::path::Path) -> (LivePage, Arc<Mutex<Vec<String>>>) {
        let told = Arc::new(Mutex::new(vec![]));
        let lines = Arc::clone(&told);
        let folder = ProgressFolder::new(&folder.join("a"), Share::WHOLE);
        (LivePage::new("a", folder, move |line| lines.lock().unwrap().push(line.to_owned())), told)
    }

    #[test]
    fn a_page_begins_with_the_first_run_and_is_told_once() {
        let root = tempfile::tempdir().unwrap();
        let (page, told) = page(root.path());
        page.renew();
        assert!(!page.folder().path().exists(), "nothing was asked for");
        page.note_run(&RunEvent::Wanted(2));
        [(); 3].iter().for_each(|()| page.renew());
        assert_eq!(told.lock().unwrap().len(), 1);
        let text = || fs::read_to_string(page.folder().page()).unwrap();
        assert!(text().contains("a: running") && text().contains("runs waiting</span><span class=\"value\">2<"));
        page.stopping();
        assert!(text().contains("a: stopping"));
        page.ended("a");
        assert!(text().contains("../../a/report.html"));
    }

    #[test]
    fn a_batch_that_asks_for_nothing_leaves_no_page() {
        let root = tempfile::tempdir().unwrap();
        let ends: [fn(&LivePage); 2] = [|page| page.ended("a"), |page| page.failed(&Failure::quiet())];
        for end in ends {
            let (page, _) = page(root.path());
            page.begin();
            assert!(page.folder().page().exists());
            end(&page);
            assert!(!page.folder().path().exists());
        }
    }

    #[test]
    fn a_page_that_cannot_be_written_is_told_once_and_ends_nothing() {
        let root = tempfile::tempdir().unwrap();
        let (page, told) = page(root.path());
        fs::write(root.path().join(".progress"), "a file in its place").unwrap();
        page.begin();
        page.stopped();
        let told = told.lock().unwrap();
        assert!(told.len() == 2 && told[1].starts_with("cannot write "), "{told:?}");
    }
}
