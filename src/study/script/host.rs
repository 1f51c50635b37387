//! The interpreter with its limits, within which untrusted scripts are safe to run.

use std::panic::resume_unwind;
use std::path::Path;
use std::thread;
use std::time::{Duration, Instant};

use rhai::packages::{
    ArithmeticPackage, BasicArrayPackage, BasicFnPackage, BasicIteratorPackage, BasicMapPackage, BasicMathPackage,
    BasicStringPackage, LogicPackage, MoreStringPackage, Package,
};
use rhai::{Dynamic, Engine, OptimizationLevel, Scope, Token, TokenizeState};

use super::fault::TooLarge;
use super::module::{self, Finder, LONGEST_SCRIPT, Resolver, SourceText, Unit};
use super::{Fault, Session, checks, fault, session};
use crate::Error;
use base::cancellation::Cancellation;
use base::file::{self, FileError};

/// Stack of a thread that interprets scripts, bytes; the system commits only the used part.
pub const STACK: usize = 256 << 20;

/// Limits of a script.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Steps of the interpreter.
    pub operations: u64,
    /// Bytes of the signals, curves, scenarios and runs that it holds. The lists, maps and strings of a variable have
    /// limits of their own.
    pub bytes: usize,
    /// Wall time, host functions included.
    pub time: Duration,
}

impl Limits {
    /// For a post script, which reads one finished run.
    pub const POST: Limits = Limits { operations: 1_000_000, bytes: 256 << 20, time: Duration::from_secs(60) };
    /// For a script that simulates; its host functions may take hours, a loop of its own some seconds.
    pub const STUDY: Limits =
        Limits { operations: 50_000_000, bytes: 512 << 20, time: Duration::from_secs(7 * 24 * 3600) };
}

/// Most values of a list or a map, those of lists within it included: the table of a sweep of thousands of runs is one.
const MOST_VALUES: usize = 500_000;

/// Why a script cannot be read or compiled.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The file cannot be read, or is too long.
    #[error(transparent)]
    Refused(#[from] Error),
    /// It does not compile, or calls undefined functions.
    #[error("{}", .0.iter().map(Fault::to_string).collect::<Vec<_>>().join("; "))]
    Faults(Vec<Fault>),
}

/// An interpreter with the basic packages within `limits`: no `eval`, no modules in files, no files, no clock, no sleep.
pub fn engine(limits: Limits) -> Engine {
    let mut engine = Engine::new_raw();
    register_packages(&mut engine);
    free_reserved_words(&mut engine);
    engine
        .disable_symbol("eval")
        // Curried arguments do not count towards the limits of data and could double with every step.
        .disable_symbol("curry")
        .disable_symbol("export")
        .set_strict_variables(true)
        // Constant folding would turn a missing key of a constant map into ().
        .set_optimization_level(OptimizationLevel::None)
        .set_fail_on_invalid_map_property(true)
        // A script imports fewer; each text that imports a module counts.
        .set_max_modules(1000)
        .set_max_operations(limits.operations)
        .set_max_call_levels(48)
        .set_max_expr_depths(64, 32)
        .set_max_variables(1000)
        .set_max_functions(500)
        .set_max_string_size(100_000)
        .set_max_array_size(MOST_VALUES)
        .set_max_map_size(MOST_VALUES);
    let session = Session::default();
    engine.set_module_resolver(Resolver(session.programs().clone()));
    engine.set_default_tag(Dynamic::from(session));
    stop_beyond(&mut engine, limits, &Cancellation::default());
    super::fault::register(&mut engine);
    super::values::register_sort(&mut engine);
    engine
}

/// Ends what `engine` runs when the time of `limits` has passed from now on, when it holds more bytes, or once
/// `cancellation` says so.
pub fn stop_beyond(engine: &mut Engine, limits: Limits, cancellation: &Cancellation) {
    let (start, cancellation) = (Instant::now(), cancellation.clone());
    let budget = Session::of_engine(engine).budget().clone();
    engine.on_progress(move |operations| {
        if cancellation.is_cancelled() {
            return Some(session::STOPPED.into());
        }
        if budget.held() > limits.bytes {
            return Some(Dynamic::from(TooLarge::new(limits.bytes)));
        }
        // The clock costs more than an operation of the interpreter.
        let late = operations % 256 == 0 && start.elapsed() > limits.time;
        late.then(|| format!("the script took longer than {} s", limits.time.as_secs()).into())
    });
}

/// Frees `with`, which the language reserves, for `scenario.with(…)`.
fn free_reserved_words(engine: &mut Engine) {
    let free = |token, _, _: &TokenizeState| match token {
        Token::Reserved(word) if *word == "with" => Token::Identifier(word),
        other => other,
    };
    // Deprecated only because it may change; the tests cover it.
    #[allow(deprecated)]
    engine.on_parse_token(free);
}

/// `LanguageCore` is left out for its `sleep`, `BasicTime` for its clock.
fn register_packages(engine: &mut Engine) {
    ArithmeticPackage::new().register_into_engine(engine);
    LogicPackage::new().register_into_engine(engine);
    BasicStringPackage::new().register_into_engine(engine);
    BasicIteratorPackage::new().register_into_engine(engine);
    BasicFnPackage::new().register_into_engine(engine);
    BasicMathPackage::new().register_into_engine(engine);
    BasicArrayPackage::new().register_into_engine(engine);
    BasicMapPackage::new().register_into_engine(engine);
    MoreStringPackage::new().register_into_engine(engine);
}

/// A script that was read and compiled, with the modules that it imports.
#[derive(Clone, Debug)]
pub struct Script {
    /// The script, then each module.
    units: Vec<Unit>,
}

impl Script {
    /// Reads and compiles the script at `path`, which may use the constants in `scope`.
    ///
    /// # Errors
    /// The file cannot be read, is too long, or does not compile.
    pub fn read(engine: &Engine, scope: &Scope, path: &Path) -> Result<Script, ReadError> {
        let shown = path.display();
        let text = file::read_text(path, LONGEST_SCRIPT).map_err(|error| match error {
            FileError::TooLarge { .. } => Error::new(format!("{shown} is longer than {LONGEST_SCRIPT} bytes")),
            error => Error::new(format!("cannot read {shown}: {error}")).with_hint_if(error.hint()),
        })?;
        Script::compile(engine, scope, path, &text).map_err(ReadError::Faults)
    }

    /// Compiles `text`; faults name `path` as its file, and its modules are found beside that.
    ///
    /// # Errors
    /// The first syntax error of the script and of each module and what makes modules unusable, or else every call of an
    /// undefined function and every access to an unknown field.
    pub fn compile(engine: &Engine, scope: &Scope, path: &Path, text: &str) -> Result<Script, Vec<Fault>> {
        let source = SourceText::new(path, text);
        let compiled = engine.compile_with_scope(scope, text);
        let program = compiled.map_err(|error| vec![Fault::parsing(&source, &error)])?;
        let session = Session::of_engine(engine);
        let (shipped, reads_files) = session.modules();
        let finder = Finder { script: path.into(), shipped, reads_files };
        let units = module::load(engine, &finder, source, program)?;
        let faults = checks::faults(engine, &units);
        if faults.is_empty() { Ok(Script { units }) } else { Err(faults) }
    }

    /// The identity of the script: its text and those of its modules.
    pub fn whole_text(&self) -> String {
        let module = |(name, source): (&str, &SourceText)| format!("\n// module {name}\n{}", source.text);
        std::iter::once(self.text().to_owned()).chain(self.modules().map(module)).collect()
    }

    /// The source text.
    pub fn text(&self) -> &str {
        &self.units[0].source.text
    }

    /// The modules by their names, each with its text, in the order in which they are imported.
    pub fn modules(&self) -> impl Iterator<Item = (&str, &SourceText)> {
        self.units[1..].iter().map(|unit| (unit.name.as_str(), &unit.source))
    }

    /// Whether the script may read `args.<name>`: it or a module reads a property of that name, has the name as a text, or
    /// reads all arguments.
    pub fn mentions_argument(&self, name: &str) -> bool {
        self.units.iter().any(|unit| fault::mentions(&unit.program, name))
    }

    /// Whether the script or a module reads `args.numbers("<name>", …)` or `args.text("<name>", …)`.
    pub fn reads_list_or_text(&self, name: &str) -> bool {
        self.units.iter().any(|unit| fault::reads_with(&unit.program, &["numbers", "text"], name))
    }

    /// Runs the script with the constants in `scope` and drops its variables and last value.
    ///
    /// # Errors
    /// The script throws, exceeds a limit, or a host function fails.
    pub fn run(&self, engine: &Engine, mut scope: Scope<'static>) -> Result<(), Fault> {
        // Nested values take as deep a stack to be dropped.
        self.on_stack(move || self.value(engine, &mut scope).map(drop))
    }

    /// Runs the script with the variables in `scope`, to which it adds its own; its last value. Whoever drops them needs a
    /// [`STACK`] for nested ones.
    ///
    /// # Errors
    /// As of [`Script::run`].
    pub fn evaluate(&self, engine: &Engine, scope: &mut Scope<'static>) -> Result<Dynamic, Fault> {
        self.on_stack(|| self.value(engine, scope))
    }

    fn value(&self, engine: &Engine, scope: &mut Scope<'static>) -> Result<Dynamic, Fault> {
        let session = Session::of_engine(engine);
        session.programs().install(&self.units);
        // What it makes counts, and a panic is a fault at the call of the host that was last.
        let work = || engine.eval_ast_with_scope(scope, &self.units[0].program);
        let caught = || session::catch(session.cancellation(), || session.last_call(), work);
        session.budget().count(caught).map_err(|error| Fault::running(engine, &self.units, &error))
    }

    /// The interpreter recurses into nested values, so its stack is large enough for the deepest nesting within the
    /// limits.
    fn on_stack<T: Send>(&self, work: impl FnOnce() -> Result<T, Fault> + Send) -> Result<T, Fault> {
        thread::scope(|threads| {
            let interpreter = thread::Builder::new().name("script".into());
            let interpreter = interpreter.stack_size(STACK).spawn_scoped(threads, work);
            let interpreter = interpreter.map_err(|error| Fault::starting(&self.units[0].source, &error))?;
            interpreter.join().unwrap_or_else(|panic| resume_unwind(panic))
        })
    }
}

#[cfg(test)]
mod tests {
    use rhai::NativeCallContext;

    use super::*;

    fn run(text: &str) -> Result<(), Fault> {
        run_within(30_000, text)
    }

    fn run_within(operations: u64, text: &str) -> Result<(), Fault> {
        let (engine, scope) = (engine(Limits { operations, ..Limits::STUDY }), Scope::new());
        let script = Script::compile(&engine, &scope, Path::new("s.rhai"), text);
        script.map_err(|mut faults| faults.remove(0))?.run(&engine, scope)
    }

    #[test]
    fn faults_name_file_line_and_column() {
        for (text, expected) in [
            ("let a = 1;\nlet b = a +;", "s.rhai:2:12: "),
            ("let a = 1;\n  nosuch + 1", "s.rhai:2:3: undefined variable: nosuch"),
            ("fn f(x) {\n x.sqrt(2)\n}\nf(1)", "s.rhai:2:4: `sqrt` does not take (whole number, whole number)"),
            ("let a = [1];\na[7]", "s.rhai:2:3: array index 7 out of bounds"),
            ("throw \"enough\"", "s.rhai:1:1: enough"),
            ("let a = 0;\nloop { a += 1; }", "s.rhai:2:10: the script takes more than 30000 steps of the interpreter"),
            ("let m = #{};\nm.nosuch", "s.rhai:2:3: "),
        ] {
            let fault = run(text).unwrap_err().to_string();
            assert!(fault.starts_with(expected), "{text:?} gave: {fault}");
        }
    }

    #[test]
    fn hostile_scripts_are_stopped() {
        for text in [
            "loop {}",
            "fn f() { f() } f()",
            "let s = \"x\"; loop { s += s; }",
            "let a = [1]; loop { a += a; }",
            "let m = #{}; let i = 0; loop { m[\"k\" + i] = i; i += 1; }",
            "eval(\"1\")",
            "import \"os\" as os;",
            "sleep(1)",
            "timestamp()",
            "let a = []; loop { a = [a]; }",
            "let m = #{}; loop { m = #{ m: m, a: [m] }; }",
            "let f = Fn(\"f\"); loop { f = f.curry(f); }",
            "let f = Fn(\"f\"); loop { f = curry(f, f); }",
            "let f = || 1; loop { let g = f; f = || g.call(); }",
            "fn f(x) { x.map(|y| f([y])) } f([1])",
        ] {
            // Values in values cost the square of the steps.
            assert!(run_within(10_000, text).is_err(), "{text:?} was not stopped");
        }
    }

    #[test]
    fn lists_are_sorted_and_those_without_an_order_are_refused() {
        for (text, expected) in [
            ("let a = [2, 1.5, -3]; a.sort(); a", "[-3, 1.5, 2]"),
            ("let a = [9007199254740993, 9007199254740992]; a.sort(); a", "[9007199254740992, 9007199254740993]"),
            ("let a = [\"b\", \"a\"]; a.sort_desc(); a", "[\"b\", \"a\"]"),
            ("let a = [true, false]; a.sort(); a", "[false, true]"),
        ] {
            run(&format!("let found = {{ {text} }}; if `${{found}}` != {expected:?} {{ throw `${{found}}` }}"))
                .unwrap();
        }
        let random = "let a = []; let x = 1; for i in 0..200 { x = (x * 7919) % 10007; a.push(x); }";
        for (text, expected) in [
            ("let a = [1.0, 0.0 / 0.0];\na.sort()", "s.rhai:2:3: a list with NaN has no order"),
            ("[1, \"a\"].sort()", "s.rhai:1:10: a list is sorted where"),
            (
                &format!(
                    "{random}\na.sort(|a, b| {{ x = (x * 75 + 74) % 65537; if x % 2 == 0 {{ 1 }} else {{ -1 }} }})"
                ),
                "s.rhai:2:3: error in comparer",
            ),
        ] {
            let fault = run(text).unwrap_err().to_string();
            assert!(fault.starts_with(expected), "{text:?} gave: {fault}");
        }
    }

    #[test]
    fn a_panic_is_an_error_of_the_script() {
        let mut engine = engine(Limits::POST);
        engine.register_fn("fails", |context: NativeCallContext| -> i64 {
            Session::from_context(&context);
            panic!("no such case")
        });
        let script =
            Script::compile(&engine, &Scope::new(), Path::new("s.rhai"), "let a = 1;\nlet b = fails();").unwrap();
        let fault = script.run(&engine, Scope::new()).unwrap_err().to_string();
        assert!(fault.starts_with("s.rhai:2:9: ") && fault.ends_with("no such case"), "{fault}");
    }

    #[test]
    fn what_a_script_holds_is_bounded() {
        let engine = crate::functions::engine(Limits::POST);
        let signal = "let s = signal([0.0, 1.0], [10.0, 2.0]).resampled(1.1e-6); let a = [];\n";
        let curve = "let e = []; for i in 0..9000 { e.push(i * 0.1); } let c = curve(e, e); let a = [];\n";
        for (made, kept, dropped) in
            [(signal, "a.push(s * i)", "s * i"), (curve, "a.push(c.slice(0, 880 + i * 1e-4))", "c.slice(0, 880)")]
        {
            let run = |each: &str| {
                let text = format!("{made}for i in 0..9000 {{ {each}; }}");
                let script = Script::compile(&engine, &Scope::new(), Path::new("s.rhai"), &text).unwrap();
                script.run(&engine, Scope::new())
            };
            let fault = run(kept).unwrap_err();
            assert!(fault.to_string().starts_with("s.rhai:2:"), "{fault}");
            assert!(fault.message.contains("take more than 256 MiB") && !fault.may_pass, "{fault}");
            // What is not kept does not count.
            if made == curve {
                run(dropped).unwrap();
            }
        }
    }

    #[test]
    fn a_script_is_stopped_at_its_time_limit() {
        let engine = engine(Limits { operations: 0, time: Duration::from_millis(30), ..Limits::POST });
        let script = Script::compile(&engine, &Scope::new(), Path::new("s.rhai"), "loop {}").unwrap();
        let fault = script.run(&engine, Scope::new()).unwrap_err();
        assert_eq!((fault.message.as_str(), fault.may_pass), ("the script took longer than 0 s", true));
        assert!(!run("throw 1").unwrap_err().may_pass);
    }

    #[test]
    fn what_can_be_cancelled_keeps_its_time_limit() {
        for (time, is_cancelled, expected) in
            [(30, false, "the script took longer than 0 s"), (3_600_000, true, "stopped")]
        {
            let (mut engine, cancellation) =
                (engine(Limits { operations: 0, ..Limits::STUDY }), Cancellation::default());
            let limits = Limits { operations: 0, time: Duration::from_millis(time), ..Limits::STUDY };
            stop_beyond(&mut engine, limits, &cancellation);
            if is_cancelled {
                cancellation.cancel();
            }
            let script = Script::compile(&engine, &Scope::new(), Path::new("s.rhai"), "loop {}").unwrap();
            assert_eq!(script.run(&engine, Scope::new()).unwrap_err().message, expected);
        }
    }
}
