//! Curves of other solvers as curves of a film.

use super::Points;

/// What the ordinates of a curve are.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Ordinate {
    /// Stress of fibres or in shear, which begins at zero.
    Fibre,
    /// Flow stress.
    Flow,
}

/// The points from the abscissa zero on; in words why they are no curve of a film.
pub(super) fn of_film(points: Points, kind: Ordinate) -> Result<Points, &'static str> {
    if points.windows(2).any(|ends| ends[1][0] <= ends[0][0]) {
        return Err("its abscissas do not increase");
    }
    if kind == Ordinate::Fibre && points.iter().any(|point| point[0] < 0.0 && point[1] != 0.0) {
        return Err("it has stress in compression, which fibres do not carry");
    }
    let above: Points = points.into_iter().filter(|point| point[0] >= 0.0).collect();
    let least = if kind == Ordinate::Fibre { 2 } else { 1 };
    if above.len() < least {
        return Err("it has too few points from zero on");
    }
    if above.windows(2).any(|ends| ends[1][1] < ends[0][1]) {
        return Err("its stress falls, where film would localise in one row of elements");
    }
    Ok(above)
}
