//! Curves of other solvers as curves of a film.

use super::entry::Fields;
use super::{Points, Reader};
use crate::film::{at, unloading};

/// What the ordinates of a curve are.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Ordinate {
    /// Stress of fibres, which begins at zero.
    Fibre,
    /// Stress in shear, which is the same to both sides of zero, or written to one.
    Shear,
    /// Flow stress.
    Flow,
}

/// Relative difference of what cards write with the fewest digits, and of shares that follow from that; unloading curves rise by as
/// much where the film is slack.
const DIGITS: f64 = 1e-5;

/// The points from the abscissa zero on; in words why they are no curve of a film.
pub(super) fn of_film(points: Points, kind: Ordinate) -> Result<Points, &'static str> {
    if points.windows(2).any(|ends| ends[1][0] <= ends[0][0]) {
        return Err("its abscissas do not increase");
    }
    if kind == Ordinate::Fibre && points.iter().any(|point| point[0] < 0.0 && point[1] != 0.0) {
        return Err("it has stress in compression, which fibres do not carry");
    }
    let is_odd = |points: &Points| {
        let most = points[points.len() - 1][1].abs();
        let differs = |[x, y]: &[f64; 2]| (at(points, -x) + y).abs() > DIGITS * most;
        !points.iter().filter(|[x, y]| *x < 0.0 && *y != 0.0).any(differs)
    };
    if kind == Ordinate::Shear && points.len() > 1 && !is_odd(&points) {
        return Err("its negative side is another than its positive one");
    }
    let above: Points = points.into_iter().filter(|point| point[0] >= 0.0).collect();
    let least = if kind == Ordinate::Flow { 1 } else { 2 };
    if above.len() < least {
        return Err("it has too few points from zero on");
    }
    if above.windows(2).any(|ends| ends[1][1] < ends[0][1]) {
        return Err("its stress falls, where film would localise in one row of elements");
    }
    Ok(above)
}

/// The share of the stored energy that is lost, where the curves of the fields `paths`, in order MD, TD and shear, are the loading
/// ones compressed towards the strain from which film unloads (theory.md, equation 8), all by one share, within the digits of a card;
/// other paths are no absorption, and warned of.
pub(super) fn absorption(
    reader: &mut Reader,
    fields: &Fields<'_, '_>,
    loading: &[Points; 3],
    paths: [(&'static str, [f64; 2], Ordinate); 3],
) -> f64 {
    let share = |(loading, (name, units, kind)): (&Points, (&'static str, [f64; 2], Ordinate))| {
        let path = reader.curve(fields.cell(name).ok()?, units, kind).ok()?;
        let (&[_, [slack, _], ..], &[from, top]) = (path.as_slice(), path.last()?) else { return None };
        let expected = unloading(loading, from, slack / from);
        let is_near = |(found, expected): (&[f64; 2], &[f64; 2])| {
            (found[0] - expected[0]).abs() <= DIGITS * from && (found[1] - expected[1]).abs() <= DIGITS * top
        };
        let is_compressed = path.len() == expected.len() && path.iter().zip(&expected).all(is_near);
        is_compressed.then_some(slack / from)
    };
    let shares: Vec<f64> = loading.iter().zip(paths).filter_map(share).collect();
    if shares.len() == 3 && shares.iter().all(|share| (share - shares[0]).abs() <= DIGITS) {
        return shares.iter().sum::<f64>() / 3.0;
    }
    let cells = paths.iter().filter_map(|(name, ..)| fields.cell(name).ok());
    let written = cells.filter(|cell| cell.number() != Ok(0.0));
    reader.warnings.extend(written.map(|cell| cell.ignored(cell.text.to_owned())));
    0.0
}
