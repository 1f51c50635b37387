//! Screening, indices and surrogate models in scripts.

use rhai::Dynamic;
use serde_json::{Value, json};
use uncertainty::design::{self, Levels, Method};
use uncertainty::distribution::Family as Distributed;
use uncertainty::indices::{self as sobol, FactorIndices};
use uncertainty::screening::{self as morris, Effects};
use uncertainty::statistics::{Bootstrap, Estimate};
use uncertainty::surrogate::{Family, Options as Fit, Surrogate};

use super::common::{Host, keys, reduced, sweep_at, whole};
use crate::scenario_functions::Study;
use crate::script::{Entry, HostResult, Options};
use crate::sweep::Warning;
use base::finding::Finding;
use scene::model::{Factor, Values};

/// Levels of a screening, of each input.
const LEVELS: usize = 8;

/// Blocks of runs from which indices are found where none are given.
const BLOCKS: usize = 64;

/// `screening(scenario, #{ … })`.
pub(super) fn screening(study: &Study, options: &Options<'_>, host: &Host<'_>) -> HostResult<Dynamic> {
    options.check(&["vary", "trajectories", "seed", "figures"])?;
    let count = whole(options, "trajectories", 10)?;
    let seed = whole(options, "seed", 1)? as u64;
    let places = |factors| morris::trajectories(factors, count, LEVELS, seed).map_err(|error| error.to_string());
    let (sweep, points) = sweep_at(study, options, &places)?;
    let of_factor =
        |Effects { mean, mean_magnitude: Estimate { value, interval }, deviation, missing, .. }: Effects| {
            let interval = interval.map(|interval| [interval.low, interval.high]);
            json!({ "mu_star": value, "interval": interval, "mu": mean, "sigma": deviation, "missing": missing })
        };
    reduced(&sweep, options, host, |_, outputs| {
        let effects = morris::effects(&points, outputs, &Bootstrap::default()).map_err(|error| error.to_string())?;
        let effects = effects.into_iter().map(|effects| effects.map_or(Value::Null, of_factor));
        Ok(keys(&sweep).zip(effects).collect())
    })
}

/// `indices(scenario, #{ … })`.
pub(super) fn indices(study: &Study, options: &Options<'_>, host: &Host<'_>) -> HostResult<Dynamic> {
    options.check(&["vary", "blocks", "seed", "figures"])?;
    let blocks = whole(options, "blocks", BLOCKS)?;
    let seed = whole(options, "seed", 1)? as u64;
    let places = |factors| sobol::rows(factors, blocks, seed).map_err(|error| error.to_string());
    let (sweep, _) = sweep_at(study, options, &places)?;
    let estimate = |Estimate { value, interval }: Estimate| json!({ "value": value, "interval": interval.map(|interval| [interval.low, interval.high]) });
    let of_factor = |FactorIndices { first, total, missing, .. }: FactorIndices| json!({ "first": estimate(first), "total": estimate(total), "missing": missing });
    let factors = sweep.variation().factors.len();
    reduced(&sweep, options, host, |figure, outputs| {
        let found = sobol::indices(factors, outputs, &Bootstrap::default()).map_err(|error| error.to_string())?;
        host.session.report(open(figure, keys(&sweep), &found, blocks).iter().map(Finding::new));
        Ok(keys(&sweep).zip(found.into_iter().map(of_factor)).collect())
    })
}

/// The finding of indices whose widest interval leaves them open; no interval is wider than any.
fn open(figure: &str, keys: impl Iterator<Item = String>, found: &[FactorIndices], blocks: usize) -> Option<Warning> {
    /// Largest width that needs no word.
    const WIDTH: f64 = 0.2;
    let width = |estimate: &Estimate| estimate.interval.map_or(f64::INFINITY, |interval| interval.high - interval.low);
    let widths = found.iter().map(|factor| width(&factor.first).max(width(&factor.total)));
    let (key, width) = keys.zip(widths).max_by(|one, other| one.1.total_cmp(&other.1))?;
    let width_if_any = Some(width).filter(|width| width.is_finite());
    (width > WIDTH).then(|| Warning::OpenIndices { figure: figure.to_owned(), key, width: width_if_any, blocks })
}

/// `surrogate(scenario, #{ … })`.
pub(super) fn surrogate(study: &Study, options: &Options<'_>, host: &Host<'_>) -> HostResult<Dynamic> {
    options.check(&["vary", "samples", "seed", "figures"])?;
    let samples = whole(options, "samples", 128)?;
    let seed = whole(options, "seed", 1)? as u64;
    let places = |factors| {
        design::points(Method::Sobol, &vec![Levels::Continuous; factors], samples, seed)
            .map_err(|error| error.to_string())
    };
    let (sweep, points) = sweep_at(study, options, &places)?;
    let families: Vec<Family> = sweep.variation().factors.iter().map(family).collect();
    let of_keys = |values: Option<Vec<f64>>| -> Value { keys(&sweep).zip(values.into_iter().flatten()).collect() };
    reduced(&sweep, options, host, |_, outputs| {
        let fit = Surrogate::fit(&families, &points, outputs, &Fit::default()).map_err(|error| error.to_string())?;
        Ok(json!({
            "q2": fit.q2(), "degree": fit.degree(), "terms": fit.terms(), "mean": fit.mean(), "deviation": fit.variance().sqrt(),
            "first": of_keys(fit.first()), "total": of_keys(fit.total()),
        }))
    })
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
pub(super) const ENTRIES: &[Entry] = &[
    Entry {
        call: "screening(scenario, #{ trajectories, figures, vary, seed })",
        gives: "elementary effects (Morris) by figure and key: `mu_star` with its `interval`, `mu`, `sigma`, `missing`; \
                trajectories × (keys + 1) runs, 10 trajectories where none are given",
        example: "screening(scenario(args.scenario).with(#{ \"loading.impact.duration\": \"1 ms\", \"specimen.mesh.size\": \"80 mm\", post: (), reference: () }), \
                  #{ trajectories: 2, figures: [\"peak_displacement_m\"], vary: #{ \"loading.impact.velocity\": #{ uniform: [4.0, 4.2] } } }).peak_displacement_m[\"loading.impact.velocity\"].mu < 0",
    },
    Entry {
        call: "indices(scenario, #{ blocks, figures, vary, seed })",
        gives: "Sobol' indices by figure and key: `first` and `total`, each with `value` and `interval`, and `missing`; \
                blocks × (keys + 2) runs, 64 blocks where none are given",
        example: "indices(scenario(args.scenario).with(#{ \"loading.impact.duration\": \"1 ms\", \"specimen.mesh.size\": \"80 mm\", post: (), reference: () }), \
                  #{ blocks: 8, figures: [\"peak_displacement_m\"], vary: #{ \"loading.impact.velocity\": #{ uniform: [4.0, 4.2] } } }).peak_displacement_m[\"loading.impact.velocity\"].total.value > 0.9",
    },
    Entry {
        call: "surrogate(scenario, #{ samples, figures, vary, seed })",
        gives: "a polynomial chaos of every figure from so many runs (128 where none are given): `q2`, the share of the variance \
                of runs left out that it predicts; `mean`, `deviation`, and by key `first` and `total`, the Sobol' indices",
        example: "surrogate(scenario(args.scenario).with(#{ \"loading.impact.duration\": \"1 ms\", \"specimen.mesh.size\": \"80 mm\", post: (), reference: () }), \
                  #{ samples: 16, figures: [\"peak_displacement_m\"], vary: #{ \"loading.impact.velocity\": #{ uniform: [4.0, 4.2] } } }).peak_displacement_m.q2 > 0.99",
    },
];

#[cfg(test)]
mod tests {
    use super::*;
    use uncertainty::statistics::Interval;

    fn warning(found: &[FactorIndices], blocks: usize) -> Option<Warning> {
        open("peak", ["x", "y"].map(String::from).into_iter(), found, blocks)
    }

    /// x + 2y: of few blocks, and of as many as there are where none are given, the indices are open; of many they are not.
    #[test]
    fn many_blocks_close_indices() {
        let found = |blocks: usize| {
            let rows = sobol::rows(2, blocks, 1).expect("rows");
            let outputs: Vec<Option<f64>> = rows.iter().map(|row| Some(row[0] + 2.0 * row[1])).collect();
            let found = sobol::indices(2, &outputs, &Bootstrap::default()).expect("indices");
            warning(&found, blocks)
        };
        for blocks in [8, BLOCKS] {
            let Some(Warning::OpenIndices { figure, key, width: Some(width), blocks: said }) = found(blocks) else {
                panic!("{blocks} blocks")
            };
            assert_eq!((&figure[..], &key[..], said), ("peak", "y", blocks));
            println!("{blocks} blocks: {width}");
            assert!(width > 0.2 && width < 3.0);
        }
        assert_eq!(found(4096), None);
    }

    /// Where least is known: a resample of two blocks, one of which has the same output everywhere, has no variance to share.
    #[test]
    fn an_index_without_an_interval_is_open() {
        let outputs = [1.0, 1.0, 1.0, 1.0, 3.0, 1.0, 1.0, 3.0].map(Some);
        let found = sobol::indices(2, &outputs, &Bootstrap::default()).expect("indices");
        assert!(found.iter().all(|factor| factor.first.interval.is_none() && factor.total.interval.is_none()));
        let narrow = |value: f64| Estimate { value, interval: Some(Interval { low: value, high: value }) };
        let mut half = found.clone();
        (half[1].first, half[1].total) = (narrow(0.5), narrow(0.5));
        for (found, key) in [(&found, "y"), (&half, "x")] {
            let warning = warning(found, 2).expect("a finding");
            let Warning::OpenIndices { key: of, width: None, blocks: 2, .. } = &warning else { panic!("{warning:?}") };
            assert_eq!(of, key);
            assert!(warning.to_string().contains("has no interval after 2 blocks"), "{warning}");
        }
    }
}
