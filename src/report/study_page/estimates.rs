//! Parameters that a study estimated, as they stand in its tables.

use serde_json::Value;

use super::super::cell;
use base::written::digits;
use scene::scenario::grammar;
use study::script::{Row, ScriptOutput};

/// Columns of tables of estimates, as `confidence` gives them.
const PARAMETER: &str = "parameter";
const VALUE: &str = "value";
const ENDS: [&str; 2] = ["lower_95", "upper_95"];
const TEST: &str = "test";
const BASIS: &str = "basis";
const MEDIAN: &str = "median";

/// Ends of the names of tables of a calibration.
const PARAMETERS: &str = "parameters";
const POSTERIOR: &str = "posterior";

/// What an estimate is compared with, by the name of its column or the beginning of that of the parameter's.
const MARKS: [&str; 3] = ["truth", "paper", "prior"];

/// An estimated parameter.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Estimate {
    /// The test that it was estimated from, where there are several.
    pub test: Option<String>,
    /// Its name.
    pub parameter: String,
    /// Its value.
    pub value: f64,
    /// The interval of 95 %; an end that is open is none.
    pub interval: [Option<f64>; 2],
    /// A value that it is compared with, and what that is.
    pub mark: Option<(f64, &'static str)>,
    /// What its interval rests on, where the table says so.
    pub basis: Option<String>,
    /// What a calibration says of it in place of its interval; none of one that is determined.
    pub doubt: Option<String>,
}

impl Estimate {
    /// The parameter, by its title where it is a key.
    pub(super) fn title(&self) -> String {
        grammar::title(&self.parameter).unwrap_or_else(|| self.parameter.clone())
    }

    /// The parameter, and its test where there are several.
    pub(super) fn name(&self) -> String {
        match &self.test {
            Some(test) => format!("{} of {test}", self.title()),
            None => self.title(),
        }
    }

    /// A value of the parameter, with as many digits as tell the ends of the interval apart.
    pub(super) fn shown(&self, value: f64) -> String {
        match self.half_width() {
            Some(half) if half > 0.0 && half < 0.05 * self.value.abs() => {
                base::number::figure(value, ((self.value.abs() / half).log10().ceil() as usize + 1).min(9))
                    .replace('-', "\u{2212}")
            }
            _ => digits(value),
        }
    }

    /// Half the width of the interval; none of an open one.
    pub(super) fn half_width(&self) -> Option<f64> {
        let [Some(low), Some(high)] = self.interval else { return None };
        Some(0.5 * (high - low))
    }
}

/// The estimates in the tables of a study.
pub(super) fn estimates(output: &ScriptOutput) -> Vec<Estimate> {
    let rows = || output.tables.iter().flat_map(|(_, rows)| rows);
    // Of a calibration, by the name that its tables begin with: what the posterior says takes the place of the linear model.
    let has_posterior = |table: &str| {
        let begin = table.strip_suffix(PARAMETERS);
        begin.is_some_and(|begin| output.tables.iter().any(|(name, _)| name.strip_suffix(POSTERIOR) == Some(begin)))
    };
    let number = |row: &Row, name: &str| row.get(name).and_then(Value::as_f64);
    // The name of a test may be a number.
    let text = |row: &Row, name: &str| row.get(name).map(cell).filter(|text| !text.is_empty());
    let mark = |row: &Row, parameter: &str, test: &Option<String>| {
        let own = || MARKS.iter().find_map(|mark| Some((number(row, mark)?, *mark)));
        let is_same = |other: &&Row| text(other, TEST) == *test;
        let elsewhere = || {
            MARKS.iter().find_map(|mark| {
                let column = format!("{mark}_{parameter}");
                Some((rows().filter(is_same).find_map(|other| number(other, &column))?, *mark))
            })
        };
        own().or_else(elsewhere)
    };
    let estimate = |(table, row): (&String, &Row)| {
        let is_posterior = table.ends_with(POSTERIOR) && row.get("verdict").is_some_and(|verdict| !verdict.is_null());
        let value = if is_posterior { number(row, MEDIAN)? } else { number(row, VALUE)? };
        let parameter = text(row, PARAMETER)?;
        if has_posterior(table) || !ENDS.iter().any(|end| row.contains_key(*end)) {
            return None;
        }
        let test = text(row, TEST);
        let mark = mark(row, &parameter, &test);
        let basis = if is_posterior { Some("posterior".into()) } else { text(row, BASIS) };
        let doubt = text(row, "verdict").filter(|verdict| verdict != "determined");
        Some(Estimate { doubt, interval: ENDS.map(|end| number(row, end)), test, parameter, value, mark, basis })
    };
    output
        .tables
        .iter()
        .flat_map(|(table, rows)| rows.iter().map(move |row| (table, row)))
        .filter_map(estimate)
        .collect()
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn output(tables: Value) -> ScriptOutput {
        let tables = tables.as_object().unwrap().iter().map(|(name, rows)| {
            let rows = rows.as_array().unwrap().iter().map(|row| row.as_object().unwrap().clone());
            (name.clone(), rows.collect())
        });
        ScriptOutput { tables: tables.collect(), ..ScriptOutput::default() }
    }

    #[test]
    fn estimates_have_the_truth_of_their_test() {
        let found = estimates(&output(json!({
            "confidence": [
                { "test": "a", "parameter": "k1", "value": 2.0, "lower_95": 1.5, "upper_95": 2.5 },
                { "test": 8, "parameter": "k1", "value": 3.0, "lower_95": 2.9, "upper_95": null },
            ],
            "table_8": [{ "test": 8, "paper_k1": 3.1 }, { "test": "a", "paper_k1": 2.1 }],
            "slopes": [{ "parameter": "k1", "value": 2.0, "f": 0.1 }],
        })));
        let [a, b] = &found[..] else { panic!("{found:?}") };
        assert_eq!((a.mark, a.half_width(), a.name().as_str()), (Some((2.1, "paper")), Some(0.5), "k1 of a"));
        assert_eq!((b.mark, b.half_width(), b.name().as_str()), (Some((3.1, "paper")), None, "k1 of 8"));
    }

    /// The posterior of a calibration takes the place of the linear model of the same name, and of no other.
    #[test]
    fn a_posterior_takes_the_place_of_the_linear_model() {
        let linear = |value: f64| json!([{ "parameter": "k1", "value": value, "lower_95": value - 0.1, "upper_95": value + 0.1, "basis": "linear model" }]);
        let found = estimates(&output(json!({
            "a_parameters": linear(2.0), "b_parameters": linear(3.0),
            "a_posterior": [
                { "parameter": "k1", "median": 1.4, "lower_95": 1.3, "upper_95": 1.6, "verdict": "determined" },
                { "parameter": "model error", "median": 0.01, "lower_95": 0.0, "upper_95": 0.02, "verdict": null },
            ],
        })));
        let shown: Vec<_> = found.iter().map(|own| (own.value, own.basis.as_deref())).collect();
        assert!(shown.contains(&(1.4, Some("posterior"))) && shown.contains(&(3.0, Some("linear model"))), "{shown:?}");
        assert_eq!(shown.len(), 2);
    }

    #[test]
    fn a_row_may_have_its_own_truth_and_keys_their_titles() {
        let row = json!({ "parameter": "specimen.material.thickness", "value": 1.2e-5, "lower_95": 1e-5, "upper_95": 1.3e-5, "truth": 1.1e-5 });
        let found = estimates(&output(json!({ "found": [row] })));
        assert_eq!((found[0].mark, found[0].name().as_str()), (Some((1.1e-5, "truth")), "Thickness of one layer"));
    }
}
