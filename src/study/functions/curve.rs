//! Stress–strain curves in scripts.

use rhai::{Array, Dynamic, Engine, EvalAltResult, INT, Map, NativeCallContext};

use crate::script::{Compared, Entry, HostResult, Session, number, refuse, window};
use lab::experiment::coupon::average::{SampleStatistics, mean_curve, mean_law, mean_of_means, relative_difference};
use lab::experiment::coupon::{BREAK_SHARE, Curve, CurveEnd, WINDOW, YieldPoints, relative_residuals, yield_points};

/// Offers the type `curve`, its functions and means to scripts.
pub(super) fn register(engine: &mut Engine) {
    engine.register_type_with_name::<Curve>("curve");
    engine
        .register_fn("curve", build)
        .register_fn("len", |curve: &mut Curve| curve.strain().len() as INT)
        .register_fn("to_string", describe)
        .register_fn("strains", |curve: &mut Curve| list(curve.strain()))
        .register_fn("stresses", |curve: &mut Curve| list(curve.stress()))
        .register_fn("start", |curve: &mut Curve| curve.range()[0])
        .register_fn("end", |curve: &mut Curve| curve.range()[1])
        .register_fn("at", value_at)
        .register_fn("slice", slice)
        .register_fn("resultants", |curve: &mut Curve, thickness: Dynamic| {
            Ok::<_, Box<EvalAltResult>>(list(&curve.resultant(number(&thickness, "the thickness")?)))
        })
        .register_fn("modulus", |curve: &mut Curve| slope(curve, WINDOW))
        .register_fn("modulus", |curve: &mut Curve, window: Dynamic| slope(curve, strains(&window)?))
        .register_fn("toe_compensated", toe_compensated)
        .register_fn("rupture", |curve: &mut Curve| rupture(curve, BREAK_SHARE))
        .register_fn("rupture", |curve: &mut Curve, share: Dynamic| rupture(curve, number(&share, "the share")?))
        .register_fn("yield_points", |curve: &mut Curve| yields(curve, WINDOW))
        .register_fn("yield_points", |curve: &mut Curve, window: Dynamic| yields(curve, strains(&window)?))
        .register_fn("mean_curve", |curves: Array| mean(&curves, mean_curve))
        .register_fn("mean_law", |curves: Array| mean(&curves, mean_law))
        .register_fn("mean_of_means", |groups: Array| mean_of_groups(&groups))
        .register_fn("relative_residuals", |context: NativeCallContext, curve: Curve, reference: Curve| {
            let residuals = relative_residuals(&curve, &reference).map_err(refuse)?;
            Session::from_context(&context).add_comparison(|| Compared::curves(&curve, &reference));
            Ok::<_, Box<EvalAltResult>>(list(&residuals))
        })
        .register_fn("relative_difference", |measured: Dynamic, reference: Dynamic| {
            let reference = number(&reference, "the reference")?;
            Ok::<_, Box<EvalAltResult>>(relative_difference(number(&measured, "a figure")?, reference))
        })
        .register_fn("spread", |figures: Array| {
            let spread = SampleStatistics::from_figures(&numbers(&figures, "a figure")?).map_err(refuse)?;
            Ok::<_, Box<EvalAltResult>>(spread_map(&spread))
        });
}

/// A window of strain `[from, to]`.
pub(super) fn strains(value: &Dynamic) -> HostResult<[f64; 2]> {
    window(value)
}

/// Mean, deviation and count as a map of a script.
pub(super) fn spread_map(spread: &SampleStatistics) -> Map {
    let mut map = Map::new();
    map.insert("mean".into(), spread.mean.into());
    map.insert("deviation".into(), spread.deviation.into());
    map.insert("count".into(), (spread.count as INT).into());
    map
}

/// Yield points as a map of a script.
pub(super) fn yield_map(found: &YieldPoints) -> Map {
    let mut map = Map::new();
    map.insert("first".into(), list(&found.first).into());
    map.insert("second".into(), list(&found.second).into());
    map.insert("slopes".into(), list(&found.slopes).into());
    map.insert("residual".into(), found.residual.into());
    map
}

/// The numbers as a list.
pub(super) fn list(values: &[f64]) -> Array {
    values.iter().copied().map(Dynamic::from).collect()
}

/// The list as numbers; `what` names one of them in the error.
pub(super) fn numbers(items: &[Dynamic], what: &str) -> HostResult<Vec<f64>> {
    items.iter().map(|item| number(item, what)).collect()
}

fn build(strains: Array, stresses: Array) -> HostResult<Curve> {
    Curve::new(numbers(&strains, "a strain")?, numbers(&stresses, "a stress")?).map_err(refuse)
}

fn describe(curve: &mut Curve) -> String {
    let [start, end] = curve.range();
    format!("curve of {} samples from strain {start} to {end}", curve.strain().len())
}

fn value_at(curve: &mut Curve, strain: Dynamic) -> HostResult<f64> {
    let strain = number(&strain, "a strain")?;
    curve.stress_at(strain).ok_or_else(|| refuse(format!("the curve has no stress at the strain {strain}")))
}

fn slice(curve: &mut Curve, from: Dynamic, to: Dynamic) -> HostResult<Curve> {
    let range = [number(&from, "the start")?, number(&to, "the end")?];
    curve.within(range).ok_or_else(|| refuse(format!("fewer than two samples between {} and {}", range[0], range[1])))
}

fn slope(curve: &Curve, window: [f64; 2]) -> HostResult<f64> {
    Ok(curve.modulus(window).map_err(refuse)?.slope)
}

fn toe_compensated(curve: &mut Curve, window: Dynamic) -> HostResult<Curve> {
    let line = curve.modulus(strains(&window)?).map_err(refuse)?;
    Ok(curve.toe_compensated(line.slope, line.intercept))
}

fn rupture(curve: &Curve, share: f64) -> HostResult<Map> {
    let rupture = curve.rupture(share).map_err(refuse)?;
    let mut map = Map::new();
    map.insert("strain".into(), rupture.strain.into());
    map.insert("stress".into(), rupture.stress.into());
    map.insert("strength".into(), rupture.strength.into());
    map.insert("broke".into(), (rupture.ending == CurveEnd::Broke).into());
    Ok(map)
}

fn yields(curve: &Curve, window: [f64; 2]) -> HostResult<Map> {
    yield_points(curve, window).map(|found| yield_map(&found)).map_err(refuse)
}

fn mean(curves: &Array, of: fn(&[Curve]) -> Result<Curve, lab::Error>) -> HostResult<Curve> {
    let curve = |item: &Dynamic| {
        let found = item.clone().try_cast::<Curve>();
        found.ok_or_else(|| refuse(format!("expected a curve, found {}", item.type_name())))
    };
    of(&curves.iter().map(curve).collect::<HostResult<Vec<_>>>()?).map_err(refuse)
}

fn mean_of_groups(groups: &[Dynamic]) -> HostResult<f64> {
    let group = |item: &Dynamic| match item.read_lock::<Array>() {
        Some(figures) => numbers(&figures, "a figure"),
        None => Err(refuse(format!("expected a list of figures, found {}", item.type_name()))),
    };
    mean_of_means(&groups.iter().map(group).collect::<HostResult<Vec<_>>>()?).map_err(refuse)
}

/// The reference of the functions of curves.
pub const ENTRIES: &[Entry] = &[
    Entry {
        call: "curve(strains, stresses)",
        gives: "a stress–strain curve from two lists; strain increasing, stress in Pa",
        example: "curve([0, 0.26, 0.84], [0, 8.4e6, 20e6]).len() == 3",
    },
    Entry {
        call: "curve.strains(), curve.stresses()",
        gives: "its samples as lists, stress in Pa",
        example: "let c = curve([0, 1], [0, 5e6]); c.strains() == [0.0, 1.0] && c.stresses()[1] == 5e6",
    },
    Entry {
        call: "curve.start(), curve.end(), curve.len()",
        gives: "strain of the first and the last sample, and their number",
        example: "let c = curve([0.1, 0.2], [1, 2]); c.start() == 0.1 && c.end() == 0.2 && c.len() == 2",
    },
    Entry {
        call: "curve.at(strain)",
        gives: "the stress at a strain, linear between samples, Pa",
        example: "curve([0, 1], [0, 5e6]).at(0.5) == 2.5e6",
    },
    Entry {
        call: "curve.slice(from, to)",
        gives: "the samples with from <= strain <= to",
        example: "curve([0, 1, 2, 3], [0, 1, 2, 3]).slice(1, 2.5).len() == 2",
    },
    Entry {
        call: "curve.resultants(thickness)",
        gives: "stress times thickness (m) as a list, N/m (equation 3)",
        example: "curve([0, 0.84], [0, 20e6]).resultants(12e-6)[1] == 240.0",
    },
    Entry {
        call: "curve.modulus(), curve.modulus([from, to])",
        gives: "least-squares slope between two strains, 0 and 0.04 where none are given, Pa (equation 2)",
        example: "let c = curve([0, 0.01, 0.02, 0.1], [0, 5e5, 1e6, 2e6]); (c.modulus([0, 0.02]) - 5e7).abs() < 1",
    },
    Entry {
        call: "curve.toe_compensated([from, to])",
        gives: "the curve shifted so that its elastic line, fitted between two strains, goes through zero (ASTM D882)",
        example: "let c = curve([0.1, 0.2, 0.3], [0, 5, 10]).toe_compensated([0.1, 0.3]); c.start().abs() < 1e-12",
    },
    Entry {
        call: "curve.rupture(), curve.rupture(share)",
        gives: "a map: strain and stress at the break, strength, and whether it broke: the stress fell below a share (0.5) of its maximum",
        example: "let r = curve([0, 1, 2, 3], [0, 5, 9, 1]).rupture(); r.strain == 2.0 && r.strength == 9.0 && r.broke",
    },
    Entry {
        call: "curve.yield_points(), curve.yield_points([from, to])",
        gives: "a map: first and second [strain, stress], slopes, residual, of three straight segments beyond the elastic window",
        example: "let e = []; let s = []; for i in 0..141 { let x = i * 0.01; e.push(x); s.push(32 * min(x, 0.26) + 20 * min(max(x - 0.26, 0.0), 0.58) + 10 * max(x - 0.84, 0.0)); } let y = curve(e, s).yield_points(); (y.first[0] - 0.26).abs() < 1e-6 && (y.second[0] - 0.84).abs() < 1e-6",
    },
    Entry {
        call: "relative_residuals(curve, reference)",
        gives: "a list, for `minimize`: the differences at the samples of the reference curve, each weighted by its interval of strain; \
                their norm is the relative error over strain",
        example: "let r = curve([0, 1], [0, 5e6]); let d = relative_residuals(curve([0, 2], [0, 11e6]), r); d.len() == 2 && (d[1] - 0.1).abs() < 1e-12",
    },
    Entry {
        call: "mean_law([curve, …])",
        gives: "the exact mean of piecewise linear curves, from the latest start to the mean of their ends; a curve that \
                has ended is extrapolated along its last segment",
        example: "let m = mean_law([curve([0, 1], [0, 10]), curve([0, 0.5, 2], [0, 10, 10])]); m.strains() == [0.0, 0.5, 1.0, 1.5] && m.at(1.5) == 12.5",
    },
    Entry {
        call: "mean_curve([curve, …])",
        gives: "the mean on a common axis of strain, up to the earliest end",
        example: "let m = mean_curve([curve([0, 2], [0, 2]), curve([0, 1], [0, 3])]); m.end() == 1.0 && (m.at(1) - 2).abs() < 1e-12",
    },
    Entry {
        call: "mean_of_means([[figure, …], …])",
        gives: "the mean of the means of the lists, all with the same weight",
        example: "mean_of_means([[1, 2, 3], [4]]) == 3.0",
    },
    Entry {
        call: "relative_difference(figure, reference)",
        gives: "the difference of a figure from a reference over the reference",
        example: "(relative_difference(139, 245) + 106.0 / 245).abs() < 1e-12",
    },
    Entry {
        call: "spread([figure, …])",
        gives: "a map: mean, deviation (n - 1) and count",
        example: "let s = spread([1, 2, 3]); s.mean == 2.0 && s.deviation == 1.0 && s.count == 3",
    },
];
