//! Signals in scripts, measures of them, random numbers and thresholds.

use std::sync::{Arc, Mutex};

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal, StandardUniform};
use rhai::{Array, Dynamic, Engine, EvalAltResult, FnPtr, INT, NativeCallContext};
use serde_json::json;

use crate::script::{self, Compared, HostResult, Session, number, numbers, refuse, shown, window};
use lab::signal::clip::{self, Counting};
use lab::signal::filter::{self, Standard};
use lab::signal::{Series, hic, integrate, norm, rating, resample};

type Operator = fn(f64, f64) -> f64;

/// Offers the types `signal` and `random`, their functions and `threshold` to scripts.
pub(crate) fn register(engine: &mut Engine) {
    engine.register_type_with_name::<Series>("signal");
    engine
        .register_fn("signal", build)
        .register_fn("len", |s: &mut Series| s.len() as INT)
        .register_fn("to_string", describe)
        .register_fn("max", |s: &mut Series| there(s.largest().map(|[_, value]| value)))
        .register_fn("min", |s: &mut Series| there(s.smallest().map(|[_, value]| value)))
        .register_fn("time_of_max", |s: &mut Series| there(s.largest().map(|[time, _]| time)))
        .register_fn("time_of_min", |s: &mut Series| there(s.smallest().map(|[time, _]| time)))
        .register_fn("start", |s: &mut Series| there(s.time().first().copied()))
        .register_fn("end", |s: &mut Series| there(s.time().last().copied()))
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
        .register_fn("relative_residuals", relative_residuals)
        .register_fn("hic", |s: &mut Series, window: Dynamic| {
            let found = hic::head_injury_criterion(s, seconds(&window, "the window")?);
            found.map(|hic| hic.value).map_err(refuse)
        })
        .register_fn("hic_d", hic_d)
        .register_fn("clip", |s: &mut Series, duration: Dynamic| clip(s, &duration, Counting::Cumulative))
        .register_fn("clip_contiguous", |s: &mut Series, duration: Dynamic| clip(s, &duration, Counting::Contiguous))
        .register_fn("rate", rate)
        .register_fn("resampled", resampled)
        .register_fn("shifted", shifted)
        .register_fn("time", |s: &mut Series| Series::new(s.time().to_vec(), s.time().to_vec()))
        .register_fn("times", |context: NativeCallContext, s: &mut Series| list(&context, s.time()))
        .register_fn("values", |context: NativeCallContext, s: &mut Series| list(&context, s.values()))
        .register_type_with_name::<Stream>("random")
        // By its bits, so that a negative number is a seed too.
        .register_fn("random", |seed: INT| Stream::new(ChaCha8Rng::seed_from_u64(seed.cast_unsigned()).into()))
        .register_fn("uniform", |stream: &mut Stream| -> f64 { StandardUniform.sample(&mut *base::lock(stream)) })
        .register_fn("normal", |stream: &mut Stream| -> f64 { StandardNormal.sample(&mut *base::lock(stream)) })
        .register_fn("normals", normals)
        .register_fn("threshold", threshold);
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
    let (time, values) = (numbers(&time, "a time")?, numbers(&values, "a value")?);
    if time.len() != values.len() {
        return Err(refuse!("{} times for {} values", time.len(), values.len()));
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

/// What a signal without samples does not have.
fn there(found: Option<f64>) -> HostResult<f64> {
    found.ok_or_else(|| refuse("the signal has no samples"))
}

fn value_at(s: &mut Series, time: Dynamic) -> HostResult<f64> {
    let time = number(&time, "a time")?;
    s.value_at(time).ok_or_else(|| refuse!("the signal has no value at {time} s"))
}

fn slice(s: &mut Series, from: Dynamic, to: Dynamic) -> HostResult<Series> {
    Ok(s.window([number(&from, "the start")?, number(&to, "the end")?]))
}

fn mean(s: &mut Series) -> HostResult<f64> {
    there(match s.time() {
        [] => None,
        [_] => Some(s.values()[0]),
        [first, .., last] => Some(integrate::total(s) / (last - first)),
    })
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

/// Most samples of a resampled signal.
const MOST_SAMPLES: f64 = 1e6;

fn hic_d(s: &mut Series) -> HostResult<f64> {
    hic::head_injury_criterion(s, hic::LONG_WINDOW).map(|hic| hic::dummy_equivalent(hic.value)).map_err(refuse)
}

fn seconds(milliseconds: &Dynamic, what: &str) -> HostResult<f64> {
    Ok(1e-3 * number(milliseconds, what)?)
}

fn clip(s: &Series, duration: &Dynamic, counting: Counting) -> HostResult<f64> {
    let found = clip::clip(s, seconds(duration, "the duration")?, counting);
    found.map(|clip| clip.level).map_err(refuse)
}

fn rate(context: NativeCallContext, reference: Series, comparison: Series) -> HostResult<Dynamic> {
    let rating = rating::rate(&reference, &comparison).map_err(refuse)?;
    let all = [f64::NEG_INFINITY, f64::INFINITY];
    Session::from_context(&context).add_comparison(|| Compared::signals(&comparison, &reference, all));
    let notes: Vec<String> = rating.warnings.iter().map(ToString::to_string).collect();
    Ok(shown(&json!({
        "corridor": rating.corridor, "phase": rating.phase, "magnitude": rating.magnitude, "slope": rating.slope,
        "overall": rating.overall, "grade": rating.grade.to_string(), "shift": rating.shift, "samples": rating.samples,
        "notes": notes,
    })))
}

fn resampled(s: &mut Series, step: Dynamic) -> HostResult<Series> {
    let step = number(&step, "the time step")?;
    if let [first, .., last] = s.time()
        && step > 0.0
        && (last - first) / step >= MOST_SAMPLES
    {
        return Err(refuse!("a time step of {step} s gives more than a million samples"));
    }
    resample::uniform(s, step).map_err(refuse)
}

fn shifted(s: &mut Series, by: Dynamic) -> HostResult<Series> {
    let by = number(&by, "the time shift")?;
    let times: Vec<f64> = s.time().iter().map(|time| time + by).collect();
    let apart = times.windows(2).all(|pair| pair[0] < pair[1]) && times.iter().all(|time| time.is_finite());
    if apart { Ok(Series::new(times, s.values())) } else { Err(refuse!("times cannot be shifted by {by} s")) }
}

/// The numbers as a list within the limit of lists.
fn list(context: &NativeCallContext, numbers: &[f64]) -> HostResult<Array> {
    let (count, most) = (numbers.len(), context.engine().max_array_size());
    if count > most {
        return Err(refuse!("the signal has {count} samples, a list holds {most}: take a slice or resample it"));
    }
    Ok(script::list(numbers))
}

/// Most numbers that are drawn at once, the limit of lists.
const MOST: INT = 10_000;

/// A stream of random numbers. Shared, since functions of scripts get copies of what they are given: each draws the next numbers
/// of the same stream.
type Stream = Arc<Mutex<ChaCha8Rng>>;

fn normals(stream: &mut Stream, count: INT) -> Result<Array, Box<EvalAltResult>> {
    if !(0..=MOST).contains(&count) {
        return Err(refuse!("expected a count of 0 to {MOST} random numbers, found {count}"));
    }
    let mut stream = base::lock(stream);
    let draw = |_| -> f64 { StandardNormal.sample(&mut *stream) };
    Ok((0..count).map(draw).map(Dynamic::from).collect())
}

/// Most halvings: the bits of a number.
const MOST_HALVINGS: u32 = 64;

/// The two ends, the one nearer to `from` first, of an interval no longer than `tolerance` between `from` and `to` over
/// which the condition changes, by bisection.
///
/// # Errors
/// The condition is the same at `from` and `to`, or is no Boolean.
fn threshold(
    context: NativeCallContext,
    from: Dynamic,
    to: Dynamic,
    tolerance: Dynamic,
    condition: FnPtr,
) -> HostResult<rhai::Array> {
    let [mut near, mut far] = [number(&from, "the first end")?, number(&to, "the second end")?];
    let tolerance = number(&tolerance, "the tolerance")?;
    if !(near.is_finite() && far.is_finite() && tolerance > 0.0) {
        return Err(refuse("a threshold needs two finite ends and a tolerance above zero"));
    }
    let holds = |x: f64| -> HostResult<bool> {
        let found: Dynamic = condition.call_within_context(&context, (x,))?;
        found.as_bool().map_err(|kind| refuse!("the condition gives true or false, not {kind}"))
    };
    let at_near = holds(near)?;
    if holds(far)? == at_near {
        return Err(refuse!("the condition is {at_near} at {near} and at {far}: there is no threshold to find"));
    }
    // Not until the tolerance is met: it may be less than the distance between two numbers of this size.
    for _ in 0..MOST_HALVINGS {
        if (far - near).abs() <= tolerance {
            break;
        }
        let middle = 0.5 * (near + far);
        if holds(middle)? == at_near {
            near = middle;
        } else {
            far = middle;
        }
    }
    Ok(vec![near.into(), far.into()])
}

#[cfg(test)]
mod tests {
    use crate::functions::tests::engine;

    #[test]
    fn a_condition_may_fall_and_the_ends_may_be_in_either_order() {
        let falls = "let t = threshold(8, 0, 0.01, |x| x < 3.3); t[0] > t[1] && t[0] >= 3.3 && t[1] < 3.3 && t[0] - t[1] <= 0.01";
        assert_eq!(engine().eval::<bool>(falls).ok(), Some(true));
    }
}
