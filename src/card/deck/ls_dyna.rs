//! Decks of LS-DYNA: one keyword file.
//!
//! Fields as the keyword classes of pydyna name them (ansys/pydyna, `keyword_classes/auto`). Film is of membranes (ELFORM 9), of
//! which `*MAT_FABRIC` is a law, or of fully integrated shells with one point through the thickness, which have no bending.

use membrane::material::Law;

use super::finding::DeckLoss;
use super::{Body, Face, GRAVITY, STEEL, Scene};
use crate::layout::Field::{self, Blank, Real, Whole};
use crate::layout::in_columns;
use crate::ls_dyna::{Keyword, define_curve};

/// States that are written for pictures.
const STATES: f64 = 100.0;

/// The deck without its head.
pub(super) fn write(scene: &Scene<'_, '_>, losses: &mut Vec<DeckLoss>) -> String {
    let deck = scene.deck;
    losses.push(DeckLoss::NotRun { solver: "LS-DYNA" });
    let mut text = format!("*KEYWORD\n*TITLE\n{}\n", crate::title(deck.title));
    text += &control(scene, losses);
    scene.materials.cards.iter().for_each(|card| text += card);
    let firsts = scene.firsts();
    for (place, face) in deck.faces.iter().enumerate() {
        text += &film(scene, face, place, firsts[place]);
    }
    let mut next = firsts[deck.faces.len()];
    for (place, body) in deck.bodies.iter().enumerate() {
        text += &rigid(scene, body, place, &mut next);
    }
    text += &mounting(scene);
    let points = scene.gravity();
    text += &define_curve(GRAVITY, "gravity", &points, [1.0, 1.0]);
    // Bodies are loaded against the direction of the base acceleration: downwards.
    text += &one("LOAD_BODY_Z", "lcid sf lciddr xc yc zc cid", vec![Whole(GRAVITY), Real(1.0)]);
    for (place, body) in deck.bodies.iter().enumerate() {
        for face in 0..deck.faces.len() {
            text += &contact(scene, body, place, face);
        }
    }
    text + "*END\n"
}

/// A keyword with one card.
fn one(name: &str, names: &'static str, fields: Vec<Field>) -> String {
    Keyword { name, title: None, cards: vec![(names, fields)] }.text()
}

/// A keyword of whose lines the first is a heading.
fn headed(keyword: &str, heading: &str) -> String {
    let (first, rest) = keyword.split_once('\n').unwrap_or((keyword, ""));
    format!("{first}\n{}\n{rest}", crate::title(heading))
}

/// Numbers of the part, section and material of a body.
fn part_of_body(scene: &Scene<'_, '_>, body: usize) -> i64 {
    (scene.deck.faces.len() + body + 1) as i64
}

fn material_of_body(scene: &Scene<'_, '_>, body: usize) -> i64 {
    (scene.materials.cards.len() + body + 1) as i64
}

/// End, and what is written how often.
fn control(scene: &Scene<'_, '_>, losses: &mut Vec<DeckLoss>) -> String {
    let interval = Real(scene.time(scene.deck.interval));
    let end = vec![Real(scene.time(scene.end()))];
    let mut text = one("CONTROL_TERMINATION", "endtim endcyc dtmin endeng endmas nosol", end);
    if scene.deck.faces.iter().any(|face| !is_fabric(face)) {
        losses.push(DeckLoss::Thickness);
        let fields = vec![Blank, Blank, Blank, Whole(1)];
        text += &one("CONTROL_SHELL", "wrpang esort irnxx istupd theory bwc miter proj", fields);
    }
    for name in ["DATABASE_GLSTAT", "DATABASE_RBDOUT", "DATABASE_RCFORC"] {
        text += &one(name, "dt binary lcur ioopt", vec![interval]);
    }
    let between = Real(scene.time(scene.deck.duration / STATES));
    text + &one("DATABASE_BINARY_D3PLOT", "dt lcdt beam npltc psetid", vec![between])
}

fn is_fabric(face: &Face<'_>) -> bool {
    matches!(face.film.material.law, Law::Fabric(_) | Law::RateFabric(_))
}

/// Part, section, nodes and elements of a face.
fn film(scene: &Scene<'_, '_>, face: &Face<'_>, place: usize, first: [usize; 2]) -> String {
    let number = place as i64 + 1;
    let material = i64::from(scene.materials.of_face[place]);
    let part = one("PART", PART, vec![Whole(number), Whole(number), Whole(material)]);
    let mut text = headed(&part, &format!("face {number}: {}", face.film.name));
    let (form, points) = if is_fabric(face) { (9, Blank) } else { (16, Whole(1)) };
    text += &section(number, form, points, scene.length(face.thickness()));
    text += &nodes(scene, face.stress_free.iter().copied(), first[0]);
    let corner = |node: &u32| first[0] + *node as usize;
    let quads = face.quads.iter().map(|quad| quad.each_ref().map(corner));
    let tris = face.tris.iter().map(|tri| tri.each_ref().map(corner)).map(|[a, b, c]| [a, b, c, c]);
    text + &shells(number, first[1], quads.chain(tris))
}

const PART: &str = "pid secid mid eosid hgid grav adpopt tmid";

fn section(number: i64, form: i64, points: Field, thickness: f64) -> String {
    let thickness = Real(thickness);
    let cards = vec![
        ("secid elform shrf nip propt qr/irid icomp setyp", vec![Whole(number), Whole(form), Blank, points]),
        ("t1 t2 t3 t4 nloc marea idof edgset", vec![thickness; 4]),
    ];
    Keyword { name: "SECTION_SHELL", title: None, cards }.text()
}

/// Nodes at places in m, numbered from `first`.
fn nodes(scene: &Scene<'_, '_>, places: impl Iterator<Item = [f64; 3]>, first: usize) -> String {
    let mut text = String::from("*NODE\n$    nid               x               y               z\n");
    for (node, place) in places.enumerate() {
        let [x, y, z] = place.map(|value| in_columns(scene.length(value), 16).unwrap_or_default());
        text += &format!("{:>8}{x:>16}{y:>16}{z:>16}\n", first + node);
    }
    text
}

/// Elements numbered from `first`.
fn shells(part: i64, first: usize, elements: impl Iterator<Item = [usize; 4]>) -> String {
    let mut text = String::from("*ELEMENT_SHELL\n$    eid     pid      n1      n2      n3      n4\n");
    for (element, [a, b, c, d]) in elements.enumerate() {
        text += &format!("{:>8}{part:>8}{a:>8}{b:>8}{c:>8}{d:>8}\n", first + element);
    }
    text
}

/// Part, section, material, nodes and elements of a body; moves the numbers of the `next` node and element on.
fn rigid(scene: &Scene<'_, '_>, body: &Body, place: usize, next: &mut [usize; 2]) -> String {
    let (number, material) = (part_of_body(scene, place), material_of_body(scene, place));
    let start = scene.start(body);
    let [x, y, z] = start.map(|value| Real(scene.length(value)));
    let [ixx, iyy, izz] = body.inertia.map(|value| Real(scene.inertia(value)));
    let [vx, vy, vz] = body.velocity.map(|value| Real(scene.velocity(value)));
    let none = Real(0.0);
    let cards = vec![
        (PART, vec![Whole(number), Whole(number), Whole(material)]),
        ("xc yc zc tm ircs nodeid", vec![x, y, z, Real(scene.mass(body.mass)), Whole(0)]),
        ("ixx ixy ixz iyy iyz izz", vec![ixx, none, none, iyy, none, izz]),
        ("vtx vty vtz vrx vry vrz", vec![vx, vy, vz, none, none, none]),
    ];
    let part = Keyword { name: "PART_INERTIA", title: None, cards }.text();
    let mut text = headed(&part, &body.name);
    text += &section(number, 2, Blank, scene.length(2.0 * body.shape.inset()));
    // The mass of a body is that of its part, its stiffness that of the contact alone.
    let [density, young, poisson] = STEEL;
    let system = scene.system;
    // Of a guided body neither x and y nor rotations are free.
    let constraints = match body.is_guided {
        true => vec![Real(1.0), Real(4.0), Real(7.0)],
        false => vec![Real(0.0)],
    };
    let head = vec![Whole(material), Real(density / system.density()), Real(young / system.stress()), Real(poisson)];
    let cards =
        vec![("mid ro e pr n couple m alias", head), ("cmo con1 con2", constraints), ("lco/a1 a2 a3 v1 v2 v3", vec![])];
    text += &Keyword { name: "MAT_RIGID", title: None, cards }.text();
    let surface = body.shape.triangles(body.shape.inset(), scene.rings(body));
    let places = surface.points.iter().map(|point| [0, 1, 2].map(|axis| start[axis] + point[axis]));
    text += &nodes(scene, places, next[0]);
    let corners =
        surface.corners.iter().map(|corners| corners.map(|corner| next[0] + corner)).map(|[a, b, c]| [a, b, c, c]);
    text += &shells(number, next[1], corners);
    *next = [next[0] + surface.points.len(), next[1] + surface.corners.len()];
    text
}

/// Sets of nodes, where they are fixed, and how they are moved to the frame.
fn mounting(scene: &Scene<'_, '_>) -> String {
    let mounting = &scene.mounting;
    let mut text = String::new();
    let mut set = 0;
    for (axis, fixed) in mounting.fixed.iter().enumerate().filter(|(_, nodes)| !nodes.is_empty()) {
        set += 1;
        text += &node_set(set, fixed);
        let on = |of: usize| Whole(i64::from(of == axis));
        let fields = vec![Whole(set), Blank, on(0), on(1), on(2), Whole(0), Whole(0), Whole(0)];
        text += &one("BOUNDARY_SPC_SET", "nsid cid dofx dofy dofz dofrx dofry dofrz", fields);
    }
    if mounting.moves.is_empty() {
        return text;
    }
    for (number, title, points) in scene.motions() {
        text += &define_curve(number, title, &points, [1.0, 1.0]);
    }
    for one_move in &mounting.moves {
        set += 1;
        text += &node_set(set, &one_move.nodes);
        let (curve, scale) = scene.curve_of(one_move);
        let death = if one_move.is_held { Blank } else { Real(scene.time(mounting.time)) };
        let fields =
            vec![Whole(set), Whole(one_move.axis as i64 + 1), Whole(2), Whole(curve), Real(scale), Blank, death];
        text += &one("BOUNDARY_PRESCRIBED_MOTION_SET", "nsid dof vad lcid sf vid death birth", fields);
    }
    text
}

/// A set of nodes, which are counted from 0.
fn node_set(number: i64, nodes: &[usize]) -> String {
    let mut text = one("SET_NODE_LIST", "sid da1 da2 da3 da4 solver", vec![Whole(number)]);
    for line in nodes.chunks(8) {
        text += &line.iter().map(|node| format!("{:>10}", node + 1)).collect::<String>();
        text.push('\n');
    }
    text
}

/// Contact of the nodes of a face with a body, at half the sum of both contact thicknesses.
fn contact(scene: &Scene<'_, '_>, body: &Body, place: usize, face: usize) -> String {
    let friction = Real(body.friction[face]);
    let [of_film, of_body] = [scene.offset(face), body.shape.inset()].map(|half| Real(scene.length(2.0 * half)));
    let part = Whole(part_of_body(scene, place));
    let cards = vec![
        (
            "surfa surfb surfatyp surfbtyp saboxid sbboxid sapr sbpr",
            vec![Whole(face as i64 + 1), part, Whole(3), Whole(3)],
        ),
        ("fs fd dc vc vdc penchk bt dt", vec![friction, friction]),
        ("sfsa sfsb sast sbst sfsat sfsbt fsf vsf", vec![Real(1.0), Real(1.0), of_film, of_body]),
        // The stiffness follows from masses and the time step: film is far softer than the body.
        ("soft sofscl lcidab maxpar sbopt depth bsort frcfrq", vec![Whole(1), Real(0.1)]),
    ];
    Keyword { name: "CONTACT_AUTOMATIC_NODES_TO_SURFACE", title: None, cards }.text()
}
