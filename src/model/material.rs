//! What a layer is made of: curves that are curves, moved by their multipliers.

use super::Findings;
use crate::material::{Curve, CurveError, Elastic, Fabric, Law, Material, Multipliers, TensionField};
use crate::scenario::{self, Fibre, Point, Scale};

/// The material written at `path`, which is empty for that of a material file; none where it is no material.
pub fn check(written: &scenario::Material, path: &str, findings: &mut Findings<'_>) -> Option<Material> {
    let of = |table: &str| if path.is_empty() { table.to_owned() } else { format!("{path}.{table}") };
    let (law, rates, place) = match (&written.fabric, &written.elastic) {
        (Some(fabric), _) => {
            let place = of("fabric");
            (Law::Fabric(self::fabric(fabric, &place, findings)?), fabric.measured_rates, place)
        }
        (None, Some(written)) => (elastic(written), written.measured_rates, of("elastic")),
        (None, None) => return None,
    };
    let measured_rates = rates.map(|[from, to]| [from.0, to.0]);
    if measured_rates.is_some_and(|[from, to]| to < from) {
        let path = format!("{place}.measured_rates");
        findings.report_with(&path, "the highest rate is below the lowest", "the lowest first");
    }
    Some(Material { density: written.density.0, thickness: written.thickness.0, law, measured_rates })
}

fn elastic(written: &scenario::Elastic) -> Law {
    let elastic = Elastic { young: written.young.0, poisson: written.poisson };
    if written.wrinkling { Law::TensionField(TensionField(elastic)) } else { Law::Elastic(elastic) }
}

fn fabric(written: &scenario::Fabric, path: &str, findings: &mut Findings<'_>) -> Option<Fabric> {
    let md = fibre(&written.md, written.scale, &format!("{path}.md"), findings);
    let td = fibre(&written.td, written.scale, &format!("{path}.td"), findings);
    let shear_path = format!("{path}.shear.curve");
    let place = |index: usize| format!("{shear_path}.{index}");
    let shear = curve(&written.shear.curve, &shear_path, place, findings);
    // Outside, there is no law; the mistake was named when the range was checked.
    let absorption = Some(written.absorption).filter(|share| (0.0..1.0).contains(share));
    Some(Fabric::new(md?, td?, shear?, absorption?))
}

/// The curve of one fibre set, moved by its multipliers or else by those of the `fabric`.
fn fibre(written: &Fibre, fabric: Scale, path: &str, findings: &mut Findings<'_>) -> Option<Curve> {
    let (curve, yields) = match (&written.curve, written.yield_points, written.break_point) {
        (Some(points), _, _) => general(written, points, path, findings)?,
        (None, Some([first, second]), Some(end)) => {
            if written.yield_strains.is_some() {
                let why = "`yield` gives the yield points already";
                findings.out_of_place(&format!("{path}.yield_strains"), why);
            }
            let place = |index: usize| match index {
                0 | 1 => format!("{path}.yield.{index}"),
                _ => format!("{path}.break"),
            };
            let curve = curve(&[first, second, end], path, place, findings)?;
            (curve, Some([first.0, second.0]))
        }
        _ => return None,
    };
    let own = format!("{path}.scale");
    let of_fabric = path.rsplit_once('.').map_or(own.clone(), |(fabric, _)| format!("{fabric}.scale"));
    let (scale, scale_path) = written.scale.map_or((fabric, of_fabric), |scale| (scale, own));
    moved(curve, yields, scale, [path, &scale_path], findings)
}

/// A curve of any points; its yield strains must lie on it, in order.
fn general(
    written: &Fibre,
    points: &[Point],
    path: &str,
    findings: &mut Findings<'_>,
) -> Option<(Curve, Option<[f64; 2]>)> {
    let curve_path = format!("{path}.curve");
    let place = |index: usize| format!("{curve_path}.{index}");
    let curve = curve(points, &curve_path, place, findings)?;
    if let Some([first, second]) = written.yield_strains {
        let last = curve.points().last().map_or(0.0, |point| point[0]);
        let path = format!("{path}.yield_strains");
        if second <= first {
            findings.report(&path, "the second yield strain is not above the first");
        } else if second >= last {
            let message = format!("the curve ends at {last}, before its second yield point");
            findings.report(&path, message);
        }
    }
    Some((curve, written.yield_strains))
}

fn moved(
    curve: Curve,
    yields: Option<[f64; 2]>,
    scale: Scale,
    [path, scale_path]: [&str; 2],
    findings: &mut Findings<'_>,
) -> Option<Curve> {
    if scale == Scale::default() {
        return Some(curve);
    }
    let Some(yields) = yields else {
        findings.report_with(
            &format!("{path}.curve"),
            "`scale` moves a curve by its yield points, and this one names none",
            format!("give their strains beside it: yield_strains = [{}, {}]", 0.3, 0.8),
        );
        return None;
    };
    if ![scale.k1, scale.ke, scale.ky].iter().all(|k| *k > 0.0) {
        return None; // out of range, and said so already
    }
    let multipliers = Multipliers { k1: scale.k1, ke: scale.ke, ky: scale.ky };
    match multipliers.apply(&curve, yields) {
        Ok(curve) => Some(curve),
        Err(error) => {
            let message = format!("the multipliers leave no curve: {error}");
            findings.report(scale_path, message);
            None
        }
    }
}

/// The curve through `points`; a mistake is shown at the `place` of its point.
fn curve(points: &[Point], path: &str, place: impl Fn(usize) -> String, findings: &mut Findings<'_>) -> Option<Curve> {
    let pairs = points.iter().map(|Point(strain, stress)| [*strain, stress.0]);
    if points.is_empty() {
        return None; // too short a list, and said so already
    }
    let error = match Curve::new(pairs.collect()) {
        Ok(curve) => return Some(curve),
        Err(error) => error,
    };
    match error {
        CurveError::StrainNotIncreasing { index, strain, previous } => findings.report_with(
            &place(index),
            "the curve is not increasing in strain",
            format!("{strain} stands after {previous}"),
        ),
        CurveError::StressFalls { index, .. } => {
            findings.report(&place(index), "the stress of the curve falls");
        }
        CurveError::NotFinite { index } => {
            findings.report(&place(index), "this point of the curve is not finite");
        }
        CurveError::TooShort => findings.report(path, error.to_string()),
    }
    None
}
