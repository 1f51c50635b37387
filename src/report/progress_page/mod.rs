//! The page of a study, a sweep or a search while it runs.
//!
//! [`StudyProgress`] takes note of what happens, and shows it as a page that renews itself. It knows no files and no clock:
//! times are given to it.

mod runs;
mod search;

use serde_json::{Map, Value, json};

use crate::drawn;
use crate::html::{self, Card, Cell, escape, folded};
pub use crate::progress_page::runs::{Counts, Pace};
use crate::progress_page::runs::{Runs, SweepRuns};
use crate::progress_page::search::Search;
use base::number::{significant, wall_time};
use plot::thinned;
use study::evaluate::{Evaluation, RunEvent};
use study::identify::SearchEvent;
use study::sweep::RemainingWork;

/// Most points of all plots of a page, which is written again and again.
const MOST_POINTS: usize = 40_000;

/// Most searches that are shown, the last ones.
const MOST_SHOWN: usize = 12;

/// Most messages that are shown, the last ones.
const MOST_MESSAGES: usize = 30;

/// Digits of the error and of unknowns.
const DIGITS: usize = 5;

/// What became of a study.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum StudyState {
    /// It runs.
    Running,
    /// It was told to stop, and ends once what runs has ended.
    Stopping,
    /// It was stopped before its end.
    Stopped,
    /// It ended without results, for this cause.
    Failed(String),
}

/// The surroundings of a study that its page names.
#[derive(Clone, Debug)]
pub struct StudyCall {
    /// Its name.
    pub name: String,
    /// The command that starts it, and goes on after a stop.
    pub command: String,
    /// The folder in which it was started.
    pub folder: String,
    /// The command that stops it, where there is one besides Ctrl-C.
    pub stop: Option<String>,
}

/// When a page is written.
#[derive(Clone, Copy, Debug)]
pub struct PageTime {
    /// Time since the study began, s.
    pub elapsed: f64,
    /// Now, ms since 1970.
    pub written_ms: u64,
    /// How often the page was written before.
    pub beat: u64,
    /// Longest time between two writes of a process that lives, s.
    pub silence: f64,
}

/// A study as far as it is.
#[derive(Clone, Debug)]
pub struct StudyProgress {
    call: StudyCall,
    state: StudyState,
    runs: Runs,
    searches: Vec<Search>,
    sweep: Option<SweepRuns>,
    messages: Vec<String>,
}

impl StudyProgress {
    /// A study that begins now.
    pub fn new(call: StudyCall) -> StudyProgress {
        let (runs, searches, messages) = (Runs::default(), vec![], vec![]);
        StudyProgress { call, state: StudyState::Running, runs, searches, sweep: None, messages }
    }

    /// Sets what became of the study.
    pub fn set_state(&mut self, state: StudyState) {
        self.state = state;
    }

    /// Whether runs or trials were asked for.
    pub fn has_begun(&self) -> bool {
        self.runs.wanted() > 0 || !self.searches.is_empty()
    }

    /// Takes note of a run, at this time since the study began, s.
    pub fn note_run(&mut self, event: &RunEvent<'_>, elapsed: f64) {
        self.runs.note(event, elapsed);
    }

    /// So much of a sweep is left to compute, by an estimate.
    pub fn set_left(&mut self, left: RemainingWork) {
        self.runs.set_left(left);
    }

    /// How many runs wait, run, are done or failed, and the pace of a sweep at this time since it began, s.
    pub fn runs(&self, elapsed: f64) -> (Counts, Option<Pace>) {
        (self.runs.counts(), self.runs.pace(elapsed))
    }

    /// Takes note of a search.
    pub fn note_search(&mut self, event: &SearchEvent<'_>) {
        match event {
            SearchEvent::Begun(start) => self.searches.push(Search::new(start)),
            SearchEvent::Trial(number, event) => self.with_search(*number, |search| search.note(event)),
            SearchEvent::Ended(number) => self.with_search(*number, |search| search.is_active = false),
            SearchEvent::Progress(number, progress) => {
                self.with_search(*number, |search| search.progress = Some((*progress).clone()));
            }
            SearchEvent::Followed(text) => self.note_message(text),
            SearchEvent::Finished(_) | SearchEvent::Correlation(_) => {}
        }
    }

    fn with_search(&mut self, number: usize, change: impl FnOnce(&mut Search)) {
        if let Some(search) = self.searches.iter_mut().rev().find(|search| search.number == number) {
            change(search);
        }
    }

    /// Begins a sweep whose runs are ranked by a figure.
    pub fn begin_sweep(&mut self, ranked: &str) {
        self.sweep = Some(SweepRuns::new(ranked));
    }

    /// Takes note of the figures of a run of the sweep.
    pub fn note_figures(&mut self, place: usize, evaluation: &Evaluation) {
        if let Some(sweep) = &mut self.sweep {
            sweep.add(place, evaluation);
        }
    }

    /// Takes note of a message.
    pub fn note_message(&mut self, message: &str) {
        if self.messages.len() == MOST_MESSAGES {
            self.messages.remove(0);
        }
        self.messages.push(message.to_owned());
    }

    /// What is known, for a program: counts, and the best of each search.
    pub fn summary(&self) -> Map<String, Value> {
        let counts = |Counts { waiting, running, done, known, failed }: Counts| json!({ "waiting": waiting + running, "done": done, "known_before": known, "failed": failed });
        let search = |search: &Search| {
            let x =
                |best: &search::Best| search.unknowns.iter().cloned().zip(best.x.iter().map(|x| json!(x))).collect();
            json!({
                "title": search.title(),
                "error": search.best().map(|best| best.f),
                "best": search.best().map(|best| Value::Object(x(best))),
                "trials": counts(search.counts()),
            })
        };
        let entries = [("runs", counts(self.runs.counts())), ("searches", self.searches.iter().map(search).collect())];
        entries.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
    }

    /// The active search, or the last one.
    fn current(&self) -> Option<&Search> {
        self.searches.iter().find(|search| search.is_active).or(self.searches.last())
    }

    /// Trials of the searches that ask for some, or did when the study ended; or runs.
    fn counts(&self) -> (Counts, &'static str) {
        let mut active: Vec<&Search> = self.searches.iter().filter(|search| search.is_active).collect();
        if active.is_empty() && self.state != StudyState::Running {
            active.extend(self.searches.last());
        }
        if active.is_empty() {
            return (self.runs.counts(), "runs");
        }
        let add = |sum: Counts, other: Counts| Counts {
            waiting: sum.waiting + other.waiting,
            running: sum.running + other.running,
            done: sum.done + other.done,
            known: sum.known + other.known,
            failed: sum.failed + other.failed,
        };
        (active.into_iter().map(Search::counts).fold(Counts::default(), add), "trials")
    }

    /// How long it takes, in words: of a sweep the time. A search has a limit only, and a script may ask for more runs.
    fn remaining(&self, elapsed: f64) -> Option<String> {
        if !matches!(self.state, StudyState::Running) {
            return None;
        }
        let Some(search) = self.searches.iter().find(|search| search.is_active) else {
            let Pace { to_go, .. } = self.sweep.as_ref().and_then(|_| self.runs.pace(elapsed))?;
            return Some(format!("about {} to go", wall_time(to_go)));
        };
        let progress = search.progress.as_ref()?;
        let left = progress.max_evaluations.saturating_sub(progress.iteration.evaluations);
        Some(match progress.starts {
            1 => format!("at most {left} more trials in this search"),
            starts => format!("at most {left} more trials in start {} of {starts}", progress.iteration.start + 1),
        })
    }

    /// `progress.html`.
    pub fn page(&self, time: PageTime) -> String {
        let title = format!("{}: {}", self.call.name, self.state.word());
        let parts = [
            self.renewal(time),
            self.cards(),
            self.bar(),
            self.best(),
            self.search_sections(),
            self.runs.sections(time.elapsed),
            html::section("Messages", &html::list(&self.messages)),
            html::section("Stop and go on", &self.commands()),
        ];
        html::living_page(&title, &html::framed(&title, &self.sentence(time.elapsed), &parts))
    }

    fn sentence(&self, elapsed: f64) -> String {
        let (counts, what) = self.counts();
        let so_far = format!("{} {what} done in {}", counts.done + counts.failed, wall_time(elapsed));
        match &self.state {
            StudyState::Running => {
                [Some(so_far), self.remaining(elapsed)].into_iter().flatten().collect::<Vec<_>>().join(", ")
            }
            StudyState::Stopping => format!("{so_far}; no {what} begin any more, and {} under way end", counts.running),
            StudyState::Stopped => format!("Stopped: {so_far}. The same command goes on from here."),
            StudyState::Failed(cause) => format!("Failed after {}: {cause}", wall_time(elapsed)),
        }
    }

    /// What the page's script needs to renew it, and what is seen without a script.
    fn renewal(&self, time: PageTime) -> String {
        let lives = matches!(self.state, StudyState::Running | StudyState::Stopping);
        format!(
            "<p class=\"renewal note\" data-lives=\"{lives}\" data-beat=\"{}\" data-written=\"{}\" data-silence=\"{}\">\
             </p>\n",
            time.beat, time.written_ms, time.silence
        )
    }

    fn cards(&self) -> String {
        let (counts, what) = self.counts();
        let Counts { waiting, running, done, known, failed } = counts;
        let taken = if known > 0 { format!("{known} of them known before") } else { String::new() };
        let card = |words: &str, count: usize, beside: &str| {
            Card { words: format!("{what} {words}"), value: &count.to_string(), beside, ..Card::default() }.html()
        };
        let cards = [
            card("waiting", waiting, ""),
            card("running", running, ""),
            card("done", done, &taken),
            card("failed", failed, ""),
        ];
        html::cards(&cards.concat())
    }

    /// How far all runs are, where their number is known.
    fn bar(&self) -> String {
        let counts = self.runs.counts();
        let wanted = self.runs.wanted();
        if wanted == 0 || !self.searches.is_empty() {
            return String::new();
        }
        let done = counts.done + counts.failed;
        format!(
            "<progress class=\"bar\" max=\"{wanted}\" value=\"{done}\" aria-label=\"runs done\">{done} of {wanted}\
             </progress>\n"
        )
    }

    /// The searches, the last one first, each with its phases in their order.
    fn with_phases(&self) -> impl Iterator<Item = &[Search]> {
        self.searches.chunk_by(|_, next| next.continues()).rev()
    }

    /// The best of each search, and the worst run of a sweep.
    fn best(&self) -> String {
        let row = |phases: &[Search]| {
            let (search, best) = phases
                .iter()
                .rev()
                .filter(|search| search.is_search())
                .find_map(|search| Some((search, search.best()?)))?;
            let x = search.unknowns.iter().zip(&best.x).map(|(name, x)| format!("{name} {}", significant(*x, DIGITS)));
            let state = if phases.iter().any(|search| search.is_active) { "searching" } else { "ended" };
            let state = [state, search.phase()].into_iter().filter(|words| !words.is_empty()).collect::<Vec<_>>();
            Some(vec![
                Cell::text(search.common_title()),
                Cell::number(best.f, significant(best.f, DIGITS)),
                Cell::text(x.collect::<Vec<_>>().join(", ")),
                Cell::number(best.number as f64, best.number.to_string()),
                Cell::text(state.join(": ")),
            ])
        };
        let rows: Vec<Vec<Cell>> = self.with_phases().filter_map(row).take(MOST_SHOWN).collect();
        let head = ["search", "error", "parameters", "trial", "state"].map(Cell::text);
        let worst =
            self.sweep.as_ref().and_then(SweepRuns::worst).map_or_else(String::new, |(number, words, value)| {
                format!("<p>Largest {} so far: {}, of run {number}.</p>\n", escape(&words), escape(&value))
            });
        [html::section("Best so far", &html::sorted_table(&head, &rows)), html::section("Worst so far", &worst)]
            .concat()
    }

    /// The searches: the active ones and the last open, those before folded, and so are the phases before the last of each.
    fn search_sections(&self) -> String {
        let shown = self.with_phases().take(MOST_SHOWN).collect::<Vec<_>>();
        let current = self.current().map(|search| search.number);
        let most = MOST_POINTS / shown.iter().map(|phases| phases.len()).sum::<usize>().max(1);
        let section = |phases: &&[Search]| {
            let Some((last, before)) = phases.split_last() else { return String::new() };
            let own = content(last, most);
            let own = match last.is_active || Some(last.number) == current {
                true => own,
                false => folded("curves and trials", &own),
            };
            let before =
                before.iter().rev().map(|phase| folded(&format!("before: {}", phase.phase()), &content(phase, most)));
            html::section(&last.title(), &[own, before.collect()].concat())
        };
        shown.iter().map(section).collect()
    }

    fn commands(&self) -> String {
        let StudyCall { command, folder, stop, .. } = &self.call;
        let stopping = match stop {
            Some(stop) => format!(
                "<p>To stop it once what runs has ended, press Ctrl-C in its terminal, or:</p>\n{}",
                html::verbatim(stop)
            ),
            None => "<p>To stop it once what runs has ended, press Ctrl-C in its terminal.</p>\n".to_owned(),
        };
        let going = format!("<p>What is done stays. To go on, in {}:</p>\n", escape(folder));
        let lives = matches!(self.state, StudyState::Running | StudyState::Stopping);
        [if lives { stopping } else { String::new() }, going, html::verbatim(command)].concat()
    }
}

/// The plots of a search and its failed trials.
fn content(search: &Search, most_points: usize) -> String {
    let plots = thinned(search.plots(), most_points);
    let failed = search.causes.table("trials");
    let failed = if failed.is_empty() { failed } else { format!("<h3>Failed trials</h3>\n{failed}") };
    [drawn::figures(&plots), failed].concat()
}

impl StudyState {
    /// In one word.
    pub fn word(&self) -> &'static str {
        match self {
            StudyState::Running => "running",
            StudyState::Stopping => "stopping",
            StudyState::Stopped => "stopped",
            StudyState::Failed(_) => "failed",
        }
    }
}

/// `progress.html` of a study that has ended: it leads to its report, at this address relative to the page.
pub fn ended_page(name: &str, report: &str) -> String {
    html::leading_page(&format!("{name}: report"), report)
}

#[cfg(test)]
mod tests {
    use super::*;
    use study::identify::{Labels, Phase, SearchStart, TrialEvent};
    use study::store::evaluations::Key;

    fn progress() -> StudyProgress {
        StudyProgress::new(StudyCall {
            name: "a <b>".into(),
            command: "droptower sweep a.toml".into(),
            folder: "/home/x".into(),
            stop: Some("kill -INT 12".into()),
        })
    }

    const TIME: PageTime = PageTime { elapsed: 12.0, written_ms: 1000, beat: 7, silence: 10.0 };

    #[test]
    fn a_page_says_how_far_a_study_is_and_how_to_stop_it() {
        let mut progress = progress();
        assert!(!progress.has_begun());
        progress.note_run(&RunEvent::Wanted(3), 0.0);
        progress.note_run(&RunEvent::Begun { run: Key([1; 16]), name: "drop" }, 0.0);
        progress.note_run(&RunEvent::Ended { run: Key([1; 16]) }, 6.0);
        progress.note_message("<script>");
        let html = progress.page(TIME);
        assert!(!html.contains("to go"), "a script may ask for more");
        for part in [
            "<h1>a &lt;b&gt;: running</h1>",
            "1 runs done in 12 s",
            "data-lives=\"true\" data-beat=\"7\" data-written=\"1000\" data-silence=\"10\"",
            "runs waiting</span><span class=\"value\">2</span>",
            "max=\"3\" value=\"1\"",
            "<li>&lt;script&gt;</li>",
            "<pre>kill -INT 12</pre>",
            "<pre>droptower sweep a.toml</pre>",
        ] {
            assert!(html.contains(part), "{part} is not in {html}");
        }
        assert!(progress.has_begun());
    }

    /// A search in phases is one search: its last phase is open, those before are folded into it.
    #[test]
    fn the_phases_of_a_search_are_one_search() {
        let mut progress = progress();
        let unknowns = ["k".to_owned()];
        for (number, phase) in ["stage 1 of 2", "stage 2 of 2"].into_iter().enumerate() {
            let phase = Some(Phase { number, name: phase.into() });
            let labels = Labels { title: Some("Calibration".into()), phase, signals: vec![] };
            let (function, is_virtual) = ("calibrate", false);
            let start = SearchStart { number, function, labels: &labels, unknowns: &unknowns, is_virtual };
            progress.note_search(&SearchEvent::Begun(start));
            for (x, f) in [(1.0, 3.0), (2.0, 0.25 + number as f64)] {
                let trial = &study::identify::Evaluation::from(f).into();
                let ended = TrialEvent::Ended { x: &[x], trial: Some(trial), waiting: 0 };
                progress.note_search(&SearchEvent::Trial(number, ended));
            }
            if number == 0 {
                progress.note_search(&SearchEvent::Ended(number));
            }
        }
        let html = progress.page(TIME);
        assert_eq!(html.matches("<h2>Calibration").count(), 1, "{html}");
        for part in ["Calibration, stage 2 of 2", "before: stage 1 of 2", "searching: stage 2 of 2", "1.25"] {
            assert!(html.contains(part), "{part} is not in {html}");
        }
        let best = &html[html.find("Best so far").unwrap()..];
        assert_eq!(best[..best.find("</table>").unwrap()].matches("<tr>").count(), 2, "a head and one search");
    }

    #[test]
    fn a_stopped_study_renews_nothing_and_says_so() {
        let mut progress = progress();
        progress.set_state(StudyState::Stopped);
        let html = progress.page(TIME);
        assert!(html.contains("data-lives=\"false\"") && html.contains("a &lt;b&gt;: stopped"), "{html}");
        assert!(!html.contains("kill -INT"), "what has stopped cannot be stopped");
        progress.set_state(StudyState::Failed("no disk".into()));
        assert!(progress.page(TIME).contains("Failed after 12 s: no disk"));
    }
}
