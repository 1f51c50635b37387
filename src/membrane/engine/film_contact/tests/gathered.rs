//! Film that gathers and meets itself: taken through a ring, dragged along in a fold, and as a bag that is emptied.

use std::f64::consts::PI;

use nalgebra::{Matrix3, Vector2};

use super::itself::{fixed, grid, mount, section};
use super::*;
use crate::engine::Inflation;

fn positions<'a>(view: &'a View<'_>) -> impl Iterator<Item = Vector3<f64>> + 'a {
    (0..view.nodes.mass.len()).map(|n| Vector3::from(view.nodes.position.value_at(n)))
}

/// A free square lies on a ring of straight bars, and a ball takes it through: it gathers in pleats between both.
#[test]
fn film_that_a_ball_takes_through_a_ring_gathers_without_crossing() {
    if !thorough::thorough() {
        return;
    }
    let [thickness, opening, bar, radius] = [3e-4, 0.06, 0.008, 0.03];
    let section = Section { thickness, ..section(5e6) };
    let (film, nodes) = mount(&square(0.26, 26, 0.2), &section, |_| [0.0; 3]);
    let offset = vec![0.5 * thickness; nodes.mass.len()];
    let height = -bar - 0.5 * thickness;
    let corner = |k: u32| [f64::cos(PI / 16.0 * f64::from(k)) * opening, f64::sin(PI / 16.0 * f64::from(k)) * opening];
    let lines: Vec<[[f64; 2]; 2]> = (0..32).map(|k| [corner(k), corner(k + 1)]).collect();
    let ring = fixed(Surface::bars(&lines, bar, 0.0).unwrap(), height, 0.2, &offset);
    let pose = Isometry3::translation(0.0, 0.0, radius + 0.5 * thickness);
    let contact = Contact::new(Surface::sphere(radius).unwrap(), 0.4, 1.0, offset);
    let ball = Impact::new(RigidBody::guided(pose, -4.0, 0.3), contact).starting_in_contact(true);
    let loads = Loads { damping: 5.0, step_factor: 0.5, ..Loads::default() };
    let mut run = Run { engine: Engine::new(vec![film], nodes, [ball, ring], loads).with_self_contact(0.3) };
    // Nodes on the bar are half a thickness above it: the nearest, and how many there are at most.
    let (mut nearest, mut most) = (f64::INFINITY, 0);
    let course = run.watched(0.06, 20, |view| {
        let beside = |at: Vector3<f64>, [from, to]: &[[f64; 2]; 2]| {
            let [from, to] = [from, to].map(|end| Vector2::from(*end));
            let (arm, along) = (at.xy() - from, to - from);
            (arm - along * (arm.dot(&along) / along.norm_squared()).clamp(0.0, 1.0)).norm()
        };
        let nearest_line = |at: Vector3<f64>| lines.iter().map(|line| beside(at, line)).fold(f64::INFINITY, f64::min);
        let gap = |at: Vector3<f64>| nearest_line(at).hypot(at.z - height) - bar;
        nearest = positions(view).map(gap).fold(nearest, f64::min);
        most = most.max(positions(view).filter(|at| gap(*at) < thickness).count());
    });
    println!("nearest to the bar {nearest}, {most} nodes on it");
    course.check(50, 0.6 * thickness, 2.0 * course.exchanged);
    assert!(nearest > 0.4 * thickness && most > 20, "{nearest} {most}");
    let highest = run.observe(|view| positions(view).map(|at| at.z).fold(f64::MIN, f64::max));
    assert!(highest < height - bar, "all of the film is below the ring: {highest}");
}

/// A sheet in three layers, folded about two lines, lies on a flat block; a ball that slides over it drags the upper layer
/// by friction, and one fold after it.
#[test]
fn a_fold_that_a_ball_drags_does_not_cross_itself() {
    if !thorough::thorough() {
        return;
    }
    let (bend, flat, thickness) = (4e-4, 0.08, 2e-4);
    let arc = PI * bend;
    let length = 3.0 * flat + 2.0 * arc;
    // Along the sheet: right at the bottom, back in the middle, right at the top.
    let profile = |s: f64| -> [f64; 2] {
        let around = |s: f64, side: f64| [side * bend * (s / bend).sin(), bend * (1.0 - (s / bend).cos())];
        if s < flat {
            [s, 0.0]
        } else if s < flat + arc {
            let [x, z] = around(s - flat, 1.0);
            [flat + x, z]
        } else if s < 2.0 * flat + arc {
            [2.0 * flat + arc - s, 2.0 * bend]
        } else if s < 2.0 * (flat + arc) {
            let [x, z] = around(s - 2.0 * flat - arc, -1.0);
            [x, 2.0 * bend + z]
        } else {
            [s - 2.0 * (flat + arc), 4.0 * bend]
        }
    };
    let cells = [36, 6];
    let mesh = grid(cells, false, |u, v| {
        let [x, z] = profile(u * length);
        Point3::new(x - 0.5 * flat, 0.05 * (v - 0.5), z)
    });
    let section = Section { thickness, ..section(5e6) };
    let (film, nodes) = mount(&mesh, &section, |_| [0.0; 3]);
    let offset = vec![0.5 * thickness; nodes.mass.len()];
    let depth = 0.02;
    let block = Surface::cuboid([0.6, 0.6, depth], 2e-3).unwrap();
    let floor = fixed(block, -0.5 * depth - 0.5 * thickness, 0.6, &offset);
    let radius = 0.02;
    let pose = Isometry3::translation(-0.02, 0.0, 4.0 * bend + radius + 0.5 * thickness);
    // Too inert to roll.
    let ball = RigidBody::free(pose, Vector3::new(1.0, 0.0, 0.0), 1.0, Matrix3::identity());
    let contact = Contact::new(Surface::sphere(radius).unwrap(), 0.6, 1.0, offset);
    let ball = Impact::new(ball, contact).starting_in_contact(true);
    let loads = Loads { gravity: 9.81, damping: 5.0, step_factor: 0.5, ..Loads::default() };
    let mut run = Run { engine: Engine::new(vec![film], nodes, [ball, floor], loads).with_self_contact(0.1) };
    let row = cells[0] as usize + 1;
    // Mean of a column of nodes, two thirds along the sheet that of the second fold.
    let mean = |run: &mut Run, column: usize| {
        let sum = |view: &View<'_>| positions(view).skip(column).step_by(row).map(|at| at.x).sum::<f64>();
        run.observe(sum) / f64::from(cells[1] + 1)
    };
    let drawn = |run: &mut Run| mean(run, 2 * cells[0] as usize / 3) - mean(run, 0);
    let start = drawn(&mut run);
    let course = run.course(0.03, 20);
    let drawn = drawn(&mut run) - start;
    println!("the fold is {drawn} nearer to the ball, over the layer below");
    // Folds are as sharp as elements, and the ball has fifteen times the energy that is exchanged.
    course.check(50, 0.4 * thickness, 6.0 * course.exchanged);
    assert!(drawn > 5e-3, "{drawn}");
}

/// A pillow of two sheets that are joined at their edges, neither of which is the image of the other.
fn pillow(size: f64, cells: u32, height: f64) -> Mesh {
    let at = |k: u32| f64::from(k) / f64::from(cells) - 0.5;
    let row = cells + 1;
    let is_rim = |i: u32, j: u32| [i, j].iter().any(|k| [0, cells].contains(k));
    let dome = |i: u32, j: u32| (PI * at(i)).cos() * (PI * at(j)).cos();
    let mut mesh = Mesh::default();
    // Numbers of the nodes of the upper and of the lower half; those of the rim are shared.
    let mut number = [vec![], vec![]];
    for (half, side) in [1.0, -1.0].into_iter().enumerate() {
        for j in 0..row {
            for i in 0..row {
                let shared = (half == 1 && is_rim(i, j)).then(|| number[0][(j * row + i) as usize]);
                let node = shared.unwrap_or(mesh.nodes.len() as u32);
                number[half].push(node);
                if shared.is_none() {
                    // The lower half is flatter, skewed to the other side, and its nodes lie a third of a cell beside those
                    // of the upper one.
                    let (x, y) = (at(i), at(j));
                    let z = height * (side + 0.15) * dome(i, j) * (1.0 + side * 0.2 * x - 0.1 * y);
                    let beside = 0.17 * side / f64::from(cells) * dome(i, j);
                    mesh.nodes.push(Point3::new(size * (x + beside), size * (y - beside), z));
                }
            }
        }
    }
    for (half, number) in number.iter().enumerate() {
        for j in 0..cells {
            for i in 0..cells {
                let [a, b, c, d] =
                    [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| number[(j * row + i) as usize]);
                // Normals point outward.
                mesh.quads.push(if half == 0 { [a, b, c, d] } else { [a, d, c, b] });
            }
        }
    }
    mesh
}

#[test]
fn a_bag_that_is_emptied_comes_to_lie_on_itself() {
    let size = 0.2;
    let (film, nodes) = mount(&pillow(size, 16, 0.03), &section(2e7), |_| [0.0; 3]);
    // The pressure around it is higher than that within.
    let inflation = Some(Inflation { pressure: -300.0, ramp: 0.02 });
    let loads = Loads { inflation, damping: 20.0, step_factor: 0.25, ..Loads::default() };
    let mut run = Run { engine: Engine::new(vec![film], nodes, [], loads).with_self_contact(0.3) };
    let volume = |run: &mut Run| run.observe(|view| crate::engine::pressure::volume(view.films, view.nodes));
    let start = volume(&mut run);
    let course = run.course(0.04, 40);
    let volume = volume(&mut run);
    // Between the middle surfaces of two halves that lie on each other there is the thickness of one, and more where their folds
    // do not fit.
    let share = volume / (size * size * THICKNESS);
    println!("volume {share} of the thickness over the area, {} of that at the start", volume / start);
    course.check(200, 0.75 * THICKNESS, course.exchanged);
    assert!(share > 0.8 && volume < 0.03 * start, "{share}");
    assert!(course.momentum[0] < 1e-12, "{course:?}");
}
