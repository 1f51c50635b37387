//! A batch of runs, those of a sweep, a script or a study, computed alone or with other processes: its records, its part, its end.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::Args;

use crate::failure::ExitStatus;
use crate::folder::ResultArgs;
use crate::live_page::LivePage;
use crate::{Failure, args};
use base::cancellation::Cancellation;
use base::diagnostic::Diagnostic;
use base::periodic;
use study::evaluate::Evaluations;
use study::store;
use study::store::evaluations::Share;

/// Time between two looks at the clock.
const TICK: Duration = Duration::from_millis(100);

/// Where records and results of many runs go, the part of them that one of several processes takes, and when it stops.
#[derive(Clone, Debug, Args)]
pub(super) struct BatchArgs {
    #[command(flatten)]
    pub results: ResultArgs,
    /// Take this part of the runs first, then what no other process has begun: 3/16
    #[arg(long, value_name = "K/N")]
    pub shard: Option<String>,
    /// Stop before this wall time is over ("50min"); what is done stays
    #[arg(long, value_name = "TIME")]
    pub stop_after: Option<String>,
    /// Folder of the evaluations that are never computed twice
    #[arg(long, value_name = "DIR", default_value = store::EVALUATIONS)]
    pub store: PathBuf,
}

impl BatchArgs {
    /// The records of the runs, of which this process takes `share` and `page` shows the progress.
    pub(super) fn evaluations(&self, share: Share, page: &LivePage) -> Evaluations {
        let page = page.clone();
        Evaluations::new(&self.store).with_share(share).with_observer(move |event| page.note_run(&event))
    }

    /// The part of the runs.
    pub(super) fn share(&self) -> Result<Share, Failure> {
        let Some(text) = &self.shard else { return Ok(Share::WHOLE) };
        Share::parse(text).ok_or_else(|| {
            let mistake = Diagnostic::new(format!("expected a part of the runs, found \"{text}\""));
            mistake.hint("the third of sixteen processes is --shard 3/16").into()
        })
    }

    /// Latest time at which a run may end.
    pub(super) fn deadline(&self, begin: Instant) -> Result<Option<Instant>, Failure> {
        let Some(text) = &self.stop_after else { return Ok(None) };
        let seconds = args::time("--stop-after", text)?;
        let limit = Duration::try_from_secs_f64(seconds).ok().and_then(|limit| begin.checked_add(limit));
        match limit {
            Some(limit) if seconds > 0.0 => Ok(Some(limit)),
            _ => {
                let mistake = args::in_option("--stop-after", text, format!("no run ends within {text}"));
                Err(mistake.hint("write it like \"50 min\"").into())
            }
        }
    }
}

/// What signals of the operating system end.
pub(super) struct Ends {
    /// Nothing begins any more, and what has begun ends.
    pub stop: Cancellation,
    /// What has begun is given up, too.
    pub given_up: Cancellation,
}

impl Ends {
    /// Takes a signal: Ctrl-C stops, and a second one gives up; any other signal gives up at once. Whether the program must
    /// end here, since it was given up before.
    fn take(&self, is_interrupt: bool) -> bool {
        let is_second = self.stop.is_cancelled();
        let is_late = self.given_up.is_cancelled();
        self.stop.cancel();
        if is_second || !is_interrupt {
            self.given_up.cancel();
        }
        is_late
    }

    /// Whether it was stopped or given up.
    pub(super) fn is_over(&self) -> bool {
        self.stop.is_cancelled() || self.given_up.is_cancelled()
    }
}

/// Handles signals from now on. `told` is called once what has begun is to end.
pub(super) fn end_on_signals(ends: Ends, told: impl Fn() + Send + 'static) -> Result<(), Failure> {
    on_signals(true, move |is_interrupt| {
        let was_over = ends.is_over();
        if ends.take(is_interrupt) {
            std::process::exit(ExitStatus::OutputFailed as i32);
        }
        if !was_over && !ends.given_up.is_cancelled() {
            told();
        }
    })
}

/// Cancels `work` at the first Ctrl-C from now on; a second one ends the program.
pub(super) fn cancel_on_interrupt(work: Cancellation) -> Result<(), Failure> {
    on_signals(false, move |_| {
        if work.is_cancelled() {
            std::process::exit(ExitStatus::OutputFailed as i32);
        }
        work.cancel();
    })
}

/// Calls `handle` at each Ctrl-C from now on, and with `others` at each other signal that would end the program; it is told
/// whether it is Ctrl-C.
#[cfg(unix)]
fn on_signals(others: bool, handle: impl Fn(bool) + Send + 'static) -> Result<(), Failure> {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    let all = [SIGINT, SIGTERM, SIGHUP];
    let found = signal_hook::iterator::Signals::new(if others { &all[..] } else { &all[..1] });
    let mut found = found.map_err(|error| unhandled(&error))?;
    let watch = move || found.forever().for_each(|signal| handle(signal == SIGINT));
    let started = std::thread::Builder::new().name("signals".into()).spawn(watch);
    started.map(drop).map_err(|error| unhandled(&error))
}

/// Calls `handle` at each Ctrl-C from now on, which is the only signal here.
#[cfg(not(unix))]
fn on_signals(_: bool, handle: impl Fn(bool) + Send + 'static) -> Result<(), Failure> {
    ctrlc::set_handler(move || handle(true)).map_err(|error| unhandled(&error))
}

fn unhandled(error: &impl std::fmt::Display) -> Failure {
    Failure::output(Diagnostic::new(format!("cannot handle signals: {error}")))
}

/// Runs `work` while other processes are shown that this one is at work; cancels it at the deadline.
pub(super) fn watched<T>(
    evaluations: &Evaluations,
    cancellation: &Cancellation,
    deadline: Option<Instant>,
    work: impl FnOnce() -> T,
) -> T {
    let watch = || {
        if deadline.is_some_and(|deadline| Instant::now() >= deadline) {
            cancellation.cancel();
        }
        // What cannot be written shows in the next record.
        let _ = evaluations.store().keep_alive();
    };
    periodic::during(TICK, watch, work)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_first_interrupt_lets_what_has_begun_end() {
        let ends = Ends { stop: Cancellation::default(), given_up: Cancellation::default() };
        assert!(!ends.is_over());
        assert!(!ends.take(true) && ends.is_over() && !ends.given_up.is_cancelled());
        assert!(!ends.take(true) && ends.given_up.is_cancelled());
        assert!(ends.take(true), "a third one ends the program");
    }

    #[test]
    fn termination_gives_up_at_once() {
        let ends = Ends { stop: Cancellation::default(), given_up: Cancellation::default() };
        assert!(!ends.take(false) && ends.stop.is_cancelled() && ends.given_up.is_cancelled());
    }
}
