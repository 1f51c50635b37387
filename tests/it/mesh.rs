//! Meshes: counts, areas, mirror images, rims, quality, and files good and bad.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use droptower::mesh::{self, Element, Mesh, Meshing, Outline, Quality, Side};
use droptower::model::Symmetry;

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

#[test]
fn whole_meshes_are_their_own_mirror_images() {
    for shape in [SQUARE, DISC] {
        for element in [Element::Quad4, Element::Tri3] {
            let mesh = build(&shape, Symmetry::None, element, 0.021);
            let whole = elements(&mesh, [1.0, 1.0]);
            assert_eq!(whole, elements(&mesh, [-1.0, 1.0]), "{shape:?} {element:?} in x");
            assert_eq!(whole, elements(&mesh, [1.0, -1.0]), "{shape:?} {element:?} in y");
        }
    }
}

#[test]
fn mirrored_parts_make_the_whole() {
    for shape in [SQUARE, DISC] {
        for element in [Element::Quad4, Element::Tri3] {
            let whole = build(&shape, Symmetry::None, element, 0.02);
            let quarter = build(&shape, Symmetry::Quarter, element, 0.02);
            let mirrors = [[1.0, 1.0], [-1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]];
            let four = mirrors.iter().flat_map(|mirror| elements(&quarter, *mirror));
            assert_eq!(elements(&whole, [1.0, 1.0]), four.collect());
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

fn as_obj(mesh: &Mesh) -> String {
    let points = mesh.nodes.iter().map(|p| format!("v {} {} {}\n", p.x, p.y, p.z));
    let corner = |node: &u32| format!(" {}", node + 1);
    let outlines = outlines(mesh);
    let faces = outlines.iter();
    let faces = faces.map(|o| format!("f{}\n", o.iter().map(corner).collect::<String>()));
    points.chain(faces).collect()
}

fn as_stl(mesh: &Mesh) -> String {
    let vertex = |node: &u32| {
        let p = mesh.nodes[*node as usize];
        format!("vertex {} {} {}\n", p.x, p.y, p.z)
    };
    let facet = |tri: &[u32; 3]| {
        let vertices: String = tri.iter().map(vertex).collect();
        format!("facet normal 0 0 1\nouter loop\n{vertices}endloop\nendfacet\n")
    };
    let facets: String = mesh.tris.iter().map(facet).collect();
    format!("solid film\n{facets}endsolid film\n")
}

fn as_vtu(mesh: &Mesh) -> String {
    let points = mesh.nodes.iter().map(|p| format!("{} {} {} ", p.x, p.y, p.z));
    let corners: Vec<String> = outlines(mesh).concat().iter().map(u32::to_string).collect();
    let sizes: Vec<usize> = outlines(mesh).iter().map(Vec::len).collect();
    let ends = sizes.iter().scan(0, |end, size| {
        *end += size;
        Some(format!("{end} "))
    });
    let types = sizes.iter().map(|size| if *size == 3 { "5 " } else { "9 " });
    vtu(&points.collect::<String>(), &corners.join(" "), &ends.collect::<String>(), &types.collect::<String>())
}

/// Version 2.2 of Gmsh, with a line and a point of its model beside the elements.
fn as_msh_2(mesh: &Mesh) -> String {
    let nodes = mesh.nodes.iter().enumerate().map(|(n, p)| format!("{} {} {} {}\n", 3 * n + 5, p.x, p.y, p.z));
    let tag = |node: &u32| format!(" {}", 3 * node + 5);
    let element = |(e, corners): (usize, Vec<u32>)| {
        let tags: String = corners.iter().map(tag).collect();
        format!("{} {} 2 0 1{tags}\n", e + 3, corners.len() - 1)
    };
    let elements: String = outlines(mesh).into_iter().enumerate().map(element).collect();
    format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 1 \"film 2\"\n$EndPhysicalNames\n\
         $Nodes\n{}\n{}$EndNodes\n$Elements\n{}\n1 15 2 0 1 5\n2 1 2 0 1 5 8\n{elements}$EndElements\n",
        mesh.nodes.len(),
        nodes.collect::<String>(),
        outlines(mesh).len() + 2,
    )
}

/// Version 4.1 of Gmsh: nodes in two blocks, one of them with coordinates on its surface, and elements by kind.
fn as_msh_4(mesh: &Mesh) -> String {
    let (first, second) = mesh.nodes.split_at(mesh.nodes.len() / 2);
    let tags = |from: usize, count: usize| (from..from + count).map(|tag| format!("{tag}\n")).collect::<String>();
    let points = |part: &[nalgebra::Point3<f64>], more: &str| {
        part.iter().map(|p| format!("{} {} {}{more}\n", p.x, p.y, p.z)).collect::<String>()
    };
    let block = |kind: usize, all: Vec<&[u32]>| {
        let line = |corners: &&[u32]| {
            let tags: String = corners.iter().map(|node| format!(" {}", node + 1)).collect();
            format!("7{tags}\n")
        };
        format!("2 1 {kind} {}\n{}", all.len(), all.iter().map(line).collect::<String>())
    };
    format!(
        "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n2 {} 1 {}\n1 1 0 {}\n{}{}2 1 1 {}\n{}{}$EndNodes\n\
         $Elements\n3 {} 1 9\n1 1 1 1\n7 1 2\n{}{}$EndElements\n",
        mesh.nodes.len(),
        mesh.nodes.len(),
        first.len(),
        tags(1, first.len()),
        points(first, ""),
        second.len(),
        tags(1 + first.len(), second.len()),
        points(second, " 0.5 0.25"),
        outlines(mesh).len() + 1,
        block(2, mesh.tris.iter().map(|tri| tri.as_slice()).collect()),
        block(3, mesh.quads.iter().map(|quad| quad.as_slice()).collect()),
    )
}

fn vtu(points: &str, connectivity: &str, offsets: &str, types: &str) -> String {
    format!(
        r#"<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt32">
<UnstructuredGrid><Piece NumberOfPoints="0" NumberOfCells="0">
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">{points}</DataArray></Points>
<Cells>
<DataArray type="Int64" Name="connectivity" format="ascii">{connectivity}</DataArray>
<DataArray type="Int64" Name="offsets" format="ascii">{offsets}</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">{types}</DataArray>
</Cells></Piece></UnstructuredGrid></VTKFile>"#
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

#[test]
fn meshes_are_read_back_from_files_unchanged() {
    for (symmetry, element) in SYMMETRIES.into_iter().flat_map(with_elements) {
        let mesh = build(&DISC, symmetry, element, 0.03);
        let files = [
            ("film.obj", as_obj(&mesh)),
            ("film.VTU", as_vtu(&mesh)),
            ("film.msh", as_msh_2(&mesh)),
            ("blocks.msh", as_msh_4(&mesh)),
        ];
        for (name, text) in files {
            let (_folder, path) = file(name, text);
            let back = import(&path, symmetry, Element::Quad4).unwrap();
            assert_eq!(elements(&back, [1.0; 2]), elements(&mesh, [1.0; 2]), "{name}");
            assert_eq!(labels(&back), labels(&mesh), "{name} {symmetry:?}");
        }
    }
    let mesh = build(&SQUARE, Symmetry::Quarter, Element::Tri3, 0.1);
    let (_folder, path) = file("film.stl", as_stl(&mesh));
    let back = import(&path, Symmetry::Quarter, Element::Tri3).unwrap();
    assert_eq!(back.nodes.len(), mesh.nodes.len());
    assert_eq!(back.tris.len(), mesh.tris.len());
    assert_eq!(back.rim.len(), mesh.rim.len());
    assert!((Quality::from_mesh(&back).area - 0.04).abs() < 1e-8);
}

#[test]
fn quads_of_a_file_become_triangles_where_asked() {
    let mesh = build(&SQUARE, Symmetry::None, Element::Quad4, 0.1);
    let (_folder, path) = file("film.obj", as_obj(&mesh));
    let back = import(&path, Symmetry::None, Element::Tri3).unwrap();
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

#[test]
fn binary_arrays_are_read() {
    // Points (0,0,0), (1,0,0), (0,1,0) as float32 and one triangle, each behind its length in bytes.
    let arrays = [
        "JAAAAAAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AAAAAA==",
        "DAAAAAAAAAABAAAAAgAAAA==",
        "BAAAAAMAAAA=",
        "AQAAAAU=",
    ];
    let text = vtu(arrays[0], arrays[1], arrays[2], arrays[3])
        .replace("ascii", "binary")
        .replace("Float64", "Float32")
        .replace("Int64", "Int32");
    let (_folder, path) = file("film.vtu", text);
    let mesh = import(&path, Symmetry::None, Element::Tri3).unwrap();
    assert_eq!(mesh.tris, [[0, 1, 2]]);
    assert_eq!(mesh.nodes[1].x, 1.0);
}

const TRIANGLE: &str = "0 0 0 1 0 0 0 1 0";
const MSH_NODES: &str = "$Nodes\n3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n$EndNodes\n";

#[test]
fn faults_of_files_are_reported_with_their_path() {
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
    let obj = |faces: &str| ("film.obj", format!("{square}{faces}"));
    let vtu = |c: &str, o: &str, t: &str| ("film.vtu", vtu(TRIANGLE, c, o, t));
    let msh = |format: &str, rest: &str| ("film.msh", format!("$MeshFormat\n{format}\n$EndMeshFormat\n{rest}"));
    let cases = [
        (obj(""), "no triangles"),
        (obj("f 1 2 9\n"), "out of bounds"),
        (obj("f 1 2 2\n"), "element 0 has zero area"),
        (obj("v 2 1 0\nf 1 2 3 5 4\n"), "a face with 5 corners"),
        (obj("v 0.1 0.1 0\nf 1 2 5 4\n"), "concave"),
        (obj("v 0 0 1\nf 1 2 5\n"), "element 0 is vertical"),
        (obj("v 0.2 0.9 1\nf 1 2 3\nf 1 2 5\n"), "is folded"),
        (obj("v 0 0 1\nv 0 1 1\nf 1 2 3\nf 1 2 5\nf 1 2 6\n"), "3 elements share"),
        (obj("v 1 x 0\nf 1 2 5\n"), "position parse error"),
        (obj("v 1 nan 0\nf 1 2 5\n"), "not finite"),
        (vtu("0 1 2", "3", "10"), "VTK type 10"),
        (vtu("0 1 7", "3", "5"), "refers to node 7 of 3"),
        (vtu("0 1 2", "4", "5"), "do not match"),
        (vtu("0 1 -1", "3", "5"), "expected a node number, found -1"),
        (vtu("0 1 two", "3", "5"), "expected a number, found `two`"),
        (("film.vtu", "<VTKFile/>".to_owned()), "`UnstructuredGrid` is missing"),
        (("film.vtu", "<VTKFile compressor='vtkZLibDataCompressor'/>".to_owned()), "compressed"),
        (("film.vtu", "solid".to_owned()), "film.vtu: "),
        (("film.stl", "solid film\nfacet\n".to_owned()), "film.stl: "),
        (msh("4.0 0 8", ""), "version 4.0 of the format is not supported"),
        (msh("4.1 1 8", ""), "the file is binary"),
        (msh("2.2 0 8", ""), "`$Nodes` is missing"),
        (msh("2.2 0 8", "$Nodes\n2\n1 0 0 0\n$EndNodes\n"), "`$Nodes` ends too early"),
        (msh("2.2 0 8", "$Nodes\n2\n1 0 0 0\n1 1 0 0\n$EndNodes\n"), "two nodes have the tag 1"),
        (msh("2.2 0 8", "$Nodes\n1\n1 0 zero 0\n$EndNodes\n"), "expected a number in `$Nodes`, found `zero`"),
        (msh("2.2 0 8", &format!("{MSH_NODES}$Elements\n1\n1 4 0 1 2 3 4\n$EndElements\n")), "found Gmsh type 4"),
        (msh("2.2 0 8", &format!("{MSH_NODES}$Elements\n1\n1 2 0 1 2 9\n$EndElements\n")), "node 9, which is missing"),
        (msh("2.2 0 8", &format!("{MSH_NODES}$Elements\n0\n$EndElements\n")), "no triangles"),
        (("film.step", String::new()), "expected a file .stl, .obj, .vtu or .msh"),
    ];
    for ((name, text), expected) in cases {
        let (_folder, path) = file(name, text);
        let message = import(&path, Symmetry::None, Element::Quad4).unwrap_err().to_string();
        assert!(message.contains(name) && message.contains(expected), "{message}");
    }
}

#[test]
fn a_mesh_with_symmetry_is_the_computed_part_only() {
    let (_folder, path) = file("film.obj", as_obj(&build(&SQUARE, Symmetry::None, Element::Quad4, 0.1)));
    let message = import(&path, Symmetry::HalfY, Element::Quad4).unwrap_err().to_string();
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
