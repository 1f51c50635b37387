//! `confidence` and `profiles`.

use rhai::{Array, Dynamic, Engine, FnPtr, INT, Map, NativeCallContext};

use super::host::SearchHost;
use super::options::{self, ScriptSearch, count, unknown, word};
use super::result;
use crate::identify::confidence::profile::ProfileError;
use crate::identify::confidence::refinement::{ProfileOptions, linearization};
use crate::script::{Entry, HostResult, number, refuse};
use lab::confidence::Confidence;
use lab::confidence::ConfidenceOptions;
use lab::confidence::{Colour, Misfit};
use plot::Correlation;

/// Options beside those of `minimize`.
const OPTIONS: [&str; 7] = ["noise", "relative", "points", "parts", "misfit", "prior", "held"];

/// Options of an assumed misfit.
const MISFIT: [&str; 3] = ["error", "correlation", "interval"];

const COLOURS: [(&str, Colour); 2] = [("coloured", Colour::Coloured), ("white", Colour::White)];

/// Default and largest number of points of a profile on each side of the estimate.
const POINTS: usize = 3;
const MAX_POINTS: INT = 20;

/// The arguments of `confidence` or `profiles`.
struct Request {
    /// A search that starts at the estimate.
    search: ScriptSearch,
    options: ProfileOptions,
    /// The result of `minimize`; none where the estimate is a list.
    best: Map,
}

impl Request {
    fn new(best: &Dynamic, options: &Map, call: FnPtr) -> HostResult<Request> {
        let known = || options::OPTIONS.into_iter().chain(OPTIONS);
        if let Some(other) = options.keys().find(|option| !known().any(|known| known == option.as_str())) {
            return Err(unknown("option", other, known()));
        }
        let (own, others): (Map, Map) =
            options.clone().into_iter().partition(|(option, _)| OPTIONS.contains(&option.as_str()));
        let search = ScriptSearch::new("levenberg-marquardt", &estimate(best)?, &others, call)?;
        search.search.check().map_err(refuse)?;
        let confidence = ConfidenceOptions::new(search.search.names.clone());
        let options = ProfileOptions { confidence, points: POINTS, parts: None };
        let best = best.read_lock::<Map>().map(|map| map.clone()).unwrap_or_default();
        let unknowns = options.confidence.names.len();
        let mut request = Request { search, options, best };
        for (option, value) in &own {
            match option.as_str() {
                "noise" => request.options.confidence.colour = word(option, &value.to_string(), &COLOURS)?,
                "relative" => {
                    let boolean = value.as_bool();
                    request.options.confidence.relative =
                        boolean.map_err(|found| refuse(format!("`relative` is true or false, not {found}")))?;
                }
                "parts" => request.options.parts = Some(parts(value)?),
                "misfit" if own.contains_key("noise") => {
                    return Err(refuse(
                        "`noise` has no effect beside `misfit`, which says what the noise is: leave one out",
                    ));
                }
                "misfit" => request.options.confidence.misfit = Some(misfits(value)?),
                "prior" => request.options.confidence.prior = deviations(option, value, unknowns)?,
                "held" => request.options.confidence.held = deviations(option, value, unknowns)?,
                _ => request.options.points = count(value, "points", MAX_POINTS)?,
            }
        }
        let ConfidenceOptions { prior, held, .. } = &request.options.confidence;
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
    let wrong = || refuse(format!("`parts` is a list of lengths, such as [400, 400], not {value}"));
    let list = value.read_lock::<Array>().map(|list| list.clone()).ok_or_else(wrong)?;
    let length = |item: &Dynamic| item.as_int().ok().and_then(|length| usize::try_from(length).ok());
    list.iter().map(|item| length(item).filter(|length| *length > 0).ok_or_else(wrong)).collect()
}

/// The assumed errors of the parts: one for all, or a list of the option that differs.
fn misfits(value: &Dynamic) -> HostResult<Vec<Misfit>> {
    let kind =
        || refuse(format!("`misfit` is a map, such as #{{ error: 0.03, correlation: 20 }}, not {}", value.type_name()));
    let map = value.read_lock::<Map>().map(|map| map.clone()).ok_or_else(kind)?;
    if let Some(other) = map.keys().find(|option| !MISFIT.contains(&option.as_str())) {
        return Err(unknown("option of `misfit`", other, MISFIT));
    }
    let values = |name: &str, otherwise: Option<f64>, fits: fn(f64) -> bool, range: &str| {
        let values = match (map.get(name), otherwise) {
            (None, Some(otherwise)) => vec![otherwise],
            (None, None) => {
                return Err(refuse(format!("`misfit` has no `{name}`, the norm of the error of the residuals")));
            }
            (Some(value), _) => match value.read_lock::<Array>() {
                Some(list) => list.iter().map(|item| number(item, name)).collect::<HostResult<Vec<f64>>>()?,
                None => vec![number(value, name)?],
            },
        };
        match values.iter().find(|value| !(value.is_finite() && fits(**value))) {
            Some(found) => Err(refuse(format!("`{name}` of `misfit` is {found}, which must be {range}"))),
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
        refuse(format!(
            "`{option}` is a list of standard deviations, () for parameters without one, such as [(), 0.1], not {value}"
        ))
    };
    let list = value.read_lock::<Array>().map(|list| list.clone()).ok_or_else(wrong)?;
    if list.len() != unknowns {
        return Err(refuse(format!("`{option}` has {} entries for {unknowns} unknowns", list.len())));
    }
    let deviation = |item: &Dynamic| match item.is_unit() {
        true => Ok(None),
        false => match number(item, option)? {
            deviation if deviation.is_finite() && deviation > 0.0 => Ok(Some(deviation)),
            found => Err(refuse(format!("a standard deviation of `{option}` is {found}, which must be above zero"))),
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
    let confidences =
        host.script_run::<_, ProfileError>(context, std::slice::from_ref(&request.search), |evaluator, _| {
            let linearization = linearization(&request.search.search, &request.options, evaluator)?;
            Ok(Confidence::from_linearization(&linearization, &request.options.confidence)?)
        })?;
    let confidence = first(confidences)?;
    let title = match &request.search.labels.title {
        Some(title) => format!("Correlation: {title}"),
        None => "Correlation".into(),
    };
    host.report_correlation(&plotted(&confidence, title));
    Ok(result::of_confidence(&confidence))
}

fn profiles(host: &SearchHost, context: &NativeCallContext, request: &Request) -> HostResult<Map> {
    let Request { search, options, best } = request;
    if !options.confidence.prior.is_empty() || !options.confidence.held.is_empty() {
        return Err(refuse(
            "`prior` and `held` are options of `confidence`: for profiles, add (x - expected) / deviation to the residuals",
        ));
    }
    let refinement = host.profiles(context, search, options)?;
    let mut map = result::of_profiles(&refinement.profiles, &search.search.names);
    map.insert("best".into(), result::of_refinement(&refinement, best, &search.search).into());
    Ok(map)
}

fn plotted(confidence: &Confidence, title: String) -> Correlation {
    let correlation = &confidence.correlation;
    let rows = correlation.row_iter().map(|row| row.iter().copied().collect()).collect();
    Correlation { title, names: confidence.names.clone(), rows }
}

fn first<T>(results: Vec<T>) -> HostResult<T> {
    results.into_iter().next().ok_or_else(|| refuse("the search has no result"))
}

/// Registers `confidence` and `profiles`.
pub(super) fn register(engine: &mut Engine, host: &SearchHost) {
    type Function = fn(&SearchHost, &NativeCallContext, &Request) -> HostResult<Map>;
    let functions: [(&str, Function); 2] = [("confidence", confidence), ("profiles", profiles)];
    for (name, function) in functions {
        let own = host.clone();
        let with = move |context: NativeCallContext, best: Dynamic, options: Map, call: FnPtr| {
            function(&own, &context, &Request::new(&best, &options, call)?)
        };
        engine.register_fn(name, with);
        let own = host.clone();
        let without = move |context: NativeCallContext, best: Dynamic, call: FnPtr| {
            function(&own, &context, &Request::new(&best, &Map::new(), call)?)
        };
        engine.register_fn(name, without);
    }
}

/// The reference of `confidence` and `profiles`.
pub(super) const ENTRIES: &[Entry] = &[
    Entry {
        call: "confidence(best, options, |x| residuals)",
        gives: "confidence intervals of the parameters that `minimize` found (or a list x), from the Jacobian of the \
            residuals: #{ names, x, standard_errors, lower, upper, covariance, correlation, samples, \
            effective_samples, degrees_of_freedom, condition, warnings, findings, table, correlation_table }; \
            intervals of 95 %. Residuals may be correlated along the list. `warnings` name combinations that are not \
            identifiable. Takes the options of `minimize`, of which names, bounds, difference and the rules for \
            failed trials have an effect",
        example: r#"let read = [3.1, 4.9, 7.0, 9.2, 10.9, 13.1];
                    let line = |x| read.map(|y, i| x[0] + x[1] * i - y);
                    let o = #{ names: ["offset", "slope"] };
                    let best = minimize("levenberg-marquardt", [1.0, 1], o, line);
                    let c = confidence(best, o, line);
                    c.lower[1] < 2 && c.upper[1] > 2
                        && c.table[1].parameter == "slope" && c.table[1].value == best.x[1]"#,
    },
    Entry {
        call: "profiles(best, options, |x| residuals)",
        gives: "the objective along each parameter, all others fitted again: #{ table, intervals, lower, upper, \
            warnings, findings, best }; `table` has parameter, value, f and all parameters, `intervals` the ends of \
            95 %, () where the objective does not rise enough, and why in the columns lower_note and upper_note. Two \
            or three trials for each value. A profile that finds a lower value than the estimate continues the search \
            from there, three times at most, and the profiles are those about its result; `best` is what `minimize` \
            gave, or the result of the continued search",
        example: r#"let read = [3.0, 2.2, 1.5, 1.2, 0.8, 0.6, 0.4, 0.3];
                    let decay = |x| read.map(|y, i| x[0] * exp(-x[1] * i) - y);
                    let best = minimize("levenberg-marquardt", [2.0, 0.2], decay);
                    let p = profiles(best, #{ relative: true }, decay);
                    p.table.len() == 14 && p.lower[1] < best.x[1] && p.upper[1] > best.x[1] && p.best.x == best.x"#,
    },
    Entry {
        call: "#{ noise: \"coloured\" | \"white\", relative: false, points: 3, parts: [n1, n2, …] }",
        gives: "further options of `confidence` and `profiles`: whether neighbouring residuals may be correlated; \
            intervals symmetric in the logarithm, for multipliers; points of a profile on each side; lengths of the \
            lists that the residuals are joined from, such as several signals (their sum is the number of residuals; \
            one list otherwise): each part then has noise of its own size and correlation",
        example: r#"let c = confidence([2.0], #{ noise: "white", relative: true }, |x| [x[0] - 1.9, x[0] - 2.1]);
                    let joined = |x| [x[0] - 1.9, x[0] - 2.1] + [x[1] - 1.0, x[1] - 5.0];
                    let d = confidence([2.0, 3.0], #{ noise: "white", parts: [2, 2] }, joined);
                    (c.lower[0] * c.upper[0] - 4).abs() < 1e-9 && (c.standard_errors[0] - 0.1).abs() < 1e-9
                        && (d.standard_errors[0] - 0.1).abs() < 1e-9 && (d.standard_errors[1] - 2).abs() < 1e-9"#,
    },
    Entry {
        call: "#{ misfit: #{ error: 0.03, correlation: 2e-3, interval: 1e-4 } }",
        gives: "an assumed error of the residuals, such as that of a model, instead of the noise that they show: its norm, \
            the time over which its correlation decays to 1/e, and the time between two residuals (one otherwise, so that \
            `correlation` is a number of residuals); a list of any of these has an entry for each of `parts`. Intervals \
            are those of the normal distribution",
        example: r#"let mean = |x| { let all = []; for i in 0..400 { all.push(x[0]); } all };
                    let width = |correlation| {
                        let c = confidence([1.0], #{ misfit: #{ error: 0.4, correlation: correlation } }, mean);
                        c.standard_errors[0]
                    };
                    (width.call(0) - 0.001).abs() < 1e-9 && width.call(20) > 6 * width.call(0)"#,
    },
    Entry {
        call: "#{ prior: [(), 0.1], held: [(), 0.1] }",
        gives: "standard deviations of what is known of parameters besides the residuals, in their units; () for those that \
            the residuals alone determine. With `prior` these are fitted together with the others, about their values in \
            `best`; with `held` the fit held them at these values, as an objective holds the dimensions of a tower: the \
            result is about the others, and `shift_table` has what one standard deviation of each changes them by. Of \
            `confidence` only",
        example: r#"let sum = |x| { let all = []; for i in 0..100 { all.push(x[0] + x[1]); } all };
                    let o = #{ misfit: #{ error: 1.0 }, prior: [(), 0.3] };
                    let c = confidence([2.0, 0.0], o, sum);
                    let h = confidence([2.0, 0.0], #{ misfit: #{ error: 1.0 }, held: [(), 0.3] }, sum);
                    (c.standard_errors[0] - (0.01 ** 2 + 0.3 ** 2).sqrt()).abs() < 1e-9
                        && (h.standard_errors[0] - c.standard_errors[0]).abs() < 1e-9 && h.names == ["x0"]
                        && h.shift_table[0].parameter == "x1" && (h.shift_table[0].x0 + 0.3).abs() < 1e-9"#,
    },
];

#[cfg(test)]
mod tests {
    use super::super::test_engine;
    use super::*;
    use crate::script::Limits;

    /// The model is linear: the ends of the profiles are those of the covariance, each with the noise of its own part.
    #[test]
    fn profiles_of_joined_signals_have_the_intervals_of_the_covariance() {
        let script = r#"
            let quiet = [0.1, -0.2, 0.1, 0.2, -0.1, -0.1, 0.1, -0.1];
            let loud = [3.0, 4.0, -1.0, -4.0, -3.0, -1.0, 1.0, 1.0];
            let means = |x| quiet.map(|y| x[0] - y) + loud.map(|y| x[1] - y);
            let ends = |options| {
                let p = profiles([0.0, 0.0], options, means);
                let c = confidence([0.0, 0.0], options, means);
                [p.upper[0], p.upper[1], c.upper[0], c.upper[1]]
            };
            ends.call(#{ noise: "white", parts: [8, 8] }) + ends.call(#{ noise: "white" })
        "#;
        let found = test_engine(Limits::STUDY).eval::<Array>(script).unwrap();
        let found: Vec<f64> = found.iter().map(|end| end.as_float().unwrap()).collect();
        let [along, along_loud, apart, apart_loud, joined, ..] = found[..] else { panic!("{found:?}") };
        assert!((along / apart - 1.0).abs() < 1e-6 && (along_loud / apart_loud - 1.0).abs() < 1e-6, "{found:?}");
        // t(7) √(Σ y²/7/8), of Student's tables 2.3646.
        for (end, squares) in [(along, 0.14_f64), (along_loud, 54.0)] {
            assert!((end / (2.3646 * (squares / 56.0).sqrt()) - 1.0).abs() < 1e-4, "{end}");
        }
        assert!(joined > 5.0 * along, "{found:?}");
    }

    /// The minimum of this objective is at (7, 1.5). A search from (9.9, 0.5) ends in another valley, on the bound of
    /// k1.
    const TWO_VALLEYS: &str = r#"
        let flat = []; for i in 0..40 { flat.push(if i % 2 == 0 { 1 } else { -1 } / (40.0).sqrt()); }
        let valley = |p, q, depth| [p, q] + flat.map(|sample| depth * sample);
        let square = |r| r.reduce(|sum, r| sum + r * r, 0.0);
        let misfit = |k| {
            let deep = valley.call(3 * (k[0] - 7), k[1] - 1.5, 0.05);
            let shallow = valley.call(0.3 * (12 - k[0]), 0.5 * (k[1] - 0.5), 2.0);
            if square.call(deep) < square.call(shallow) { deep } else { shallow }
        };
        let o = #{ names: ["k1", "ke"], lower: [0.2, 0.2], upper: [10, 10], difference: 0.01 };
        let best = minimize("levenberg-marquardt", [9.9, 0.5], o, misfit);
    "#;

    /// A search that ends on a bound has not converged; a profile that finds less continues it, and all that the script
    /// gets is about the better point.
    #[test]
    fn a_profile_that_finds_less_continues_the_search() {
        let text = TWO_VALLEYS.to_owned()
            + r#"
            let along = profiles(best, o + #{ relative: true, noise: "white" }, misfit);
            let better = along.best;
            [best, better, along]
        "#;
        let found = test_engine(Limits::STUDY).eval::<Array>(&text).unwrap();
        let [best, better, along] = [0, 1, 2].map(|index: usize| found[index].clone().cast::<Map>());
        let codes = |map: &Map| -> Vec<String> {
            let findings = map["findings"].clone().cast::<Array>();
            findings.iter().map(|found| found.clone().cast::<Map>()["code"].to_string()).collect()
        };
        let reason = |map: &Map| map["reason"].to_string();
        let converged = |map: &Map| map["converged"].as_bool().unwrap();
        assert_eq!((converged(&best), reason(&best).as_str()), (false, "the best point lies on a bound"));
        assert_eq!(codes(&best), ["on-bound"]);
        assert_eq!(
            best["warnings"].clone().cast::<Array>()[0].to_string(),
            "not converged: k1 = 10 lies on its upper bound, and the objective still falls beyond it"
        );
        let [k1, ke] = [0, 1].map(|index: usize| better["x"].clone().cast::<Array>()[index].as_float().unwrap());
        assert!((k1 - 7.0).abs() < 1e-3 && (ke - 1.5).abs() < 1e-3, "{k1} {ke}");
        assert!(converged(&better), "{}", reason(&better));
        assert!(codes(&better).iter().all(|code| code == "continued-from-profile"), "{:?}", codes(&better));
        assert!(better["history"].clone().cast::<Array>().len() > best["history"].clone().cast::<Array>().len());
        let lower = codes(&along).contains(&"lower-than-estimate".to_owned());
        assert!(!lower, "{:?}", codes(&along));
    }

    #[test]
    fn mistakes_are_reported() {
        let engine = test_engine(Limits::STUDY);
        for (text, expected) in [
            ("confidence([1.0], |x| x[0])", "the objective gave a number, and a confidence needs residuals"),
            ("profiles([1.0], |x| x[0])", "the objective gave a number, and a confidence needs residuals"),
            ("confidence(1.0, |x| [x[0], 1])", "an estimate is what `minimize` gave, or a list x, not f64"),
            ("confidence(#{ y: 1 }, |x| [x[0], 1])", "an estimate is what `minimize` gave, or a list x, not map"),
            ("confidence([], |x| [1])", "a search needs 1 to 50 unknowns, the start has 0"),
            ("confidence([1, 2], |x| [x[0], x[1]])", "the objective gave 2 residuals for 2 parameters"),
            (
                "confidence([1], |x| if x[0] == 1 { [1, 2] } else { [1] })",
                "the objective gave 1 residuals at [1.001], and 2 at the estimate",
            ),
            ("profiles([1, 1], |x| if (x[0] - 1).abs() > 0.01 { [1] } else { [x[0], x[1], 2] })", "residuals at ["),
            ("confidence([1], |x| throw \"no\")", "the objective has no value at the estimate [1.0]: no"),
            (
                "confidence([1], |x| if x[0] == 1 { [1, 2] } else { throw \"no\" })",
                "the trials beside x0 failed, there is no derivative: at [0.999]: no",
            ),
            (
                "confidence([1], #{ on_failure: \"stop\" }, |x| if x[0] <= 1 { [x[0], 2] } else { throw \"no\" })",
                "the trials beside x0 failed, there is no derivative: at [1.001]: no",
            ),
            (
                "confidence([1], #{ relativ: true }, |x| [x[0], 1])",
                "unknown option `relativ` (did you mean `relative`?)",
            ),
            ("confidence([1], #{ relative: 1 }, |x| [x[0], 1])", "`relative` is true or false, not i64"),
            (
                "confidence([1], #{ noise: \"pink\" }, |x| [x[0], 1])",
                "unknown noise `pink` (there are coloured, white)",
            ),
            ("profiles([1], #{ points: 0 }, |x| [x[0], 1])", "`points` is 0, which must be 1 to 20"),
            (
                "confidence([1], #{ parts: [1, 2] }, |x| [x[0], 1])",
                "`parts` [1, 2] are 3 residuals together, and the objective gave 2: expected the lengths of the lists",
            ),
            ("profiles([1], #{ parts: [] }, |x| [x[0], 1])", "`parts` [] are 0 residuals together"),
            (
                "confidence([1], #{ parts: [0, 2] }, |x| [x[0], 1])",
                "`parts` is a list of lengths, such as [400, 400], not [0, 2]",
            ),
            (
                "confidence([1], #{ parts: 2 }, |x| [x[0], 1])",
                "`parts` is a list of lengths, such as [400, 400], not 2",
            ),
            ("confidence([1], #{ misfit: 0.03 }, |x| [x[0], 1])", "`misfit` is a map, such as #{ error: 0.03"),
            ("confidence([1], #{ misfit: #{} }, |x| [x[0], 1])", "`misfit` has no `error`"),
            (
                "confidence([1], #{ misfit: #{ error: 0 } }, |x| [x[0], 1])",
                "`error` of `misfit` is 0, which must be above zero",
            ),
            (
                "confidence([1], #{ misfit: #{ error: 1, correlations: 2 } }, |x| [x[0], 1])",
                "unknown option of `misfit` `correlations` (did you mean `correlation`?)",
            ),
            (
                "confidence([1], #{ misfit: #{ error: [1, 2], correlation: [1, 2, 3] } }, |x| [x[0], 1])",
                "the lists of `misfit` have different lengths",
            ),
            (
                "confidence([1], #{ misfit: #{ error: [1, 2] } }, |x| [x[0], 1])",
                "`misfit` has 2 errors for 1 parts of the residuals",
            ),
            (
                "confidence([1], #{ misfit: #{ error: 1 }, noise: \"white\" }, |x| [x[0], 1])",
                "`noise` has no effect beside",
            ),
            ("confidence([1], #{ prior: 1 }, |x| [x[0], 1])", "`prior` is a list of standard deviations"),
            ("confidence([1], #{ prior: [1, 2] }, |x| [x[0], 1])", "`prior` has 2 entries for 1 unknowns"),
            (
                "confidence([1], #{ prior: [0] }, |x| [x[0], 1])",
                "a standard deviation of `prior` is 0, which must be above",
            ),
            ("profiles([1], #{ prior: [1] }, |x| [x[0], 1])", "`prior` and `held` are options of `confidence`"),
            ("confidence([1], #{ held: [1] }, |x| [x[0], 1])", "all parameters are `held`"),
            (
                "confidence([1, 2], #{ prior: [(), 1], held: [(), 1] }, |x| [x[0], x[1], 1])",
                "a parameter has a `prior` where it is fitted and is `held` where it is not",
            ),
            ("confidence([1], #{ lower: [2] }, |x| [x[0], 1])", "the start lies outside the bounds"),
            ("confidence([1, 2], #{ names: [\"a\"] }, |x| [x[0], 1])", "`names` has 1 entries for 2 unknowns"),
            ("confidence([1], |x| x[3])", "Array index 3 out of bounds"),
            (
                "minimize(\"nelder-mead\", [1], |x| confidence([1], |y| [y[0], 1]).x[0])",
                "an objective cannot search: `confidence` is called within one",
            ),
        ] {
            let error = engine.run(text).unwrap_err().to_string();
            assert!(error.contains(expected), "{text} gave: {error}");
        }
    }
}
