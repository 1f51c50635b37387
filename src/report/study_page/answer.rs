//! What a study answers: how its curves compare with those measured, and how well its parameters are known.

use serde_json::Value;

use crate::drawn::{self, Line, RangeLook, ranges};
use crate::html::{self, Card, escape, kept_together};
use crate::script_output;
use crate::study_page::estimates::Estimate;
use base::group;
use base::units::Unit;
use base::written::{Reading, capital, digits, figure};
use plot::{Plot, thinned};
use study::script::{self, ConvergenceHistory, Row, ScriptOutput, figure_sentence};

/// Most curves that are shown over those measured.
const MOST_FITS: usize = 24;

/// Most points of their plots.
const MOST_POINTS: usize = 24_000;

/// Most figures at the top of the page.
const MOST_CARDS: usize = 8;

/// Most parameters whose values the answer names.
const MOST_NAMED: usize = 4;

/// The best curve of a search and the one that it was to meet.
struct Fit<'a> {
    search: &'a ConvergenceHistory,
    fit: &'a script::Fit,
    /// The search, the quantity, or both: what tells it from the others.
    name: String,
    /// Root mean square of the difference over that of the measured curve.
    error: f64,
}

fn fits(output: &ScriptOutput) -> Vec<Fit<'_>> {
    let is_one = output.searches.len() == 1;
    output.searches.iter().flat_map(|search| search_fits(search, is_one)).collect()
}

fn search_fits(search: &ConvergenceHistory, is_one: bool) -> impl Iterator<Item = Fit<'_>> {
    let name = move |fit: &script::Fit| match (search.fits.len(), is_one) {
        (1, _) => search.title.clone(),
        (_, true) => fit.quantity.clone(),
        (_, false) => format!("{}: {}", search.title, fit.quantity),
    };
    let error = |fit: &script::Fit| {
        let square = |value: f32| f64::from(value).powi(2);
        let pairs = || fit.values.iter().zip(&fit.target.values);
        let difference: f64 = pairs().map(|(found, wanted)| square(found - wanted)).sum();
        let whole: f64 = pairs().map(|(_, wanted)| square(*wanted)).sum();
        (whole > 0.0).then(|| (difference / whole).sqrt())
    };
    search.fits.iter().filter_map(move |fit| Some(Fit { search, fit, name: name(fit), error: error(fit)? }))
}

/// The answer of a study in a few sentences: its own, else what its searches found.
pub(super) fn found(output: &ScriptOutput, estimates: &[Estimate]) -> Option<String> {
    if let Some(answer) = &output.answer {
        return Some(answer.clone());
    }
    let next: Vec<_> = output.findings.iter().filter(|own| own.code == "measure-next").collect();
    // A script with several calibrations has as many: none of them is its answer.
    let next = if let [one] = next[..] { Some(format!("{}.", capital(&one.message))) } else { None };
    let answers = [met(&fits(output)), known(estimates)].into_iter().flatten();
    let sentences: Vec<String> = answers.chain(next).collect();
    (!sentences.is_empty()).then(|| sentences.join(" "))
}

/// The first paragraph of the script's description, at most its first sentence: its lines end where the page is narrow.
pub(super) fn described(script: &str) -> String {
    let lines = script.lines().skip_while(|line| !line.starts_with("//!")).map_while(|line| line.strip_prefix("//!"));
    let words: Vec<&str> = lines.map(str::trim).take_while(|line| !line.is_empty()).collect();
    let text = words.join(" ");
    text.split_once(". ").map_or(text.clone(), |(first, _)| format!("{first}."))
}

/// How far the identified curves are from those measured.
fn met(fits: &[Fit]) -> Option<String> {
    let worst = fits.iter().max_by(|a, b| a.error.total_cmp(&b.error))?;
    let best = fits.iter().min_by(|a, b| a.error.total_cmp(&b.error))?;
    let is_virtual = fits.iter().all(|fit| fit.search.is_virtual);
    let from = if is_virtual { "virtual recordings" } else { "those measured" };
    let [low, high] = [best, worst].map(|fit| digits(100.0 * fit.error));
    Some(match fits {
        [one] => format!("The identified curve of {} differs from {} by {high} %.", one.name, from_one(is_virtual)),
        _ => format!(
            "The {} identified curves differ from {from} by {low} to {high} %; {} is worst.",
            fits.len(),
            worst.name
        ),
    })
}

fn from_one(is_virtual: bool) -> &'static str {
    if is_virtual { "the virtual recording" } else { "the one measured" }
}

/// How the basis of the intervals of a calibration without a posterior begins.
const LINEAR: &str = "linear model";

/// The parameters and how well they are known.
fn known(estimates: &[Estimate]) -> Option<String> {
    let is_sure = |one: &&Estimate| one.doubt.is_none();
    let open = estimates.iter().filter(is_sure).filter(|one| one.half_width().is_none());
    let open: Vec<String> = open.map(Estimate::name).collect();
    let share =
        |one: &'_ Estimate| one.half_width().map(|half| half / one.value.abs()).filter(|share| share.is_finite());
    let mut shares: Vec<(f64, &Estimate)> =
        estimates.iter().filter(is_sure).filter_map(|one| Some((share(one)?, one))).collect();
    let width = |share: f64| digits(100.0 * share);
    let closed = if shares.len() <= MOST_NAMED {
        let known =
            |(share, one): &(f64, &Estimate)| format!("{} {} (±{} %)", one.name(), one.shown(one.value), width(*share));
        let known: Vec<String> = shares.iter().map(known).collect();
        (!known.is_empty()).then(|| format!("Identified: {}.", known.join(", ")))
    } else {
        shares.sort_by(|a, b| a.0.total_cmp(&b.0));
        let [best, worst] = [&shares[0], &shares[shares.len() - 1]];
        let least = worst.1.name();
        Some(format!("Parameters are known to ±{} to ±{} %, least of all {least}.", width(best.0), width(worst.0)))
    };
    let is_linear = |(_, one): &(f64, &Estimate)| one.basis.as_deref().is_some_and(|own| own.starts_with(LINEAR));
    let linear = shares.iter().any(is_linear).then(|| {
        "The intervals are those of a linear model, too narrow where the law is off: sample the posterior.".to_owned()
    });
    let open = (!open.is_empty()).then(|| format!("Without a bound: {}.", open.join(", ")));
    // What a calibration doubts has no width in the answer.
    let doubts = group::by_key(estimates.iter().filter_map(|one| Some((one.doubt.as_deref()?, one.name()))));
    let doubts = doubts.into_iter().map(|(doubt, names)| {
        // Once, of several calibrations.
        let names = group::unique(names);
        let verb = if names.len() == 1 { "is" } else { "are" };
        format!("{} {verb} {doubt}.", names.join(" and "))
    });
    let sentences: Vec<String> = [closed, linear, open].into_iter().flatten().chain(doubts).collect();
    (!sentences.is_empty()).then(|| sentences.join(" "))
}

/// Identified curves over those measured, small and side by side (HTML).
pub(super) fn curves(output: &ScriptOutput) -> String {
    let plot = |fit: &Fit| {
        let plot = script_output::best_fit(fit.search, fit.fit, "identified");
        Plot { title: format!("{}: {} % apart", fit.name, digits(100.0 * fit.error)), ..plot }
    };
    let plots: Vec<Plot> = fits(output).iter().take(MOST_FITS).map(plot).collect();
    drawn::small(&thinned(plots, MOST_POINTS))
}

/// Parameters with their intervals, and what they are compared with (HTML): an axis a parameter.
pub(super) fn parameters(estimates: &[Estimate]) -> String {
    let of = |(_, own): (&str, Vec<&Estimate>)| {
        let is_alone = own.iter().all(|one| one.test.is_none());
        let lines: Vec<Line> = own.iter().map(|one| line(one, is_alone)).collect();
        let heading = if is_alone { String::new() } else { own[0].title() };
        ranges(&heading, RangeLook::Dots, &lines)
    };
    let of_parameters = group::by_key(estimates.iter().map(|one| (one.parameter.as_str(), one)));
    let blocks: String = of_parameters.into_iter().map(of).collect();
    let marks = estimates.iter().find_map(|one| one.mark.as_ref()).map(|(_, what)| format!("; diamonds: {what}"));
    let basis = estimates.iter().find_map(|one| one.basis.as_ref());
    let basis = basis.map(|basis| format!(", by the {basis}")).unwrap_or_default();
    let note = format!("Dots with their intervals of 95 %{basis}{}.", marks.unwrap_or_default());
    html::blocks(&blocks, &note)
}

fn line(one: &Estimate, is_alone: bool) -> Line {
    let shown = |value: f64| one.shown(value);
    let [low, high] = one.interval.map(|end| end.map_or_else(|| "open".into(), shown));
    let mark = one.mark.map(|(value, what)| (value, format!("{what} {}", digits(value))));
    let compared = mark.as_ref().map_or_else(String::new, |(_, words)| format!("; {words}"));
    let words = if is_alone { one.title() } else { one.test.clone().unwrap_or_default() };
    Line {
        words,
        title: one.parameter.clone(),
        value: Some(one.value),
        interval: Some([one.interval[0].unwrap_or(one.value), one.interval[1].unwrap_or(one.value)]),
        mark,
        text: format!("{} ({low} to {high}){compared}", shown(one.value)),
    }
}

/// The first figures that the script measured, large (HTML), each with the sentence that the `script` gives of it. The ends of an
/// interval stand beside their figure, or in its place where there is none, with the sentence of the low end.
pub(super) fn cards(measures: &Row, script: &str) -> String {
    let number = |name: &str| measures.get(name).and_then(Value::as_f64);
    let ends = |name: &str| Some((number(&beside(name, "low"))?, number(&beside(name, "high"))?));
    let of_end =
        |name: &str, end: &str| name.contains(end).then(|| name.replacen(end, "", 1)).filter(|of| ends(of).is_some());
    let card = |name: &String| {
        let range = of_end(name, "_low").filter(|of| !measures.contains_key(of));
        let is_end = ["_low", "_high"].iter().any(|end| of_end(name, end).is_some());
        if is_end && range.is_none() {
            return None;
        }
        let name = range.as_ref().unwrap_or(name);
        let interval = ends(name).map(|(low, high)| {
            let reading = Reading::of_name(name, number(name).unwrap_or(high)).1;
            reading.with_unit(&format!("{} to {}", reading.digits(low), reading.digits(high)))
        });
        let told = if interval.is_some() { &beside(name, "low") } else { name };
        let (shown, interval) = match (measures.get(name), interval) {
            (Some(Value::Number(number)), interval) => (figure(name, number.as_f64()?), interval),
            (Some(Value::Bool(yes)), interval) => (if *yes { "yes" } else { "no" }.into(), interval),
            (None, Some(interval)) => (interval, None),
            _ => return None,
        };
        let beside: Vec<&str> = interval.as_deref().into_iter().chain(figure_sentence(script, told)).collect();
        let (words, value) = (escape(&Reading::of_name(name, 0.0).0), &escape(&kept_together(&shown)));
        Some(Card { title: name, words, value, beside: &beside.join(": "), ..Card::default() }.html())
    };
    let cards: String = measures.keys().filter_map(card).take(MOST_CARDS).collect();
    html::cards(&cards)
}

/// The name of the figure's `end`, which stands before its unit: `mass_low_kg` of `mass_kg`.
fn beside(name: &str, end: &str) -> String {
    let unit = Unit::of_name(name).map_or(0, |(stem, _)| name.len() - stem.len());
    let (stem, unit) = name.split_at(name.len() - unit);
    format!("{stem}_{end}{unit}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::finding::Finding;

    #[test]
    fn the_ends_of_an_interval_stand_beside_their_figure() {
        let measures = serde_json::json!({
            "failure_mass_low_kg": 0.05, "failure_mass_kg": 0.06, "failure_mass_high_kg": 0.07, "share_low": 0.1, "share": 0.2,
            "lowest_m": 1, "span_low_kg": 0.02, "span_high_kg": 0.04,
        });
        let script = "//! figure failure_mass_low_kg  95 % interval.\n//! figure span_low_kg  One change a time.\n//! figure share  Of all.\n";
        let html = cards(measures.as_object().expect("figures"), script);
        assert_eq!(html.matches("<li>").count(), 5, "{html}");
        assert!(html.contains("60\u{a0}g</span><span class=\"beside\">50 to 70 g: 95 % interval.</span>"), "{html}");
        let share = "20\u{a0}%</span><span class=\"beside\">Of all.</span></li>";
        assert!(html.contains(share) && html.contains("lowest"), "an open end is no interval: {html}");
        assert!(html.contains("20 to 40\u{a0}g</span><span class=\"beside\">One change a time.</span>"), "{html}");
    }

    #[test]
    fn a_description_is_a_sentence_and_not_a_line() {
        for (script, expected) in [
            (
                "//! Mass at which the film breaks or\n//! holds. More of it.\n//!\n//! --arg a=1  b\n",
                "Mass at which the film breaks or holds.",
            ),
            ("//! One line\n//!\n//! more\nlet a = 1;", "One line"),
            ("// a comment\nlet a = 1;", ""),
        ] {
            assert_eq!(described(script), expected);
        }
    }

    /// What a calibration doubts has no width in the answer, and what to measure next is its last sentence.
    #[test]
    fn doubts_stand_in_the_answer() {
        let one = |parameter: &str, doubt: Option<&str>| Estimate {
            test: None,
            parameter: parameter.into(),
            value: 2.0,
            interval: [Some(1.9), Some(2.1)],
            mark: None,
            basis: None,
            doubt: doubt.map(str::to_owned),
        };
        let output = ScriptOutput {
            findings: vec![Finding::of_script("measure-next", "measure light next: it narrows ky")],
            ..ScriptOutput::default()
        };
        let mesh = Some("limited by the mesh");
        let all = [one("k1", None), one("ke", mesh), one("ky", mesh), one("kb", Some("at its upper bound"))];
        let doubts = "ke and ky are limited by the mesh. kb is at its upper bound.";
        let whole = format!("Identified: k1 2 (±5 %). {doubts} Measure light next: it narrows ky.");
        assert_eq!(found(&output, &all), Some(whole));
        let of = |basis: &str| Estimate { basis: Some(basis.into()), ..all[0].clone() };
        let answer = |basis| found(&ScriptOutput::default(), &[of(basis)]).expect("an answer");
        assert!(answer("linear model at the best point").ends_with(
            "k1 2 (±5 %). The intervals are those of a linear \
            model, too narrow where the law is off: sample the posterior."
        ));
        assert_eq!(answer("posterior"), "Identified: k1 2 (±5 %).");
        // Of two calibrations that doubt the same.
        let output = ScriptOutput { findings: [&output.findings[..]; 2].concat(), ..ScriptOutput::default() };
        let twice = found(&output, &[&all[1..], &all[1..]].concat()).expect("an answer");
        assert_eq!(twice, doubts);
    }
}
