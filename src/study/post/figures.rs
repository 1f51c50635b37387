//! The names of all figures of a run; its headlines, by which runs are judged, compared and ranked; the sentence that its page
//! begins with.

use std::sync::LazyLock;

use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, SchemaGenerator};
use serde_json::{Map, Value};

use super::impact::BodyFigures;
use super::results::{HEADER, OUTPUT};
use super::{
    Audit, Impact, Indent, Inflation, Measures, Results, RunFindings, Stretch, VERDICT, Verdict, lowest_point,
};
use crate::script::object;
use base::group;
use base::number::duration;
use base::units::STANDARD_GRAVITY;
use base::written::{Reading, capital, digits};
use lab::signal::column::{self, Column};
use scene::model::Model;
use scene::model::loading::Test;
use scene::simulate::{BREAK_STRAIN_OF_COUPONS, FRAME_HIT};

/// The fields that a summary may have in a script: those of all kinds of loading, then those of every run. Of several
/// impactors, those of each begin with its name.
pub(super) static SUMMARY: LazyLock<Vec<&str>> = LazyLock::new(|| NAMES.iter().map(String::as_str).collect());

/// The strings of [`SUMMARY`].
static NAMES: LazyLock<Vec<String>> = LazyLock::new(|| {
    let of_loadings =
        [names::<BodyFigures>(), names::<Impact>(), names::<Stretch>(), names::<Indent>(), names::<Inflation>()];
    let mut all = group::unique(HEADER.map(String::from).into_iter().chain(of_loadings.into_iter().flatten()));
    let findings = object(RunFindings::default()).into_iter().map(|(name, _)| name);
    all.extend(names::<Audit>().into_iter().chain(findings).chain(OUTPUT.map(String::from)));
    all
});

/// Whether the figure of a run is one that its post script measured.
pub fn is_of_script(name: &str) -> bool {
    let is_of = |known: &&str| name == *known || name.strip_suffix(*known).is_some_and(|name| name.ends_with('_'));
    !SUMMARY.iter().any(is_of)
}

/// Whether a run without a post script may have this figure; of several impactors each has its own, behind its name.
pub fn is_known(name: &str, has_several: bool) -> bool {
    SUMMARY.contains(&name) || has_several && !is_of_script(name)
}

/// A figure of `summary.json`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FigureName {
    /// Its name there; of several impactors it begins with theirs.
    pub name: String,
    /// Its meaning.
    pub sentence: String,
    /// Tables of the loadings whose runs have it.
    pub loadings: Vec<&'static str>,
    /// Whether each impactor has one.
    pub is_of_each_impactor: bool,
}

/// All figures, those of impacts first.
pub fn figures() -> Vec<FigureName> {
    let mut found: Vec<FigureName> = Vec::new();
    let mut add = |(name, sentence): (String, String), loadings: &[&'static str], is_of_each_impactor| match found
        .iter_mut()
        .find(|known| known.name == name && known.sentence == sentence)
    {
        Some(known) => known.loadings.extend_from_slice(loadings),
        None => found.push(FigureName { name, sentence, loadings: loadings.to_vec(), is_of_each_impactor }),
    };
    fields::<BodyFigures>().into_iter().for_each(|field| add(field, &["impact"], true));
    let of_loadings: [(_, &[&str]); 4] = [
        (fields::<Impact>(), &["impact"]),
        (fields::<Stretch>(), &["stretch"]),
        (fields::<Indent>(), &["indent"]),
        (fields::<Inflation>(), &["pressure", "volume"]),
    ];
    for (own, loadings) in of_loadings {
        own.into_iter().chain(fields::<Audit>()).for_each(|field| add(field, loadings, false));
    }
    found
}

/// The names of the fields of `T` as they are written.
fn names<T: JsonSchema>() -> Vec<String> {
    fields::<T>().into_iter().map(|(name, _)| name).collect()
}

/// The fields of `T` as they are written: names and sentences.
fn fields<T: JsonSchema>() -> Vec<(String, String)> {
    let settings = SchemaSettings::draft2020_12().with(|settings| settings.inline_subschemas = true).for_serialize();
    let schema = SchemaGenerator::new(settings).into_root_schema_for::<T>();
    let fields = schema.get("properties").and_then(Value::as_object).into_iter().flatten();
    let sentence = |field: &Value| {
        let lines = field.get("description").and_then(Value::as_str).unwrap_or_default();
        lines.split_whitespace().collect::<Vec<_>>().join(" ")
    };
    fields.map(|(name, field)| (name.clone(), sentence(field))).collect()
}

/// A figure of `summary.json` that a person asks for first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Headline {
    /// The test that has it; none of a figure of every test.
    pub test: Option<TestKind>,
    /// Its name in the summary; of several impactors it begins with theirs.
    pub name: &'static str,
    /// What it is called where it is shown.
    pub words: &'static str,
    /// From the summary's unit to the one shown.
    pub factor: f64,
    /// The unit shown.
    pub unit: &'static str,
    /// The figure that says at which time, strain or depth it was.
    pub at: Option<&'static str>,
    /// Whether films are judged by it; the others tell of the computation, of a reference, or what the test was.
    pub judges: bool,
}

/// What is done to the film.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TestKind {
    /// An impact.
    Impact,
    /// A stretch.
    Stretch,
    /// An indentation.
    Indent,
    /// An inflation.
    Inflation,
}

type Shown = (f64, &'static str);

const fn other(test: Option<TestKind>, name: &'static str, words: &'static str, (factor, unit): Shown) -> Headline {
    Headline { test, name, words, factor, unit, at: None, judges: false }
}

const fn result(test: Option<TestKind>, name: &'static str, words: &'static str, shown: Shown) -> Headline {
    Headline { judges: true, ..other(test, name, words, shown) }
}

const fn at(at: &'static str, headline: Headline) -> Headline {
    Headline { at: Some(at), ..headline }
}

const IMPACT: Option<TestKind> = Some(TestKind::Impact);
const STRETCH: Option<TestKind> = Some(TestKind::Stretch);
const INDENT: Option<TestKind> = Some(TestKind::Indent);
const INFLATION: Option<TestKind> = Some(TestKind::Inflation);
const EVERY: Option<TestKind> = None;

const G: Shown = (1.0 / STANDARD_GRAVITY, "g");
const MM: Shown = (1e3, "mm");
const N: Shown = (1.0, "N");
const KPA: Shown = (1e-3, "kPa");
const PERCENT: Shown = (100.0, "%");

/// All of them, in the order of pages; the first of a test is the one by which its runs are ranked.
pub const HEADLINES: [Headline; 25] = [
    at("time_of_peak_acceleration_s", result(IMPACT, "peak_acceleration_m_s2", "peak deceleration", G)),
    at("time_of_peak_displacement_s", result(IMPACT, "peak_displacement_m", "lowest point", MM)),
    result(IMPACT, "energy_absorption", "loading energy absorbed", PERCENT),
    at("time_of_rebound_s", result(IMPACT, "rebound_velocity_m_s", "largest upward speed", (1.0, "m/s"))),
    other(IMPACT, "acceleration_error", "acceleration error E_a", PERCENT),
    other(IMPACT, "displacement_error", "displacement error E_d", PERCENT),
    result(STRETCH, "peak_force_N", "peak force", N),
    at("strain_at_peak_stress", result(STRETCH, "peak_stress_Pa", "peak stress", (1e-6, "MPa"))),
    result(STRETCH, "strain_at_break", "strain at break", PERCENT),
    other(STRETCH, "final_strain", "final strain", PERCENT),
    at("depth_at_peak_force_m", result(INDENT, "peak_force_N", "peak force", N)),
    result(INDENT, "work_J", "work", (1.0, "J")),
    result(INDENT, "depth_at_break_m", "depth at break", MM),
    result(INDENT, "final_depth_m", "final depth", MM),
    result(INFLATION, "peak_deflection_m", "largest deflection", MM),
    result(INFLATION, "final_deflection_m", "deflection", MM),
    result(INFLATION, "final_volume_m3", "volume", (1e3, "l")),
    result(INFLATION, "peak_pressure_Pa", "peak pressure", KPA),
    result(INFLATION, "burst_pressure_Pa", "burst pressure", KPA),
    other(INFLATION, "settling", "settled to", PERCENT),
    other(EVERY, "energy_balance_error", "energy balance error", PERCENT),
    result(EVERY, "torn_length_m", "torn", MM),
    result(EVERY, "warming_K", "warmed up by", (1.0, "K")),
    result(EVERY, "field_rms_m", "field error, rms", MM),
    other(EVERY, "field_error", "field error", PERCENT),
];

/// Whether the film held: a headline without a number.
const RUPTURED: &str = "ruptured";

impl TestKind {
    /// That of a run of `model`.
    pub fn of(model: &Model) -> TestKind {
        match model.loading.test() {
            Test::Impact => TestKind::Impact,
            Test::Stretch => TestKind::Stretch,
            Test::Indent { .. } => TestKind::Indent,
            Test::Inflation => TestKind::Inflation,
        }
    }

    /// Its own headlines.
    pub fn headlines(self) -> impl Iterator<Item = &'static Headline> {
        HEADLINES.iter().filter(move |headline| headline.test == Some(self))
    }
}

impl Headline {
    /// What it is called of an impactor that still descends at the end, or not.
    pub fn words_of(&self, descends: bool) -> &'static str {
        match self.name {
            "peak_acceleration_m_s2" if descends => "largest deceleration so far",
            "peak_displacement_m" if descends => "lowest so far, still descending",
            _ => self.words,
        }
    }

    /// Its value and where it was reached, with their units: `14.3 g at 57.0 ms`. None where `figures` have no such figure of
    /// the impactor whose names begin with `prefix`.
    pub fn text(&self, prefix: &str, figures: &Map<String, Value>) -> Option<String> {
        let number = |name: &str| figures.get(&format!("{prefix}{name}"))?.as_f64();
        let value = number(self.name)? * self.factor;
        let is_least = self.unit == "%" && value.abs() < LEAST_SHARE;
        let shown =
            if is_least { format!("below {LEAST_SHARE} %") } else { format!("{} {}", digits(value), self.unit) };
        Some(match self.at.and_then(|at| Some(reached(at, number(at)?))) {
            Some(at) => format!("{shown} {at}"),
            None => shown,
        })
    }
}

/// The time, length or strain `value`, as its name `at` says, at which a figure was reached: `at 57.0 ms`.
pub fn reached(at: &str, value: f64) -> String {
    match at {
        _ if at.ends_with("_s") => format!("at {}", duration(value)),
        _ if at.ends_with("_m") => format!("at {} mm", digits(value * 1e3)),
        _ => format!("at {} %", digits(value * 100.0)),
    }
}

/// Share in % below which a figure shows no digits.
pub const LEAST_SHARE: f64 = 0.01;

/// The findings that question whether film holds and what the first figures are of, which stand in the answer.
const DOUBTS: [&str; 2] = [BREAK_STRAIN_OF_COUPONS.name, FRAME_HIT.name];

/// Most figures of an impactor in a sentence.
const MOST_TOLD: usize = 3;

/// What a run answers: whether the film held, the first figures of each impactor, and what questions it.
pub fn answer(model: &Model, results: &Results, failed: bool) -> String {
    let figures = results.figures();
    let verdict = results.audit.verdict;
    let film = match results.audit.rupture_time_s {
        Some(time) => format!("{} at {}", verdict.sentence(), duration(time)),
        None if failed && verdict != Verdict::CannotBreak => "The film held until the run failed".into(),
        None => verdict.sentence().into(),
    };
    let of_body = |prefix: &String| {
        if let Some(at_break) = at_break(results, prefix) {
            return Some(format!("{}{at_break}", whose(prefix)));
        }
        let told = headlines_of(model, results, prefix).filter(|headline| headline.judges);
        let text = |one: &Headline| {
            Some(format!("{} {}", one.words_of(descends(results, prefix)), one.text(prefix, &figures)?))
        };
        let told: Vec<String> = told.filter_map(text).take(MOST_TOLD).collect();
        (!told.is_empty()).then(|| format!("{}{}", whose(prefix), told.join(", ")))
    };
    let told: Vec<String> = prefixes(results).iter().filter_map(of_body).collect();
    let doubts = results.findings.iter().filter(|finding| DOUBTS.contains(&finding.code.as_str()));
    let doubts: String = doubts.map(|finding| format!(" {}.", capital(&finding.message))).collect();
    if told.is_empty() { format!("{film}.{doubts}") } else { format!("{film}: {}.{doubts}", told.join("; ")) }
}

/// The impactor whose figures begin with `prefix`, before what is told of it; empty of a single one.
fn whose(prefix: &str) -> String {
    prefix.strip_suffix('_').map_or_else(String::new, |name| format!("{name}, "))
}

/// Force, travel and energy of an impactor when film first broke; none where no film broke before it met the film.
fn at_break(results: &Results, prefix: &str) -> Option<String> {
    let Measures::Impact(_) = results.measures else { return None };
    let until = results.signals.time.partition_point(|time| *time <= results.audit.rupture_time_s.unwrap_or(-1.0));
    let of = |column: Column| Some(&results.signals.channel(&format!("{prefix}{}", column.name))?[..until]);
    let [force, travel, velocity] = [of(column::CONTACT_FORCE)?, of(column::DISPLACEMENT)?, of(column::VELOCITY)?];
    force.iter().any(|force| *force != 0.0).then_some(())?;
    let power: Vec<f64> = force.iter().zip(velocity).map(|(force, velocity)| -force * velocity).collect();
    let time = results.signals.time[..until].windows(2);
    let energy: f64 = time.zip(power.windows(2)).map(|(t, p)| 0.5 * (p[0] + p[1]) * (t[1] - t[0])).sum();
    let [force, travel] = [force.last()?, travel.last()?];
    Some(format!("force {} N, travel {} mm, energy {} J", digits(*force), digits(-1e3 * travel), digits(energy)))
}

/// The headlines of an impactor's test beyond those of its answer, in words, and those of every test.
pub fn further(model: &Model, results: &Results) -> Vec<String> {
    let figures = results.figures();
    let of_body = |prefix: &String| {
        let told = headlines_of(model, results, prefix).filter(|headline| headline.judges);
        let most = if at_break(results, prefix).is_some() { 0 } else { MOST_TOLD };
        let told: Vec<&str> =
            told.filter(|one| one.text(prefix, &figures).is_some()).map(|one| one.name).take(most).collect();
        let whose = prefix.replace('_', " ");
        let rest = headlines_of(model, results, prefix)
            .filter(move |one| !told.contains(&one.name) && !one.name.ends_with("_error"));
        rest.filter_map(|one| Some(format!("{whose}{} {}", one.words, one.text(prefix, &figures)?))).collect::<Vec<_>>()
    };
    let own: Vec<String> = prefixes(results).iter().flat_map(of_body).collect();
    let every = HEADLINES.iter().filter(|one| one.test.is_none() && !one.name.starts_with("field_"));
    let every = every.filter_map(|one| {
        let is_none = figures.get(one.name).and_then(Value::as_f64) == Some(0.0) && one.judges;
        (!is_none).then(|| one.text("", &figures)).flatten().map(|text| format!("{} {text}", one.words))
    });
    own.into_iter().chain(every).collect()
}

/// The headlines of the test of a run, without the deceleration of an impactor that only fell, and without the lowest point of one
/// that fell through film.
pub fn headlines_of(model: &Model, results: &Results, prefix: &str) -> impl Iterator<Item = &'static Headline> + use<> {
    let is_falling = descends(results, prefix);
    let peak = |body: &super::BodyFigures| {
        body.prefix == prefix && body.peak_acceleration_m_s2.is_some_and(|peak| peak <= 0.0)
    };
    let fell = is_falling && matches!(&results.measures, Measures::Impact(impact) if impact.bodies.iter().any(peak));
    let fell_through = is_falling && results.audit.ruptured;
    TestKind::of(model).headlines().filter(move |headline| match headline.name {
        "peak_acceleration_m_s2" => !fell,
        "peak_displacement_m" => !fell_through,
        _ => true,
    })
}

/// Whether an impactor still descends at the end.
pub fn descends(results: &Results, prefix: &str) -> bool {
    lowest_point(&results.signals, prefix).is_none()
}

/// What the names of the impactors' figures begin with; one empty text where there is one, or none.
fn prefixes(results: &Results) -> Vec<String> {
    match &results.measures {
        Measures::Impact(impact) if !impact.bodies.is_empty() => {
            impact.bodies.iter().map(|body| body.prefix.clone()).collect()
        }
        _ => vec![String::new()],
    }
}

/// The figure by which runs of `model` are ranked where none is named.
pub fn ranking_figure(model: &Model) -> &'static str {
    TestKind::of(model).headlines().next().map_or(RUPTURED, |first| first.name)
}

/// How bad a value of a figure is where runs are ranked by it: its size, since a depth may be negative; of a figure that a post
/// script measures, the value as it is.
pub fn badness(figure: &str, value: f64) -> f64 {
    if is_of_script(figure) { value } else { value.abs() }
}

/// The words of a figure and how its values are read, of which the largest has this `size`: of a headline as it is shown first, also
/// of one of several impactors.
pub fn reading(name: &str, size: f64) -> (String, Reading) {
    let Some(headline) = find(name).next() else { return Reading::of_name(name, size) };
    let whose = name.strip_suffix(headline.name).unwrap_or_default().replace('_', " ");
    (format!("{whose}{}", headline.words), Reading { unit: headline.unit.into(), factor: headline.factor })
}

/// Whether a figure is one by which films are judged, also of one of several impactors, with its name before.
pub fn is_result(name: &str) -> bool {
    find(name).any(|headline| headline.judges) || is_meant(name, RUPTURED)
}

/// Whether a figure is shown even where all runs agree.
pub(super) fn is_key_figure(name: &str) -> bool {
    find(name).next().is_some() || is_meant(name, RUPTURED) || name == VERDICT
}

fn find(name: &str) -> impl Iterator<Item = &'static Headline> {
    HEADLINES.iter().filter(move |headline| is_meant(name, headline.name))
}

fn is_meant(name: &str, headline: &str) -> bool {
    let is_of_body = || name.strip_suffix(headline).is_some_and(|name| name.ends_with('_'));
    name == headline || !SUMMARY.contains(&name) && is_of_body()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_figure_has_a_sentence() {
        let all = figures();
        assert!(all.iter().all(|figure| figure.sentence.ends_with('.')), "{all:?}");
        let of = |name: &str| all.iter().find(|figure| figure.name == name).unwrap_or_else(|| panic!("{name}"));
        assert!(of("peak_acceleration_m_s2").is_of_each_impactor);
        assert_eq!(of("elements").loadings, ["impact", "stretch", "indent", "pressure", "volume"]);
        assert_eq!(of("burst_pressure_Pa").loadings, ["pressure", "volume"]);
    }

    #[test]
    fn every_headline_is_a_figure_of_its_test() {
        for Headline { name, test, .. } in HEADLINES {
            assert!(SUMMARY.contains(&name), "{name}");
            assert!(test.is_some_and(|test| test.headlines().any(|own| own.name == name)) || test.is_none(), "{name}");
        }
        assert!(SUMMARY.contains(&RUPTURED));
    }

    #[test]
    fn a_deep_run_is_worse_than_a_shallow_one() {
        assert!(badness("peak_displacement_m", -0.3) > badness("peak_displacement_m", -0.1));
        assert!(badness("overshoot", -0.3) < badness("overshoot", -0.1), "a script's figure has its own sign");
    }
}
