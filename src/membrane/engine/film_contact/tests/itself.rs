//! Faces that meet themselves: where they fold, where a tube is pressed flat, and where the lips of a cut or a tear meet.

use super::*;
use crate::engine::ThreadPool;
use crate::lane::Width;
use crate::material::Criterion;

/// A grid of quadrilaterals, `cells` along each direction, at `place` of shares between 0 and 1; closed where the last
/// column is the first one again.
pub(super) fn grid(cells: [u32; 2], is_closed: bool, place: impl Fn(f64, f64) -> Point3<f64>) -> Mesh {
    let [columns, rows] = cells;
    let row = if is_closed { columns } else { columns + 1 };
    let share = |k: u32, of: u32| f64::from(k) / f64::from(of);
    let nodes = (0..=rows).flat_map(|j| (0..row).map(move |i| (i, j)));
    let nodes = nodes.map(|(i, j)| place(share(i, columns), share(j, rows))).collect();
    let quad = |i: u32, j: u32| {
        let next = (i + 1) % row;
        [j * row + i, j * row + next, (j + 1) * row + next, (j + 1) * row + i]
    };
    let quads = (0..rows).flat_map(|j| (0..columns).map(move |i| quad(i, j))).collect();
    Mesh { nodes, quads, ..Mesh::default() }
}

pub(super) fn section(young: f64) -> Section {
    Section::new(Law::Elastic(Elastic { young, poisson: 0.3 }), 1000.0, THICKNESS)
}

/// Film that meets itself, mounted from `mesh` with a velocity (m/s) at every point.
pub(super) fn mount(mesh: &Mesh, section: &Section, velocity: impl Fn(Vector3<f64>) -> [f64; 3]) -> (Film, Nodes) {
    let mut nodes = Nodes::default();
    let film = Film::mount(mesh, section, 0.0, &mut nodes).unwrap();
    for n in film.nodes.clone() {
        let at = Vector3::from(nodes.position.value_at(n));
        nodes.velocity.set(n, velocity(at));
    }
    (film, nodes)
}

/// Least distance of parts of film over each other, m.
const LEAST: f64 = 0.8 * THICKNESS;

/// What a run came to.
#[derive(Debug, Default)]
pub(super) struct Course {
    crossings: usize,
    /// Least distance of parts of film over each other, m.
    distance: f64,
    /// Largest change of momentum, kg m/s, and of angular momentum, kg m²/s.
    pub(super) momentum: [f64; 2],
    /// Largest error of the energy balance, J, that lasts from one look to the next: where much film meets in one step,
    /// velocities at the full step show half of the loss only.
    error: f64,
    /// Energy at the start, and that exchanged until the end, J.
    start: f64,
    pub(super) exchanged: f64,
    pressed: usize,
    lost: u64,
    unresolved: [u64; 2],
}

impl Run {
    /// Steps until `end` (s), and looks at the film every `steps`.
    pub(super) fn course(&mut self, end: f64, steps: usize) -> Course {
        self.watched(end, steps, |_| {})
    }

    /// The same, with something else to `look` at.
    pub(super) fn watched(&mut self, end: f64, steps: usize, mut look: impl FnMut(&View<'_>)) -> Course {
        let start = self.after(1);
        let mut course = Course { distance: f64::INFINITY, start: start.energies.total(), ..Course::default() };
        let mut last = 0.0;
        while self.engine.time() < end {
            let now = self.after(steps);
            let crossed = self.observe(|view| {
                look(view);
                crossings(view.films, view.nodes, true)
            });
            course.crossings = course.crossings.max(crossed);
            course.distance = course.distance.min(now.contact.distance);
            let changes = [now.momentum - start.momentum, now.angular_momentum - start.angular_momentum];
            (0..2).for_each(|k| course.momentum[k] = course.momentum[k].max(changes[k].norm()));
            let error = (now.energies.total() - course.start).abs();
            course.error = course.error.max(error.min(last));
            course.exchanged = now.energies.exchanged(&start.energies);
            last = error;
            course.pressed = course.pressed.max(now.contact.nodes);
            (course.lost, course.unresolved) = (now.contact.lost, now.contact.unresolved);
        }
        println!("{course:?}");
        course
    }
}

impl Course {
    /// Film that is pressed on itself at `pressed` nodes or more at once, is nowhere nearer to itself than `least` (m), and
    /// keeps its energy to a thousandth of `energy` (J).
    pub(super) fn check(&self, pressed: usize, least: f64, energy: f64) {
        assert_eq!((self.crossings, self.lost, self.unresolved[0]), (0, 0, 0), "{self:?}");
        assert!(self.distance > least && self.pressed >= pressed, "{self:?}");
        assert!(self.error < 1e-3 * energy, "{self:?}");
    }
}

/// A tube whose upper and lower half move towards each other until its inner sides meet, with meshes that fit and that do
/// not.
fn tube(skew: f64) -> (Film, Nodes) {
    let radius = 0.02;
    let mesh = grid([36, 16], true, |u, v| {
        let angle = std::f64::consts::TAU * (u + skew * v);
        Point3::new(radius * angle.cos(), 0.06 * (v - 0.5), radius * angle.sin())
    });
    mount(&mesh, &section(2e8), |at| [0.3 * at.y / 0.03, 0.1, -4.0 * at.z / radius])
}

fn free(film: Film, nodes: Nodes, friction: f64, step_factor: f64) -> Run {
    let loads = Loads { step_factor, ..Loads::default() };
    Run { engine: Engine::new(vec![film], nodes, [], loads).with_self_contact(friction) }
}

/// Steps in which the halves of a cut meet.
const STEPS: usize = 640;

/// Bits of all positions after so many steps of `build` on so many threads, with a restart on the way or without.
fn bits(build: &dyn Fn() -> Run, threads: usize, width: Width, restarts: bool) -> Vec<u64> {
    let build = || build().engine.with_pool(ThreadPool::new(threads).at_width(width));
    let mut engine = build();
    let mut pressed = 0;
    for step in 0..STEPS {
        if restarts && step == STEPS * 4 / 5 {
            let state = engine.state();
            engine = build();
            engine.restore(state).expect("a state");
        }
        let nodes = engine.read_step(|view| view.film_contact_state().map_or(0, |state| state.nodes)).expect("a step");
        pressed = pressed.max(nodes);
    }
    assert!(pressed > 10, "{pressed}");
    engine.nodes.position.iter().flatten().map(f64::to_bits).collect()
}

#[test]
fn bits_depend_on_neither_threads_nor_width_nor_a_restart() {
    let build = || {
        let (film, nodes) = halves(0.2);
        free(film, nodes, 0.3, 1.0)
    };
    let expected = bits(&build, 1, Width::Baseline, false);
    for width in Width::available() {
        for threads in [1, 3] {
            assert!(bits(&build, threads, width, true) == expected, "{threads} threads, {width:?}");
        }
    }
}

#[test]
fn a_tube_that_is_pressed_flat_meets_itself() {
    for (skew, friction) in thorough::first(1, [(0.13, 0.3), (0.0, 0.0), (0.0, 0.3)]) {
        let (film, nodes) = tube(skew);
        let course = free(film, nodes, friction, 0.5).course(0.016, 20);
        course.check(40, LEAST, course.start);
        assert!(course.momentum[0] < 1e-15, "{course:?}");
    }
}

/// A square that is cut in two, whose halves move towards each other: in their plane, and so that one comes over the other
/// at one end and under it at the other.
fn halves(lift: f64) -> (Film, Nodes) {
    let mesh = square(0.1, 20, 0.0);
    let (mut film, nodes) = mount(&mesh, &section(2e8), |at| {
        let side = at.y.signum();
        [0.05 * side, -side, lift * side * at.x / 0.05]
    });
    assert_eq!(film.cut(&nodes, &[[-0.06, 0.0024], [0.06, 0.0024]]), 20);
    (film, nodes)
}

#[test]
fn the_lips_of_a_cut_meet() {
    for (lift, pressed) in thorough::first(2, [(0.2, 40), (-1.0, 4), (0.0, 40)]) {
        let (film, nodes) = halves(lift);
        let course = free(film, nodes, 0.3, 0.5).course(0.016, 20);
        course.check(pressed, LEAST, course.start);
        assert!(course.momentum[0] < 1e-15, "{course:?}");
    }
}

/// A body that stands still beside the film.
pub(super) fn fixed(surface: Surface, height: f64, friction: f64, offset: &[f64]) -> Impact {
    let body = RigidBody::prescribed(Isometry3::translation(0.0, 0.0, height), 0.0);
    Impact::new(body, Contact::new(surface, friction, 1.0, offset.to_vec()))
}

/// A sheet that falls upright on a ball. Of the energy balance, steps of the central differences leave 9e-3 on its sharp
/// folds, half of them 2.3e-3, a quarter 8e-4.
fn falling() -> Run {
    let radius = 0.5;
    let mesh = grid([20, 20], false, |u, v| Point3::new(0.1 * (u - 0.5), 1e-3 * (9.0 * v + 2.0 * u).sin(), 0.1 * v));
    let (film, nodes) = mount(&mesh, &section(2e7), |_| [0.0, 0.0, -3.0]);
    let offset = vec![0.5 * THICKNESS; nodes.mass.len()];
    let floor = fixed(Surface::sphere(radius).unwrap(), -radius - 1e-3, 0.3, &offset);
    let loads = Loads { gravity: 9.81, step_factor: 0.25, ..Loads::default() };
    Run { engine: Engine::new(vec![film], nodes, [floor], loads).with_self_contact(0.3) }
}

#[test]
fn a_sheet_that_falls_edge_on_folds_on_itself() {
    let course = falling().course(0.03, 40);
    course.check(20, LEAST, course.start);
}

/// A clamped square that a sphere tears, which springs back behind it: the lips of the tear meet the film and each other. With
/// some steps they come nearer than allowed (docs/limits.md).
#[test]
fn the_lips_of_a_tear_meet() {
    if !thorough::thorough() {
        return;
    }
    let rupture = Rupture { criterion: Criterion::Strain, limit: 0.05, fracture_energy: 1e4 };
    let scene = Scene {
        prestrain: 0.02,
        is_clamped: true,
        friction: 0.3,
        rupture: vec![Some(rupture)],
        sphere: Some((0.03, 8.0, 0.5)),
        loads: Loads { step_factor: 0.5, ..Loads::default() },
        ..Scene::default()
    };
    let mut run = scene.with(&[(square(0.2, 20, 0.0), 0.0, [0.0; 3])]);
    run.engine = run.engine.with_self_contact(0.3);
    let course = run.course(0.03, 25);
    assert!(run.observe(|view| view.films[0].torn().length) > 0.1);
    course.check(5, LEAST, course.start);
}

/// A free sheet around a ball: its thickness (m), the speed of the ball (m/s), the friction, and the share of the time step.
struct Wrap {
    thickness: f64,
    speed: f64,
    friction: f64,
    step_factor: f64,
}

impl Wrap {
    /// Of the ball's flight into the sheet, which wraps around it in sharp folds that move over themselves by more than
    /// they are thick in a step.
    fn course(&self) -> Course {
        let Wrap { thickness, speed, friction, step_factor } = *self;
        let section = Section { thickness, ..section(5e6) };
        let (film, nodes) = mount(&square(0.4, 25, 0.0), &section, |_| [0.0; 3]);
        let offset = vec![0.5 * thickness; nodes.mass.len()];
        let pose = Isometry3::translation(0.0, 0.0, 0.04 + 0.5 * thickness);
        let contact = Contact::new(Surface::sphere(0.04).unwrap(), friction, 1.0, offset);
        let ball = Impact::new(RigidBody::guided(pose, -speed, 0.5), contact).starting_in_contact(true);
        let loads = Loads { gravity: 9.81, damping: 5.0, step_factor, ..Loads::default() };
        let engine = Engine::new(vec![film], nodes, [ball], loads).with_self_contact(friction);
        Run { engine }.course(0.12, 10)
    }
}

fn a_sheet_that_wraps_around_a_ball_does_not_cross_itself(speed: f64, step_factor: f64) {
    let course = Wrap { thickness: 3e-4, speed, friction: 0.4, step_factor }.course();
    assert_eq!((course.crossings, course.lost, course.unresolved[0]), (0, 0, 0), "{course:?}");
    assert!(course.distance > 0.0 && course.pressed > 50 && course.error < 2e-3 * course.start, "{course:?}");
}

thorough::cases!(a_sheet_that_wraps_around_a_ball_does_not_cross_itself {
    slow: 4.0, 1.0;
} thorough {
    slow_with_half_the_step: 4.0, 0.5;
    fast_with_half_the_step: 6.0, 0.5;
});

/// 24 of them.
fn no_variant_of_a_sheet_around_a_ball_crosses_itself(step_factor: f64, speed: f64) {
    for (thickness, friction) in [(2e-4, 0.4), (3e-4, 0.4), (5e-4, 0.4), (3e-4, 0.0)] {
        println!("{thickness} m, {speed} m/s, friction {friction}, steps {step_factor}:");
        let course = Wrap { thickness, speed, friction, step_factor }.course();
        assert_eq!((course.crossings, course.lost), (0, 0), "{course:?}");
        assert!(course.distance > 0.1 * thickness && course.error < 2.5e-3 * course.start, "{course:?}");
    }
}

thorough::cases!(no_variant_of_a_sheet_around_a_ball_crosses_itself {} thorough {
    at_4_m_s: 1.0, 4.0;
    at_6_m_s: 1.0, 6.0;
    at_8_m_s: 1.0, 8.0;
    at_4_m_s_with_half_the_step: 0.5, 4.0;
    at_6_m_s_with_half_the_step: 0.5, 6.0;
    at_8_m_s_with_half_the_step: 0.5, 8.0;
});
