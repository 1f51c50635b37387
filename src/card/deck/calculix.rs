//! Decks of CalculiX: one input file.
//!
//! Film is of membranes, which CalculiX expands to solids: their thickness would bound an explicit step to fractions of a
//! microsecond, so that the deck is implicit (`*DYNAMIC`). A body is a fan of tetrahedra around its centre, which `*RIGID BODY`
//! makes rigid. CalculiX has no contact thickness: for each face a body has a surface of its own, as much larger as film in
//! contact is away. Friction is not written: with it CalculiX 2.20 shortened its increments without end.

use membrane::material::{HyperelasticLaw, Law};

use super::body::COARSE;
use super::finding::DeckLoss;
use super::mounting::shares;
use super::{Body, Face, Scene};
use crate::number::in_twenty;

/// Stiffness of a contact over that of film in its plane: E t/h² times this.
const STIFFER: f64 = 100.0;

/// Damping of a contact over its stiffness, s: without it light film bounces off the body in every increment.
const DAMPING: f64 = 1e-3;

/// Increments of the mounting.
const MOUNTING: f64 = 20.0;

/// First, least and largest increment of the test over its duration.
const INCREMENTS: [f64; 3] = [3e-4, 1e-9, 1e-2];

/// Increments between two outputs: CalculiX has one such number for all that a step writes.
const BETWEEN_OUTPUTS: u32 = 5;

/// The deck without its head.
pub(super) fn write(scene: &Scene<'_, '_>, losses: &mut Vec<DeckLoss>) -> String {
    let deck = scene.deck;
    let depth = deck.bodies.iter().map(|body| body.shape.facet_depth(COARSE)).fold(0.0, f64::max);
    let stiffness = deck.faces.iter().map(stiffness).fold(0.0, f64::max);
    losses.extend([DeckLoss::Facets { depth }, DeckLoss::Implicit { stiffness }]);
    losses
        .extend(deck.bodies.iter().any(|body| body.friction.iter().any(|f| *f > 0.0)).then_some(DeckLoss::NoFriction));
    losses.extend(deck.bodies.iter().any(|body| !body.is_guided).then_some(DeckLoss::Rotation));
    let mut text = format!("*HEADING\n{}\n", crate::title(deck.title));
    let (first_nodes, first_elements) = (scene.first_nodes(), scene.first_elements());
    for (place, face) in deck.faces.iter().enumerate() {
        text += &film(scene, face, place, [first_nodes[place], first_elements[place]]);
    }
    let mut next = [first_nodes[deck.faces.len()], first_elements[deck.faces.len()]];
    let mut references = vec![];
    for (place, body) in deck.bodies.iter().enumerate() {
        text += &rigid(scene, body, place, &mut next, &mut references);
    }
    let mut names = vec![];
    for (card, place) in scene.materials.cards.iter().zip(1..) {
        names.push(material_name(card));
        text += card;
        debug_assert!(scene.materials.of_face.contains(&place));
    }
    for (place, face) in deck.faces.iter().enumerate() {
        let name = &names[scene.materials.of_face[place] as usize - 1];
        let thickness = in_twenty(scene.length(face.thickness()));
        text += &format!("*MEMBRANE SECTION, ELSET=FACE{}, MATERIAL={name}\n{thickness}\n", place + 1);
        text += &contact(scene, face, place);
    }
    for (body, (reference, _)) in deck.bodies.iter().zip(&references) {
        text += "*INITIAL CONDITIONS, TYPE=VELOCITY\n";
        for (axis, velocity) in body.velocity.iter().enumerate() {
            text += &format!("{reference}, {}, {}\n", axis + 1, in_twenty(scene.velocity(*velocity)));
        }
    }
    text + &steps(scene, &references)
}

/// The name behind `NAME=` of a material's card.
fn material_name(card: &str) -> String {
    let line = card.lines().find_map(|line| line.strip_prefix("*MATERIAL, NAME="));
    line.unwrap_or_default().trim().to_owned()
}

/// Nodes, elements and the surface of a face.
fn film(scene: &Scene<'_, '_>, face: &Face<'_>, place: usize, first: [usize; 2]) -> String {
    let number = place + 1;
    let mut text = nodes(scene, &format!("FILM{number}"), face.stress_free.iter().copied(), first[0]);
    let corner = |node: &u32| first[0] + *node as usize;
    let quads: Vec<Vec<usize>> = face.quads.iter().map(|quad| quad.iter().map(corner).collect()).collect();
    let tris: Vec<Vec<usize>> = face.tris.iter().map(|tri| tri.iter().map(corner).collect()).collect();
    text += &elements("M3D4", &format!("FACE{number}"), first[1], &quads);
    text += &elements("M3D3", &format!("FACE{number}"), first[1] + quads.len(), &tris);
    text + &format!("*SURFACE, NAME=SURFACE{number}, TYPE=NODE\nFILM{number}\n")
}

/// Nodes at places in m, numbered from `first`.
fn nodes(scene: &Scene<'_, '_>, set: &str, places: impl Iterator<Item = [f64; 3]>, first: usize) -> String {
    let mut text = format!("*NODE, NSET={set}\n");
    for (node, place) in places.enumerate() {
        let [x, y, z] = place.map(|value| in_twenty(scene.length(value)));
        text += &format!("{}, {x}, {y}, {z}\n", first + node);
    }
    text
}

/// Elements numbered from `first`; nothing where there are none.
fn elements(kind: &str, set: &str, first: usize, elements: &[Vec<usize>]) -> String {
    if elements.is_empty() {
        return String::new();
    }
    let mut text = format!("*ELEMENT, TYPE={kind}, ELSET={set}\n");
    for (element, corners) in elements.iter().enumerate() {
        let corners: String = corners.iter().map(|corner| format!(", {corner}")).collect();
        text += &format!("{}{corners}\n", first + element);
    }
    text
}

/// A body: for each face tetrahedra around a centre, and the nodes that move and turn it; moves the numbers of the `next` node
/// and element on.
fn rigid(
    scene: &Scene<'_, '_>,
    body: &Body,
    place: usize,
    next: &mut [usize; 2],
    references: &mut Vec<(usize, usize)>,
) -> String {
    let number = place + 1;
    let start = scene.start(body);
    let surfaces: Vec<_> = (0..scene.deck.faces.len())
        .map(|face| body.shape.triangles(scene.offset(face), COARSE).lower(scene.deck.mirrored))
        .collect();
    let mut text = String::new();
    let volume: f64 = surfaces.iter().map(super::body::Triangles::volume).sum();
    for (face, surface) in surfaces.iter().enumerate() {
        let centre = next[0];
        let places = surface.points.iter().map(|point| [0, 1, 2].map(|axis| start[axis] + point[axis]));
        text += &nodes(scene, &format!("BODY{number}"), std::iter::once(start).chain(places), centre);
        // The first face of each is the one outside, seen from the fourth node.
        let corners: Vec<Vec<usize>> = surface
            .corners
            .iter()
            .map(|[a, b, c]| vec![a, c, b])
            .map(|corners| corners.into_iter().map(|corner| centre + 1 + corner).chain([centre]).collect())
            .collect();
        let set = format!("BODY{number}OF{}", face + 1);
        text += &elements("C3D4", &set, next[1], &corners);
        text += &format!("*SURFACE, NAME=S{set}\n{set}, S1\n");
        text += &format!("*SOLID SECTION, ELSET={set}, MATERIAL=RIGID{number}\n");
        *next = [centre + 1 + surface.points.len(), next[1] + surface.corners.len()];
    }
    let (reference, rotation) = (next[0], next[0] + 1);
    next[0] += 2;
    references.push((reference, rotation));
    text += &nodes(scene, &format!("REFERENCE{number}"), std::iter::once(start), reference);
    text += &nodes(scene, &format!("ROTATION{number}"), std::iter::once(start), rotation);
    text += &format!("*RIGID BODY, NSET=BODY{number}, REF NODE={reference}, ROT NODE={rotation}\n");
    // The mass is that of a point at the reference node; what the tetrahedra have of it is round-off.
    let density = OF_SOLIDS * body.mass / volume / scene.system.density();
    let mass = scene.mass((1.0 - OF_SOLIDS) * body.mass);
    text += &format!("*ELEMENT, TYPE=MASS, ELSET=MASS{number}\n{}, {reference}\n", next[1]);
    text += &format!("*MASS, ELSET=MASS{number}\n{}\n", in_twenty(mass));
    next[1] += 1;
    let [young, poisson] = STEEL;
    text += &format!(
        "*MATERIAL, NAME=RIGID{number}\n*DENSITY\n{},\n*ELASTIC\n{}, {}\n",
        in_twenty(density),
        in_twenty(young / scene.system.stress()),
        in_twenty(poisson)
    );
    text
}

/// Share of the mass of a body that its tetrahedra have.
const OF_SOLIDS: f64 = 1e-6;

/// Young's modulus (Pa) and Poisson's ratio of the tetrahedra, which do not deform.
const STEEL: [f64; 2] = [210e9, 0.3];

/// Stiffness of the contact of a face, Pa/m.
fn stiffness(face: &Face<'_>) -> f64 {
    let young = match &face.film.material.law {
        Law::Elastic(law) => law.young,
        Law::TensionField(field) => field.0.young,
        Law::Plastic(law) => law.elastic().young,
        Law::Hyperelastic(HyperelasticLaw::CompressibleNeoHookean(film)) => film.energy.young,
        Law::Hyperelastic(law) => 3.0 * crate::film::shear_modulus(law),
        // The card of a fabric is refused before.
        Law::Fabric(_) | Law::RateFabric(_) => 0.0,
    };
    STIFFER * young * face.thickness() / face.edge().powi(2)
}

/// Contact of a face with all bodies.
fn contact(scene: &Scene<'_, '_>, face: &Face<'_>, place: usize) -> String {
    let number = place + 1;
    let stiffness = stiffness(face) * scene.system.length() / scene.system.stress();
    let mut text = format!("*SURFACE INTERACTION, NAME=CONTACT{number}\n");
    // Pressure over overclosure, and the tension at infinite distance, which is a trifle.
    let tension = in_twenty(1e-3 * stiffness * scene.length(face.thickness()));
    text += &format!("*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n{}, {tension}\n", in_twenty(stiffness));
    text += &format!("*CONTACT DAMPING, TANGENT FRACTION=0\n{}\n", in_twenty(stiffness * scene.time(DAMPING)));
    for body in 1..=scene.deck.bodies.len() {
        text += &format!(
            "*CONTACT PAIR, INTERACTION=CONTACT{number}, TYPE=NODE TO SURFACE\nSURFACE{number}, SBODY{body}OF{number}\n"
        );
    }
    text
}

/// The steps: mounting, where there is one, and the test.
fn steps(scene: &Scene<'_, '_>, references: &[(usize, usize)]) -> String {
    let mounting = &scene.mounting;
    let fixed = fixed(scene, references);
    let mut text = String::new();
    if mounting.time > 0.0 {
        let time = scene.time(mounting.time);
        text += "*AMPLITUDE, NAME=MOUNTING\n";
        for [share, moved] in shares() {
            text += &format!("{}, {}\n", in_twenty(share * time), in_twenty(moved));
        }
        text += "*STEP, NLGEOM, INC=1000\n*DYNAMIC, ALPHA=-0.3, DIRECT\n";
        text += &format!("{}, {}\n*BOUNDARY, AMPLITUDE=MOUNTING\n", in_twenty(time / MOUNTING), in_twenty(time));
        for one in &mounting.moves {
            text += &boundary(&one.nodes, one.axis, scene.length(one.by));
        }
        text += &format!("*BOUNDARY\n{fixed}{}", output(scene));
    }
    let duration = scene.time(scene.end() - mounting.time);
    // Times of an amplitude are those of its step.
    text += "*AMPLITUDE, NAME=GRAVITY\n";
    for [at, g] in scene.gravity() {
        text += &format!("{}, {}\n", in_twenty((at - scene.time(mounting.time)).max(0.0)), in_twenty(g));
    }
    let [first, least, largest] = INCREMENTS.map(|share| in_twenty(share * duration));
    text += &format!(
        "*STEP, NLGEOM, INC=1000000\n*DYNAMIC, ALPHA=-0.3\n{first}, {}, {least}, {largest}\n",
        in_twenty(duration)
    );
    text += "*BOUNDARY, OP=NEW\n";
    for one in mounting.moves.iter().filter(|one| one.is_held) {
        text += &boundary(&one.nodes, one.axis, scene.length(one.by));
    }
    text += &format!("{fixed}*DLOAD, AMPLITUDE=GRAVITY\n");
    let faces = (1..=scene.deck.faces.len()).map(|number| format!("FACE{number}"));
    for set in faces.chain((1..=references.len()).map(|number| format!("MASS{number}"))) {
        text += &format!("{set}, GRAV, 1.0, 0.0, 0.0, -1.0\n");
    }
    text + &output(scene)
}

/// Lines of nodes, counted from 0, that are moved along an axis.
fn boundary(nodes: &[usize], axis: usize, by: f64) -> String {
    let (axis, by) = (axis + 1, in_twenty(by));
    nodes.iter().map(|node| format!("{}, {axis}, {axis}, {by}\n", node + 1)).collect()
}

/// What never moves: of film and of guided bodies; and no body turns, of which only a point has mass.
fn fixed(scene: &Scene<'_, '_>, references: &[(usize, usize)]) -> String {
    let of_film = scene.mounting.fixed.iter().enumerate().map(|(axis, nodes)| boundary(nodes, axis, 0.0));
    let of_body = |(body, (reference, rotation)): (&Body, &(usize, usize))| {
        let guide = if body.is_guided { format!("{reference}, 1, 2\n") } else { String::new() };
        format!("{guide}{rotation}, 1, 3\n")
    };
    of_film.chain(scene.deck.bodies.iter().zip(references).map(of_body)).collect()
}

/// The motion of bodies, and states of the film for a picture; the end of a step.
fn output(scene: &Scene<'_, '_>) -> String {
    let bodies = 1..=scene.deck.bodies.len();
    let motion: String = bodies
        .map(|number| format!("*NODE PRINT, NSET=REFERENCE{number}, FREQUENCY={BETWEEN_OUTPUTS}\nU, V\n"))
        .collect();
    // Energies have to be asked for before a dynamic step.
    format!(
        "{motion}*NODE FILE, FREQUENCY={BETWEEN_OUTPUTS}\nU\n*EL FILE, FREQUENCY={BETWEEN_OUTPUTS}\nS, ENER\n*END STEP\n"
    )
}
