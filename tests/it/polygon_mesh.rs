//! Meshes of polygons: shapes, sizes and edges; drawings of outlines.

use std::f64::consts::{PI, TAU};

use droptower::mesh::{
    self, Element, Grading, Mesh, MeshError, MeshErrorKind, Meshing, Outline, Polygon, Quality, Zone, import,
};

use crate::workbench::{mistaken, root};

fn circle([x, y]: [f64; 2], radius: f64) -> Vec<[f64; 2]> {
    let at = |place: u32| {
        let (sin, cos) = (TAU * f64::from(place) / 180.0).sin_cos();
        [x + radius * cos, y + radius * sin]
    };
    (0..180).map(at).collect()
}

fn corner() -> Vec<[f64; 2]> {
    vec![[-0.1, -0.1], [0.1, -0.1], [0.1, 0.0], [0.0, 0.0], [0.0, 0.1], [-0.1, 0.1]]
}

fn square() -> Vec<[f64; 2]> {
    vec![[0.0, 0.0], [0.1, 0.0], [0.1, 0.1], [0.0, 0.1]]
}

fn polygon(outer: Vec<[f64; 2]>, holes: Vec<Vec<[f64; 2]>>) -> Polygon {
    Polygon { outer, holes }
}

fn build(polygon: &Polygon, mirrored: [bool; 2], element: Element, grading: Option<Grading>) -> Mesh {
    let meshing = Meshing { element, size: 5e-3, grading };
    mesh::build(&Outline::Polygon(polygon.clone()), mirrored, &meshing).unwrap()
}

fn fine() -> Option<Grading> {
    Some(Grading { fine: 1e-3, growth: 0.25, zones: vec![Zone { at: [-0.03, 0.03], within: 0.01 }] })
}

#[test]
fn elements_fill_the_outline_with_sound_shapes() {
    let hole = circle([-0.05, -0.05], 0.02);
    let disc = circle([0.0, 0.0], 0.0635);
    // Name, polygon, grading, least scaled Jacobian of quadrilaterals and of triangles.
    let cases = [
        ("square", polygon(square(), vec![]), None, [0.5, 0.55]),
        ("angle with a hole", polygon(corner(), vec![hole.clone()]), None, [0.5, 0.55]),
        ("angle, graded", polygon(corner(), vec![hole]), fine(), [0.5, 0.55]),
        ("disc", polygon(disc, vec![]), None, [0.5, 0.55]),
        ("hole near an edge", polygon(square(), vec![circle([0.05, 0.021], 0.02)]), None, [0.3, 0.5]),
        ("narrow corner", polygon(vec![[0.0, 0.0], [0.2, 0.0], [0.2, 0.04]], vec![]), None, [0.15, 0.15]),
    ];
    for (name, polygon, grading, least) in cases {
        for (element, least) in [Element::Quad4, Element::Tri3].into_iter().zip(least) {
            let mesh = build(&polygon, [false; 2], element, grading.clone());
            let quality = Quality::from_mesh(&mesh);
            let case = format!("{name} {element:?}: {quality}");
            assert_eq!(mesh.quads.is_empty(), element == Element::Tri3, "{case}");
            assert_eq!(mesh.tris.is_empty(), element == Element::Quad4, "{case}");
            assert!(quality.jacobian > least, "{case}");
            assert!((quality.area / polygon.area() - 1.0).abs() < 2e-3, "{case}");
            let cells = match &grading {
                Some(grading) => grading.cells(polygon.area(), 5e-3),
                None => polygon.area() / 25e-6,
            };
            let wanted = if element == Element::Tri3 { 2.0 * cells } else { cells };
            let share = quality.elements as f64 / wanted;
            assert!((0.7..2.5).contains(&share), "{share} of the wanted number: {case}");
            assert!(quality.edges[1] < 2.0 * 5e-3, "{case}");
        }
    }
}

#[test]
fn the_frame_holds_the_outline_and_not_the_holes() {
    let polygon = polygon(square(), vec![circle([0.03, 0.05], 0.02), circle([0.08, 0.05], 0.005)]);
    for element in [Element::Quad4, Element::Tri3] {
        let mesh = build(&polygon, [false; 2], element, None);
        let on_edge = |node: &u32| {
            let p = mesh.nodes[*node as usize];
            [p.x, p.y].iter().any(|c| c.abs() < 1e-12 || (c - 0.1).abs() < 1e-12)
        };
        assert!(mesh.rim.iter().all(on_edge));
        let all = (0..mesh.nodes.len() as u32).filter(on_edge).count();
        assert_eq!(mesh.rim.len(), all, "{element:?}");
        assert!(mesh.sides.iter().all(|side| side.len() > 10));
    }
}

#[test]
fn a_polygon_with_symmetry_is_the_computed_part() {
    let part = polygon(square(), vec![]);
    let mesh = build(&part, [true, true], Element::Quad4, None);
    let on = |axis: usize| mesh.nodes.iter().filter(|p| p[axis].abs() < 1e-12).count();
    assert_eq!([mesh.mirrors[0].len(), mesh.mirrors[1].len()], [on(0), on(1)]);
    assert!(mesh.rim.iter().all(|node| mesh.nodes[*node as usize].coords.amax() > 0.1 - 1e-12));
    let whole = polygon(corner(), vec![]);
    let error = whole.check([true, false]).unwrap_err().to_string();
    assert!(error.contains("lies beyond the mirror plane x = 0"), "{error}");
    let beside = polygon(square().iter().map(|p| [p[0] + 1.0, p[1]]).collect(), vec![]);
    let error = beside.check([true, false]).unwrap_err().to_string();
    assert_eq!(error, "no edge lies on the mirror plane x = 0");
}

#[test]
fn the_same_polygon_gives_the_same_bits() {
    let polygon = polygon(corner(), vec![circle([-0.05, -0.05], 0.02)]);
    for element in [Element::Quad4, Element::Tri3] {
        let [first, second] = [0, 1].map(|_| build(&polygon, [false; 2], element, fine()));
        assert_eq!(first.nodes, second.nodes);
        assert_eq!((first.quads, first.tris), (second.quads, second.tris));
    }
}

#[test]
fn outlines_that_are_none_are_refused() {
    let with = |corner: [f64; 2]| {
        let mut corners = square();
        corners.insert(1, corner);
        polygon(corners, vec![])
    };
    let round = |radius: f64| circle([0.05, 0.05], radius);
    let cases = [
        (polygon(square()[..2].to_vec(), vec![]), "the outline has no area"),
        (polygon(vec![[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]], vec![]), "the outline has no area"),
        (with([0.05, 0.15]), "the outline crosses itself near"),
        (with([0.0, 0.0]), "has the corner (0.0000 mm, 0.0000 mm) twice"),
        (with([0.05, f64::NAN]), "not finite"),
        (polygon(vec![[0.0, 0.0], [0.1, 0.0], [0.1, 0.005]], vec![]), "has 2.9 degrees"),
        (polygon(square(), vec![round(0.06)]), "the outline and hole 1 cross near"),
        (polygon(square(), vec![circle([0.3, 0.05], 0.01)]), "hole 1 lies outside the film"),
        (polygon(square(), vec![round(0.04), round(0.01)]), "hole 2 lies outside the film"),
    ];
    for (polygon, expected) in cases {
        let message = polygon.check([false; 2]).unwrap_err().to_string();
        assert!(message.contains(expected), "{message}, not {expected}");
    }
}

/// The outline in a drawing of `formats/mesh`, with this unit (m).
fn drawn(name: &str, unit: Option<f64>) -> Result<Polygon, MeshError> {
    import::polygon(&root().join("tests/it/formats/mesh").join(name), unit)
}

/// A slot of two lines and two half circles, its hole a circle, and a note: in mm, as one polyline with bulges in inches, and
/// without a unit.
#[test]
fn drawings_give_their_outline_and_holes() {
    let exact = 1e-6 * (40.0 * 20.0 + PI * 100.0 - PI * 16.0);
    let lines = drawn("slot.dxf", None).unwrap();
    assert_eq!(lines.holes.len(), 1);
    assert!((lines.area() / exact - 1.0).abs() < 3e-4, "{} of {exact}", lines.area());
    lines.check([false; 2]).unwrap();
    let bulged = drawn("slot-inches.DXF", None).unwrap();
    assert!((bulged.area() / lines.area() - 1.0).abs() < 1e-9);
    assert!((bulged.extent() - 0.06).abs() < 1e-9);
    assert_eq!(drawn("slot-no-unit.dxf", None).unwrap_err().kind, MeshErrorKind::NoUnit);
    let centimetres = drawn("slot-no-unit.dxf", Some(1e-2)).unwrap();
    assert!((centimetres.area() / lines.area() - 100.0).abs() < 1e-6);
}

#[test]
fn drawings_that_are_no_outline_are_refused() {
    for [name, expected, text] in mistaken("outlines.txt") {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        let message = import::polygon(&path, None).unwrap_err().to_string();
        assert!(message.contains(&expected), "{message}, not {expected}");
    }
    assert_eq!(drawn("slot.dxf", Some(1.0)).unwrap_err().kind, MeshErrorKind::OtherUnit);
}

/// The slot of the DXF file as a path with arcs, as shapes with transforms, and in the units of the page, which is 60 by 20 mm with
/// 10 units a millimetre, its origin in the middle.
#[test]
fn svg_gives_the_outline_and_holes_of_dxf() {
    let lines = drawn("slot.dxf", None).unwrap();
    for name in ["slot-path.svg", "slot-shapes.svg", "slot-bezier.svg"] {
        let found = drawn(name, None).unwrap();
        assert_eq!(found.holes.len(), 1);
        assert!((found.area() / lines.area() - 1.0).abs() < 1e-3, "{} of {}, {name}", found.area(), lines.area());
        assert!((found.extent() - 0.06).abs() < 2e-5, "{} {name}", found.extent());
        found.check([false; 2]).unwrap();
        assert_eq!(drawn(name, Some(1.0)).unwrap_err().kind, MeshErrorKind::OtherUnit);
    }
    // Up in the film is up in the drawing, where y points down.
    let corners = drawn("corner.svg", None).unwrap().outer;
    assert!(corners.iter().any(|corner| (corner[1] - 0.01).abs() < 1e-12), "{corners:?}");
}
