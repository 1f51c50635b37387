//! `sweep` in scripts.

use rhai::Dynamic;
use serde_json::{Value, json};

use super::common::{Host, assignment, refused, varied};
use crate::scenario_functions::Study;
use crate::script::{Entry, HostResult, Options, from_json, to_json};
use crate::sweep::Sweep;
use crate::sweep::table::Table;
use base::table::{Column, Values};
use scene::scenario::Document;

/// `sweep(scenario, #{ … })`.
pub(super) fn sweep(study: &Study, options: &Options<'_>, host: &Host<'_>) -> HostResult<Dynamic> {
    options.check(&["vary", "samples", "seed", "method"])?;
    let sweep = Sweep::prepare(&designed(&varied(study, options)?, options)?, None).map_err(refused)?;
    let results = host.results(&sweep)?;
    let mut summary = results.summary(&sweep, 0.0);
    ["seconds", "engine_s", "scenario", "title", "droptower"].iter().for_each(|name| drop(summary.remove(*name)));
    summary.insert("table".into(), columns(&results.table));
    Ok(from_json(&Value::Object(summary)))
}

/// The scenario with what the options say of the design of its runs.
fn designed(document: &Document, options: &Options<'_>) -> HostResult<Document> {
    let given = ["samples", "seed", "method"].into_iter().filter_map(|name| Some((name, options.map.get(name)?)));
    let change = |(name, value): (&str, &Dynamic)| assignment(&format!("variation.{name}"), &to_json(value)?);
    Ok(document.with(&given.map(change).collect::<HostResult<Vec<_>>>()?))
}

/// The columns of a table by name.
fn columns(table: &Table) -> Value {
    let values = |column: &Column| match &column.values {
        Values::Numbers(values) => json!(values),
        Values::Flags(values) => json!(values),
        Values::Texts(values) => json!(values),
    };
    table.columns.iter().map(|column| (column.name.clone(), values(column))).collect()
}

/// The reference of sweeps in scripts.
pub(super) const ENTRIES: &[Entry] = &[Entry {
    call: "sweep(scenario, #{ vary: #{ \"key.path\": values }, samples, seed, method })",
    gives: "the results of many runs, as `summary.json` of `droptower sweep` has them, and `table`, the columns of inputs \
                and figures; what is left out is that of [variation]. Failed runs are rows with their cause",
    example: "sweep(scenario(args.scenario).with(#{ \"loading.impact.duration\": \"1 ms\", \"specimen.mesh.size\": \"80 mm\", post: (), reference: () }), \
                  #{ vary: #{ \"impactor.mass\": [10, 11] } }).table.run == [1.0, 2.0]",
}];
