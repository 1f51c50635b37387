//! How far an estimate is to be trusted, in scripts: `confidence` and `profiles`.

use rhai::{Array, Dynamic, Engine, FnPtr, INT, Map, NativeCallContext};

use super::confidence::{Confidence, Question};
use super::crew::Desk;
use super::noise::Colour;
use super::options::Search;
use super::profile::{self, Profile, ProfileError};
use super::script::{self, Reply, SearchHost, Written, unknown, whole, word, written};
use super::tangent::{Tangent, TangentError};
use crate::plot::Correlation;
use crate::script::{Entry, refuse};

/// Options beside those of `minimize`.
const OPTIONS: [&str; 4] = ["noise", "relative", "points", "parts"];

const COLOURS: [(&str, Colour); 2] = [("coloured", Colour::Coloured), ("white", Colour::White)];

/// Places of a profile on each side of the estimate, where the script does not say.
const POINTS: usize = 3;
const MOST_POINTS: INT = 20;

/// An estimate as a script asks about it.
struct Asked {
    /// It starts at the estimate.
    search: Search,
    /// Of the picture of correlations.
    title: String,
    question: Question,
    /// Places of a profile on each side.
    points: usize,
    /// Lengths of the lists that the objective joins; none where it joins nothing.
    parts: Option<Vec<usize>>,
}

impl Asked {
    fn new(best: &Dynamic, options: &Map) -> Reply<Asked> {
        let known = || script::OPTIONS.into_iter().chain(OPTIONS);
        if let Some(other) = options.keys().find(|option| !known().any(|known| known == option.as_str())) {
            return Err(unknown("option", other, known()));
        }
        let (own, others): (Map, Map) =
            options.clone().into_iter().partition(|(option, _)| OPTIONS.contains(&option.as_str()));
        let Written { search, labels } = written("levenberg-marquardt", &estimate(best)?, &others)?;
        search.check().map_err(refuse)?;
        let title = labels.title.map_or_else(|| "Correlation".into(), |title| format!("Correlation: {title}"));
        let question = Question { names: labels.names, colour: Colour::default(), relative: false };
        let mut asked = Asked { search, title, question, points: POINTS, parts: None };
        for (option, value) in &own {
            match option.as_str() {
                "noise" => asked.question.colour = word(option, &value.to_string(), &COLOURS)?,
                "relative" => {
                    let truth = value.as_bool();
                    asked.question.relative =
                        truth.map_err(|found| refuse(format!("`relative` is true or false, not {found}")))?;
                }
                "parts" => asked.parts = Some(parts(value)?),
                _ => asked.points = points(value)?,
            }
        }
        Ok(asked)
    }

    fn tangent(&self, desk: &Desk<'_, '_>) -> Result<Tangent, TangentError> {
        let tangent = Tangent::at_start(&self.search, desk)?;
        match &self.parts {
            Some(parts) => tangent.joined_from(parts),
            None => Ok(tangent),
        }
    }
}

fn parts(value: &Dynamic) -> Reply<Vec<usize>> {
    let wrong = || refuse(format!("`parts` is a list of lengths, such as [400, 400], not {value}"));
    let list = value.read_lock::<Array>().map(|list| list.clone()).ok_or_else(wrong)?;
    let length = |item: &Dynamic| item.as_int().ok().and_then(|length| usize::try_from(length).ok());
    list.iter().map(|item| length(item).filter(|length| *length > 0).ok_or_else(wrong)).collect()
}

fn points(value: &Dynamic) -> Reply<usize> {
    let count = whole(value, "points")?;
    let fits = usize::try_from(count).ok().filter(|_| (1..=MOST_POINTS).contains(&count));
    fits.ok_or_else(|| refuse(format!("`points` is {count}, which must be 1 to {MOST_POINTS}")))
}

/// What `minimize` or `confidence` gave, or a list.
fn estimate(best: &Dynamic) -> Reply<Array> {
    let found = match best.read_lock::<Map>() {
        Some(map) => map.get("x").cloned().unwrap_or_default(),
        None => best.clone(),
    };
    let wrong = || format!("an estimate is what `minimize` gave, or a list x, not {}", best.type_name());
    let list = found.read_lock::<Array>().map(|list| list.clone());
    list.ok_or_else(|| refuse(wrong()))
}

fn ask_confidence(
    host: &SearchHost,
    context: &NativeCallContext,
    best: &Dynamic,
    options: &Map,
    call: &FnPtr,
) -> Reply<Map> {
    let asked = Asked::new(best, options)?;
    let task = [(asked.search.clone(), call.clone())];
    let confidences = host.at_work::<_, ProfileError>(context, &task, |desk, _| {
        Ok(Confidence::of(&asked.tangent(desk)?, &asked.question)?)
    })?;
    let confidence = first(confidences)?;
    host.correlated(&pictured(&confidence, asked.title));
    Ok(result(&confidence))
}

fn ask_profiles(
    host: &SearchHost,
    context: &NativeCallContext,
    best: &Dynamic,
    options: &Map,
    call: &FnPtr,
) -> Reply<Map> {
    let asked = Asked::new(best, options)?;
    let task = [(asked.search.clone(), call.clone())];
    let profiles = host.at_work::<_, ProfileError>(context, &task, |desk, _| {
        let tangent = asked.tangent(desk)?;
        let confidence = Confidence::of(&tangent, &asked.question)?;
        let mut listener = |left: usize| host.note(&format!("profiles: {left} places are searched"));
        profile::profiles(&asked.search, &tangent, &confidence, asked.points, desk, &mut listener)
    })?;
    first(profiles).map(|profiles| profiled(&profiles, &asked.question.names))
}

fn pictured(confidence: &Confidence, title: String) -> Correlation {
    let correlation = &confidence.correlation;
    let rows = correlation.row_iter().map(|row| row.iter().copied().collect()).collect();
    Correlation { title, names: confidence.names.clone(), rows }
}

/// What was found for the only task.
fn first<T>(found: Vec<T>) -> Reply<T> {
    found.into_iter().next().ok_or_else(|| refuse("nothing was found"))
}

/// What a script gets of a confidence.
fn result(confidence: &Confidence) -> Map {
    let names = &confidence.names;
    let count = names.len();
    let matrix = |entry: &dyn Fn(usize, usize) -> f64| -> Array {
        (0..count).map(|row| list((0..count).map(|column| entry(row, column))).into()).collect()
    };
    let mut map = Map::new();
    map.insert("names".into(), names.iter().map(|name| name.clone().into()).collect::<Array>().into());
    map.insert("x".into(), list(confidence.x.iter().copied()).into());
    map.insert("standard_errors".into(), list(confidence.standard_errors.iter().copied()).into());
    map.insert("lower".into(), list(confidence.intervals.iter().map(|[lower, _]| *lower)).into());
    map.insert("upper".into(), list(confidence.intervals.iter().map(|[_, upper]| *upper)).into());
    map.insert("covariance".into(), matrix(&|row, column| confidence.covariance[(row, column)]).into());
    map.insert("correlation".into(), matrix(&|row, column| confidence.correlation[(row, column)]).into());
    map.insert("samples".into(), INT::try_from(confidence.samples).unwrap_or(INT::MAX).into());
    map.insert("effective_samples".into(), confidence.effective_samples.into());
    map.insert("degrees_of_freedom".into(), confidence.freedom.into());
    map.insert("condition".into(), confidence.condition.into());
    map.insert("warnings".into(), texts(&confidence.warnings));
    map.insert("table".into(), (0..count).map(|place| row(confidence, place).into()).collect::<Array>().into());
    let correlations = (0..count).map(|place| correlations(confidence, place).into());
    map.insert("correlation_table".into(), correlations.collect::<Array>().into());
    map
}

fn row(confidence: &Confidence, place: usize) -> Map {
    let [lower, upper] = confidence.intervals[place];
    let figures = [
        ("value", confidence.x[place]),
        ("standard_error", confidence.standard_errors[place]),
        ("lower_95", lower),
        ("upper_95", upper),
    ];
    named(&confidence.names[place], figures)
}

fn correlations(confidence: &Confidence, place: usize) -> Map {
    let names = confidence.names.iter().enumerate();
    let pairs = names.map(|(other, name)| (name.as_str(), confidence.correlation[(place, other)]));
    named(&confidence.names[place], pairs)
}

/// What a script gets of profiles.
fn profiled(profiles: &[Profile], names: &[String]) -> Map {
    let side = |side: usize| -> Array { profiles.iter().map(|profile| or_unit(profile.interval[side])).collect() };
    let intervals = profiles.iter().map(|profile| {
        let mut map = named(&names[profile.parameter], []);
        map.insert("lower_95".into(), or_unit(profile.interval[0]));
        map.insert("upper_95".into(), or_unit(profile.interval[1]));
        map.insert("threshold".into(), profile.threshold.sqrt().into());
        Dynamic::from(map)
    });
    let warnings: Vec<String> = profiles.iter().flat_map(|profile| profile.warnings.clone()).collect();
    let mut map = Map::new();
    map.insert("lower".into(), side(0).into());
    map.insert("upper".into(), side(1).into());
    map.insert("intervals".into(), intervals.collect::<Array>().into());
    map.insert("warnings".into(), texts(&warnings));
    map.insert("table".into(), profiles.iter().flat_map(|profile| places(profile, names)).collect::<Array>().into());
    map
}

/// A profile as rows of a table.
fn places<'p>(profile: &'p Profile, names: &'p [String]) -> impl Iterator<Item = Dynamic> + 'p {
    profile.points.iter().map(|point| {
        let mut map = named(&names[profile.parameter], [("value", point.value)]);
        map.insert("f".into(), or_unit(point.f));
        for (name, x) in names.iter().zip(&point.x) {
            map.insert(name.as_str().into(), (*x).into());
        }
        map.into()
    })
}

fn named<'n>(name: &str, figures: impl IntoIterator<Item = (&'n str, f64)>) -> Map {
    let figures = figures.into_iter().map(|(name, value)| (name.into(), value.into()));
    std::iter::once(("parameter".into(), name.to_owned().into())).chain(figures).collect()
}

fn list(values: impl Iterator<Item = f64>) -> Array {
    values.map(Dynamic::from).collect()
}

fn texts(warnings: &[String]) -> Dynamic {
    warnings.iter().map(|warning| warning.clone().into()).collect::<Array>().into()
}

fn or_unit(value: Option<f64>) -> Dynamic {
    value.map_or(Dynamic::UNIT, Dynamic::from)
}

/// Offers `confidence` and `profiles` to scripts.
pub(super) fn register(engine: &mut Engine, host: &SearchHost) {
    type Ask = fn(&SearchHost, &NativeCallContext, &Dynamic, &Map, &FnPtr) -> Reply<Map>;
    let asks: [(&str, Ask); 2] = [("confidence", ask_confidence), ("profiles", ask_profiles)];
    for (name, ask) in asks {
        let own = host.clone();
        let with = move |context: NativeCallContext, best: Dynamic, options: Map, call: FnPtr| {
            ask(&own, &context, &best, &options, &call)
        };
        engine.register_fn(name, with);
        let own = host.clone();
        let without = move |context: NativeCallContext, best: Dynamic, call: FnPtr| {
            ask(&own, &context, &best, &Map::new(), &call)
        };
        engine.register_fn(name, without);
    }
}

/// The reference of trust.
pub const ENTRIES: &[Entry] = &[
    Entry {
        call: "confidence(best, options, |x| residuals)",
        gives: "how well the parameters that `minimize` found (or a list x) are known, from the slope of the residuals: #{ names, x, \
                standard_errors, lower, upper, covariance, correlation, samples, effective_samples, degrees_of_freedom, condition, \
                warnings, table, correlation_table }; intervals of 95 %. Residuals may be correlated along the list. `warnings` say in words which \
                combination is not identifiable. Takes the options of `minimize`, of which it minds names, bounds, difference and the \
                rules for failed trials",
        example: r#"let read = [3.1, 4.9, 7.0, 9.2, 10.9, 13.1];
                    let line = |x| read.map(|y, i| x[0] + x[1] * i - y);
                    let o = #{ names: ["offset", "slope"] };
                    let best = minimize("levenberg-marquardt", [1.0, 1], o, line);
                    let c = confidence(best, o, line);
                    c.lower[1] < 2 && c.upper[1] > 2 && c.table[1].parameter == "slope" && c.table[1].value == best.x[1]"#,
    },
    Entry {
        call: "profiles(best, options, |x| residuals)",
        gives: "the objective along each parameter, all others searched again: #{ table, intervals, lower, upper, warnings }; `table` has \
                parameter, value, f and all parameters, `intervals` the ends of 95 %, () where the objective does not rise enough. \
                Two or three trials a place",
        example: r#"let read = [3.0, 2.2, 1.5, 1.2, 0.8, 0.6, 0.4, 0.3];
                    let decay = |x| read.map(|y, i| x[0] * exp(-x[1] * i) - y);
                    let best = minimize("levenberg-marquardt", [2.0, 0.2], decay);
                    let p = profiles(best, #{ relative: true }, decay);
                    p.table.len() == 14 && p.lower[1] < best.x[1] && p.upper[1] > best.x[1]"#,
    },
    Entry {
        call: "#{ noise: \"coloured\" | \"white\", relative: false, points: 3, parts: [n1, n2, …] }",
        gives: "further options of `confidence` and `profiles`: whether neighbouring residuals may be correlated; intervals symmetric in \
                the logarithm, for multipliers; places of a profile on each side; lengths of the lists that the residuals are joined \
                from, such as several signals (their sum is the number of residuals; one list otherwise): each part then has noise \
                of its own size and correlation",
        example: r#"let c = confidence([2.0], #{ noise: "white", relative: true }, |x| [x[0] - 1.9, x[0] - 2.1]);
                    let joined = |x| [x[0] - 1.9, x[0] - 2.1] + [x[1] - 1.0, x[1] - 5.0];
                    let d = confidence([2.0, 3.0], #{ noise: "white", parts: [2, 2] }, joined);
                    (c.lower[0] * c.upper[0] - 4).abs() < 1e-9 && (c.standard_errors[0] - 0.1).abs() < 1e-9
                        && (d.standard_errors[0] - 0.1).abs() < 1e-9 && (d.standard_errors[1] - 2).abs() < 1e-9"#,
    },
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::functions::engine;
    use crate::script::Limits;

    fn host() -> Engine {
        let mut engine = engine(Limits::STUDY);
        script::register(&mut engine, &SearchHost::new(None, |_| {}));
        engine
    }

    /// The model is linear: the ends of the profiles are those of the covariance, each with the noise of its own part.
    #[test]
    fn profiles_of_joined_signals_end_where_the_covariance_says() {
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
        let found = host().eval::<Array>(script).unwrap();
        let found: Vec<f64> = found.iter().map(|end| end.as_float().unwrap()).collect();
        let [along, along_loud, apart, apart_loud, joined, ..] = found[..] else { panic!("{found:?}") };
        assert!((along / apart - 1.0).abs() < 1e-6 && (along_loud / apart_loud - 1.0).abs() < 1e-6, "{found:?}");
        // t(7) √(Σ y²/7/8), of Student's tables 2.3646.
        for (end, squares) in [(along, 0.14_f64), (along_loud, 54.0)] {
            assert!((end / (2.3646 * (squares / 56.0).sqrt()) - 1.0).abs() < 1e-4, "{end}");
        }
        assert!(joined > 5.0 * along, "{found:?}");
    }

    #[test]
    fn mistakes_are_said() {
        let engine = host();
        for (text, expected) in [
            (
                "confidence([1.0], |x| x[0])",
                "the objective gave a number, and what a parameter is worth shows in residuals",
            ),
            (
                "profiles([1.0], |x| x[0])",
                "the objective gave a number, and what a parameter is worth shows in residuals",
            ),
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
                "the trials beside x[0] failed, there is no slope: at [0.999]: no",
            ),
            (
                "confidence([1], #{ on_failure: \"stop\" }, |x| if x[0] <= 1 { [x[0], 2] } else { throw \"no\" })",
                "the trials beside x[0] failed, there is no slope: at [1.001]: no",
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
                "`parts` [1, 2] are 3 residuals together, and the objective gave 2: they are the lengths of the lists",
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
