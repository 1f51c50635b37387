//! Decks of OpenRadioss: a starter and an engine file.
//!
//! Blocks in the format of 2023, as its configuration files have them (OpenRadioss, `hm_cfg_files/config/CFG`). A fabric (LAW58)
//! takes the property of type 16, LAW19 and LAW43 that of type 9, the others that of type 1; all with one point through the
//! thickness.

use membrane::material::Law;

use super::finding::DeckLoss;
use super::{Body, DeckRefusal, Face, GRAVITY, STEEL, Scene};
use crate::layout::Field::{self, Real, Whole, Word};
use crate::layout::written;
use crate::openradioss::{Block, function};
use crate::target::System;

/// Share of the mass of a body that its shells have; the rest is that of its main node.
const OF_SHELLS: f64 = 1e-3;

/// Largest stiffness of a contact at a node, N/m. The solver's own is that of the steepest curve, unloading among them, which
/// throws stiff film back and takes four times as many steps. Nodes of test 1008, with 3 N each, sink by 0.2 mm.
const CONTACT: f64 = 2e4;

/// What shells do where a card has no field of the law's: these are defaults of the solver.
const SHEAR_SHARE: f64 = 5.0 / 6.0;
const NUMERICAL_DAMPING: f64 = 0.015;

/// Starter without its head, and engine.
pub(super) fn write(scene: &Scene<'_, '_>, losses: &mut Vec<DeckLoss>) -> Result<[String; 2], DeckRefusal> {
    let units = match scene.system {
        System::KgMS => ["kg", "m", "s"],
        System::TMmS => ["Mg", "mm", "s"],
        System::GMmMs => ["g", "mm", "ms"],
        System::KgMmMs => ["kg", "mm", "ms"],
        System::LbfInS => return Err(DeckRefusal::Units(scene.system.name())),
    };
    let deck = scene.deck;
    losses.push(DeckLoss::ContactStiffness { stiffness: CONTACT });
    let units: String = units.iter().map(|unit| format!("{unit:>20}")).collect();
    let mut text = format!("/BEGIN\nfilm\n{:>10}{:>10}\n{units}\n{units}\n", 2023, 0);
    text += &format!("/TITLE\n{}\n", crate::title(deck.title));
    scene.materials.cards.iter().for_each(|card| text += card);
    let firsts = scene.firsts();
    let mut groups = Groups::default();
    for (place, face) in deck.faces.iter().enumerate() {
        text += &film(scene, face, place, firsts[place]);
        let [first, _] = firsts[place];
        text += &groups.add(&format!("face {}", place + 1), first..first + face.mounted.len());
    }
    let mut next = firsts[deck.faces.len()];
    for (place, body) in deck.bodies.iter().enumerate() {
        text += &rigid(scene, body, place, &mut next, &mut groups);
    }
    text += &mounting(scene, &mut groups);
    text += &function(GRAVITY, "gravity", scene.gravity());
    text += &groups.add("all", 1..next[0]);
    let [of, along, no_skew, no_sensor, on] = loaded(GRAVITY, "Z", groups.last);
    let names = "funct_IDT# DIR# skew_ID# sensor_ID# grnod_ID# - Ascale_x Fscale_Y";
    let values = [of, along, no_skew, no_sensor, on, Real(1.0), Real(-1.0)];
    text += &Block::begin("/GRAV/1", "gravity").line(names, &values).0;
    for (place, body) in deck.bodies.iter().enumerate() {
        for face in 0..deck.faces.len() {
            text += &contact(scene, body, place, face);
        }
    }
    Ok([text + "/END\n", engine(scene)])
}

/// Type of the property that a law takes.
fn property(face: &Face<'_>) -> u32 {
    match &face.film.material.law {
        Law::Fabric(_) | Law::RateFabric(_) => 16,
        Law::Elastic(_) | Law::TensionField(_) => 9,
        Law::Plastic(law) => {
            if crate::film::lost_hill(law).is_some() {
                9
            } else {
                1
            }
        }
        Law::Hyperelastic(_) => 1,
    }
}

/// Groups of nodes, numbered one after the other.
#[derive(Default)]
struct Groups {
    last: i64,
}

impl Groups {
    /// Nodes that are counted from 1.
    fn add(&mut self, title: &str, nodes: impl IntoIterator<Item = usize>) -> String {
        self.last += 1;
        let nodes: Vec<usize> = nodes.into_iter().collect();
        let line = |line: &[usize]| line.iter().map(|node| format!("{node:>10}")).collect::<String>() + "\n";
        format!("/GRNOD/NODE/{}\n{title}\n{}", self.last, nodes.chunks(10).map(line).collect::<String>())
    }
}

/// Function, direction, no skew, no sensor, group.
fn loaded(function: i64, direction: &'static str, group: i64) -> [Field; 5] {
    [Whole(function), Word(direction), Whole(0), Whole(0), Whole(group)]
}

/// Part, property, nodes and elements of a face.
fn film(scene: &Scene<'_, '_>, face: &Face<'_>, place: usize, first: [usize; 2]) -> String {
    let number = place + 1;
    let material = i64::from(scene.materials.of_face[place]);
    let title = crate::title(&format!("face {number} {}", face.film.name));
    let mut text = part(number, &title, material) + &film_property(scene, face, number, material, &title);
    text += &nodes(scene, face.stress_free.iter().copied(), first[0]);
    let corner = |node: &u32| first[0] + *node as usize;
    let quads: Vec<Vec<usize>> = face.quads.iter().map(|quad| quad.iter().map(corner).collect()).collect();
    let tris: Vec<Vec<usize>> = face.tris.iter().map(|tri| tri.iter().map(corner).collect()).collect();
    text += &elements("SHELL", number, first[1], &quads);
    text + &elements("SH3N", number, first[1] + quads.len(), &tris)
}

fn part(number: usize, title: &str, material: i64) -> String {
    let values = [Whole(number as i64), Whole(material), Whole(0)];
    Block::begin(&format!("/PART/{number}"), title).line("prop_ID# mat_ID# subset_ID#", &values).0
}

/// Lines that begin all properties of shells: elements of type 24 (QEPH), measure of strain, no damping but that of membranes.
fn shell_property(kind: u32, number: usize, title: &str, strain: i64) -> Block {
    let names = if kind == 16 {
        "Ishell# Ismstr# Ish3n# - - - P_Thick_Fail"
    } else {
        "Ishell# Ismstr# Ish3n# Idrill# - - P_Thick_Fail"
    };
    let mut flags = vec![Whole(24), Whole(strain), Whole(2)];
    flags.extend((kind != 16).then_some(Whole(0)));
    flags.push(Real(1.0));
    let none = Real(0.0);
    Block::begin(&format!("/PROP/TYPE{kind}/{number}"), title)
        .line(names, &flags)
        .line("Hm Hf Hr Dm Dn", &[none, none, none, none, Real(NUMERICAL_DAMPING)])
}

/// The property of a face: large strain, and thickness that changes where the law is one of true stress.
fn film_property(scene: &Scene<'_, '_>, face: &Face<'_>, number: usize, material: i64, title: &str) -> String {
    let kind = property(face);
    let thickness = Real(scene.length(face.thickness()));
    let [vx, vy] = [face.md_angle.cos(), face.md_angle.sin()].map(Real);
    // Rubber has the strain of the whole motion: increments of it add up to another one where film is sheared.
    let strain = if matches!(face.film.material.law, Law::Hyperelastic(_)) { 10 } else { 4 };
    let block = shell_property(kind, number, title, strain);
    // One point: no bending. Strain is computed, as all that is read of it needs.
    let [one, two, none, nil] = [Whole(1), Whole(2), Whole(0), Real(0.0)];
    let shear = Real(SHEAR_SHARE);
    match kind {
        16 => block
            // Forces per width of film without stress: its thickness stays.
            .line("N# Istrain# Thick Ashear - Ithick#", &[one, one, thickness, shear, two])
            .line("Vx Vy Vz Skew_ID# Ipos# - Ip#", &[vx, vy, nil, none, none, none])
            .line("Phi_i Alpha_i T_i Z_i mat_IDi#", &[nil, Real(90.0), thickness, nil, Whole(material)]),
        9 => block
            .line("N# Istrain# Thick Ashear Iskew# Ithick# Iplas#", &[one, one, thickness, shear, none, one, one])
            .line("Vx Vy Vz Phi - Ip#", &[vx, vy, nil, nil, none]),
        // Film that flows thins as it does without volume: without Iplas it thins as elastic film.
        _ => block.line("N# Istrain# Thick Ashear - Ithick# Iplas#", &[one, one, thickness, shear, one, one]),
    }
    .0
}

/// Nodes at places in m, numbered from `first`.
fn nodes(scene: &Scene<'_, '_>, places: impl Iterator<Item = [f64; 3]>, first: usize) -> String {
    let mut text = String::from("/NODE\n#  NODE_ID                  XC                  YC                  ZC\n");
    for (node, place) in places.enumerate() {
        let place = place.map(|value| written(Real(scene.length(value)), 20));
        text += &format!("{:>10}{:>20}{:>20}{:>20}\n", first + node, place[0], place[1], place[2]);
    }
    text
}

/// Elements numbered from `first`; nothing where there are none.
fn elements(kind: &str, part: usize, first: usize, elements: &[Vec<usize>]) -> String {
    if elements.is_empty() {
        return String::new();
    }
    let mut text = format!("/{kind}/{part}\n");
    for (element, corners) in elements.iter().enumerate() {
        let numbers = std::iter::once(first + element).chain(corners.iter().copied());
        text += &numbers.map(|number| format!("{number:>10}")).collect::<String>();
        text.push('\n');
    }
    text
}

/// A body as shells on a main node at its centre, which has its mass, velocity and output; moves the numbers of the `next` node
/// and element on.
fn rigid(scene: &Scene<'_, '_>, body: &Body, place: usize, next: &mut [usize; 2], groups: &mut Groups) -> String {
    let deck = scene.deck;
    let number = deck.faces.len() + place + 1;
    let material = (scene.materials.cards.len() + place + 1) as i64;
    let (start, inset) = (scene.start(body), body.shape.inset());
    let surface = body.shape.triangles(inset, scene.rings(body));
    let main = next[0];
    let title = crate::title(&body.name);
    let mut text = part(number, &title, material);
    // Thin shells of any mass but none: what they have is not added to the main node.
    let thickness = Real(scene.length(inset));
    let values = [Whole(1), Whole(1), thickness, Real(SHEAR_SHARE), Whole(2), Whole(1)];
    text += &shell_property(1, number, &title, 2).line("N# Istrain# Thick Ashear - Ithick# Iplas#", &values).0;
    let density = Real(OF_SHELLS * body.mass / (surface.area() * inset) / scene.system.density());
    // The shells of a body are rigid.
    let [_, young, poisson] = STEEL;
    text += &Block::begin(&format!("/MAT/LAW1/{material}"), &title)
        .line("RHO_I", &[density])
        .line("E nu", &[Real(young / scene.system.stress()), Real(poisson)])
        .0;
    let places = surface.points.iter().map(|point| [0, 1, 2].map(|axis| start[axis] + point[axis]));
    text += &nodes(scene, std::iter::once(start).chain(places), main);
    let corners: Vec<Vec<usize>> =
        surface.corners.iter().map(|corners| corners.iter().map(|corner| main + 1 + corner).collect()).collect();
    text += &elements("SH3N", number, next[1], &corners);
    *next = [main + 1 + surface.points.len(), next[1] + surface.corners.len()];
    text += &groups.add(&format!("{title}, surface"), main + 1..next[0]);
    let inertia = body.inertia.map(|value| Real(scene.inertia(value)));
    let mass = Real(scene.mass((1.0 - OF_SHELLS) * body.mass));
    let (none, nil) = (Whole(0), Real(0.0));
    // The centre is that of the main node.
    let head = [Whole(main as i64), none, none, none, mass, Whole(groups.last), none, Whole(3), none];
    text += &Block::begin(&format!("/RBODY/{}", place + 1), &title)
        .line("node_ID# sens_ID# Skew_ID# Ispher# Mass grnd_ID# Ikrem# ICoG# surf_ID#", &head)
        .line("Jxx Jyy Jzz", &inertia)
        .line("Jxy Jyz Jxz", &[nil; 3])
        .line("Ioptoff# Iexpams#", &[none; 2])
        .0;
    text += &format!("/SURF/PART/{number}\n{title}\n{number:>10}\n");
    text += &groups.add(&format!("{title}, main node"), [main]);
    if body.is_guided {
        text += &constraint(place + 1, "110 111", groups.last, &format!("{title}, guide"));
    }
    text += &groups.add(&format!("{title}, all"), main..next[0]);
    let [vx, vy, vz] = body.velocity.map(|value| Real(scene.velocity(value)));
    text += &Block::begin(&format!("/INIVEL/TRA/{}", place + 1), &title)
        .line("Vx Vy Vz Gnod_id# Skew_id#", &[vx, vy, vz, Whole(groups.last), none])
        .0;
    // By its end a time history is known as that of a test: lab's reader of them has its signals over the time of the test.
    let test = format!("{}; test from {} s", title.chars().take(60).collect::<String>(), scene.mounting.begin);
    text += &format!("/TH/NODE/{}\n{test}\nDZ        VZ        AZ\n{main:>10}{:>10}\n", 2 * place + 1, 0);
    text + &format!("/TH/RBODY/{}\n{title}\nDEF       FX        FY        FZ\n{:>10}\n", 2 * place + 2, place + 1)
}

/// Degrees of freedom of a group that are fixed.
fn constraint(number: usize, fixed: &'static str, group: i64, title: &str) -> String {
    let values = [Word(fixed), Whole(0), Whole(group)];
    Block::begin(&format!("/BCS/{number}"), title).line("Tra_rot# skew_ID# grnod_ID#", &values).0
}

/// Groups of nodes, where they are fixed, and how they are moved to the frame.
fn mounting(scene: &Scene<'_, '_>, groups: &mut Groups) -> String {
    let mounting = &scene.mounting;
    let mut text = String::new();
    let counted = |nodes: &[usize]| nodes.iter().map(|node| node + 1).collect::<Vec<usize>>();
    for (axis, fixed) in mounting.fixed.iter().enumerate().filter(|(_, nodes)| !nodes.is_empty()) {
        let name = ["x", "y", "z"][axis];
        text += &groups.add(&format!("fixed along {name}"), counted(fixed));
        let number = scene.deck.bodies.len() + axis + 1;
        text +=
            &constraint(number, ["100 000", "010 000", "001 000"][axis], groups.last, &format!("fixed along {name}"));
    }
    if mounting.moves.is_empty() {
        return text;
    }
    let (time, end) = (scene.time(mounting.time), 2.0 * scene.time(scene.end()));
    for (number, title, points) in scene.motions() {
        text += &function(number, title, points);
    }
    for (place, one) in mounting.moves.iter().enumerate() {
        let direction = ["X", "Y", "Z"][one.axis];
        text += &groups.add(&format!("moved along {direction}"), counted(&one.nodes));
        let (curve, scale) = scene.curve_of(one);
        let stop = if one.is_held { end } else { time };
        text += &Block::begin(&format!("/IMPDISP/{}", place + 1), "mounting")
            .line(
                "funct_IDT# Dir# skew_ID# sensor_ID# grnod_ID# frame_ID# Icoor#",
                &[&loaded(curve, direction, groups.last)[..], &[Whole(0); 2]].concat(),
            )
            .line("Ascale_x Fscale_Y Tstart Tstop", &[Real(1.0), Real(scale), Real(0.0), Real(stop)])
            .0;
    }
    text
}

/// Contact of the nodes of a face with a body, at a constant gap.
fn contact(scene: &Scene<'_, '_>, body: &Body, place: usize, face: usize) -> String {
    let number = place * scene.deck.faces.len() + face + 1;
    let surface = (scene.deck.faces.len() + place + 1) as i64;
    let gap = scene.length(body.shape.inset() + scene.offset(face));
    let (none, nil, one) = (Whole(0), Real(0.0), Real(1.0));
    // The group of a face has its number. The least of both stiffnesses, a constant gap.
    let head = [Whole(face as i64 + 1), Whole(surface), Whole(4), none, Whole(1000), none, none, none, none];
    let stiffness = [nil, Real(scene.stiffness(CONTACT)), nil, nil, Whole(1), none];
    // Friction by increments: the default is viscous, and less.
    let friction = [none, none, nil, Whole(2), none, none, one, none];
    Block::begin(&format!("/INTER/TYPE7/{number}"), &crate::title(&format!("{} on face {}", body.name, face + 1)))
        .line("grnod_id# surf_id# Istf# Ithe# Igap# - Ibag# Idel# Icurv# Iadm#", &head)
        .line("Fscalegap Gap_max Fpenmax - - Itied#", &[one, nil, nil, none])
        .line("Stmin Stmax Percent_mesh_size dtmin Irem_gap# Irem_i2#", &stiffness)
        .line("Stfac Fric GAPmin Tstart Tstop", &[one, Real(body.friction[face]), Real(gap), nil, nil])
        .line("IBC# - - Inacti# VIS_S VIS_F Bumult", &[Word("000"), none, Real(0.05), one, nil])
        .line("Ifric# Ifiltr# Xfreq Iform# sens_ID# fct_IDF# AscaleF fric_ID#", &friction)
        .0
}

/// The engine file: how long, and what is written how often. Time histories of the format of 2021 name their units.
fn engine(scene: &Scene<'_, '_>) -> String {
    let [end, interval] = [scene.end(), scene.deck.interval].map(|time| crate::layout::whole(scene.time(time)));
    let states = crate::layout::whole(scene.time(scene.deck.duration / 100.0));
    // Stiff film of linear law rings at its stable step.
    let is_stiff = |face: &Face<'_>| property(face) != 16 && !matches!(face.film.material.law, Law::Hyperelastic(_));
    let step = if scene.deck.faces.iter().any(is_stiff) { 0.6 } else { 0.9 };
    format!(
        "#RADIOSS ENGINE\n/VERS/2023\n/RUN/film/1\n{end}\n/TFILE\n{interval}\n/TH/VERS/2021\n/ANIM/DT\n0.0 {states}\n/PRINT/-1000\n/DT\n{step} 0.0\n"
    )
}
