use nalgebra::{UnitQuaternion, Vector3};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Normal};

use crate::field_comparison::comparison::FilmSurface;
use crate::field_comparison::*;
use base::units::Length;
use lab::dic::{Field, FieldState, RigidMotion};
use scene::model::Align;
use scene::scenario::Marker;
use scene::simulate::{FaceMotion, FaceState};

/// A flat film of 0.4 m × 0.3 m in n × n elements, whose inner nodes are shifted, moved by `displacement` at each time.
fn film(n: u32, times: &[f64], displacement: impl Fn([f64; 3], f64) -> [f64; 3]) -> FaceMotion {
    let node = |i: u32, j: u32| j * (n + 1) + i;
    let place = |i: u32, j: u32| {
        let inner = (1..n).contains(&i) && (1..n).contains(&j);
        let shift = if inner { 0.2 * f64::from((7 * i + 3 * j) % 5) / 5.0 - 0.1 } else { 0.0 };
        let [x, y] = [i, j].map(|index| (f64::from(index) + shift) / f64::from(n));
        [0.4 * x - 0.2, 0.3 * y - 0.15, 0.01]
    };
    let nodes = (0..=n).flat_map(|j| (0..=n).map(move |i| place(i, j)));
    let element = |i, j| [node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)];
    let reference: Vec<[f64; 3]> = nodes.collect();
    let state = |time: &f64| FaceState {
        time: *time,
        displacements: reference.iter().map(|place| displacement(*place, *time).map(|part| part as f32)).collect(),
    };
    FaceMotion {
        face: 0,
        corners: (0..n).flat_map(|j| (0..n).map(move |i| element(i, j))).collect(),
        mirrored: [false; 2],
        states: times.iter().map(state).collect(),
        reference,
    }
}

/// A bulge with in-plane parts, without symmetry.
fn bulge([x, y, _]: [f64; 3], time: f64) -> [f64; 3] {
    let (x, y) = (x / 0.2, y / 0.15);
    let height = (1.0 - x * x) * (1.0 - y * y) * (1.0 + 0.4 * x - 0.3 * y);
    [0.004 * time * x * (1.0 - x * x), -0.003 * time * y * (1.0 - y * y), -0.05 * time * height]
}

/// The displacements of a film at points of a grid, in the axes of a camera, with noise (m).
fn measured(film: &FaceMotion, camera: &RigidMotion, noise: f64, is_seen: impl Fn(usize) -> bool) -> Field {
    let surface = FilmSurface::of_motion(film).unwrap();
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let normal = Normal::new(0.0, noise).unwrap();
    let grid = (0..25)
        .flat_map(|i| (0..20).map(move |j| [0.3 * f64::from(i) / 24.0 - 0.15, 0.2 * f64::from(j) / 19.0 - 0.09, 0.01]));
    let places: Vec<[f64; 3]> = grid.collect();
    let state = |state: &FaceState| {
        let nearest = places.iter().map(|place| surface.nearest(Vector3::from(*place)));
        let points = (0u32..).zip(nearest).filter(|(place, _)| is_seen(*place as usize)).map(|(place, nearest)| {
            let displacement = nearest.displacement(state).map(|part| part + normal.sample(&mut random));
            (place, camera.rotate(displacement.into()))
        });
        FieldState { path: "field.csv".into(), time: state.time, points: points.collect(), missing: 0 }
    };
    let states = film.states.iter().map(state).collect();
    Field {
        program: "VIC-3D",
        columns: Default::default(),
        places: places.iter().map(|place| camera.apply(*place)).collect(),
        states,
        annotations: Default::default(),
    }
}

fn camera(turn: [f64; 3]) -> RigidMotion {
    let rotation = UnitQuaternion::from_scaled_axis(Vector3::from(turn));
    RigidMotion { rotation, translation: Vector3::new(0.31, -0.12, 0.87) }
}

#[test]
fn a_linear_displacement_is_interpolated_without_error() {
    let linear = |[x, y, _]: [f64; 3], _: f64| [0.1 * x - 0.2 * y, 0.3 * y, 0.05 * x + 0.07 * y];
    let film = film(6, &[1.0], linear);
    let surface = FilmSurface::of_motion(&film).unwrap();
    for (point, on_film) in [
        ([0.013, -0.071, 0.01], [0.013, -0.071, 0.01]),
        ([-0.17, 0.11, 0.04], [-0.17, 0.11, 0.01]),
        ([0.3, 0.02, 0.01], [0.2, 0.02, 0.01]),
        ([0.5, 0.5, 0.0], [0.2, 0.15, 0.01]),
    ] {
        let nearest = surface.nearest(Vector3::from(point));
        let offset = Vector3::from(point) - Vector3::from(on_film);
        assert!((nearest.offset - offset).norm() < 1e-9, "{point:?}: {:?}", nearest.offset);
        let expected = Vector3::from(linear(on_film, 1.0));
        // Displacements are stored in single precision.
        assert!((nearest.displacement(&film.states[0]) - expected).norm() < 1e-8, "{point:?}");
        let gradient = nearest.displacement_gradient(&film.states[0]);
        let expected = nalgebra::Matrix3::new(0.1, -0.2, 0.0, 0.0, 0.3, 0.0, 0.05, 0.07, 0.0);
        assert!((gradient - expected).amax() < 1e-5, "{gradient}");
    }
}

#[test]
fn mirror_images_move_as_the_part_that_is_computed() {
    let mut film = film(4, &[1.0], |[x, y, _], _| [x, y, 0.5]);
    for place in &mut film.reference {
        *place = [place[0] + 0.2, place[1] + 0.15, place[2]];
    }
    film.mirrored = [true, true];
    let surface = FilmSurface::of_motion(&film).unwrap();
    let moved = |point: [f64; 3]| surface.nearest(Vector3::from(point)).displacement(&film.states[0]);
    let [own, image] = [moved([0.1, 0.05, 0.01]), moved([-0.1, -0.05, 0.01])];
    assert!((own.component_mul(&Vector3::new(-1.0, -1.0, 1.0)) - image).norm() < 1e-12, "{own} {image}");
    assert_eq!(surface.points().count(), 4 * 25);
}

/// Derivatives of the residuals are those of differences.
#[test]
fn residuals_have_their_derivatives() {
    let film = film(8, &[1.0], bulge);
    let field = measured(&film, &RigidMotion::identity(), 0.0, |_| true);
    let surface = FilmSurface::of_motion(&film).unwrap();
    let points = field.states[0].points.clone();
    let problem = alignment::Problem {
        surface: &surface,
        places: &field.places,
        states: vec![(&film.states[0], points)],
        centre: Vector3::new(0.02, 0.0, 0.0),
        radius: 0.1,
    };
    let motion = RigidMotion {
        rotation: UnitQuaternion::from_scaled_axis(Vector3::new(0.02, -0.01, 0.03)),
        translation: Vector3::new(0.001, 0.002, 0.003),
    };
    let gradient = problem.linearized(&motion).normal_equations(1.0).gradient;
    for axis in 0..6 {
        let mut step = nalgebra::Vector6::zeros();
        step[axis] = 1e-6;
        let [ahead, behind] =
            [step, -step].map(|step| problem.linearized(&problem.stepped(&motion, &step)).normal_equations(1.0).cost);
        let slope = (ahead - behind) / 2e-6;
        assert!((slope - gradient[axis]).abs() < 0.01 * gradient.amax(), "{axis}: {slope} and {}", gradient[axis]);
    }
}

#[test]
fn the_motion_of_the_camera_is_found() {
    let film = film(12, &[0.2, 0.6, 1.0], bulge);
    // A third of the points is not seen, and a corner of the film has none.
    let is_seen = |place: usize| place % 3 != 1 && place > 60;
    for turn in [[0.0, 0.0, 0.0], [0.1, -0.2, 0.3], [3.0, 0.4, 0.2], [-0.5, 1.4, 2.2], [0.0, 0.0, 2.6]] {
        let camera = camera(turn);
        let noise = 20e-6;
        let field = measured(&film, &camera, noise, is_seen);
        let found = FieldComparison::new(&film, &field, &Align::Rigid, [0.0, 1.0]).unwrap();
        let back = camera.inverse();
        let turned = found.alignment.motion.rotation.angle_to(&back.rotation);
        let moved = |point: [f64; 3]| {
            (Vector3::from(found.alignment.motion.apply(point)) - Vector3::from(back.apply(point))).norm()
        };
        let largest = field.places.iter().map(|place| moved(*place)).fold(0.0, f64::max);
        assert!(turned < 2e-3 && largest < 2e-4, "{turn:?}: {turned} rad, {largest} m");
        let quality = found.alignment.found.unwrap();
        assert!(!quality.is_uncertain() && quality.others == 0, "{turn:?}: {quality:?}");
        // Three components of noise.
        let rms = found.norms().rms().unwrap();
        assert!((rms / (noise * 3f64.sqrt()) - 1.0).abs() < 0.1, "{turn:?}: {rms}");
        assert_eq!(found.counts()[0], found.counts()[1]);
    }
}

#[test]
fn a_few_wrong_points_do_not_move_the_field() {
    let film = film(12, &[1.0], bulge);
    let camera = camera([0.2, 0.1, -0.4]);
    let mut field = measured(&film, &camera, 10e-6, |_| true);
    for (order, (_, displacement)) in field.states[0].points.iter_mut().enumerate().filter(|(order, _)| order % 12 == 0)
    {
        displacement[order % 3] += 0.02;
    }
    let found = FieldComparison::new(&film, &field, &Align::Rigid, [0.0, 1.0]).unwrap();
    let back = camera.inverse();
    assert!(found.alignment.motion.rotation.angle_to(&back.rotation) < 2e-3, "{:?}", found.alignment);
}

/// A round bulge turns about its axis without any difference.
#[test]
fn a_motion_that_is_not_determined_is_called_so() {
    let round = |[x, y, _]: [f64; 3], time: f64| {
        let r2 = (x * x + y * y) / 0.0225;
        [0.0, 0.0, -0.04 * time * (1.0 - r2).max(0.0)]
    };
    // Measured of a finer film: the corners of elements do not give the turn away.
    let field = measured(&film(96, &[1.0], round), &camera([0.1, 0.0, 0.5]), 2e-4, |_| true);
    let film = film(24, &[1.0], round);
    let found = FieldComparison::new(&film, &field, &Align::Rigid, [0.0, 1.0]).unwrap().alignment.found.unwrap();
    assert!(found.is_uncertain() || found.others > 0, "{found:?}");
}

#[test]
fn markers_and_common_axes_need_no_search() {
    let film = film(8, &[0.5, 1.0], bulge);
    let camera = camera([0.3, -0.1, 1.1]);
    let field = measured(&film, &camera, 0.0, |place| place != 5);
    let corners = [[-0.2, -0.15, 0.01], [0.2, -0.15, 0.01], [0.2, 0.15, 0.01]];
    let marker = |corner| {
        let [field, film] = [camera.apply(corner), corner].map(|place| place.map(Length));
        Marker { field, film }
    };
    let markers = Align::Markers(corners.map(marker).to_vec());
    let found = FieldComparison::new(&film, &field, &markers, [0.0, 0.7]).unwrap();
    assert!(found.norms().rms().unwrap() < 1e-7, "{:?}", found.norms());
    assert_eq!((found.states.len(), found.outside, found.residuals().count()), (1, 1, 499 * 3));
    let apart = FieldComparison::new(&film, &field, &Align::None, [0.0, 1.0]).unwrap();
    assert_eq!(apart.counts(), [998, 0], "nothing lies on the film");
    assert!(FieldComparison::new(&film, &field, &Align::None, [2.0, 3.0]).is_err());
}
