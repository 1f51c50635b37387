//! Motions from which an alignment starts: the field turned in its plane, on both of its sides.

use std::f64::consts::TAU;

use nalgebra::{Matrix3, Rotation3, SymmetricEigen, UnitQuaternion, Vector3};

use super::pair::Pair;
use super::surface::FilmSurface;
use lab::field::RigidMotion;

/// Turns in the plane.
const TURNS: u32 = 12;

/// No motion, and the motions that bring the plane of the `places` onto that of the film, and the centre of the displacements
/// of one state onto that of the film's: both sides up, in steps of 30°.
pub fn starts(surface: &FilmSurface<'_>, places: &[[f64; 3]], pair: &Pair<'_>) -> Vec<RigidMotion> {
    let of_field = Cloud::new(pair.field.points.iter().map(|(place, displacement)| {
        (Vector3::from(places[*place as usize]), Vector3::from(*displacement).norm_squared())
    }));
    let of_film =
        Cloud::new(surface.points().map(|(node, place)| {
            (place, pair.film.displacements[node].iter().map(|part| f64::from(part * part)).sum())
        }));
    let mut starts = vec![RigidMotion::identity()];
    let (Some(of_field), Some(of_film)) = (of_field, of_film) else { return starts };
    for side in [Matrix3::identity(), Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, -1.0))] {
        for turn in 0..TURNS {
            let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), TAU * f64::from(turn) / f64::from(TURNS));
            let matrix = of_film.axes * turn.matrix() * side * of_field.axes.transpose();
            let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(matrix));
            starts.push(RigidMotion { rotation, translation: of_film.centre - rotation * of_field.centre });
        }
    }
    starts
}

/// Points with weights.
struct Cloud {
    /// Their centre by weight.
    centre: Vector3<f64>,
    /// Principal axes of the points without weights, right-handed, the normal of their plane last.
    axes: Matrix3<f64>,
}

impl Cloud {
    fn new(points: impl Iterator<Item = (Vector3<f64>, f64)>) -> Option<Cloud> {
        let points: Vec<(Vector3<f64>, f64)> = points.collect();
        let total: f64 = points.iter().map(|(_, weight)| weight).sum();
        let mean = points.iter().map(|(place, _)| place).sum::<Vector3<f64>>() / points.len() as f64;
        let centre = if total > 0.0 {
            points.iter().map(|(place, weight)| *weight * place).sum::<Vector3<f64>>() / total
        } else {
            mean
        };
        let spread: Matrix3<f64> = points.iter().map(|(place, _)| (place - mean) * (place - mean).transpose()).sum();
        if !(spread.trace() > 0.0 && spread.trace().is_finite() && centre.iter().all(|part| part.is_finite())) {
            return None;
        }
        let eigen = SymmetricEigen::new(spread);
        let mut order = [0, 1, 2];
        order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
        let [first, second] = [order[0], order[1]].map(|place| eigen.eigenvectors.column(place).into_owned());
        Some(Cloud { centre, axes: Matrix3::from_columns(&[first, second, first.cross(&second)]) })
    }
}
