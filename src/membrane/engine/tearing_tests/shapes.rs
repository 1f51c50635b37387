//! When a tear grows, on elements of many shapes and directions, against Griffith's balance: a wide strip of rubber and a
//! crack in the middle of a plate.

use nalgebra::Point3;

use super::{POISSON, THICKNESS, YOUNG, cells, section};
use crate::engine::{Engine, Film, Jaw, Loads, Mesh, Nodes, Section, Unobserved};
use crate::material::{Criterion, Elastic, Hyperelastic, HyperelasticLaw, Law, Limit, Polynomial, Rupture};

/// Shape of the elements of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Shape {
    /// Edges along and across the tear, m.
    edges: [f64; 2],
    /// Angle by which the mesh is turned, degrees.
    turned: f64,
    /// By how much rows are moved along themselves from one to the next, over the edge.
    skew: f64,
    /// By how much nodes are moved at random, over the edges.
    uneven: f64,
}

impl Shape {
    const fn even(edges: [f64; 2], turned: f64) -> Shape {
        Shape { edges, turned, skew: 0.0, uneven: 0.0 }
    }

    /// Elements of this shape that cover a rectangle from 0 along x and about 0 along y, and some beyond.
    fn mesh(&self, [length, height]: [f64; 2]) -> Mesh {
        let Shape { edges: [along, across], turned, skew, uneven } = *self;
        let reach = length + height;
        let [columns, rows] = [along, across].map(|edge| (2 * (reach / edge).ceil() as u32) | 1);
        let mut seed = 1_u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let (sin, cos) = turned.to_radians().sin_cos();
        let places: Vec<Point3<f64>> = (0..=rows)
            .flat_map(|j| (0..=columns).map(move |i| (f64::from(i), f64::from(j))))
            .map(|(i, j)| {
                let row = j - 0.5 * f64::from(rows);
                let [a, b] = [random(), random()].map(|r| 2.0 * uneven * r);
                let x = (i - 0.5 * f64::from(columns) + skew * row % 1.0 + a) * along;
                let y = (row + b) * across;
                Point3::new(0.5 * length + cos * x - sin * y, sin * x + cos * y, 0.0)
            })
            .collect();
        let all = cells(columns, rows, |i, j| places[(j * (columns + 1) + i) as usize]);
        let within = |quad: &[u32; 4]| {
            let centre = quad.iter().map(|n| places[*n as usize].coords).sum::<nalgebra::Vector3<f64>>() / 4.0;
            (0.0..length).contains(&centre.x) && centre.y.abs() < 0.5 * height + across.max(along)
        };
        let quads: Vec<[u32; 4]> = all.quads.into_iter().filter(within).collect();
        let mut numbers = vec![u32::MAX; places.len()];
        let mut nodes = vec![];
        let mut number = |n: u32| {
            if numbers[n as usize] == u32::MAX {
                numbers[n as usize] = nodes.len() as u32;
                nodes.push(places[n as usize]);
            }
            numbers[n as usize]
        };
        let quads = quads.iter().map(|quad| quad.map(&mut number)).collect();
        Mesh { nodes, quads, ..Mesh::default() }
    }
}

/// A rectangle of film that is pulled along y.
struct Pulled {
    section: Section,
    shape: Shape,
    /// Length along x and distance of the jaws, m.
    lengths: [f64; 2],
    /// Where the cut starts and ends along x, m.
    cut: [f64; 2],
    /// Strain at the start, and per s.
    strain: [f64; 2],
}

impl Pulled {
    /// Strain, and the mean stress across (Pa) for the stress-free film, when the tear has grown by so much (m).
    fn grown(&self, by: f64, most: f64) -> [f64; 2] {
        let [length, height] = self.lengths;
        let mesh = self.shape.mesh(self.lengths);
        let mut nodes = Nodes::default();
        let mut film = Film::mount(&mesh, &self.section, 0.0, &mut nodes).unwrap();
        film.cut(&nodes, &[[self.cut[0], 1e-6], [self.cut[1], 1e-6]]);
        let [start, rate] = self.strain;
        let mut jaws = [-1.0, 1.0].map(|side| Jaw { nodes: vec![], velocity: 0.5 * side * rate * height });
        let mut upper = vec![];
        for n in 0..nodes.mass.len() {
            let [x, y, z] = nodes.position.value_at(n);
            if y.abs() > 0.5 * height - 1e-9 {
                // Beyond a jaw film is rigid.
                nodes.position.set(n, [x, y + 0.5 * y.signum() * start * height, z]);
                jaws[usize::from(y > 0.0)].nodes.push(n as u32);
                upper.extend((y > 0.0).then_some(n as u32));
            } else {
                nodes.position.set(n, [x, (1.0 + start) * y, z]);
                nodes.velocity.set(n, [0.0, rate * y, 0.0]);
            }
        }
        for (axis, jaw) in jaws.iter().enumerate() {
            nodes.hold(jaw.nodes.iter().map(|n| *n as usize), [true; 3]);
            let velocity = [0.0, jaws[axis].velocity, 0.0];
            jaw.nodes.iter().for_each(|n| nodes.velocity.set(*n as usize, velocity));
        }
        let loads = Loads { damping: 100.0, multiplicity: 1.0, ..Loads::default() };
        let mut engine = Engine::new(vec![film], nodes, [], loads);
        loop {
            let (time, torn, force) = engine
                .read_step(|view| (view.time, view.torn().unwrap().length, -view.nodes.total_force(&upper, 1)))
                .unwrap();
            let strain = start + rate * time;
            if torn > by || strain > most {
                return [strain, force / (length * self.section.thickness)];
            }
            (0..5).for_each(|_| assert!(engine.step(&mut Unobserved).is_ok()));
        }
    }
}

/// Γ of the rubber, J/m², its shear modulus, Pa, and the distance of its jaws, m: W H = Γ at a strain of 0.71.
const RUBBER: [f64; 3] = [25e3, 395e3, 0.1];

/// Energy of a wide strip of the rubber over what a tear takes, W H/Γ, when the tear has grown by 15 mm.
fn rubber(shape: Shape) -> f64 {
    let [energy, mu, height] = RUBBER;
    let law = HyperelasticLaw::Polynomial(Hyperelastic { energy: Polynomial::neo_hookean(mu), wrinkling: true });
    let rupture = Rupture { criterion: Criterion::Strain, limit: Limit::One(8.0), fracture_energy: energy };
    let section =
        Section { law: Law::Hyperelastic(law), rupture: Some(rupture), density: 930.0, thickness: 5e-4, ..section() };
    let pulled = Pulled { section, shape, lengths: [0.2, height], cut: [-0.01, 0.08], strain: [0.4, 1.0] };
    let [strain, _] = pulled.grown(15e-3, 1.1);
    let stretch = 1.0 + strain;
    0.5 * mu * (stretch * stretch + stretch.powi(-2) - 2.0) * height / energy
}

/// Elements of 5 mm, long and short along the tear, uneven and skewed, in a mesh that is turned by so many degrees.
fn shapes(turned: f64) -> Vec<Shape> {
    let size = 5e-3;
    let even = [[size, size], [2.0 * size, size], [size, 2.0 * size]].map(|edges| Shape::even(edges, turned));
    let square = even[0];
    [&even[..], &[Shape { uneven: 0.2, ..square }, Shape { skew: 0.4, ..square }]].concat()
}

/// A strip that is pulled at 1/s tears at somewhat more than W H = Γ: the tear has to grow meanwhile. On elements of other
/// shapes it tears at the energy of squares.
#[test]
fn a_wide_strip_of_rubber_tears_on_elements_of_any_shape() {
    let found: Vec<(Shape, f64)> = shapes(0.0).into_iter().map(|shape| (shape, rubber(shape))).collect();
    for (shape, ratio) in &found {
        println!("{shape:?}: W H/Γ {ratio:.3}");
    }
    let square = found[0].1;
    assert!((square - 1.0).abs() < 0.2, "{square}");
    assert!(found.iter().all(|(_, ratio)| (ratio / square - 1.0).abs() < 0.12), "{found:?}");
}

/// On meshes that the tear crosses, its path is one of steps, and it takes more (docs/limits.md). Minutes.
#[test]
#[ignore = "prints the figures of docs/limits.md"]
fn a_wide_strip_of_rubber_tears_later_on_meshes_that_are_turned() {
    for shape in [22.5, 45.0].into_iter().flat_map(shapes) {
        let ratio = rubber(shape);
        println!("{shape:?}: W H/Γ {ratio:.3}");
        assert!(ratio > 0.9 && ratio < 1.9, "{shape:?}: {ratio}");
    }
}

/// Stress over that at which a crack of the length 2 a in a wide plate grows: G = π σ² a/E sec(π a/L).
fn centre_crack(shape: Shape) -> f64 {
    // Whole elements are cut: half of the crack is five and a half of them.
    let (energy, half, length) = (1370.0, 0.0275, 0.2);
    let law = Law::Elastic(Elastic { young: YOUNG, poisson: POISSON });
    let rupture = Rupture { criterion: Criterion::Strain, limit: Limit::One(0.5), fracture_energy: energy };
    let section = Section { law, rupture: Some(rupture), thickness: THICKNESS, ..section() };
    let cut = [0.5 * length - half + 1e-4, 0.5 * length + half - 1e-4];
    let pulled = Pulled { section, shape, lengths: [length, 0.3], cut, strain: [0.005, 0.2] };
    let [_, stress] = pulled.grown(10e-3, 0.08);
    let pi = std::f64::consts::PI;
    stress * (pi * half / (pi * half / length).cos() / (YOUNG * energy)).sqrt()
}

#[test]
#[ignore = "prints the figures of docs/limits.md"]
fn a_crack_in_the_middle_of_a_plate_grows_at_its_stress() {
    for turned in [0.0, 22.5, 45.0] {
        let square = Shape::even([5e-3; 2], turned);
        for shape in [square, Shape { uneven: 0.2, ..square }] {
            let ratio = centre_crack(shape);
            println!("{shape:?}: stress over that of the crack {ratio:.3}");
            assert!((ratio - 1.0).abs() < 0.2, "{shape:?}: {ratio}");
        }
    }
}
