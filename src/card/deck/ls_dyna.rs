//! Decks of LS-DYNA: one keyword file.
//!
//! Fields as the keyword classes of pydyna name them (ansys/pydyna, `keyword_classes/auto`). Film is of membranes (ELFORM 9), of
//! which `*MAT_FABRIC` is a law, or of fully integrated shells with one point through the thickness, which have no bending.

use membrane::material::Law;

use super::finding::DeckLoss;
use super::{Body, DeckWriter, Face, GRAVITY, Move, STEEL, Scene, listed};
use crate::film::WriteCurve;
use crate::layout::Field::{Blank, Real, Whole};
use crate::layout::{Field, Layout, in_columns};
use crate::ls_dyna::{define_curve, keyword};

/// Keywords of a deck. The stiffness of a contact follows from masses and the time step (`soft` 1): film is far softer than the
/// body. A mounting prescribes displacements (`vad` 2).
const TERMINATION: Layout = &["endtim:time endcyc dtmin endeng endmas nosol"];
const SHELL: Layout = &["wrpang= esort= irnxx= istupd=1 theory= bwc= miter= proj="];
const OUTPUT: Layout = &["dt:time binary lcur ioopt"];
const STATE: Layout = &["dt:time lcdt beam npltc psetid"];
const GRAVITY_LOAD: Layout = &["lcid sf=1.0 lciddr= xc= yc= zc= cid="];
const PART: Layout = &["pid secid mid eosid hgid grav adpopt tmid"];
const PART_INERTIA: Layout = &[
    "pid secid mid eosid= hgid= grav= adpopt= tmid=",
    "xc:length yc:length zc:length tm:mass ircs=0 nodeid=",
    "ixx:inertia ixy=0.0 ixz=0.0 iyy:inertia iyz=0.0 izz:inertia",
    "vtx:velocity vty:velocity vtz:velocity vrx=0.0 vry=0.0 vrz=0.0",
];
const SECTION: Layout = &[
    "secid elform shrf= nip propt= qr/irid= icomp= setyp=",
    "t1:length t2:length t3:length t4:length nloc marea idof edgset",
];
const RIGID: Layout =
    &["mid ro:density e:stress pr n= couple= m= alias=", "cmo con1 con2", "lco/a1= a2= a3= v1= v2= v3="];
const FIXED: Layout = &["nsid cid= dofx dofy dofz dofrx=0 dofry=0 dofrz=0"];
const MOTION: Layout = &["nsid dof vad=2 lcid sf vid= death:time birth="];
const NODES: Layout = &["sid da1 da2 da3 da4 solver"];
const CONTACT: Layout = &[
    "surfa surfb surfatyp=3 surfbtyp=3 saboxid= sbboxid= sapr= sbpr=",
    "fs fd dc= vc= vdc= penchk= bt= dt=",
    "sfsa=1.0 sfsb=1.0 sast:length sbst:length sfsat= sfsbt= fsf= vsf=",
    "soft=1 sofscl=0.1 lcidab= maxpar= sbopt= depth= bsort= frcfrq=",
];

/// States that are written for pictures.
const STATES: f64 = 100.0;

pub(super) struct LsDyna<'s> {
    scene: &'s Scene<'s, 's>,
    /// Sets of nodes so far.
    sets: i64,
}

impl DeckWriter for LsDyna<'_> {
    const CURVE: WriteCurve = define_curve;

    fn begin(&mut self) -> String {
        let deck = self.scene.deck;
        let mut text = format!("*TITLE\n{}\n", crate::title(deck.title));
        text += &self.keyword("CONTROL_TERMINATION", TERMINATION, vec![Real(self.scene.end())]);
        if has_shells(self.scene) {
            text += &self.keyword("CONTROL_SHELL", SHELL, vec![]);
        }
        for name in ["DATABASE_GLSTAT", "DATABASE_RBDOUT", "DATABASE_RCFORC"] {
            text += &self.keyword(name, OUTPUT, vec![Real(deck.interval)]);
        }
        text + &self.keyword("DATABASE_BINARY_D3PLOT", STATE, vec![Real(deck.duration / STATES)])
    }

    fn face(&mut self, face: &Face<'_>, place: usize, first: [usize; 2]) -> String {
        let number = place as i64 + 1;
        let material = i64::from(self.scene.materials.of_face[place]);
        let title = format!("face {number}: {}", face.film.name);
        let mut text = self.headed("PART", &title, PART, vec![Whole(number), Whole(number), Whole(material)]);
        let (form, points) = if is_fabric(face) { (9, Blank) } else { (16, Whole(1)) };
        text += &self.section(number, form, points, face.thickness());
        text += &self.nodes(face.stress_free.iter().copied(), first[0]);
        let corner = |node: u32| first[0] + node as usize;
        let quads = face.quads.iter().map(|quad| quad.map(corner));
        let tris = face.tris.iter().map(|tri| tri.map(corner)).map(|[a, b, c]| [a, b, c, c]);
        text + &shells(number, first[1], quads.chain(tris))
    }

    fn body(&mut self, body: &Body, place: usize, next: &mut [usize; 2]) -> String {
        let number = self.part_of_body(place);
        let material = (self.scene.materials.cards.len() + place + 1) as i64;
        let start = self.scene.start(body);
        let mut values = vec![Whole(number), Whole(number), Whole(material)];
        values.extend([&start[..], &[body.mass], &body.inertia, &body.velocity].concat().into_iter().map(Real));
        let mut text = self.headed("PART_INERTIA", &body.name, PART_INERTIA, values);
        text += &self.section(number, 2, Blank, 2.0 * body.shape.inset());
        // The mass of a body is that of its part, its stiffness that of the contact alone.
        let mut values = vec![Whole(material)];
        values.extend(STEEL.map(Real));
        // Of a guided body neither x and y nor rotations are free.
        values.extend(if body.is_guided { [Real(1.0), Real(4.0), Real(7.0)] } else { [Real(0.0), Blank, Blank] });
        text += &self.keyword("MAT_RIGID", RIGID, values);
        let surface = body.shape.triangles(body.shape.inset(), self.scene.rings(body));
        let places = surface.points.iter().map(|point| [0, 1, 2].map(|axis| start[axis] + point[axis]));
        text += &self.nodes(places, next[0]);
        let corners = surface.corners.iter().map(|corners| corners.map(|corner| next[0] + corner));
        text += &shells(number, next[1], corners.map(|[a, b, c]| [a, b, c, c]));
        *next = [next[0] + surface.points.len(), next[1] + surface.corners.len()];
        text
    }

    fn fixed(&mut self, axis: usize, nodes: &[usize]) -> String {
        let on = |of: usize| Whole(i64::from(of == axis));
        let set = self.node_set(nodes);
        set + &self.keyword("BOUNDARY_SPC_SET", FIXED, vec![Whole(self.sets), on(0), on(1), on(2)])
    }

    fn moved(&mut self, _: usize, one: &Move) -> String {
        let set = self.node_set(&one.nodes);
        let (curve, scale) = self.scene.curve_of(one);
        let death = if one.is_held { Blank } else { Real(self.scene.mounting.time) };
        let values = vec![Whole(self.sets), Whole(one.axis as i64 + 1), Whole(curve), Real(scale), death];
        set + &self.keyword("BOUNDARY_PRESCRIBED_MOTION_SET", MOTION, values)
    }

    fn gravity(&mut self, _: usize) -> String {
        // Bodies are loaded against the direction of the base acceleration: downwards.
        self.keyword("LOAD_BODY_Z", GRAVITY_LOAD, vec![Whole(GRAVITY)])
    }

    /// At half the sum of both contact thicknesses.
    fn contact(&mut self, body: &Body, place: usize, face: usize) -> String {
        let friction = Real(body.friction[face]);
        let [of_film, of_body] = [self.scene.offset(face), body.shape.inset()].map(|half| Real(2.0 * half));
        let [film, part] = [face as i64 + 1, self.part_of_body(place)].map(Whole);
        let values = vec![film, part, friction, friction, of_film, of_body];
        self.keyword("CONTACT_AUTOMATIC_NODES_TO_SURFACE", CONTACT, values)
    }
}

impl<'s> LsDyna<'s> {
    pub(super) fn new(scene: &'s Scene<'s, 's>, losses: &mut Vec<DeckLoss>) -> LsDyna<'s> {
        losses.push(DeckLoss::NotRun { solver: "LS-DYNA" });
        losses.extend(has_shells(scene).then_some(DeckLoss::Thickness));
        LsDyna { scene, sets: 0 }
    }

    fn keyword(&self, name: &str, layout: Layout, values: Vec<Field>) -> String {
        keyword(name, None, self.scene.system, &[(layout, values)])
    }

    fn headed(&self, name: &str, heading: &str, layout: Layout, values: Vec<Field>) -> String {
        keyword(name, Some(&crate::title(heading)), self.scene.system, &[(layout, values)])
    }

    /// Number of the part and section of a body.
    fn part_of_body(&self, body: usize) -> i64 {
        (self.scene.deck.faces.len() + body + 1) as i64
    }

    fn section(&self, number: i64, form: i64, points: Field, thickness: f64) -> String {
        let values = [&[Whole(number), Whole(form), points][..], &[Real(thickness); 4]].concat();
        self.keyword("SECTION_SHELL", SECTION, values)
    }

    /// Nodes at places in m, numbered from `first`.
    fn nodes(&self, places: impl Iterator<Item = [f64; 3]>, first: usize) -> String {
        let mut text = String::from("*NODE\n$    nid               x               y               z\n");
        for (node, place) in places.enumerate() {
            let [x, y, z] = place.map(|value| in_columns(self.scene.length(value), 16).unwrap_or_default());
            text += &format!("{:>8}{x:>16}{y:>16}{z:>16}\n", first + node);
        }
        text
    }

    /// The next set of nodes.
    fn node_set(&mut self, nodes: &[usize]) -> String {
        self.sets += 1;
        self.keyword("SET_NODE_LIST", NODES, vec![Whole(self.sets)]) + &listed(nodes.iter().map(|node| node + 1), 8)
    }
}

fn is_fabric(face: &Face<'_>) -> bool {
    matches!(face.film.material.law, Law::Fabric(_) | Law::RateFabric(_))
}

/// Whether there is film of shells, which keep their thickness unless they are told to change it.
fn has_shells(scene: &Scene<'_, '_>) -> bool {
    scene.deck.faces.iter().any(|face| !is_fabric(face))
}

/// Elements numbered from `first`.
fn shells(part: i64, first: usize, elements: impl Iterator<Item = [usize; 4]>) -> String {
    let mut text = String::from("*ELEMENT_SHELL\n$    eid     pid      n1      n2      n3      n4\n");
    for (element, [a, b, c, d]) in elements.enumerate() {
        text += &format!("{:>8}{part:>8}{a:>8}{b:>8}{c:>8}{d:>8}\n", first + element);
    }
    text
}
