//! `[variation]`: the keys that vary from run to run of a sweep, and how their values are chosen.

use std::path::PathBuf;

use super::grammar::{self, Bound, Key, Range, Rule, TableRule};
use super::schema;
use super::tree::{Entry, Node, Table, Value};
use base::diagnostic::{Diagnostic, Span, closest};
use base::units::{Temperature, TemperatureDifference};

keys! {
    /// Keys that vary from run to run of `droptower sweep`, each under its path in quotes (`"impactor.mass"`): a list of values,
    /// `{ range = ["1 m", "2 m"], count = 5 }`, or a distribution: `{ uniform = [low, high] }`,
    /// `{ normal = { mean = …, deviation = … } }`, `{ lognormal = { mean = …, deviation = … } }` or
    /// `{ weibull = { scale = …, shape = … } }`, each with or without `truncate = { low = …, high = … }`.
    #[schemars(extend("x-varied" = true))]
    pub struct Variation {
        /// Number of runs of a Latin hypercube, a Sobol' sequence or random points; `-n` replaces it.
        samples: Option<u32>, from 1, to 10_000_000;
        /// How the values of the runs are chosen; where it is left out, a grid if every key has a list or a range, else a
        /// Sobol' sequence.
        method: Option<Method>;
        /// The same seed gives the same values.
        seed: u64, default "schema::one::<u64>";
        /// Correlation of keys with distributions (Gaussian copula).
        correlation: Option<Correlation>;
        /// The keys that vary, as written.
        keys: toml::Table, flat, schemars(skip);
    }

    /// How the values of the runs are chosen.
    pub enum Method {
        /// Every combination of the listed values; the last key varies fastest.
        Grid,
        /// Each key once in each of as many parts of equal probability as there are runs.
        LatinHypercube,
        /// A scrambled Sobol' sequence: the first runs of a larger sweep are those of a smaller one.
        Sobol,
        /// Independent random values; the first runs of a larger sweep are those of a smaller one.
        Random,
        /// A CSV file with a column for each key that varies and a row for each run: a column is called by the key, with or
        /// without its unit behind (`impactor.mass_kg`), as in the `table.csv` of a sweep.
        Table(#[schemars(extend("x-path" = true))] PathBuf),
    }

    /// Correlation of keys.
    pub struct Correlation {
        /// The keys, each with a distribution.
        keys: Vec<String>, least 2;
        /// The coefficients of correlation of the underlying normal distributions, a row for each key: symmetric, positive
        /// definite, with ones on its diagonal.
        matrix: Vec<Vec<f64>>, least 2, schemars(inner(length(min = 2), inner(range(min = -1, max = 1))));
    }
}

/// A key that varies, as written.
#[derive(Clone, Debug)]
pub struct VariedKey {
    /// Path of the key.
    pub path: String,
    /// Where the path stands.
    pub span: Span,
    /// Its list, range or distribution.
    pub node: Node,
}

/// Names of the kinds of values that a table under a key chooses from.
const KINDS: [&str; 5] = ["range", "uniform", "normal", "lognormal", "weibull"];

/// The entries of the table `[variation]` that name keys of the scenario: a path in quotes, or tables in one another.
pub(super) fn varied_keys(table: &Table, rule: &TableRule) -> Vec<VariedKey> {
    let others = table.entries.iter().filter(|entry| rule.key(&entry.key).is_none());
    let mut found = Vec::new();
    others.for_each(|entry| gather(&entry.key, entry, &mut found));
    found
}

fn gather(path: &str, entry: &Entry, found: &mut Vec<VariedKey>) {
    match &entry.node.value {
        Value::Table(table) if !chooses(table) => {
            table.entries.iter().for_each(|inner| gather(&format!("{path}.{}", inner.key), inner, found));
        }
        _ => {
            let path = path.trim().to_owned();
            found.push(VariedKey { path, span: entry.key_span.clone(), node: entry.node.clone() });
        }
    }
}

/// Whether the table is a range or a distribution, and not a part of a path.
fn chooses(table: &Table) -> bool {
    table.entries.is_empty()
        || table.entries.iter().any(|entry| KINDS.contains(&entry.key.as_str()) || entry.key == "truncate")
}

impl VariedKey {
    /// The rule of the scenario's key at the path.
    ///
    /// # Errors
    /// There is no such key, or it cannot vary.
    pub fn rule(&self) -> Result<&'static Rule, Diagnostic> {
        let mut rule = grammar::scenario();
        for (place, step) in self.path.split('.').enumerate() {
            let refused = |message: String| Diagnostic::new(message).at(&self.span);
            if place == 0 && ["variation", "extends", "unset"].contains(&step) {
                return Err(refused(format!("`{step}` cannot vary")));
            }
            rule = rule.under(step).ok_or_else(|| {
                let mistake = refused(format!("unknown key `{}`", self.path));
                let known = rule.table().into_iter().flat_map(|table| &table.keys);
                if ["mean", "deviation"].contains(&step) {
                    return mistake
                        .hint("mean and deviation are those of a distribution: put them into `normal` or `lognormal`");
                }
                match closest(step, known.map(|key| key.name.as_str())) {
                    Some(name) => mistake.hint(format!("did you mean `{}`?", self.path.replacen(step, name, 1))),
                    None => mistake.hint("`droptower explain` lists the keys of a scenario"),
                }
            })?;
        }
        Ok(rule)
    }

    /// The lists, ranges and distributions that the key may have.
    ///
    /// # Errors
    /// As those of [`VariedKey::rule`].
    pub(super) fn choices(&self) -> Result<Rule, Diagnostic> {
        let rule = self.rule()?;
        let list = Rule::List { item: Box::new(rule.clone()), min_items: 1, max_items: 1_000_000 };
        Ok(match rule.number() {
            Some(number) => Rule::Either(vec![list, Rule::Table(choice(number))]),
            None => list,
        })
    }
}

/// Numbers above zero, such as deviations.
const POSITIVE: Range = Range { from: Some(Bound { value: 0.0, included: false }), to: None, likely: None };

/// The table of a range or a distribution of such a number.
fn choice(number: &Rule) -> TableRule {
    let range = Range {
        from: Some(Bound { value: 2.0, included: true }),
        to: Some(Bound { value: 1e6, included: true }),
        likely: None,
    };
    let mut keys = vec![key("range", pair(number), false), key("count", Rule::Number { whole: true, range }, false)];
    // A whole number has no density.
    if !matches!(number, Rule::Number { whole: true, .. }) {
        keys.extend(distributions(number));
    }
    one_of(keys)
}

/// The table of a distribution of numbers without unit.
pub(crate) fn distribution_rule() -> Rule {
    Rule::Table(one_of(distributions(&Rule::Number { whole: false, range: Range::default() })))
}

/// A table with one kind of values of these keys.
fn one_of(keys: Vec<Key>) -> TableRule {
    let groups = KINDS.iter().filter(|kind| keys.iter().any(|key| key.name == **kind));
    let groups =
        groups.map(|kind| if *kind == "range" { vec!["range".into(), "count".into()] } else { vec![(*kind).into()] });
    TableRule { groups: groups.collect(), keys, group_required: true, ..TableRule::default() }
}

/// The keys of distributions of such a number.
fn distributions(number: &Rule) -> Vec<Key> {
    let positive = match number.dimension() {
        Some(Temperature::DIMENSION) => Rule::Quantity(TemperatureDifference::DIMENSION, POSITIVE),
        _ => within(number, POSITIVE),
    };
    // A limit of a distribution may lie outside of what the key allows.
    let unlimited = within(number, Range::default());
    let moments = [("mean", number), ("deviation", &positive)];
    let shape = Rule::Number { whole: false, range: POSITIVE };
    vec![
        key("uniform", pair(number), false),
        key("normal", table(&moments, true), false),
        key("lognormal", table(&moments, true), false),
        key("weibull", table(&[("scale", &positive), ("shape", &shape)], true), false),
        key("truncate", table(&[("low", &unlimited), ("high", &unlimited)], false), false),
    ]
}

fn pair(number: &Rule) -> Rule {
    Rule::Tuple(vec![number.clone(), number.clone()])
}

fn key(name: &str, rule: Rule, required: bool) -> Key {
    Key { name: name.into(), title: None, sentence: None, default: None, required, rule }
}

fn table(keys: &[(&str, &Rule)], required: bool) -> Rule {
    let keys = keys.iter().map(|(name, rule)| key(name, (*rule).clone(), required));
    Rule::Table(TableRule { keys: keys.collect(), ..TableRule::default() })
}

/// A rule for numbers of this range in the unit of `number`, which need not be whole.
fn within(number: &Rule, range: Range) -> Rule {
    match number {
        Rule::Quantity(dimension, _) => Rule::Quantity(*dimension, range),
        _ => Rule::Number { whole: false, range },
    }
}
