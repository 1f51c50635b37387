//! How far runs and sweeps are: bars on a terminal, events for a program, the time that is left.

use std::collections::VecDeque;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::json;

use crate::folder::DIGITS;
use crate::live_page::LivePage;
use crate::{Shared, tell, tell_event};
use base::diagnostic::{self, Diagnostic};
use base::finding::{Finding, Report};
use base::number::{self, duration, figure, grouped, rounded, wall_time};
use base::units::Time;
use membrane::engine::Settling;
use report::{Counts, Pace};
use scene::mesh::Outline;
use scene::model::{Model, Symmetry};
use scene::simulate::{self, Progress, SpringStep};
use study::sweep::Event;

/// Steps of the bar for one run.
const PER_RUN: f64 = 1000.0;

/// Time between two updates of the bar.
const REFRESH: Duration = Duration::from_millis(100);

/// Time after which a command without a bar shows that it works.
const SOON: Duration = Duration::from_secs(1);

/// A bar of so many steps on standard error; hidden where that is not a terminal, or by wish.
fn bar(steps: Option<u64>, template: &str, hidden: bool) -> ProgressBar {
    let target = if hidden { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr_with_hz(10) };
    let bar = ProgressBar::with_draw_target(steps, target);
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar
}

/// Prints a line above the bar.
fn print_above(bar: &ProgressBar, text: &str) {
    bar.suspend(|| tell(text));
}

/// The end of the sign of work that is shown; it is closed to end it.
static WORK: Mutex<Option<Work>> = Mutex::new(None);

/// A thread that shows that a command works.
struct Work {
    end: Sender<()>,
    thread: thread::JoinHandle<()>,
}

/// Shows on a terminal that a command without a bar works, from its first second until [`end_of_work`].
pub(crate) fn begin_work(quiet: bool) {
    let bar = bar(None, "{spinner} {elapsed}", quiet);
    if bar.is_hidden() {
        return;
    }
    let (end, ended) = channel();
    let show = move || {
        let mut wait = SOON;
        while ended.recv_timeout(wait) == Err(RecvTimeoutError::Timeout) {
            bar.tick();
            wait = REFRESH;
        }
        bar.finish_and_clear();
    };
    // Without a thread nothing is shown.
    if let Ok(thread) = thread::Builder::new().name("progress".into()).spawn(show) {
        *base::lock(&WORK) = Some(Work { end, thread });
    }
}

/// Removes what [`begin_work`] shows: the command prints now.
pub(crate) fn end_of_work() {
    if let Some(Work { end, thread }) = base::lock(&WORK).take() {
        drop(end);
        let _ = thread.join();
    }
}

/// One bar for all runs.
pub(crate) struct Bar {
    bar: ProgressBar,
    done: Vec<AtomicU64>,
    /// Progress of resumed runs when they resumed.
    before: Vec<AtomicU64>,
    quiet: bool,
    start: Instant,
    drawn: Mutex<Drawn>,
}

/// The last update of the bar, and what it knows of the pace.
struct Drawn {
    at: Instant,
    pace: RunPace,
}

impl Bar {
    /// A bar for so many runs on standard error; hidden where that is not a terminal or `quiet`.
    pub(crate) fn new(runs: usize, quiet: bool) -> Bar {
        let bar = bar(Some((runs as f64 * PER_RUN) as u64), "{wide_bar} {percent:>3} %  {msg}", quiet);
        let start = Instant::now();
        let none = || (0..runs).map(|_| AtomicU64::new(0)).collect();
        Bar {
            bar,
            done: none(),
            before: none(),
            quiet,
            start,
            drawn: Mutex::new(Drawn { at: start, pace: RunPace::default() }),
        }
    }

    /// Sets the share of the run at `index` that was done before it resumed.
    pub(crate) fn start_at(&self, index: usize, share: f64) {
        let share = (share.clamp(0.0, 1.0) * PER_RUN) as u64;
        self.before[index].store(share, Ordering::Relaxed);
        self.done[index].store(share, Ordering::Relaxed);
    }

    /// Shows the progress of the run at `index`; the bar is redrawn ten times a second at most.
    pub(crate) fn show(&self, index: usize, progress: Progress) {
        let share = (progress.time / progress.duration).clamp(0.0, 1.0);
        self.done[index].store((share * PER_RUN) as u64, Ordering::Relaxed);
        // Another run that is drawing the bar includes the progress of this one.
        let Ok(mut drawn) = self.drawn.try_lock() else {
            return;
        };
        if drawn.at.elapsed() < REFRESH {
            return;
        }
        drawn.at = Instant::now();
        let sum = |shares: &[AtomicU64]| shares.iter().map(|share| share.load(Ordering::Relaxed)).sum::<u64>();
        let (total, before) = (sum(&self.done), sum(&self.before));
        let state = if self.done.len() == 1 { state(&progress) } else { String::new() };
        let whole = self.done.len() as f64 * PER_RUN;
        let to_go = drawn.pace.remaining(self.start.elapsed(), before as f64 / whole, total as f64 / whole);
        let to_go = to_go.map(|left| format!("{} to go  ", wall_time(left))).unwrap_or_default();
        self.bar.set_message(format!("{to_go}{state}"));
        self.bar.set_position(total);
    }

    /// Wall time since the bar was made.
    pub(crate) fn elapsed(&self) -> Duration {
        self.start.elapsed()
    }

    /// Prints a finding with its severity above the bar, unless `quiet`.
    pub(crate) fn report(&self, report: &impl Report) {
        if !self.quiet {
            self.print(&format!("{}: {report}", report.code().severity));
        }
    }

    /// Prints a finding of the scenario of a run, with its name where there are several, unless `quiet`.
    pub(crate) fn finding(&self, run: &str, finding: &Finding) {
        let several = self.done.len() > 1;
        if !self.quiet {
            self.print(&if several { format!("{run}: {finding}") } else { finding.to_string() });
        }
    }

    /// Prints how the run proceeds above the bar, as a note, unless `quiet`.
    pub(crate) fn note(&self, text: &str) {
        if !self.quiet {
            self.print(&format!("note: {text}"));
        }
    }

    /// Prints a warning above the bar.
    #[cfg(feature = "rerun")]
    pub(crate) fn warn(&self, text: &str) {
        self.print(&format!("warning: {text}"));
    }

    /// Prints an error above the bar; the runs continue.
    pub(crate) fn error(&self, mistake: &Diagnostic) {
        self.print(&diagnostic::render(std::slice::from_ref(mistake), false));
    }

    fn print(&self, text: &str) {
        print_above(&self.bar, text);
    }

    /// Removes the bar.
    pub(crate) fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

/// The present state of a run: its time, or how far its film is from equilibrium before its first step.
fn state(progress: &Progress) -> String {
    match progress.settling {
        Some(Settling { residual, tolerance, steps }) => {
            let [residual, tolerance] = [residual, tolerance].map(|value| figure(value, 2));
            format!("settling: residual {residual}, ends at {tolerance}, {steps} steps")
        }
        None => format!("{}, {} steps", duration(progress.time), progress.steps),
    }
}

/// The pace of the last part of the runs: a step in contact may cost many times one of the flight before it.
#[derive(Default)]
struct RunPace {
    /// Wall times and the shares done then, the oldest first.
    marks: VecDeque<(Duration, f64)>,
}

/// Shortest time over which the pace is taken, and its share of the time so far.
const PACE_OVER: (Duration, f64) = (Duration::from_secs(3), 0.25);

impl RunPace {
    /// The remaining wall time (s) at `elapsed`, once enough is done for an estimate; the share done went from `before` to
    /// `share`.
    fn remaining(&mut self, elapsed: Duration, before: f64, share: f64) -> Option<f64> {
        let since = elapsed.saturating_sub(PACE_OVER.0.max(elapsed.mul_f64(PACE_OVER.1)));
        while self.marks.get(1).is_some_and(|(time, _)| *time <= since) {
            self.marks.pop_front();
        }
        let own = share - before;
        let enough = own >= 0.02 || (own > 0.0 && elapsed >= Duration::from_millis(500));
        let (from, done) =
            self.marks.front().copied().filter(|_| since > Duration::ZERO).unwrap_or((Duration::ZERO, before));
        self.marks.push_back((elapsed, share));
        (enough && share > done).then(|| (elapsed - from).as_secs_f64() * (1.0 - share) / (share - done))
    }
}

/// Time between two events.
const EVERY: Duration = Duration::from_millis(500);

/// One bar, or events, for the runs of a sweep.
pub(crate) struct SweepBar<'p> {
    bar: ProgressBar,
    events: bool,
    quiet: bool,
    total: usize,
    /// What counts the runs.
    page: &'p LivePage,
    state: Mutex<State>,
}

/// The runs that failed, and when the bar was last renewed.
struct State {
    /// Runs with an end: computed, taken from records or refused.
    ended: usize,
    failed: usize,
    refused: usize,
    reported: Instant,
}

impl<'p> SweepBar<'p> {
    /// Of a sweep of `total` runs that `page` counts.
    pub(crate) fn new(total: usize, page: &'p LivePage, shared: &Shared) -> SweepBar<'p> {
        let bar = bar(Some(total as u64), "{wide_bar} {pos}/{len}  {msg}", shared.quiet || shared.json);
        let state = State { ended: 0, failed: 0, refused: 0, reported: Instant::now() };
        SweepBar { bar, events: shared.json, quiet: shared.quiet, total, page, state: Mutex::new(state) }
    }

    /// Shows what became of a run.
    pub(crate) fn show(&self, event: &Event<'_>) {
        let mut state = base::lock(&self.state);
        state.ended += usize::from(!matches!(event, Event::Left(_)));
        match event {
            Event::Computed(_, evaluation) => state.failed += usize::from(evaluation.failure.is_some()),
            Event::Refused(_, cause) => {
                state.refused += 1;
                if state.refused == 1 && !self.quiet && !self.events {
                    print_above(&self.bar, &format!("warning: a run has no result: {cause}"));
                }
            }
            Event::Taken(..) | Event::Left(_) => {}
        }
        let (counts, pace) = self.page.runs();
        if state.reported.elapsed() >= EVERY || state.ended == self.total {
            state.reported = Instant::now();
            self.report(counts, pace, state.failed + state.refused);
        }
    }

    fn report(&self, counts: Counts, pace: Option<Pace>, failed: usize) {
        let done = counts.done + counts.failed;
        if self.events && !self.quiet {
            let event = json!({
                "event": "progress",
                "done": done,
                "of": self.total,
                "reused": counts.known,
                "failed": failed,
                "elapsed_s": self.page.elapsed(),
                "runs_per_s": pace.map(|pace| pace.rate),
                "to_go_s": pace.map(|pace| pace.to_go),
            });
            tell_event(&event);
        }
        self.bar.set_position(done as u64);
        let pace = pace.map(|Pace { rate, to_go }| format!("{} runs/s  {} to go", figure(rate, 2), wall_time(to_go)));
        let failed = if failed > 0 { format!("  {failed} failed") } else { String::new() };
        self.bar.set_message(pace.unwrap_or_default() + failed.as_str());
    }

    /// Removes the bar.
    pub(crate) fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

/// Wall time from which a forecast is printed, s.
const LONG: f64 = 60.0;

/// Wall time from which it says what is cheaper, s.
const COSTLY: f64 = 3600.0;

/// Wall time that is measured before the forecast: the first steps fill caches and curves.
const MEASURED: Duration = Duration::from_secs(1);

/// Wall time between two checkpoints that the forecast proposes, s.
const BETWEEN_CHECKPOINTS: f64 = 600.0;

/// Factor on a forecast from which a later one is printed too: film that unloads or tears may shorten the step by orders
/// of magnitude.
const LONGER: f64 = 10.0;

/// Measures a run second by second.
#[derive(Default)]
pub(crate) struct Forecast {
    /// Wall time and steps at the start of the present measurement.
    first: Option<(Duration, u64)>,
    /// Wall time from which the next forecast is printed, s; none before the first measurement.
    from: Option<f64>,
}

/// The rest of a run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Left {
    /// s.
    wall: f64,
    /// ns.
    per_element_step: f64,
    steps: f64,
    progress: Progress,
}

impl Forecast {
    /// The rest of a run that has taken `wall` so far, if it is long; given after the first second of stepping, and again
    /// where a later second shows that the run takes [`LONGER`] times as long. The time step is taken as constant;
    /// yielding film makes it longer.
    pub(crate) fn update(&mut self, progress: &Progress, wall: Duration) -> Option<Left> {
        // Equilibrium before the first step has another pace, and its end is not known.
        if progress.settling.is_some() {
            return None;
        }
        let (before, steps) = *self.first.get_or_insert((wall, progress.steps));
        if wall - before < MEASURED || progress.steps == steps {
            return None;
        }
        self.first = Some((wall, progress.steps));
        let per_step = (wall - before).as_secs_f64() / (progress.steps - steps) as f64;
        let steps = (progress.duration - progress.time).max(0.0) / progress.time_step;
        let per_element_step = 1e9 * per_step / progress.elements.max(1) as f64;
        let left = Left { wall: steps * per_step, per_element_step, steps, progress: *progress };
        // Strictly, or a run without an end would be told of every second.
        let is_longer = self.from.map_or(left.wall >= LONG, |from| left.wall > from);
        if is_longer || self.from.is_none() {
            // A run of less than a minute that is disturbed for a second is not long yet.
            self.from = Some(LONGER * left.wall.max(LONG));
        }
        is_longer.then_some(left)
    }
}

impl Left {
    /// The message of the terminal; `has_checkpoints` is whether the run writes checkpoints.
    pub(crate) fn message(&self, model: &Model, has_checkpoints: bool) -> String {
        let Left { wall, per_element_step, steps, progress } = self;
        let hints = if *wall < COSTLY { vec![] } else { self.cheaper(model, has_checkpoints) };
        let hints: String = hints.iter().map(|way| format!("\n  {way}")).collect();
        format!(
            "{} will take about {}: {} elements, {} steps of {} us to go, {per_element_step:.0} ns per element step{hints}",
            model.name,
            wall_time(*wall),
            grouped(progress.elements as u64),
            grouped(rounded(*steps, 2) as u64),
            number::figure(1e6 * progress.time_step, DIGITS),
        )
    }

    /// Ways to a shorter run, or to one that may be interrupted.
    fn cheaper(&self, model: &Model, has_checkpoints: bool) -> Vec<String> {
        let mut cheaper = vec![];
        // Mounted once more, which a run that takes so long does not notice.
        let engine = model.frame.springs.as_ref().and_then(|_| simulate::engine(model).ok());
        let springs = engine.as_ref().and_then(SpringStep::of_engine).filter(SpringStep::is_much_shorter);
        if let Some(springs) = springs {
            let free = number::figure(1e6 * springs.free, DIGITS);
            cheaper.push(format!("{} makes the step so short: without springs it is {free} us", SpringStep::KEY));
        } else if model.faces.iter().any(|face| face.meshing.grading.is_some()) {
            cheaper.push("a larger specimen.mesh.fine takes fewer elements and longer steps".to_owned());
        } else if !matches!(model.specimen.shape, Outline::Mesh { .. }) {
            cheaper.push("twice the specimen.mesh.size takes an eighth of the time".to_owned());
        }
        if model.specimen.symmetry == Symmetry::None {
            cheaper.push("specimen.symmetry, where the scene is symmetric, takes a half or a quarter".to_owned());
        }
        if !has_checkpoints {
            let every = rounded(self.progress.duration * BETWEEN_CHECKPOINTS / self.wall, 1);
            cheaper.push(format!("--checkpoint-every \"{}\" allows it to resume after an interruption", Time(every)));
        }
        cheaper
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use scene::model;
    use scene::scenario::{Assignment, Document};

    use super::*;

    #[test]
    fn the_remaining_time_waits_for_enough_progress() {
        let after =
            |millis, share| RunPace::default().remaining(Duration::from_millis(millis), 0.0, share).map(wall_time);
        assert_eq!(after(100, 0.0), None);
        assert_eq!(after(100, 0.01), None);
        assert_eq!(after(900, 0.0), None);
        assert_eq!(after(1000, 0.1).as_deref(), Some("9 s"));
        assert_eq!(after(60_000, 0.2).as_deref(), Some("4 min"));
    }

    #[test]
    fn film_that_settles_shows_its_residual() {
        let settling = Some(Settling { residual: 3.21e-4, tolerance: 1e-6, steps: 1200 });
        let progress = Progress { time: 0.0, duration: 0.1, steps: 0, time_step: 1e-6, elements: 100, settling };
        assert_eq!(state(&progress), "settling: residual 3.2e-4, ends at 1.0e-6, 1200 steps");
        let stepping = Progress { time: 2e-3, steps: 5, settling: None, ..progress };
        assert_eq!(state(&stepping), "2.0 ms, 5 steps");
    }

    #[test]
    fn the_remaining_time_of_a_resumed_run_counts_from_there() {
        let after =
            |millis, share| RunPace::default().remaining(Duration::from_millis(millis), 0.5, share).map(wall_time);
        assert_eq!(after(100, 0.501), None);
        assert_eq!(after(10_000, 0.75).as_deref(), Some("10 s"));
    }

    /// Half of a run in 10 s, then a tenth of that pace: 100 s to go, where the mean would give 10 s, then more and more.
    #[test]
    fn the_remaining_time_follows_a_pace_that_falls() {
        let mut pace = RunPace::default();
        let mut shown = Vec::new();
        for tenths in 1..1090_u32 {
            let time = 0.1 * f64::from(tenths);
            let share = if time < 10.0 { 0.05 * time } else { 0.5 + 0.005 * (time - 10.0) };
            shown.push(pace.remaining(Duration::from_millis(u64::from(tenths) * 100), 0.0, share));
        }
        for (tenths, expected) in [(50, 15.0), (200, 90.0), (800, 30.0), (1000, 10.0)] {
            let found: f64 = shown[tenths - 1].expect("a time");
            assert!((found - expected).abs() < 1e-6, "{found} s to go after {tenths} tenths of a second");
        }
        assert!(pace.marks.len() < 300, "the bar holds the last quarter alone");
    }

    /// A run of 0.1 s in steps of 1 us over 100 000 elements after so many steps.
    fn after(steps: u64) -> Progress {
        let time = 1e-6 * steps as f64;
        Progress { time, duration: 0.1, steps, time_step: 1e-6, elements: 100_000, settling: None }
    }

    #[test]
    fn a_long_run_is_forecast_once_after_a_second() {
        let mut forecast = Forecast::default();
        let mut update = |millis, steps| forecast.update(&after(steps), Duration::from_millis(millis));
        assert!(update(300, 10).is_none());
        assert!(update(1200, 15).is_none(), "not a second of stepping yet");
        let left = update(2300, 20).expect("100 000 steps of 0.2 s are long");
        assert!((left.wall - 0.2 * (100_000.0 - 20.0)).abs() < 1e-6 * left.wall, "{left:?}");
        assert!((left.per_element_step - 2000.0).abs() < 1e-9);
        assert!(update(9000, 30).is_none(), "there is one forecast");
    }

    #[test]
    fn a_run_whose_step_shrinks_is_forecast_again() {
        let mut forecast = Forecast::default();
        let mut update = |millis, progress: Progress| forecast.update(&progress, Duration::from_millis(millis));
        assert!(update(0, after(1)).is_none());
        assert!(update(1000, after(10_001)).is_none(), "nine seconds");
        let shrunk = |steps| Progress { time_step: 1e-11, ..after(steps) };
        let left = update(2000, shrunk(20_001)).expect("10 000 000 000 steps are long");
        assert!(left.wall > 1e5, "{left:?}");
        assert!(update(3000, shrunk(30_001)).is_none(), "there is one forecast for it");
    }

    #[test]
    fn springs_that_shorten_the_step_are_named_in_place_of_a_larger_mesh() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/trampoline/bed.toml");
        let bed = Document::read(&path).expect("a scenario");
        let message = |change: &str| {
            let changes = ["specimen.mesh.size=200mm", change];
            let changes = changes.map(|change| Assignment::from_argument(change).expect("a change"));
            let model = model::check(&bed.with(&changes)).expect("a model");
            Left { wall: 2.0 * COSTLY, per_element_step: 1.0, steps: 1.0, progress: after(1) }.message(&model, true)
        };
        let (springs, larger) = ("makes the step so short: without springs it is", "twice the specimen.mesh.size");
        for (change, shortens) in
            [("frame.springs.stiffness=1000 MN/m", true), ("frame.springs.stiffness=3 kN/m", false)]
        {
            let message = message(change);
            assert_eq!(message.contains(larger), !shortens, "{message}");
            assert_eq!(message.contains(&format!("frame.springs.stiffness {springs}")), shortens, "{message}");
        }
    }

    #[test]
    fn a_run_of_less_than_a_minute_has_no_forecast() {
        // 100 000 steps.
        for (steps_a_second, long) in [(1700, false), (1600, true)] {
            let mut forecast = Forecast::default();
            forecast.update(&after(1), Duration::from_millis(200));
            let left = forecast.update(&after(1 + steps_a_second), Duration::from_millis(1200));
            assert_eq!(left.is_some(), long, "{steps_a_second} steps a second: {left:?}");
        }
    }
}
