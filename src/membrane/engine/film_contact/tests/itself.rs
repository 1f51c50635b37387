//! Faces that meet themselves: where they fold, where a tube is pressed flat, and where the lips of a cut or a tear meet.

use super::*;

/// A grid of quadrilaterals, `cells` along each direction, at `place` of shares between 0 and 1; closed where the last
/// column is the first one again.
fn grid(cells: [u32; 2], is_closed: bool, place: impl Fn(f64, f64) -> Point3<f64>) -> Mesh {
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

fn section(young: f64) -> Section {
    Section {
        law: Law::Elastic(Elastic { young, poisson: 0.3 }),
        viscosity: None,
        rupture: None,
        density: 1000.0,
        thickness: THICKNESS,
        md_angle: 0.0,
        prestrain: [0.0; 2],
        full_integration: false,
    }
}

/// Film that meets itself, mounted from `mesh` with a velocity (m/s) at every point.
fn mount(mesh: &Mesh, section: &Section, velocity: impl Fn(Vector3<f64>) -> [f64; 3]) -> (Film, Nodes) {
    let mut nodes = Nodes::default();
    let film = Film::mount(mesh, section, 0.0, &mut nodes).unwrap();
    for n in film.nodes.clone() {
        let at = Vector3::from(nodes.position.value_at(n));
        nodes.velocity.set(n, velocity(at));
    }
    (film, nodes)
}

/// Pairs of triangles of one film that cross each other, but for those that have no other point in common than film that
/// is connected has.
fn self_crossings(view: &View<'_>) -> usize {
    let at = |n: u32| Vector3::from(view.nodes.position.value_at(n as usize));
    let mut count = 0;
    for film in view.films {
        let mut all: Vec<[u32; 3]> = vec![];
        film.for_each_intact(|corners| {
            all.push([corners[0], corners[1], corners[2]]);
            if corners.len() == 4 {
                all.push([corners[0], corners[2], corners[3]]);
            }
        });
        let low = |t: &[u32; 3]| at(t[0]).inf(&at(t[1])).inf(&at(t[2]));
        let high = |t: &[u32; 3]| at(t[0]).sup(&at(t[1])).sup(&at(t[2]));
        let boxes: Vec<_> = all.iter().map(|t| (low(t), high(t))).collect();
        let pierced = |edge: [u32; 2], t: &[u32; 3]| {
            !edge.iter().any(|n| t.contains(n)) && pierces(edge.map(at), t.map(at))
        };
        let edges = |t: &[u32; 3]| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
        for (k, s) in all.iter().enumerate() {
            for (l, t) in all.iter().enumerate().skip(k + 1) {
                let apart = (0..3).any(|axis| {
                    boxes[k].0[axis] > boxes[l].1[axis] || boxes[l].0[axis] > boxes[k].1[axis]
                });
                if !apart {
                    let cross = edges(s).into_iter().any(|e| pierced(e, t)) || edges(t).into_iter().any(|e| pierced(e, s));
                    count += usize::from(cross);
                }
            }
        }
    }
    count
}

/// What a run came to.
#[derive(Debug, Default)]
struct Course {
    crossings: usize,
    /// Least distance of parts of film over each other, m.
    distance: f64,
    /// Largest change of momentum, kg m/s, and of angular momentum, kg m²/s.
    momentum: [f64; 2],
    /// Largest error of the energy balance.
    balance: f64,
    pressed: usize,
    lost: u64,
    unresolved: [u64; 2],
}

impl Run {
    /// Steps until `end` (s), and looks at the film every `steps`.
    fn course(&mut self, end: f64, steps: usize) -> Course {
        let start = self.after(1);
        let mut course = Course { distance: f64::INFINITY, ..Course::default() };
        while self.engine.time() < end {
            let now = self.after(steps);
            let crossed = self.observe(self_crossings);
            if std::env::var("SHOW").is_ok() {
                println!("{:.5} crossed {crossed} {:?} balance {:.1e} {:.3e}", self.engine.time(), now.contact, now.balance_error(&start), now.energies.total());
            }
            course.crossings = course.crossings.max(crossed);
            course.distance = course.distance.min(now.contact.distance);
            let changes = [now.momentum - start.momentum, now.angular_momentum - start.angular_momentum];
            (0..2).for_each(|k| course.momentum[k] = course.momentum[k].max(changes[k].norm()));
            course.balance = course.balance.max(now.balance_error(&start));
            course.pressed = course.pressed.max(now.contact.nodes);
            (course.lost, course.unresolved) = (now.contact.lost, now.contact.unresolved);
        }
        println!("{course:?}");
        course
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

#[test]
fn a_tube_that_is_pressed_flat_meets_itself() {
    for (skew, friction) in [(0.0, 0.0), (0.0, 0.3), (0.13, 0.3)] {
        let (film, nodes) = tube(skew);
        let course = free(film, nodes, friction, 1.0).course(0.02, 20);
        assert_eq!((course.crossings, course.lost), (0, 0));
        assert!(course.distance > 0.7 * THICKNESS && course.pressed > 100);
        assert!(course.momentum[0] < 1e-13 && course.balance < 1e-3);
    }
}

/// A square that is cut in two, whose halves move towards each other: in their plane, and so that one comes over the other
/// at one end and under it at the other.
fn halves(lift: f64) -> (Film, Nodes) {
    let mesh = square(0.1, 20, 0.0);
    let (mut film, nodes) = mount(&mesh, &section(2e8), |at| {
        let side = at.y.signum();
        [0.05 * side, -1.0 * side, lift * side * at.x / 0.05]
    });
    assert_eq!(film.cut(&nodes, &[[-0.06, 0.0024], [0.06, 0.0024]]), 20);
    (film, nodes)
}

#[test]
fn the_lips_of_a_cut_meet() {
    for lift in [0.0, 0.2, -1.0] {
        let (film, nodes) = halves(lift);
        let course = free(film, nodes, 0.3, 1.0).course(0.02, 20);
        assert_eq!((course.crossings, course.lost), (0, 0));
        assert!(course.momentum[0] < 1e-13 && course.balance < 1e-3);
        assert!(course.pressed > 10);
    }
}

/// A sheet that falls upright on a ball.
fn falling(step_factor: f64, meets: bool) -> Run {
    let radius = 0.5;
    let mesh = grid([20, 20], false, |u, v| Point3::new(0.1 * (u - 0.5), 1e-3 * (9.0 * v + 2.0 * u).sin(), 0.1 * v));
    let (film, nodes) = mount(&mesh, &section(2e7), |_| [0.0, 0.0, -3.0]);
    let offset = vec![0.5 * THICKNESS; nodes.mass.len()];
    let pose = Isometry3::translation(0.0, 0.0, -radius - 1e-3);
    let contact = Contact::new(Surface::sphere(radius).unwrap(), 0.3, 1.0, offset);
    let floor = Impact::new(RigidBody::prescribed(pose, 0.0), contact);
    let loads = Loads { gravity: 9.81, step_factor, ..Loads::default() };
    let engine = Engine::new(vec![film], nodes, [floor], loads);
    Run { engine: if meets { engine.with_self_contact(0.3) } else { engine } }
}

#[test]
fn a_sheet_that_falls_edge_on_folds_on_itself() {
    let course = falling(1.0, true).course(0.06, 20);
    assert_eq!((course.crossings, course.lost), (0, 0));
    assert!(course.balance < 2e-3);
}

#[test]
#[ignore]
fn debug_balance() {
    for factor in [1.0, 0.5, 0.25] {
        println!("{factor}");
        falling(factor, true).course(0.03, 20);
        let (film, nodes) = tube(0.0);
        free(film, nodes, 0.0, factor).course(0.012, 20);
        let (film, nodes) = halves(0.0);
        free(film, nodes, 0.0, factor).course(0.012, 20);
    }
}

fn debug(view: &View<'_>) -> bool {
    let at = |n: u32| Vector3::from(view.nodes.position.value_at(n as usize));
    let contact = view.film_contact.unwrap();
    let surface = &contact.surface;
    let itself = contact.itself.as_ref().unwrap();
    let mut any = false;
    for (s, one) in surface.corners.iter().enumerate() {
        for (t, other) in surface.corners.iter().enumerate().skip(s + 1) {
            if !surface.is_intact[s] || !surface.is_intact[t] {
                continue;
            }
            let edges = |t: &[u32; 3]| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
            let pierced = |edge: [u32; 2], t: &[u32; 3]| {
                !edge.iter().any(|n| t.contains(n)) && pierces(edge.map(at), t.map(at))
            };
            let by = edges(one).into_iter().find(|e| pierced(*e, other)).map(|e| (e, other)).or(edges(other).into_iter().find(|e| pierced(*e, one)).map(|e| (e, one)));
            if let Some((e, t0)) = by {
                any = true;
                println!("triangles {s} {one:?} and {t} {other:?}: edge {e:?} pierces {t0:?}");
                for n in one.iter().chain(other) {
                    println!("   node {n} at {:?}", at(*n).map(|x| (x * 1e6).round()));
                }
                itself.show(surface, &view.nodes.position, [s as u32, t as u32]);
            }
        }
    }
    any
}

#[test]
#[ignore]
fn debug_tube() {
    let (film, nodes) = tube(0.0);
    let mut run = free(film, nodes, 0.0, 1.0);
    while run.engine.time() < 0.02 {
        if run.engine.time() > std::env::var("FROM").unwrap().parse::<f64>().unwrap() {
            let t = run.engine.time();
            if run.observe(debug) {
                println!("at {t}");
                return;
            }
        } else {
            run.engine.step(&mut Unobserved).unwrap();
        }
    }
}
