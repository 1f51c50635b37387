//! Graded meshes: sizes, shapes, numbers and symmetry of their elements.

use std::f64::consts::PI;

use droptower::mesh::{self, Element, Grading, Mesh, Meshing, Outline, Quality, Zone};

const DISC: Outline = Outline::Circle { radius: 63.5e-3 };
const SHEET: Outline = Outline::Rectangle { x: 0.5, y: 0.4 };
const STRIP: Outline = Outline::Rectangle { x: 0.5, y: 0.03 };

/// Least scaled Jacobian of a graded mesh; 0.70 is that of the templates between squares of two sizes.
const WORST_JACOBIAN: f64 = 0.4;

fn build(outline: &Outline, mirrored: [bool; 2], element: Element, [size, fine, growth]: [f64; 3], zone: Zone) -> Mesh {
    let grading = Some(Grading { fine, growth, zones: vec![zone] });
    mesh::build(outline, mirrored, &Meshing { element, size, grading }).unwrap()
}

fn elements(mesh: &Mesh) -> impl Iterator<Item = Vec<[f64; 2]>> + '_ {
    let quads = mesh.quads.iter().map(|quad| quad.as_slice());
    let all = quads.chain(mesh.tris.iter().map(|tri| tri.as_slice()));
    all.map(|corners| corners.iter().map(|node| mesh.nodes[*node as usize]).map(|p| [p.x, p.y]).collect())
}

fn area(corners: &[[f64; 2]]) -> f64 {
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).map(|(a, b)| 0.5 * (a[0] * b[1] - b[0] * a[1])).sum()
}

/// Outline, mirror planes, size, fine size, centre and radius of the zone.
type Case = (Outline, [bool; 2], f64, f64, [f64; 2], f64);

fn cases() -> Vec<Case> {
    vec![
        (DISC, [true, true], 5e-3, 0.5e-3, [0.0, 0.0], 19.05e-3),
        (DISC, [false, false], 5e-3, 0.5e-3, [0.0, 0.0], 0.0),
        (DISC, [true, false], 5e-3, 0.5e-3, [0.0, 0.02], 10e-3),
        (DISC, [false, false], 5e-3, 0.5e-3, [0.04, 0.02], 10e-3),
        (DISC, [false, false], 5e-3, 0.5e-3, [0.06, 0.02], 10e-3),
        (Outline::Circle { radius: 12e-3 }, [false, false], 5e-3, 0.2e-3, [0.0, 0.0], 1e-3),
        (SHEET, [true, true], 20e-3, 2e-3, [0.0, 0.0], 50e-3),
        (SHEET, [false, true], 20e-3, 2e-3, [0.1, 0.0], 50e-3),
        (STRIP, [false, false], 20e-3, 2e-3, [0.1, 0.0], 10e-3),
    ]
}

#[test]
fn elements_have_their_sizes_shapes_and_numbers() {
    for (outline, mirrored, size, fine, at, within) in cases() {
        for (element, growth) in [(Element::Quad4, 0.25), (Element::Quad4Full, 0.5), (Element::Tri3, 0.25)] {
            let zone = Zone { at, within };
            let mesh = build(&outline, mirrored, element, [size, fine, growth], zone);
            let quality = Quality::from_mesh(&mesh);
            let case = format!("{outline:?} {at:?} {element:?}: {quality}");
            assert!(quality.jacobian > WORST_JACOBIAN && quality.aspect < 4.5, "{case}");
            assert!(quality.edges[0] > 0.6 * fine && quality.edges[1] < 2.1 * size, "{case}");

            let copies: f64 = mirrored.iter().map(|mirror| if *mirror { 2.0 } else { 1.0 }).product();
            let whole = match outline {
                Outline::Rectangle { x, y } => x * y,
                Outline::Circle { radius } => PI * radius * radius,
                _ => unreachable!(),
            };
            assert!((quality.area * copies / whole - 1.0).abs() < 1e-2, "{case}");
            let triangles = if element == Element::Tri3 { 2.0 } else { 1.0 };
            let wanted = triangles * Grading { fine, growth, zones: vec![zone] }.cells(whole, size) / copies;
            assert!((quality.elements as f64) < 2.5 * wanted.max(400.0), "{case}, wanted {wanted}");

            for corners in elements(&mesh) {
                let middle = [0, 1].map(|axis| corners.iter().map(|p| p[axis]).sum::<f64>() / corners.len() as f64);
                let distance = (middle[0] - at[0]).hypot(middle[1] - at[1]) - within;
                let side = (triangles * area(&corners)).sqrt();
                let h = size.min(fine + growth * distance.max(0.0));
                assert!(side < 1.4 * h, "{side} in place of {h} at {middle:?}: {case}");
            }
        }
    }
}

#[test]
fn neighbours_share_their_edges() {
    for (outline, mirrored, size, fine, at, within) in cases() {
        for element in [Element::Quad4, Element::Tri3] {
            let mesh = build(&outline, mirrored, element, [size, fine, 0.3], Zone { at, within });
            let outer: f64 =
                mesh::outer_edges(&mesh).map(|[a, b]| (mesh.nodes[a as usize] - mesh.nodes[b as usize]).norm()).sum();
            let share = |axis: usize| if mirrored[axis] { 0.5 } else { 1.0 };
            let perimeter = match outline {
                Outline::Rectangle { x, y } => {
                    let sides = |axis: usize| if mirrored[axis] { 1.0 } else { 2.0 };
                    x * share(0) * sides(1) + y * share(1) * sides(0)
                }
                Outline::Circle { radius } => 2.0 * PI * radius * share(0) * share(1),
                _ => unreachable!(),
            };
            assert!((outer / perimeter - 1.0).abs() < 4e-3, "{outline:?} {element:?}: {outer} of {perimeter}");
        }
    }
}

#[test]
fn whole_graded_meshes_are_their_own_mirror_images() {
    for outline in [DISC, SHEET] {
        let zone = Zone { at: [0.0; 2], within: 0.01 };
        let mesh = build(&outline, [false; 2], Element::Quad4, [10e-3, 1e-3, 0.3], zone);
        for mirror in [[-1.0, 1.0], [1.0, -1.0]] {
            let rounded = |mirror: [f64; 2]| {
                let place = |corner: &[f64; 2]| [0, 1].map(|axis| (corner[axis] * mirror[axis] * 1e9).round() as i64);
                let mut all: Vec<Vec<[i64; 2]>> = elements(&mesh)
                    .map(|corners| {
                        let mut places: Vec<_> = corners.iter().map(place).collect();
                        places.sort_unstable();
                        places
                    })
                    .collect();
                all.sort_unstable();
                all
            };
            assert!(rounded(mirror) == rounded([1.0; 2]), "{outline:?} {mirror:?}");
        }
    }
}

#[test]
fn the_zone_of_a_sheet_has_exact_squares_and_the_same_bits_twice() {
    let outline = Outline::Rectangle { x: 0.32, y: 0.32 };
    let zone = Zone { at: [0.0; 2], within: 0.02 };
    let mesh = build(&outline, [true; 2], Element::Quad4, [8e-3, 1e-3, 0.25], zone);
    let near = |corners: &&Vec<[f64; 2]>| corners.iter().all(|p| p[0].hypot(p[1]) < 0.02);
    let squares: Vec<Vec<[f64; 2]>> = elements(&mesh).collect();
    let inner: Vec<&Vec<[f64; 2]>> = squares.iter().filter(near).collect();
    assert!(inner.len() > 280, "{}", inner.len());
    assert!(inner.iter().all(|corners| (area(corners) / 1e-6 - 1.0).abs() < 1e-9));
    let again = build(&outline, [true; 2], Element::Quad4, [8e-3, 1e-3, 0.25], zone);
    assert_eq!(mesh.nodes, again.nodes);
    assert_eq!(mesh.quads, again.quads);
}

#[test]
fn absurd_gradings_are_refused() {
    let zone = Zone { at: [0.0; 2], within: 1.0 };
    for fine in [1e-300, 0.0, f64::NAN] {
        let grading = Some(Grading { fine, growth: 0.25, zones: vec![zone] });
        let meshing = Meshing { element: Element::Quad4, size: 0.01, grading };
        assert!(mesh::build(&SHEET, [false; 2], &meshing).is_err(), "{fine}");
    }
}
