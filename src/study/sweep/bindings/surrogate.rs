//! Surrogate models in scripts.

use rhai::Dynamic;
use serde_json::{Value, json};
use uncertainty::design::{self, Levels, Method};
use uncertainty::distribution::Family as Distributed;
use uncertainty::surrogate::{Family, Options as Fit, Surrogate};

use super::common::{Host, refused, varied, whole};
use crate::scenario_functions::Study;
use crate::script::{Entry, HostResult, Options, from_json, refuse};
use crate::sweep::{Sweep, SweepError};
use scene::model::{self, Factor, Values};

/// `surrogate(scenario, #{ … })`.
pub(super) fn surrogate(study: &Study, options: &Options<'_>, host: &Host<'_>) -> HostResult<Dynamic> {
    options.check(&["vary", "samples", "seed", "figures"])?;
    let samples = whole(options, "samples", 128)?;
    let seed = whole(options, "seed", 1)? as u64;
    let asked = options.map.get("figures").cloned().map(Dynamic::into_typed_array::<String>).transpose();
    let asked = asked.map_err(|found| refuse(format!("expected a list of names as figures, found {found}")))?;
    let document = varied(study, options)?;
    let variation = model::variation(&document).map_err(|mistakes| refused(SweepError::Scenario(mistakes)))?;
    let factors = variation.ok_or_else(|| refused(SweepError::NothingVaries))?.factors;
    let axes = vec![Levels::Continuous; factors.len()];
    let points = design::points(Method::Sobol, &axes, samples, seed).map_err(refuse)?;
    let sweep = Sweep::prepare_at(&document, &points).map_err(refused)?;
    let results = host.results(&sweep)?;
    let families: Vec<Family> = factors.iter().map(family).collect();
    let of_keys = |values: Option<Vec<f64>>| -> Value {
        factors.iter().map(|factor| factor.path.clone()).zip(values.into_iter().flatten()).collect()
    };
    let varying = || results.effects.iter().map(|effects| effects.figure.clone()).collect();
    let mut found = serde_json::Map::new();
    for name in asked.unwrap_or_else(varying) {
        let column = results.table.column(&name);
        let column = column.ok_or_else(|| refuse(format!("the runs have no figure `{name}`")))?;
        let fit = Surrogate::fit(&families, &points, &column.values.numbers(), &Fit::default());
        let fit = fit.map_err(|error| refuse(format!("{name}: {error}")))?;
        let figures = json!({
            "q2": fit.q2(), "degree": fit.degree(), "terms": fit.terms(), "mean": fit.mean(), "deviation": fit.variance().sqrt(),
            "first": of_keys(fit.first()), "total": of_keys(fit.total()),
        });
        found.insert(name, figures);
    }
    Ok(from_json(&Value::Object(found)))
}

/// Polynomials that suit the distribution of a key.
fn family(factor: &Factor) -> Family {
    let Values::Distribution(distribution) = &factor.values else { return Family::Legendre };
    let is_whole = distribution.ends() == (None, None);
    match distribution.family() {
        Distributed::Normal { .. } | Distributed::LogNormal { .. } if is_whole => Family::Hermite,
        _ => Family::Legendre,
    }
}

/// The reference of sensitivities in scripts.
pub(super) const ENTRIES: &[Entry] = &[Entry {
    call: "surrogate(scenario, #{ samples, figures, vary, seed })",
    gives: "a polynomial chaos of every figure from so many runs (128 where none are given): `q2`, the share of the variance \
                of runs left out that it predicts; `mean`, `deviation`, and by key `first` and `total`, the Sobol' indices",
    example: "surrogate(scenario(args.scenario).with(#{ \"loading.impact.duration\": \"1 ms\", \"specimen.mesh.size\": \"80 mm\", post: (), reference: () }), \
                  #{ samples: 16, figures: [\"peak_displacement_m\"], vary: #{ \"loading.impact.velocity\": #{ uniform: [4.0, 4.2] } } }).peak_displacement_m.q2 > 0.99",
}];
