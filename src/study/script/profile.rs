//! Which lines of a script and its modules run, how often, and how long they take.

use std::collections::{BTreeMap, HashMap};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, ThreadId};
use std::time::{Duration, Instant};

use rhai::debugger::{DebuggerCommand, DebuggerEvent};
use rhai::{Engine, EvalContext};
use serde::Serialize;

use super::Session;
use super::module::SourceText;

/// Calls and time of one line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct LineUse {
    /// How often it was reached.
    pub calls: u64,
    /// Time in it, host functions included and lines of functions that it calls excluded, s. Where it begins work on other
    /// threads, their lines have their own time besides.
    pub time_s: f64,
}

/// A line of a script or a module.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Line {
    /// The file; of a shipped module its name in angle brackets.
    pub file: String,
    /// Counted from one.
    pub number: usize,
}

/// Called with each line that is reached and the text in which it is.
type OnLine = Box<dyn Fn(&Line, &SourceText) + Send + Sync>;

/// Watches the lines of a script. Cheap to clone.
#[derive(Clone, Default)]
pub struct Profile(Arc<Mutex<State>>);

#[derive(Default)]
struct State {
    lines: BTreeMap<Line, LineUse>,
    /// The line that each thread is in, and since when: an objective runs on several.
    at: HashMap<ThreadId, (Line, Instant)>,
}

impl Profile {
    /// Watches all scripts of the engine from now on; `on_line` is told each line that is reached.
    pub fn watch(engine: &mut Engine, on_line: OnLine) -> Profile {
        let profile = Profile::default();
        let watched = profile.clone();
        // Marked as deprecated only because it may change; the tests cover it.
        #[allow(deprecated)]
        engine.register_debugger(
            |_, debugger| debugger,
            move |context, event, node, source, position| {
                // The end of a call is also told at the place of the call.
                if matches!(event, DebuggerEvent::Start | DebuggerEvent::Step)
                    && let Some(number) = position.line()
                    && let Some(text) = text_of(&context, source)
                    && let line = (Line { file: text.id(), number })
                    && watched.reach(&line, node.is_stmt())
                {
                    on_line(&line, &text);
                }
                Ok(DebuggerCommand::StepInto)
            },
        );
        profile
    }

    /// Notes that this thread is in a line; whether it was reached anew.
    fn reach(&self, line: &Line, is_statement: bool) -> bool {
        let now = Instant::now();
        let mut state = self.state();
        let before = state.at.insert(thread::current().id(), (line.clone(), now));
        let is_new = is_statement || before.as_ref().is_none_or(|(last, _)| last != line);
        if let Some((last, since)) = before {
            state.add(last, now - since);
        }
        if is_new {
            state.lines.entry(line.clone()).or_default().calls += 1;
        }
        is_new
    }

    /// The lines that were reached, once the script has ended. Where a thread ended is not known, but the script itself
    /// waits for all of them: the line that began them has that time.
    pub fn lines(&self) -> BTreeMap<Line, LineUse> {
        let mut state = self.state();
        let now = Instant::now();
        let first = state.at.values().min_by_key(|(_, since)| *since).cloned();
        if let Some((line, since)) = first {
            state.add(line, now - since);
        }
        state.at.clear();
        state.lines.clone()
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The text in which the interpreter is.
fn text_of(context: &EvalContext, source: Option<&str>) -> Option<SourceText> {
    let session = context.tag().read_lock::<Session>().map(|session| session.clone())?;
    let calls = context.global_runtime_state().debugger().call_stack();
    session.programs().source(source, calls.last().map(|call| call.fn_name.as_str()))
}

impl State {
    fn add(&mut self, line: Line, time: Duration) {
        self.lines.entry(line).or_default().time_s += time.as_secs_f64();
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;
    use std::sync::atomic::{AtomicUsize, Ordering};

    use rhai::Scope;

    use super::*;
    use crate::script::{Limits, Script, engine};

    #[test]
    fn lines_are_counted_and_timed() {
        let mut engine = engine(Limits::STUDY);
        engine.register_fn("wait", |milliseconds: i64| thread::sleep(Duration::from_millis(milliseconds as u64)));
        let told = Arc::new(AtomicUsize::new(0));
        let heard = Arc::clone(&told);
        let profile = Profile::watch(&mut engine, Box::new(move |_, _| _ = heard.fetch_add(1, Ordering::Relaxed)));
        let text = "fn slow(x) {\n    wait(x);\n    x\n}\nlet sum = 0;\nfor x in 0..5 {\n    sum += slow(2 * x);\n}\n\
                    if sum > 100 {\n    wait(1);\n}\nwait(30);\n";
        let script = Script::compile(&engine, &Scope::new(), Path::new("s.rhai"), text).unwrap();
        script.run(&engine, Scope::new()).unwrap();
        let lines = profile.lines();
        assert!(lines.keys().all(|line| line.file == "s.rhai"));
        let lines: BTreeMap<usize, LineUse> = lines.into_iter().map(|(line, used)| (line.number, used)).collect();
        assert_eq!((lines[&2].calls, lines[&7].calls, lines[&5].calls), (5, 5, 1), "{lines:?}");
        assert!(!lines.contains_key(&10), "a line that is not reached");
        assert!(lines[&2].time_s >= 0.02 && lines[&12].time_s >= 0.03, "{lines:?}");
        assert!(lines[&7].time_s < lines[&2].time_s, "what a function takes is on its own lines: {lines:?}");
        assert_eq!(told.load(Ordering::Relaxed) as u64, lines.values().map(|line| line.calls).sum::<u64>());
    }
}
