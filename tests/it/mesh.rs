//! Meshes: counts, areas, mirror images, rims, quality, and files good and bad.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use droptower::mesh::{self, Element, Mesh, Meshing, Outline, Quality, Side};
use droptower::model::Symmetry;

use crate::workbench::{mistaken, root};

const SYMMETRIES: [Symmetry; 4] = [Symmetry::None, Symmetry::HalfX, Symmetry::HalfY, Symmetry::Quarter];
const SQUARE: Outline = Outline::Rectangle { x: 0.4, y: 0.4 };
const DISC: Outline = Outline::Circle { radius: 0.1 };

fn build(outline: &Outline, symmetry: Symmetry, element: Element, size: f64) -> Mesh {
    mesh::build(outline, symmetry.mirrors(), &Meshing { element, size, grading: None }).unwrap()
}

fn parts(symmetry: Symmetry) -> usize {
    match symmetry {
        Symmetry::None => 1,
        Symmetry::HalfX | Symmetry::HalfY => 2,
        Symmetry::Quarter => 4,
    }
}

#[test]
fn rectangles_have_the_elements_that_their_size_asks_for() {
    let cases = [
        ([0.4, 0.4], 0.01, Symmetry::None, 1600),
        ([0.4, 0.4], 0.01, Symmetry::Quarter, 400),
        ([0.4, 0.4], 0.01, Symmetry::HalfX, 800),
        ([0.005, 0.01], 0.01, Symmetry::None, 1),
        ([0.005, 0.01], 0.01, Symmetry::Quarter, 1),
        ([0.1, 0.05], 0.02, Symmetry::None, 5 * 3),
        ([0.1, 0.05], 0.02, Symmetry::HalfX, 3 * 3),
        ([0.3, 0.1], 0.1, Symmetry::None, 3),
        ([0.1, 0.1], 1.0, Symmetry::None, 1),
    ];
    for ([x, y], size, symmetry, elements) in cases {
        let mesh = build(&Outline::Rectangle { x, y }, symmetry, Element::Quad4, size);
        assert_eq!(mesh.quads.len(), elements, "{x} by {y} at {size} {symmetry:?}");
    }
}

#[test]
fn absurd_meshes_are_refused() {
    let absurd = Meshing { element: Element::Tri3, size: 1e-300, grading: None };
    for shape in [SQUARE, DISC] {
        assert!(mesh::build(&shape, [false; 2], &absurd).is_err());
    }
}

fn with_elements(symmetry: Symmetry) -> [(Symmetry, Element); 2] {
    [(symmetry, Element::Quad4), (symmetry, Element::Tri3)]
}

#[test]
fn parts_of_a_rectangle_cover_their_share_of_it() {
    for (symmetry, element) in SYMMETRIES.into_iter().flat_map(with_elements) {
        let mesh = build(&Outline::Rectangle { x: 0.3, y: 0.2 }, symmetry, element, 0.017);
        let share = 0.06 / parts(symmetry) as f64;
        assert!((Quality::from_mesh(&mesh).area - share).abs() < 1e-14);
    }
}

#[test]
fn disc_area_converges_with_order_two() {
    for (symmetry, element) in SYMMETRIES.into_iter().flat_map(with_elements) {
        let exact = std::f64::consts::PI * 0.01 / parts(symmetry) as f64;
        let missing = |size| exact - Quality::from_mesh(&build(&DISC, symmetry, element, size)).area;
        let order = (missing(0.01) / missing(0.0025)).log2() / 2.0;
        assert!((order - 2.0).abs() < 0.1, "{symmetry:?} {element:?}: {order}");
    }
}

#[test]
fn elements_are_as_large_as_asked_on_average_and_well_shaped() {
    for size in [0.02, 0.005, 0.001] {
        let quality = Quality::from_mesh(&build(&DISC, Symmetry::None, Element::Quad4, size));
        let mean = (quality.area / quality.elements as f64).sqrt();
        assert!((mean / size - 1.0).abs() < 0.15, "{mean} for {size}");
        assert!(quality.jacobian > 0.7, "{quality}");
        assert!(quality.aspect < 2.0, "{quality}");
        assert!(quality.skew < 0.5, "{quality}");
        assert!(quality.edges[0] > 0.6 * size, "{quality}");
    }
    let quality = Quality::from_mesh(&build(&SQUARE, Symmetry::Quarter, Element::Quad4, 0.01));
    assert!((quality.aspect - 1.0).abs() < 1e-9 && (quality.jacobian - 1.0).abs() < 1e-12);
    assert!(quality.skew < 1e-9, "{quality}");
}

#[test]
fn elements_turn_counter_clockwise() {
    for shape in [SQUARE, DISC] {
        for (symmetry, element) in SYMMETRIES.into_iter().flat_map(with_elements) {
            let mesh = build(&shape, symmetry, element, 0.03);
            assert!(outlines(&mesh).iter().all(|o| signed_area(&mesh, o) > 0.0));
        }
    }
}

fn outlines(mesh: &Mesh) -> Vec<Vec<u32>> {
    let quads = mesh.quads.iter().map(|q| q.to_vec());
    quads.chain(mesh.tris.iter().map(|t| t.to_vec())).collect()
}

fn signed_area(mesh: &Mesh, corners: &[u32]) -> f64 {
    let point = |i: usize| mesh.nodes[corners[i % corners.len()] as usize];
    let cross = |i| point(i).x * point(i + 1).y - point(i + 1).x * point(i).y;
    (0..corners.len()).map(cross).sum::<f64>() / 2.0
}

/// An element as the set of its corners' positions, bit by bit.
type Corners = BTreeSet<[u64; 2]>;

fn elements(mesh: &Mesh, mirror: [f64; 2]) -> BTreeSet<Corners> {
    let bits = |node: &u32| {
        let point = mesh.nodes[*node as usize];
        [0, 1].map(|axis| (point[axis] * mirror[axis] + 0.0).to_bits())
    };
    let outlines = outlines(mesh);
    outlines.iter().map(|o| o.iter().map(bits).collect()).collect()
}

/// Also where an odd number of elements lies across, so that no part is one of whole elements.
#[test]
fn mirrored_parts_make_the_whole() {
    for shape in [SQUARE, DISC] {
        for element in [Element::Quad4, Element::Tri3] {
            let [whole, quarter] = [Symmetry::None, Symmetry::Quarter].map(|s| build(&shape, s, element, 0.02));
            let mirrors = [[1.0, 1.0], [-1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]];
            let four = mirrors.iter().flat_map(|mirror| elements(&quarter, *mirror));
            assert_eq!(elements(&whole, [1.0, 1.0]), four.collect(), "{shape:?} {element:?}");
            let odd = build(&shape, Symmetry::None, element, 0.021);
            for mirror in mirrors {
                assert_eq!(elements(&odd, [1.0, 1.0]), elements(&odd, mirror), "{shape:?} {element:?} by {mirror:?}");
            }
        }
    }
}

#[test]
fn rims_sides_and_mirrors_hold_the_right_nodes() {
    let quarter = build(&SQUARE, Symmetry::Quarter, Element::Quad4, 0.1);
    let places = |nodes: &[u32]| -> Vec<[i32; 2]> {
        let place = |n: &u32| quarter.nodes[*n as usize];
        let tenth = |n| [0, 1].map(|axis| (place(n)[axis] * 10.0).round() as i32);
        nodes.iter().map(tenth).collect()
    };
    let side = |side: Side| places(&quarter.sides[side as usize]);
    assert_eq!(side(Side::XPlus), [[2, 0], [2, 1], [2, 2]]);
    assert_eq!(side(Side::YPlus), [[0, 2], [1, 2], [2, 2]]);
    assert!(side(Side::XMinus).is_empty() && side(Side::YMinus).is_empty());
    assert_eq!(places(&quarter.mirrors[0]), [[0, 0], [0, 1], [0, 2]]);
    assert_eq!(places(&quarter.mirrors[1]), [[0, 0], [1, 0], [2, 0]]);
    let rim = [[2, 0], [2, 1], [0, 2], [1, 2], [2, 2]];
    assert_eq!(places(&quarter.rim), rim);

    let whole = build(&SQUARE, Symmetry::None, Element::Tri3, 0.1);
    assert_eq!(whole.rim.len(), 16);
    assert!(whole.sides.iter().all(|side| side.len() == 5));
    assert!(whole.mirrors.iter().all(Vec::is_empty));
}

#[test]
fn a_discs_rim_stands_on_the_circle() {
    for symmetry in SYMMETRIES {
        let mesh = build(&DISC, symmetry, Element::Quad4, 0.013);
        let radius = |node: &u32| mesh.nodes[*node as usize].coords.norm();
        assert!(mesh.rim.iter().all(|n| (radius(n) - 0.1).abs() < 1e-15));
        let on_circle = (0..mesh.nodes.len() as u32).filter(|n| radius(n) > 0.0999);
        assert_eq!(mesh.rim.len(), on_circle.count());
    }
}

/// Writes `text` to a file of this name in a folder that lasts as long as the returned value.
fn file(name: &str, text: impl AsRef<[u8]>) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, text).unwrap();
    (folder, path)
}

fn import(path: &Path, symmetry: Symmetry, element: Element) -> Result<Mesh, mesh::MeshError> {
    mesh::build(
        &Outline::Mesh { path: path.to_owned(), scale: 1.0 },
        symmetry.mirrors(),
        &Meshing { element, size: 1.0, grading: None },
    )
}

/// Where the rim, the sides and the mirror nodes are, bit by bit.
fn labels(mesh: &Mesh) -> Vec<BTreeSet<[u64; 2]>> {
    let bits = |node: &u32| {
        let point = mesh.nodes[*node as usize];
        [point.x, point.y].map(|c| (c + 0.0).to_bits())
    };
    let lists = [&mesh.rim].into_iter().chain(&mesh.sides).chain(&mesh.mirrors);
    lists.map(|list| list.iter().map(bits).collect()).collect()
}

/// A mesh that the mesher made, in a format of others.
fn stored(name: &str) -> PathBuf {
    root().join("tests/it/formats/mesh").join(name)
}

/// The files hold what the mesher gives: of Gmsh with a point and a line of its model, and nodes in two blocks.
#[test]
fn meshes_are_read_back_from_files_unchanged() {
    for (stem, symmetry, element) in
        [("half", Symmetry::HalfX, Element::Quad4), ("disc", Symmetry::None, Element::Tri3)]
    {
        let mesh = build(&DISC, symmetry, element, 0.03);
        for ending in [".obj", ".VTU", "-2.msh", "-4.msh"] {
            let name = format!("{stem}{ending}");
            let back = import(&stored(&name), symmetry, Element::Quad4).unwrap();
            assert_eq!(elements(&back, [1.0; 2]), elements(&mesh, [1.0; 2]), "{name}");
            assert_eq!(labels(&back), labels(&mesh), "{name}");
        }
    }
    let mesh = build(&SQUARE, Symmetry::Quarter, Element::Tri3, 0.1);
    let back = import(&stored("square.stl"), Symmetry::Quarter, Element::Tri3).unwrap();
    assert_eq!((back.nodes.len(), back.tris.len()), (mesh.nodes.len(), mesh.tris.len()));
    assert_eq!(back.rim.len(), mesh.rim.len());
    assert!((Quality::from_mesh(&back).area - 0.04).abs() < 1e-8);
}

#[test]
fn quads_of_a_file_become_triangles_where_asked() {
    let back = import(&stored("square.obj"), Symmetry::None, Element::Tri3).unwrap();
    assert_eq!((back.quads.len(), back.tris.len()), (0, 32));
}

#[test]
fn elements_of_a_file_are_turned_and_loose_nodes_left_out() {
    let upside_down = "v 9 9 9\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nf 2 5 4 3\n";
    let (_folder, path) = file("film.obj", upside_down);
    let mesh = import(&path, Symmetry::None, Element::Quad4).unwrap();
    assert_eq!(mesh.nodes.len(), 4);
    assert!(signed_area(&mesh, &mesh.quads[0]) > 0.0);
    assert!(mesh.nodes.iter().all(|p| p.z == 1.0));
}

/// Points (0,0,0), (1,0,0), (0,1,0) as float32 and one triangle, each array behind its length in bytes.
#[test]
fn binary_arrays_are_read() {
    let mesh = import(&stored("binary.vtu"), Symmetry::None, Element::Tri3).unwrap();
    assert_eq!(mesh.tris, [[0, 1, 2]]);
    assert_eq!(mesh.nodes[1].x, 1.0);
}

#[test]
fn faults_of_files_are_reported_with_their_path() {
    for [name, expected, text] in mistaken("meshes.txt") {
        let (_folder, path) = file(&name, text);
        let message = import(&path, Symmetry::None, Element::Quad4).unwrap_err().to_string();
        assert!(message.contains(&name) && message.contains(&expected), "{message}");
    }
}

#[test]
fn a_mesh_with_symmetry_is_the_computed_part_only() {
    let message = import(&stored("square.obj"), Symmetry::HalfY, Element::Quad4).unwrap_err().to_string();
    assert!(message.contains("beyond the mirror plane y = 0"), "{message}");
    let (_folder, path) = file("film.obj", "v 1 1 0\nv 2 1 0\nv 2 2 0\nf 1 2 3\n");
    let message = import(&path, Symmetry::HalfX, Element::Quad4).unwrap_err().to_string();
    assert!(message.contains("no edge lies on the mirror plane x = 0"), "{message}");
}

const TETRAHEDRON: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";

#[test]
fn impactor_surfaces_are_closed_and_face_outwards() {
    let volume = |path: &Path| {
        let (points, tris) = mesh::import::surface(path).unwrap();
        let six = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|node| points[node as usize].coords);
            a.dot(&b.cross(&c))
        };
        tris.iter().map(six).sum::<f64>() / 6.0
    };
    for faces in ["f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n", "f 1 2 3\nf 1 4 2\nf 2 4 3\nf 1 3 4\n"] {
        let (_folder, path) = file("head.obj", format!("{TETRAHEDRON}{faces}"));
        assert!((volume(&path) - 1.0 / 6.0).abs() < 1e-15);
    }
    for (faces, expected) in
        [("f 1 3 2\nf 1 2 4\nf 2 3 4\n", "open"), ("f 1 2 3\nf 1 2 4\nf 2 3 4\nf 1 4 3\n", "opposite orientations")]
    {
        let (_folder, path) = file("head.obj", format!("{TETRAHEDRON}{faces}"));
        let message = mesh::import::surface(&path).unwrap_err().to_string();
        assert!(message.contains(expected), "{message}");
    }
}
