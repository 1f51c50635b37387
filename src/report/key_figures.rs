//! The key figures at the top of a page.

use serde_json::{Map, Value};

use super::figure::DIGITS;
use super::html::escape;
use base::number::{self, duration, significant};
use scene::model::Model;
use study::post::{
    BodyFigures, HEADLINES, Headline, LEAST_SHARE, Measures, Results, TestKind, descends, headlines_of, is_too_coarse,
    reached,
};

/// Of a drop that was recorded: of a run it is an input.
const IMPACT_SPEED: Headline = Headline {
    test: None,
    name: "impact_velocity_m_s",
    words: "impact speed",
    factor: 1.0,
    unit: "m/s",
    at: None,
    judges: false,
};

/// Cards of the figures of a drop that was recorded; empty where there are none.
pub(super) fn of_drop(figures: &Map<String, Value>) -> String {
    let all = std::iter::once(&IMPACT_SPEED).chain(TestKind::Impact.headlines());
    let cards: String = all.filter_map(|headline| card(headline, headline.words, "", figures)).collect();
    if cards.is_empty() { cards } else { format!("<ul class=\"cards\">\n{cards}</ul>\n") }
}

/// Cards of the key figures in `summary`, that of `results`, and whether the film held; the run has `failed` or not.
pub(super) fn cards(model: &Model, results: &Results, failed: bool, summary: &Map<String, Value>) -> String {
    let bodies: &[BodyFigures] = match &results.measures {
        Measures::Impact(impact) => &impact.bodies,
        _ => &[],
    };
    let named = bodies.iter().map(|body| body.prefix.as_str()).filter(|prefix| !prefix.is_empty());
    let own = named.chain([""]).flat_map(|prefix| {
        let words = |headline: &Headline| headline.words_of(descends(results, prefix));
        let card = |headline: &'static Headline| card(headline, words(headline), prefix, summary);
        headlines_of(model, results, prefix).filter_map(card).collect::<Vec<_>>()
    });
    let is_shown = |headline: &&Headline| headline.test.is_none() && !(headline.name == TORN && holds(summary));
    let others = HEADLINES.iter().filter(is_shown).filter_map(|headline| card(headline, headline.words, "", summary));
    let unmet = bodies.iter().filter(|body| !body.had_film_contact && !failed).map(|body| not_met(&body.prefix));
    let cards: String = own.chain(others).chain(unmet).collect();
    let film = film(summary, failed, is_too_coarse(results));
    // A film that ruptured is what a reader asks for first.
    let [first, last] =
        if summary.contains_key(RUPTURE) && !summary[RUPTURE].is_null() { [&film, &cards] } else { [&cards, &film] };
    format!("<ul class=\"cards\">\n{first}{last}</ul>\n")
}

/// When film first broke.
const RUPTURE: &str = "rupture_time_s";

/// Of film that tears: how far, which may be short of its end.
const TORN: &str = "torn_length_m";

/// Whether no film is torn.
fn holds(summary: &Map<String, Value>) -> bool {
    summary.get(TORN).and_then(Value::as_f64).is_none_or(|length| length == 0.0)
}

/// The card of an impactor that never met the film; `prefix` begins the names of its figures.
fn not_met(prefix: &str) -> String {
    let whose = owner(prefix);
    format!("<li><span class=\"words\">{whose}contact with the film</span><span class=\"value\">none</span></li>\n")
}

/// Whose figures have names that begin with `prefix`, before their words; empty of a single impactor.
fn owner(prefix: &str) -> String {
    prefix.strip_suffix('_').map_or_else(String::new, |body| format!("{}: ", escape(body)))
}

/// The card of a figure whose name begins with `prefix`, where the summary has it.
fn card(headline: &Headline, words: &str, prefix: &str, summary: &Map<String, Value>) -> Option<String> {
    let Headline { name, factor, unit, at, .. } = headline;
    let number = |name: &str| summary.get(&format!("{prefix}{name}"))?.as_f64();
    let value = number(name)?;
    let whose = owner(prefix);
    // A letter behind `_` is a subscript.
    let words = words.split_once('_').map_or(words.into(), |(before, index)| format!("{before}<sub>{index}</sub>"));
    let beside = at.and_then(|at| Some(reached(at, number(at)?)));
    let shown = if *unit == "%" && (value * factor).abs() < LEAST_SHARE {
        format!("&lt; {LEAST_SHARE}")
    } else {
        number_of(value * factor)
    };
    let beside = beside.map_or(String::new(), |beside| format!("<span class=\"beside\">{}</span>", escape(&beside)));
    Some(format!(
        "<li data-figure=\"{prefix}{name}\" data-value=\"{value}\" data-factor=\"{factor}\">\
         <span class=\"words\">{whose}{words}</span><span class=\"value\">{shown}</span> <span class=\"unit\">{unit}</span>{beside}</li>\n"
    ))
}

/// Four significant digits, as short as they can be written.
fn number_of(value: f64) -> String {
    let small = value != 0.0 && value.abs() < 1e-3;
    let text = if small { number::figure(value, DIGITS) } else { significant(value, DIGITS) };
    text.replace('-', "\u{2212}")
}

/// Whether the film ruptured, and when; of a failed run, that it held until then.
fn film(summary: &Map<String, Value>, failed: bool, is_coarse: bool) -> String {
    let rupture = summary.get(RUPTURE).and_then(Value::as_f64);
    let (shown, beside) = match rupture {
        Some(time) => ("ruptured", format!("<span class=\"beside\">at {}</span>", duration(time))),
        None if failed => ("held", "<span class=\"beside\">until the run failed</span>".into()),
        None if is_coarse => ("not told", "<span class=\"beside\">elements too coarse</span>".into()),
        None => ("held", String::new()),
    };
    format!("<li><span class=\"words\">film</span><span class=\"value\">{shown}</span>{beside}</li>\n")
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn a_card_shows_the_figure_in_its_unit_and_names_it_in_full() {
        let summary = json!({ "peak_displacement_m": -0.169854473, "time_of_peak_displacement_s": 0.0573 });
        let [peak, lowest] = [0, 1].map(|at| &HEADLINES[at]);
        let html = card(lowest, lowest.words, "", summary.as_object().unwrap()).unwrap();
        assert!(html.contains("data-figure=\"peak_displacement_m\" data-value=\"-0.169854473\" data-factor=\"1000\""));
        assert!(html.contains("\u{2212}169.9</span> <span class=\"unit\">mm") && html.contains("at 57.3 ms"), "{html}");
        assert_eq!(card(peak, peak.words, "", &Map::new()), None);
    }

    #[test]
    fn the_film_of_a_failed_run_held_until_it_failed() {
        let whole = film(&Map::new(), false, false);
        assert!(whole.contains("held") && !whole.contains("run failed"));
        assert!(film(&Map::new(), true, false).contains("until the run failed"));
        assert!(film(&Map::new(), false, true).contains("too coarse"));
        let ruptured = json!({ "rupture_time_s": 0.04 });
        assert!(
            film(ruptured.as_object().unwrap(), true, true)
                .contains("ruptured</span><span class=\"beside\">at 40.0 ms")
        );
    }

    #[test]
    fn numbers_are_short() {
        for (value, expected) in [(1.37e-9, "1.370e-9"), (0.0, "0"), (15.1, "15.1"), (-0.02091, "-0.02091")] {
            assert_eq!(number_of(value), expected.replace('-', "\u{2212}"));
        }
    }
}
