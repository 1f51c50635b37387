//! Signals in scripts: a series is one value, so that loops run in the host.

use rhai::{Array, Dynamic, Engine, EvalAltResult, INT, NativeCallContext};

use crate::script::{Compared, Entry, HostResult, Session, number, refuse, window};
use lab::signal::filter::{self, Standard};
use lab::signal::{Series, integrate, norm};

type Operator = fn(f64, f64) -> f64;

/// Offers the type `signal` and its functions to scripts.
pub(super) fn register(engine: &mut Engine) {
    engine.register_type_with_name::<Series>("signal");
    engine
        .register_fn("signal", build)
        .register_fn("len", |s: &mut Series| s.len() as INT)
        .register_fn("to_string", describe)
        .register_fn("max", |s: &mut Series| Ok::<_, Box<EvalAltResult>>(largest(s)?[1]))
        .register_fn("min", |s: &mut Series| Ok::<_, Box<EvalAltResult>>(smallest(s)?[1]))
        .register_fn("time_of_max", |s: &mut Series| Ok::<_, Box<EvalAltResult>>(largest(s)?[0]))
        .register_fn("time_of_min", |s: &mut Series| Ok::<_, Box<EvalAltResult>>(smallest(s)?[0]))
        .register_fn("start", |s: &mut Series| end_of(s.time().first()))
        .register_fn("end", |s: &mut Series| end_of(s.time().last()))
        .register_fn("at", value_at)
        .register_fn("slice", slice)
        .register_fn("mean", mean)
        .register_fn("integral", |s: &mut Series| integrate::total(s))
        .register_fn("integrated", |s: &mut Series, start: Dynamic| {
            Ok::<_, Box<EvalAltResult>>(integrate::once(s, number(&start, "the value at the start")?))
        })
        .register_fn("filtered", |s: &mut Series, class: Dynamic| filtered(s, &class, Standard::Iso6487))
        .register_fn("filtered_sae", |s: &mut Series, class: Dynamic| filtered(s, &class, Standard::SaeJ211))
        .register_fn("abs", |s: &mut Series| map(s, f64::abs))
        .register_fn("relative_error", relative_error)
        .register_fn("relative_residuals", relative_residuals);
    register_operators(engine);
}

fn register_operators(engine: &mut Engine) {
    engine.register_fn("-", |s: Series| map(&s, |v| -v));
    let operators: [(&str, Operator); 4] =
        [("+", |a, b| a + b), ("-", |a, b| a - b), ("*", |a, b| a * b), ("/", |a, b| a / b)];
    for (symbol, operator) in operators {
        engine.register_fn(symbol, move |a: Series, b: Series| pointwise(&a, &b, operator));
        engine.register_fn(symbol, move |a: Series, b: f64| map(&a, |v| operator(v, b)));
        engine.register_fn(symbol, move |a: Series, b: INT| map(&a, |v| operator(v, b as f64)));
        engine.register_fn(symbol, move |a: f64, b: Series| map(&b, |v| operator(a, v)));
        engine.register_fn(symbol, move |a: INT, b: Series| map(&b, |v| operator(a as f64, v)));
    }
}

fn build(time: Array, values: Array) -> HostResult<Series> {
    let numbers = |items: &Array, what| items.iter().map(|item| number(item, what)).collect::<HostResult<Vec<_>>>();
    let (time, values) = (numbers(&time, "a time")?, numbers(&values, "a value")?);
    if time.len() != values.len() {
        return Err(refuse(format!("{} times for {} values", time.len(), values.len())));
    }
    if !time.iter().all(|t| t.is_finite()) || !time.windows(2).all(|pair| pair[0] < pair[1]) {
        return Err(refuse("time does not increase"));
    }
    Ok(Series::new(time, values))
}

fn describe(s: &mut Series) -> String {
    match s.time() {
        [first, .., last] => format!("signal of {} samples from {first} s to {last} s", s.len()),
        _ => format!("signal of {} samples", s.len()),
    }
}

fn largest(s: &Series) -> HostResult<[f64; 2]> {
    s.largest().ok_or_else(nothing)
}

fn smallest(s: &Series) -> HostResult<[f64; 2]> {
    s.smallest().ok_or_else(nothing)
}

fn end_of(time: Option<&f64>) -> HostResult<f64> {
    time.copied().ok_or_else(nothing)
}

fn nothing() -> Box<EvalAltResult> {
    refuse("the signal has no samples")
}

fn value_at(s: &mut Series, time: Dynamic) -> HostResult<f64> {
    let time = number(&time, "a time")?;
    s.value_at(time).ok_or_else(|| refuse(format!("the signal has no value at {time} s")))
}

fn slice(s: &mut Series, from: Dynamic, to: Dynamic) -> HostResult<Series> {
    Ok(s.window([number(&from, "the start")?, number(&to, "the end")?]))
}

fn mean(s: &mut Series) -> HostResult<f64> {
    match s.time() {
        [] => Err(nothing()),
        [_] => Ok(s.values()[0]),
        [first, .., last] => Ok(integrate::total(s) / (last - first)),
    }
}

fn filtered(s: &Series, class: &Dynamic, standard: Standard) -> HostResult<Series> {
    filter::channel(s, number(class, "the channel frequency class")?, standard).map_err(refuse)
}

fn map(s: &Series, f: impl Fn(f64) -> f64) -> Series {
    s.with_values(s.values().iter().map(|v| f(*v)).collect())
}

/// `f` of `a` and of `b`, interpolated at the times of `a`.
fn pointwise(a: &Series, b: &Series, f: Operator) -> Series {
    let values = a.samples().map(|[time, value]| f(value, b.value_at(time).unwrap_or(f64::NAN)));
    a.with_values(values.collect())
}

fn relative_error(context: NativeCallContext, signal: Series, reference: Series, bounds: Dynamic) -> HostResult<f64> {
    let window = window(&bounds)?;
    let error = norm::relative_error(&signal, &reference, window).map_err(refuse)?;
    Session::from_context(&context).add_comparison(|| Compared::signals(&signal, &reference, window));
    Ok(error)
}

fn relative_residuals(
    context: NativeCallContext,
    signal: Series,
    reference: Series,
    bounds: Dynamic,
) -> HostResult<Series> {
    let window = window(&bounds)?;
    let residuals = norm::relative_residuals(&signal, &reference, window).map_err(refuse)?;
    Session::from_context(&context).add_comparison(|| Compared::signals(&signal, &reference, window));
    Ok(residuals)
}

/// The reference of the functions of signals.
pub const ENTRIES: &[Entry] = &[
    Entry {
        call: "signal(times, values)",
        gives: "a signal from two lists; times in s, increasing",
        example: "signal([0, 1, 2], [5, 6.5, 8]).len() == 3",
    },
    Entry { call: "signal.len()", gives: "the number of samples", example: "signal([0, 1], [5, 6]).len() == 2" },
    Entry {
        call: "signal.max(), signal.min()",
        gives: "the largest and the smallest measured value",
        example: "let s = signal([0, 1, 2], [5, 9, 7]); s.max() == 9.0 && s.min() == 5.0",
    },
    Entry {
        call: "signal.time_of_max(), signal.time_of_min()",
        gives: "the time of its first occurrence, s",
        example: "let s = signal([0, 1, 2], [5, 9, 7]); s.time_of_max() == 1.0 && s.time_of_min() == 0.0",
    },
    Entry {
        call: "signal.start(), signal.end()",
        gives: "the times of the first and the last sample, s",
        example: "let s = signal([2, 3], [0, 0]); s.start() == 2.0 && s.end() == 3.0",
    },
    Entry {
        call: "signal.at(t)",
        gives: "the value at time t (s), linear between samples",
        example: "let s = signal([0, 1], [5, 6]); s.at(0.5) == 5.5 && s.at(1) == 6.0",
    },
    Entry {
        call: "signal.slice(from, to)",
        gives: "the samples with from <= time <= to (s)",
        example: "signal([0, 1, 2, 3], [5, 6, 7, 8]).slice(1, 2.5).len() == 2",
    },
    Entry {
        call: "signal.mean()",
        gives: "the mean over time (trapezoidal rule)",
        example: "signal([0, 1, 3], [0, 2, 2]).mean() == 5.0 / 3.0",
    },
    Entry {
        call: "signal.integral()",
        gives: "the integral over time (trapezoidal rule)",
        example: "signal([0, 1, 3], [0, 2, 2]).integral() == 5.0",
    },
    Entry {
        call: "signal.integrated(start)",
        gives: "the cumulative integral as a signal that begins at start",
        example: "signal([0, 1, 3], [0, 2, 2]).integrated(-1).at(3) == 4.0",
    },
    Entry {
        call: "signal.filtered(class)",
        gives: "the signal through the channel filter of that class (ISO 6487); its steps must be equal",
        example: "let s = signal([0, 0.0001, 0.0002], [2, 2, 2]).filtered(1000); (s.at(0.0001) - 2).abs() < 1e-9",
    },
    Entry {
        call: "signal.filtered_sae(class)",
        gives: "the same with the constant of SAE J211-1",
        example: "let s = signal([0, 0.0001, 0.0002], [2, 2, 2]).filtered_sae(600.0); (s.at(0) - 2).abs() < 1e-9",
    },
    Entry { call: "signal.abs()", gives: "the magnitudes", example: "signal([0, 1], [-5, 3]).abs().max() == 5.0" },
    Entry {
        call: "signal + signal, signal * number, -signal, …",
        gives: "+ − * / of signals and numbers; a second signal is interpolated at the times of the first",
        example: "let s = signal([0, 1], [5, 6]); (2 * s - s / 0.5 + 1).max() == 1.0 && (-(s - s)).min() == 0.0",
    },
    Entry {
        call: "relative_error(signal, reference, [from, to])",
        gives: "the norm of the difference over the norm of the reference, at its samples in the window (equations 14, 15)",
        example: "let r = signal([0, 1, 2], [1, 1, 1]); let e = relative_error(1.1 * r, r, [0, 2.0]); (e - 0.1).abs() < 1e-12",
    },
    Entry {
        call: "relative_residuals(signal, reference, [from, to])",
        gives: "the differences whose norm is `relative_error`, as a signal",
        example: "let r = signal([0, 1, 2], [1, 1, 1]); let d = relative_residuals(1.1 * r, r, [0, 2]); (d * d).integral() < 0.01",
    },
];
