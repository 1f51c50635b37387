//! `confidence`.

use rhai::{Array, Dynamic, Engine, FnPtr, Map, NativeCallContext};

use crate::identify::bindings::minimize::{self, ScriptSearch, unknown_option};
use crate::identify::bindings::{SearchEvent, SearchHost, integer};
use crate::identify::evaluator::linearize_at_start;
use crate::identify::objective::refused;
use crate::script::{HostResult, findings_map, list, number, numbers, one_or_several, refuse, unknown, word};
use base::finding::Finding;
use lab::confidence::{Colour, Confidence, ConfidenceOptions, Misfit};
use plot::Correlation;

/// Options beside those of `minimize`.
const OPTIONS: [&str; 6] = ["noise", "relative", "parts", "misfit", "prior", "held"];

/// Options of an assumed misfit.
const MISFIT: [&str; 3] = ["error", "correlation", "interval"];

const COLOURS: [(&str, Colour); 2] = [("coloured", Colour::Coloured), ("white", Colour::White)];

/// The arguments of `confidence`.
struct Request {
    /// A search that starts at the estimate.
    search: ScriptSearch,
    options: ConfidenceOptions,
    /// Numbers of residuals of the parts that the residuals are joined from; none for one part.
    parts: Option<Vec<usize>>,
}

impl Request {
    fn new(best: &Dynamic, options: &Map, call: FnPtr) -> HostResult<Request> {
        let known = || minimize::OPTIONS.into_iter().chain(OPTIONS);
        if let Some(other) = options.keys().find(|option| !known().any(|known| known == option.as_str())) {
            return Err(unknown_option("confidence", other, known()));
        }
        let (own, others): (Map, Map) =
            options.clone().into_iter().partition(|(option, _)| OPTIONS.contains(&option.as_str()));
        let search = ScriptSearch::new("levenberg-marquardt", &estimate(best)?, &others, call)?;
        search.search.check().map_err(refuse)?;
        let options = ConfidenceOptions::new(search.search.names.clone());
        let unknowns = options.names.len();
        let mut request = Request { search, options, parts: None };
        for (option, value) in &own {
            match option.as_str() {
                "noise" => request.options.colour = word(option, &value.to_string(), &COLOURS)?,
                "relative" => {
                    let boolean = value.as_bool();
                    request.options.relative =
                        boolean.map_err(|found| refuse!("`relative` is true or false, not {found}"))?;
                }
                "parts" => request.parts = Some(parts(value)?),
                "misfit" if own.contains_key("noise") => {
                    return Err(refuse(
                        "`noise` has no effect beside `misfit`, which says what the noise is: leave one out",
                    ));
                }
                "misfit" => request.options.misfit = Some(misfits(value)?),
                "prior" => request.options.prior = deviations(option, value, unknowns)?,
                _ => request.options.held = deviations(option, value, unknowns)?,
            }
        }
        let ConfidenceOptions { prior, held, .. } = &request.options;
        if prior.iter().zip(held).any(|(prior, held)| prior.is_some() && held.is_some()) {
            return Err(refuse(
                "a parameter has a `prior` where it is fitted and is `held` where it is not: leave one out",
            ));
        }
        if !held.is_empty() && held.iter().all(Option::is_some) {
            return Err(refuse("all parameters are `held`: one at least must be fitted, ()"));
        }
        Ok(request)
    }
}

fn parts(value: &Dynamic) -> HostResult<Vec<usize>> {
    let wrong = || refuse!("`parts` is a list of lengths, such as [400, 400], not {value}");
    let list = value.read_lock::<Array>().map(|list| list.clone()).ok_or_else(wrong)?;
    let length = |item: &Dynamic| item.as_int().ok().and_then(|length| usize::try_from(length).ok());
    list.iter().map(|item| length(item).filter(|length| *length > 0).ok_or_else(wrong)).collect()
}

/// The assumed errors of the parts: one for all, or a list of the option that differs.
fn misfits(value: &Dynamic) -> HostResult<Vec<Misfit>> {
    let kind = || refuse!("`misfit` is a map, such as #{{ error: 0.03, correlation: 20 }}, not {}", value.type_name());
    let map = value.read_lock::<Map>().map(|map| map.clone()).ok_or_else(kind)?;
    if let Some(other) = map.keys().find(|option| !MISFIT.contains(&option.as_str())) {
        return Err(unknown("option of `misfit`", other, MISFIT));
    }
    let values = |name: &str, otherwise: Option<f64>, fits: fn(f64) -> bool, range: &str| {
        let values = match (map.get(name), otherwise) {
            (None, Some(otherwise)) => vec![otherwise],
            (None, None) => {
                return Err(refuse!("`misfit` has no `{name}`, the norm of the error of the residuals"));
            }
            (Some(value), _) => numbers(&one_or_several(value), name)?,
        };
        match values.iter().find(|value| !(value.is_finite() && fits(**value))) {
            Some(found) => Err(refuse!("`{name}` of `misfit` is {found}, which must be {range}")),
            None => Ok(values),
        }
    };
    let errors = values("error", None, |error| error > 0.0, "above zero")?;
    let correlations = values("correlation", Some(0.0), |length| length >= 0.0, "zero or more")?;
    let intervals = values("interval", Some(1.0), |interval| interval > 0.0, "above zero")?;
    let lists = [&errors, &correlations, &intervals];
    let count = lists.iter().map(|list| list.len()).max().unwrap_or(1);
    if lists.iter().any(|list| ![1, count].contains(&list.len())) {
        return Err(refuse(
            "the lists of `misfit` have different lengths: expected one entry for each part of the residuals",
        ));
    }
    let of = |list: &[f64], part: usize| list[part % list.len()];
    let misfit =
        |part: usize| Misfit { error: of(&errors, part), correlation: of(&correlations, part) / of(&intervals, part) };
    Ok((0..count).map(misfit).collect())
}

/// Standard deviations of parameters; `()` for those without one.
fn deviations(option: &str, value: &Dynamic, unknowns: usize) -> HostResult<Vec<Option<f64>>> {
    let wrong = || {
        refuse!(
            "`{option}` is a list of standard deviations, () for parameters without one, such as [(), 0.1], not {value}"
        )
    };
    let list = value.read_lock::<Array>().map(|list| list.clone()).ok_or_else(wrong)?;
    if list.len() != unknowns {
        return Err(refuse!("`{option}` has {} entries for {unknowns} unknowns", list.len()));
    }
    let deviation = |item: &Dynamic| match item.is_unit() {
        true => Ok(None),
        false => match number(item, option)? {
            deviation if deviation.is_finite() && deviation > 0.0 => Ok(Some(deviation)),
            found => Err(refuse!("a standard deviation of `{option}` is {found}, which must be above zero")),
        },
    };
    list.iter().map(deviation).collect()
}

/// The point of a result of `minimize` or `confidence`, or a list.
fn estimate(best: &Dynamic) -> HostResult<Array> {
    let found = match best.read_lock::<Map>() {
        Some(map) => map.get("x").cloned().unwrap_or_default(),
        None => best.clone(),
    };
    let wrong = || format!("an estimate is what `minimize` gave, or a list x, not {}", best.type_name());
    let list = found.read_lock::<Array>().map(|list| list.clone());
    list.ok_or_else(|| refuse(wrong()))
}

fn confidence(host: &SearchHost, context: &NativeCallContext, request: &Request) -> HostResult<Map> {
    let confidence = host.linearized(context, &request.search, |evaluator| {
        let linearization = linearize_at_start(&request.search.search, evaluator)?;
        let linearization = match &request.parts {
            Some(parts) => linearization.joined_from(parts).map_err(|error| refused!("{error}"))?,
            None => linearization,
        };
        Confidence::from_linearization(&linearization, &request.options).map_err(|error| refused!("{error}"))
    })?;
    let title = match &request.search.labels.title {
        Some(title) => format!("Correlation: {title}"),
        None => "Correlation".into(),
    };
    (host.observer)(SearchEvent::Correlation(&plotted(&confidence, title)));
    Ok(of_confidence(&confidence))
}

/// Confidence intervals.
fn of_confidence(confidence: &Confidence) -> Map {
    let names = &confidence.names;
    let count = names.len();
    let matrix = |entry: &dyn Fn(usize, usize) -> f64| -> Array {
        (0..count).map(|row| (0..count).map(|column| entry(row, column).into()).collect::<Array>().into()).collect()
    };
    let side = |side: usize| list(&confidence.intervals.iter().map(|ends| ends[side]).collect::<Vec<_>>());
    let mut map = Map::new();
    map.insert("names".into(), names.iter().map(|name| name.clone().into()).collect::<Array>().into());
    map.insert("x".into(), list(&confidence.x).into());
    map.insert("standard_errors".into(), list(&confidence.standard_errors).into());
    map.insert("lower".into(), side(0).into());
    map.insert("upper".into(), side(1).into());
    map.insert("covariance".into(), matrix(&|row, column| confidence.covariance[(row, column)]).into());
    map.insert("correlation".into(), matrix(&|row, column| confidence.correlation[(row, column)]).into());
    map.insert("samples".into(), integer(confidence.samples));
    map.insert("effective_samples".into(), confidence.effective_samples.into());
    map.insert("degrees_of_freedom".into(), confidence.freedom.into());
    map.insert("condition".into(), confidence.condition.into());
    map.extend(findings_map(&confidence.warnings.iter().map(Finding::new).collect::<Vec<_>>()));
    let rows = (0..count).map(|index| confidence_row(confidence, index).into());
    map.insert("table".into(), rows.collect::<Array>().into());
    let correlations = (0..count).map(|index| correlation_row(confidence, index).into());
    map.insert("correlation_table".into(), correlations.collect::<Array>().into());
    let shifts = confidence.shifts.iter().map(|(held, shifts)| {
        let names = names.iter().map(String::as_str);
        Dynamic::from(named(held, names.zip(shifts.iter().copied())))
    });
    map.insert("shift_table".into(), shifts.collect::<Array>().into());
    map
}

fn confidence_row(confidence: &Confidence, index: usize) -> Map {
    let [lower, upper] = confidence.intervals[index];
    let figures = [
        ("value", confidence.x[index]),
        ("standard_error", confidence.standard_errors[index]),
        ("lower_95", lower),
        ("upper_95", upper),
    ];
    named(&confidence.names[index], figures)
}

fn correlation_row(confidence: &Confidence, index: usize) -> Map {
    let names = confidence.names.iter().enumerate();
    let pairs = names.map(|(other, name)| (name.as_str(), confidence.correlation[(index, other)]));
    named(&confidence.names[index], pairs)
}

fn named<'n>(name: &str, figures: impl IntoIterator<Item = (&'n str, f64)>) -> Map {
    let figures = figures.into_iter().map(|(name, value)| (name.into(), value.into()));
    std::iter::once(("parameter".into(), name.to_owned().into())).chain(figures).collect()
}

fn plotted(confidence: &Confidence, title: String) -> Correlation {
    let correlation = &confidence.correlation;
    let rows = correlation.row_iter().map(|row| row.iter().copied().collect()).collect();
    Correlation { title, names: confidence.names.clone(), rows }
}

/// Registers `confidence`.
pub(super) fn register(engine: &mut Engine, host: &SearchHost) {
    let own = host.clone();
    let with = move |context: NativeCallContext, best: Dynamic, options: Map, call: FnPtr| {
        confidence(&own, &context, &Request::new(&best, &options, call)?)
    };
    engine.register_fn("confidence", with);
    let own = host.clone();
    let without = move |context: NativeCallContext, best: Dynamic, call: FnPtr| {
        confidence(&own, &context, &Request::new(&best, &Map::new(), call)?)
    };
    engine.register_fn("confidence", without);
}

#[cfg(test)]
mod tests {
    use super::super::test_engine;
    use super::*;
    use crate::script::Limits;

    /// t(7) √(Σ y²/7/8), of Student's tables 2.3646.
    #[test]
    fn joined_signals_have_the_noise_of_each_part() {
        let script = r#"
        let quiet = [0.1, -0.2, 0.1, 0.2, -0.1, -0.1, 0.1, -0.1];
        let loud = [3.0, 4.0, -1.0, -4.0, -3.0, -1.0, 1.0, 1.0];
        let means = |x| quiet.map(|y| x[0] - y) + loud.map(|y| x[1] - y);
        let apart = confidence([0.0, 0.0], #{ noise: "white", parts: [8, 8] }, means);
        apart.upper + confidence([0.0, 0.0], #{ noise: "white" }, means).upper
    "#;
        let found = test_engine(Limits::STUDY).eval::<Array>(script).unwrap();
        let found: Vec<f64> = found.iter().map(|end| end.as_float().unwrap()).collect();
        for (end, squares) in found.iter().zip([0.14_f64, 54.0]) {
            assert!((end / (2.3646 * (squares / 56.0).sqrt()) - 1.0).abs() < 1e-4, "{found:?}");
        }
        assert!(found[2] > 5.0 * found[0], "{found:?}");
    }
}
