//! Free oscillation of pre-strained film: eigenfrequencies, decay by damping, the time step.

use std::f64::consts::PI;

use droptower::engine::{Engine, Loads};
use droptower::material::{Elastic, Law, Material};
use droptower::mesh;
use droptower::mesh::{Element, Meshing, Outline, Side};
use droptower::model::Face;

use super::claims::Claims;
use super::scene::{mounted, observe_step, positions, set_positions};
use super::sheet;

const DENSITY: f64 = 915.0;
const YOUNG: f64 = 50e6;
const SPAN: f64 = 0.2;
const EDGE: f64 = 0.01;
const PRESTRAIN: f64 = 0.05;
/// Height of the first mode over the span: small enough that its own stretch is a 1e-5 part of the pre-strain.
const HEIGHT: f64 = 5e-4;

/// The oscillating film.
#[derive(Clone, Copy, Debug)]
enum Film {
    /// Held at its ends, stretched along x.
    Strip,
    /// Held at its rim, stretched in both directions.
    Square,
}

impl Film {
    fn poisson(self) -> f64 {
        match self {
            Film::Strip => 0.0,
            Film::Square => 0.44,
        }
    }

    /// √(Pλ/ρ): P the first Piola–Kirchhoff stress of St. Venant–Kirchhoff at stretch λ, mass per stress-free volume ρ.
    fn wave_speed(self) -> f64 {
        let stretch = 1.0 + PRESTRAIN;
        let second = YOUNG / (1.0 - self.poisson()) * 0.5 * (stretch * stretch - 1.0);
        stretch * (second / DENSITY).sqrt()
    }

    /// Eigenfrequency of the mode with `m` and `n` half waves along x and y, Hz.
    fn frequency(self, [m, n]: [u32; 2]) -> f64 {
        let waves = match self {
            Film::Strip => f64::from(m),
            Film::Square => f64::from(m).hypot(f64::from(n)),
        };
        self.wave_speed() / (2.0 * SPAN) * waves
    }

    fn width(self, edge: f64) -> f64 {
        match self {
            Film::Strip => edge,
            Film::Square => SPAN,
        }
    }

    /// The engine at rest in the shape of a mode on elements of `edge` (m), and the share of each node in
    /// the height of the mode.
    fn deflected(self, element: Element, edge: f64, mode: [u32; 2], damping: f64) -> (Engine, Vec<f64>) {
        let law = Law::Elastic(Elastic { young: YOUNG, poisson: self.poisson() });
        let material = Material::new(law, DENSITY, 12e-6);
        let meshing = Meshing { element, size: edge, grading: None };
        let across = match self {
            Film::Strip => 0.0,
            Film::Square => PRESTRAIN,
        };
        let face = Face { meshing, ..sheet::face(material, element, [PRESTRAIN, across]) };
        let shape = Outline::Rectangle { x: SPAN, y: self.width(edge) };
        let mesh = mesh::build(&shape, [false; 2], &face.meshing).expect("a mesh");
        let (film, mut nodes) = mounted(&mesh, &face);
        let ends = [Side::XMinus, Side::XPlus].map(|side| mesh.sides[side as usize].clone()).concat();
        let held = match self {
            Film::Strip => ends,
            Film::Square => mesh.rim.clone(),
        };
        set_positions(&mut nodes, |_, x| {
            let along = |axis: usize| (PI * f64::from(mode[axis]) * (x[axis] / SPAN + 0.5)).sin();
            let shape = match self {
                Film::Strip => along(0),
                Film::Square => along(0) * along(1),
            };
            [x[0], x[1], HEIGHT * SPAN * shape]
        });
        nodes.hold(held.iter().map(|n| *n as usize), [true; 3]);
        let shape: Vec<f64> = positions(&nodes).iter().map(|x| x[2] / (HEIGHT * SPAN)).collect();
        let whole: f64 = shape.iter().zip(&nodes.mass).map(|(s, m)| m * s * s).sum();
        let shares = shape.iter().zip(&nodes.mass).map(|(s, m)| m * s / whole).collect();
        let loads = Loads { damping, multiplicity: 1.0, ..Loads::default() };
        (Engine::new(vec![film], nodes, [], loads), shares)
    }
}

/// Zero crossings of the mode, s, and its extremes between them.
fn oscillation(engine: &mut Engine, shares: &[f64], crossings: usize) -> (Vec<f64>, Vec<f64>) {
    let (mut times, mut extremes) = (vec![], vec![]);
    let (mut last, mut extreme) = ([0.0, 0.0], 0.0_f64);
    while times.len() < crossings {
        let [time, z] = observe_step(engine, |view| {
            let heights = positions(view.nodes).into_iter().map(|x| x[2]);
            [view.time, heights.zip(shares).map(|(z, share)| z * share).sum()]
        });
        if last[1] * z < 0.0 {
            times.push(last[0] + (time - last[0]) * last[1] / (last[1] - z));
            extremes.push(extreme);
            extreme = 0.0;
        }
        extreme = extreme.max(z.abs());
        last = [time, z];
    }
    (times, extremes)
}

#[test]
fn prestrained_film_oscillates_at_its_eigenfrequency() {
    let mut claims = Claims::of("eigenfrequency");
    for film in [Film::Strip, Film::Square] {
        for element in [Element::Quad4, Element::Quad4Full, Element::Tri3] {
            for (mode, edge) in [([1, 1], EDGE), ([2, 1], EDGE), ([3, 2], 0.5 * EDGE)] {
                let what = |claim: &str| format!("{film:?} {element:?}, mode {mode:?}, {claim}");
                let (mut engine, shares) = film.deflected(element, edge, mode, 0.0);
                let (times, extremes) = oscillation(&mut engine, &shares, 11);
                let frequency = 10.0 / (2.0 * (times[10] - times[0]));
                claims.near(&what("Hz"), frequency, film.frequency(mode), 1e-2);
                claims.near(&what("amplitude after ten half periods, m"), extremes[10], extremes[1], 1e-2);
            }
        }
    }
}

#[test]
fn eigenfrequencies_converge_with_the_square_of_the_size() {
    let mut claims = Claims::of("eigenfrequency");
    for element in [Element::Quad4, Element::Quad4Full, Element::Tri3] {
        let errors = [2.0, 1.0, 0.5].map(|share| {
            let (mut engine, shares) = Film::Square.deflected(element, share * EDGE, [1, 1], 0.0);
            let (times, _) = oscillation(&mut engine, &shares, 3);
            1.0 / (times[2] - times[0]) / Film::Square.frequency([1, 1]) - 1.0
        });
        claims.converges(&format!("{element:?}, square, first mode"), &errors, 1.9);
    }
}

#[test]
fn amplitude_decays_at_half_the_rate_of_damping() {
    let mut claims = Claims::of("damping");
    for ratio in [0.02, 0.2] {
        let undamped = 2.0 * PI * Film::Strip.frequency([1, 1]);
        let damping = ratio * undamped;
        let (mut engine, shares) = Film::Strip.deflected(Element::Quad4, EDGE, [1, 1], damping);
        let start = observe_step(&mut engine, |view| view.energies());
        let (times, extremes) = oscillation(&mut engine, &shares, 11);
        let rate = (extremes[1] / extremes[10]).ln() / (9.0 * (times[10] - times[1]) / 9.0);
        claims.near(&format!("rate of decay at α = {damping:.0} 1/s"), 2.0 * rate, damping, 1e-2);
        let angular = 10.0 * PI / (times[10] - times[0]);
        let damped = (undamped * undamped - 0.25 * damping * damping).sqrt();
        claims.near(&format!("damped angular frequency at α = {damping:.0} 1/s"), angular, damped, 1e-2);
        let end = observe_step(&mut engine, |view| view.energies());
        let error = (end.total() - start.total()).abs() / end.exchanged(&start);
        claims.at_most(&format!("energy balance error at α = {damping:.0} 1/s"), error, 1e-3);
    }
}

/// A bar of lumped masses along x has the highest frequency 2√(P′/ρ)/h, so that no stable step is longer than
/// h/√(P′/ρ), h the stress-free edge and P′ = E(3λ² − 1)/2; with damping the limit is shorter.
#[test]
fn the_time_step_is_below_the_limit() {
    let mut claims = Claims::of("time step");
    let stretch: f64 = 1.0 + PRESTRAIN;
    let tangent = 0.5 * YOUNG * (3.0 * stretch * stretch - 1.0);
    let limit = EDGE / stretch / (tangent / DENSITY).sqrt();
    for element in [Element::Quad4, Element::Quad4Full, Element::Tri3] {
        let (engine, _) = Film::Strip.deflected(element, EDGE, [1, 1], 0.0);
        claims.at_most(&format!("{element:?}, step over the limit of a bar"), engine.time_step() / limit, 1.0);
        let damping = 2.0 / limit;
        let (damped, _) = Film::Strip.deflected(element, EDGE, [1, 1], damping);
        let ratio = damping * 0.5 * limit / 2.0;
        let shorter = (1.0 + ratio * ratio).sqrt() - ratio;
        let step = damped.time_step() / limit;
        claims.at_most(&format!("{element:?}, damped step over the limit of a damped bar"), step / shorter, 1.0);
    }
}
