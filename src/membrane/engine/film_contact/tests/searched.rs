//! Which film is searched for parts that meet: all that may, and no film that is bent smoothly.

use std::f64::consts::TAU;

use super::itself::{grid, mount, section};
use super::numbers::Numbers;
use super::*;
use crate::engine::film_contact::self_contact::SelfContact;
use crate::engine::film_contact::surface::Surface;

/// A face, flat as mounted.
struct Face {
    film: Film,
    surface: Surface,
    nodes: Nodes,
    flat: Nodes,
}

impl Face {
    fn new(mesh: &Mesh) -> Face {
        Face::thick(mesh, THICKNESS)
    }

    fn thick(mesh: &Mesh, thickness: f64) -> Face {
        let (film, nodes) = mount(mesh, &Section { thickness, ..section(2e8) }, |_| [0.0; 3]);
        let surface = Surface::new(std::slice::from_ref(&film));
        Face { film, surface, flat: nodes.clone(), nodes }
    }

    /// Moves every node from where it was mounted.
    fn place(&mut self, at: impl Fn(f64, f64) -> [f64; 3]) {
        for n in 0..self.nodes.mass.len() {
            let [x, y, _] = self.flat.position.value_at(n);
            self.nodes.position.set(n, at(x, y));
        }
    }

    fn contact(&self) -> SelfContact {
        SelfContact::new(std::slice::from_ref(&self.film), &self.surface, &self.flat)
    }

    fn crossings(&self) -> usize {
        crossings(std::slice::from_ref(&self.film), &self.nodes, true)
    }

    /// Distance by which points may come nearer to each other until it is searched, m, and the pairs that are found.
    fn search(&self) -> (f64, usize) {
        let mut itself = self.contact();
        let spared = itself.spared(&self.surface, &self.nodes.position);
        itself.prepare(&self.surface, &self.nodes, 0.0);
        (spared, itself.state.pairs.places().len())
    }
}

/// Half a disc of 40 sectors and 8 rings.
fn half_disc(radius: f64) -> Mesh {
    let (sectors, rings) = (40, 8);
    let place = |ring: u32, k: u32| {
        let (sin, cos) = (0.5 * TAU * f64::from(k) / f64::from(sectors)).sin_cos();
        let radius = radius * f64::from(ring) / f64::from(rings);
        Point3::new(radius * cos, radius * sin, 0.0)
    };
    let mut nodes = vec![Point3::origin()];
    nodes.extend((1..=rings).flat_map(|ring| (0..=sectors).map(move |k| place(ring, k))));
    let at = |ring: u32, k: u32| 1 + (ring - 1) * (sectors + 1) + k;
    let quad = |ring: u32, k: u32| [at(ring, k), at(ring + 1, k), at(ring + 1, k + 1), at(ring, k + 1)];
    let quads = (1..rings).flat_map(|ring| (0..sectors).map(move |k| quad(ring, k))).collect();
    let tris = (0..sectors).map(|k| [0, at(1, k), at(1, k + 1)]).collect();
    Mesh { nodes, quads, tris, ..Mesh::default() }
}

/// Half a disc that is rolled into a cone, around which it winds 1.05 times: no normal is farther than 70° from their mean,
/// and the film lies on itself.
#[test]
fn a_sheet_that_is_rolled_into_a_cone_is_searched() {
    let mut face = Face::new(&half_disc(0.05));
    let half_angle = (0.5 / 1.05_f64).asin();
    face.place(|x, y| {
        let azimuth = y.atan2(x) / half_angle.sin();
        let (sin, cos) = half_angle.sin_cos();
        let radius = x.hypot(y);
        [radius * sin * azimuth.cos(), radius * sin * azimuth.sin(), radius * cos]
    });
    let normals: Vec<Vector3<f64>> =
        triangles(&face.film, &face.nodes).iter().map(|[a, b, c]| (b - a).cross(&(c - a))).collect();
    let mean: Vector3<f64> = normals.iter().sum();
    let widest = normals.iter().map(|normal| normal.angle(&mean).to_degrees()).fold(0.0, f64::max);
    assert!(widest < 70.0, "{widest}");
    let (spared, pairs) = face.search();
    assert!(spared <= 0.0 && pairs > 30, "{spared} m, {pairs} pairs");
}

/// A strip, stretched in its plane into a ring of 1.2 turns that rises by less than the reach of the search: its normals
/// are all within 2° of each other.
#[test]
fn a_strip_that_comes_over_itself_as_a_ramp_is_searched() {
    let strip = grid([60, 4], false, |u, v| Point3::new(0.3 * (u - 0.5), 0.02 * v, 0.0));
    let mut face = Face::new(&strip);
    face.place(|x, y| {
        let (angle, radius) = (1.2 * TAU * (x / 0.3 + 0.5), 0.06 - y);
        [radius * angle.cos(), radius * angle.sin(), 5e-4 * angle / TAU]
    });
    let (spared, pairs) = face.search();
    assert!(spared <= 0.0 && pairs > 100, "{spared} m, {pairs} pairs");
}

/// A sheet bent about one line, with its lengths kept and as a graph of |x|: how far it may move until it has to be
/// searched.
#[test]
fn film_that_is_bent_is_not_searched_until_it_has_moved() {
    let mut face = Face::new(&square(0.1, 10, 0.0));
    // Half squares with sides of 10 mm: the least altitude is that over the diagonal.
    let altitude = 0.01 * 0.5_f64.sqrt();
    let bound = 0.9 * THICKNESS;
    for (slope, turn) in [(0.0_f64, 0.0), (30.0, 1.0), (50.0, 2.0), (60.0, 0.0), (80.0, 0.5), (86.0, 0.0)] {
        let slope = slope.to_radians();
        let turn = nalgebra::Rotation3::from_euler_angles(turn, 2.0 * turn, 3.0 * turn);
        face.place(|x, y| (turn * Vector3::new(x * slope.cos(), y, x.abs() * slope.sin())).into());
        let (spared, pairs) = face.search();
        let expected = altitude * slope.cos() - bound;
        assert!((spared - expected).abs() < 1e-9 * altitude, "{slope}: {spared} for {expected}");
        assert_eq!(pairs, 0);
        face.place(|x, y| (turn * Vector3::new(x, y, x.abs() * slope.tan())).into());
        let (spared, expected) = (face.search().0, altitude - bound);
        assert!((spared - expected).abs() < 1e-9 * altitude, "{slope}: {spared} for {expected}");
    }
}

/// A cylinder of 100°, of which no part is looked at, and one of 160°, turned by 45°, of which only neighbouring parts are.
#[test]
fn parts_of_film_that_is_bent_are_not_searched() {
    let cells = 32;
    let mut face = Face::new(&square(0.1, cells, 0.0));
    let all = triangles(&face.film, &face.nodes).len();
    for (half_angle, turn, most) in [(50.0_f64, 0.0, 0), (80.0, 45.0_f64, 6 * all)] {
        let (half_angle, turn) = (half_angle.to_radians(), turn.to_radians());
        let radius = 0.05 / half_angle;
        face.place(|x, y| [radius * (x / radius + turn).sin(), y, radius * (x / radius + turn).cos()]);
        let looked_at = face.contact().pairs_of_triangles(&face.surface, &face.nodes.position);
        assert!(looked_at <= most, "{looked_at} of {all} triangles");
    }
}

/// Film beside an edge of a cut, inside, has film on the other side of it.
#[test]
fn film_with_a_cut_is_searched_beside_it() {
    let mut face = Face::new(&square(0.1, 20, 0.0));
    face.film.cut(&face.flat, &[[-0.06, 0.002], [0.02, 0.002]]);
    let mut deleted = Surface::new(std::slice::from_ref(&Face::new(&square(0.1, 20, 0.0)).film));
    assert!(deleted.remove_deleted(std::slice::from_ref(&face.film)));
    for surface in [deleted, Surface::new(std::slice::from_ref(&face.film))] {
        face.surface = surface;
        face.nodes = face.flat.clone();
        assert_eq!(face.search(), (0.0, 0));
        // One lip comes over the other.
        face.place(|x, y| [x, if x < 0.015 && y > 0.002 { y - 0.006 } else { y }, if y > 0.002 { 5e-4 } else { 0.0 }]);
        let mut itself = face.contact();
        itself.prepare(&face.surface, &face.nodes, 0.0);
        let expected = itself.parts_within(&face.surface, &face.nodes.position, None);
        assert!(
            itself.state.pairs.places().len() > 20 && itself.state.pairs.places().len() == expected,
            "{} of {expected}",
            itself.state.pairs.places().len()
        );
    }
}

/// Smooth sheets on uneven meshes, thin and as thick as a fifth of an element, gently bent up to crossing themselves, at
/// all orientations. Film that is not searched keeps its distance, also after any motion for which it is not searched; of
/// film that is searched no pair is missed.
#[test]
fn no_film_that_meets_itself_is_missed() {
    let mut numbers = Numbers::new(3);
    let [mut crossed, mut untold, mut spared_ones, mut searched] = [0; 4];
    for sheet in 0..300 {
        let cells = 10;
        let mut mesh = square(0.1, cells, 0.0);
        let is_inside = |p: &Point3<f64>| p.x.abs().max(p.y.abs()) < 0.049;
        for p in mesh.nodes.iter_mut().filter(|p| is_inside(p)) {
            *p += numbers.vector().component_mul(&Vector3::new(3e-3, 3e-3, 0.0));
        }
        if sheet % 2 == 1 {
            let halves = |[a, b, c, d]: &[u32; 4]| {
                if (a + b) % 3 == 0 { [[*a, *b, *c], [*a, *c, *d]] } else { [[*a, *b, *d], [*b, *c, *d]] }
            };
            mesh.tris = mesh.quads.drain(..).flat_map(|quad| halves(&quad)).collect();
        }
        let thickness = if sheet % 3 == 0 { 2e-3 } else { THICKNESS };
        let mut face = Face::thick(&mesh, thickness);
        // Waves whose slopes are about as large as this at most, after a stretch and a shear.
        let size = 0.2 + 1.5 * numbers.next().abs();
        let stretch = nalgebra::Matrix2::identity() + 0.3 * nalgebra::Matrix2::from_fn(|_, _| numbers.next());
        let turn = nalgebra::Rotation3::new(3.0 * numbers.vector());
        let waves: Vec<([f64; 2], f64, Vector3<f64>)> = (0..3)
            .map(|_| {
                let along = [80.0 * numbers.next(), 80.0 * numbers.next()];
                (along, 3.0 * numbers.next(), numbers.vector() * (size / along[0].hypot(along[1])))
            })
            .collect();
        face.place(|x, y| {
            let even = stretch * nalgebra::Vector2::new(x, y);
            let of_wave =
                |([k, l], phase, height): &([f64; 2], f64, Vector3<f64>)| height * (k * x + l * y + phase).sin();
            let waves: Vector3<f64> = waves.iter().map(of_wave).sum();
            (turn * (Vector3::new(even.x, even.y, 0.0) + waves)).into()
        });
        let crosses = face.crossings() > 0;
        crossed += usize::from(crosses);
        let mut itself = face.contact();
        let spared = itself.spared(&face.surface, &face.nodes.position);
        itself.prepare(&face.surface, &face.nodes, 0.0);
        let bound = 0.9 * thickness;
        if spared <= 0.0 {
            searched += 1;
            let expected = itself.parts_within(&face.surface, &face.nodes.position, None);
            assert_eq!(itself.state.pairs.places().len(), expected, "sheet {sheet}");
            let distance = itself.least_distance(&face.surface, &face.nodes.position, 1.0);
            untold += usize::from(crosses && distance >= 0.0);
            assert!(crosses || distance >= 0.0, "sheet {sheet}: {distance}");
            continue;
        }
        spared_ones += 1;
        assert!(!crosses, "sheet {sheet}");
        assert_eq!(itself.parts_within(&face.surface, &face.nodes.position, Some(bound)), 0, "sheet {sheet}");
        for n in 0..face.nodes.mass.len() {
            let moved = Vector3::from(face.nodes.position.value_at(n)) + 0.5 * spared * numbers.vector().normalize();
            face.nodes.position.set(n, moved.into());
        }
        assert_eq!(face.crossings(), 0, "sheet {sheet}");
        assert_eq!(itself.parts_within(&face.surface, &face.nodes.position, Some(bound)), 0, "sheet {sheet}");
    }
    println!("{crossed} cross themselves, {untold} of them untold, {spared_ones} are not searched, {searched} are");
    assert!(crossed > 40 && spared_ones > 60 && searched - crossed > 20, "{crossed} {spared_ones} {searched}");
}

/// Film that a sphere presses down and that does not fold has no pairs, and moves to the bit as film that cannot meet
/// itself.
#[test]
fn film_that_does_not_fold_moves_as_without_contact() {
    let bits = |meets_itself: bool| {
        let scene = Scene { prestrain: 0.02, is_clamped: true, sphere: Some((0.05, 4.0, 0.5)), ..Scene::default() };
        let mut run = scene.with(&[(square(0.2, 20, 0.0), 0.0, [0.0; 3])]);
        if meets_itself {
            run.engine = run.engine.with_self_contact(0.3);
        }
        let mut lowest = 0.0_f64;
        while run.engine.time() < 0.025 {
            run.after(20);
            lowest = lowest.min(run.observe(|view| {
                let itself = view.engine.film_contact.as_ref().and_then(|contact| contact.itself.as_ref());
                assert!(itself.is_none_or(|itself| itself.state.pairs.is_empty()));
                view.nodes.position.axes()[2].iter().copied().fold(0.0, f64::min)
            }));
        }
        assert!(lowest < -0.02, "{lowest}");
        let bits: Vec<u64> = run.engine.nodes.position.iter().flatten().map(f64::to_bits).collect();
        bits
    };
    assert!(bits(true) == bits(false));
}
