//! One of several processes that compute a study together: its part, its end.

use std::time::{Duration, Instant};

use clap::Args;

use super::Failure;
use base::cancellation::Cancellation;
use base::diagnostic::{Diagnostic, Source, Span};
use base::periodic;
use base::units::Time;
use study::evaluate::Evaluations;
use study::store::evaluations::Share;

/// Time between two looks at the clock.
const TICK: Duration = Duration::from_millis(100);

/// Part of the runs that one of several processes takes, and when it stops.
#[derive(Debug, Args)]
pub(super) struct ShardArgs {
    /// Take this part of the runs first, then what no other process has begun: 3/16
    #[arg(long, value_name = "K/N")]
    pub shard: Option<String>,
    /// Stop before this wall time is over ("50min"); what is done stays
    #[arg(long, value_name = "TIME")]
    pub stop_after: Option<String>,
}

impl ShardArgs {
    /// Whether the process must end in good order.
    pub(super) fn is_given(&self) -> bool {
        self.shard.is_some() || self.stop_after.is_some()
    }

    /// The part of the runs.
    pub(super) fn share(&self) -> Result<Share, Vec<Diagnostic>> {
        let Some(text) = &self.shard else { return Ok(Share::WHOLE) };
        Share::parse(text).ok_or_else(|| {
            let mistake = Diagnostic::new(format!("expected a part of the runs, found \"{text}\""));
            vec![mistake.hint("the third of sixteen processes is --shard 3/16")]
        })
    }

    /// Latest time at which a run may end.
    pub(super) fn deadline(&self, begin: Instant) -> Result<Option<Instant>, Vec<Diagnostic>> {
        let Some(text) = &self.stop_after else { return Ok(None) };
        let source = Source::unfiled("--stop-after", text.clone());
        let mistake = |message: String, hint: String| {
            vec![Diagnostic::new(message).at(&Span::new(&source, 0..text.len())).hint(hint)]
        };
        let seconds = Time::DIMENSION.parse(text).map_err(|error| mistake(error.to_string(), error.hint()))?;
        let limit = Duration::try_from_secs_f64(seconds).ok().and_then(|limit| begin.checked_add(limit));
        match limit {
            Some(limit) if seconds > 0.0 => Ok(Some(limit)),
            _ => Err(mistake(format!("no run ends within {text}"), "write it like \"50 min\"".into())),
        }
    }
}

/// Cancels the runs of this process on SIGTERM, SIGINT and SIGHUP.
pub(super) fn cancel_on_termination(cancellation: &Cancellation) -> Result<(), Failure> {
    let cancellation = cancellation.clone();
    let handled = ctrlc::set_handler(move || cancellation.cancel());
    handled.map_err(|error| Failure::output(Diagnostic::new(format!("cannot handle signals: {error}"))))
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
