//! Decks: a whole drop test in the formats of other solvers.
//!
//! A [`Deck`] is the test in their terms, in SI units: film as it is without stress and where the frame holds it, rigid bodies,
//! gravity, time. Each solver has a module that writes it; the material cards are those of [`crate::write`]. Pre-strain is
//! written as a step of mounting, of which every solver here is capable for every law: film is moved from its stress-free shape to
//! the frame, while the bodies approach, and let go of when they reach it.

mod body;
mod finding;
mod ls_dyna;
mod openradioss;

use super::Loss;
use super::film::{Film, Request, WriteCurve};
use super::target::{System, Target};
use base::diagnostic::Diagnostic;
use base::number::significant;

pub use body::stress_free;
pub use finding::{CODES, DeckLoss};

use body::{Mounting, Move, mounting, shares};
use ls_dyna::LsDyna;
use openradioss::OpenRadioss;

/// Numbers of the curves of a deck; those of materials begin above 100.
const MOTION: i64 = 1;
const REST: i64 = 2;
const GRAVITY: i64 = 3;

/// Density (kg/m³), Young's modulus (Pa) and Poisson's ratio of a body: steel.
const STEEL: [f64; 3] = [7850.0, 210e9, 0.3];

/// A drop test, SI.
#[derive(Clone, Debug)]
pub struct Deck<'a> {
    /// One line.
    pub title: &'a str,
    /// What it was made from, a line each.
    pub origin: &'a [String],
    /// The faces of film, from the first that a body meets to the last.
    pub faces: Vec<Face<'a>>,
    /// The bodies.
    pub bodies: Vec<Body>,
    /// Whether x = 0 and y = 0 are mirror planes, beside which the part at x, y > 0 is computed.
    pub mirrored: [bool; 2],
    /// m/s², downwards.
    pub gravity: f64,
    /// Simulated time from the start of the test on, s.
    pub duration: f64,
    /// Time between two outputs of the motion of bodies, s.
    pub interval: f64,
    /// What the scenario has and the deck does not.
    pub losses: Vec<DeckLoss>,
}

impl Deck<'_> {
    /// How many copies of the computed part the whole is made of.
    fn copies(&self) -> f64 {
        self.mirrored.iter().map(|is_mirrored| if *is_mirrored { 2.0 } else { 1.0 }).product()
    }
}

/// A face of film.
#[derive(Clone, Debug)]
pub struct Face<'a> {
    /// Name and material of one layer.
    pub film: Film<'a>,
    /// Layers that one element stands for.
    pub layers: u32,
    /// Nodes where the frame holds them, m.
    pub mounted: Vec<[f64; 3]>,
    /// The same nodes without stress, m.
    pub stress_free: Vec<[f64; 3]>,
    /// Corners of the elements of four nodes.
    pub quads: Vec<[u32; 4]>,
    /// Corners of the elements of three nodes.
    pub tris: Vec<[u32; 3]>,
    /// Axes along which frame or mirror planes hold each node.
    pub held: Vec<[bool; 3]>,
    /// Angle from the x axis to MD, rad.
    pub md_angle: f64,
}

impl Face<'_> {
    /// The shortest edge of its elements where the frame holds them, m.
    fn shortest(&self) -> f64 {
        let of = |corners: &[u32]| {
            let next = corners.iter().cycle().skip(1);
            let between = |(a, b): (&u32, &u32)| {
                let [a, b] = [a, b].map(|node| self.mounted[*node as usize]);
                (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>().sqrt()
            };
            corners.iter().zip(next).map(between).fold(f64::INFINITY, f64::min)
        };
        self.quads.iter().map(|quad| of(quad)).chain(self.tris.iter().map(|tri| of(tri))).fold(f64::INFINITY, f64::min)
    }

    /// Thickness of all layers without stress, m.
    pub fn thickness(&self) -> f64 {
        self.film.material.thickness * f64::from(self.layers)
    }
}

/// A rigid body.
#[derive(Clone, Debug)]
pub struct Body {
    /// One word or more.
    pub name: String,
    /// Its surface.
    pub shape: Shape,
    /// Of the computed part, kg.
    pub mass: f64,
    /// Moments of inertia about x, y and z of the computed part, kg m².
    pub inertia: [f64; 3],
    /// Its centre at the start of the test, m.
    pub position: [f64; 3],
    /// At the start of the test, m/s.
    pub velocity: [f64; 3],
    /// Whether it moves along z alone; else in all directions.
    pub is_guided: bool,
    /// Coulomb coefficient on each face.
    pub friction: Vec<f64>,
}

/// The surface of a body about its centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// A ball.
    Sphere {
        /// m.
        radius: f64,
    },
    /// A shaft along z with hemispheres at its ends.
    Capsule {
        /// Of shaft and ends, m.
        radius: f64,
        /// Of the shaft, m.
        length: f64,
    },
}

/// A file of a deck.
#[derive(Clone, Debug, PartialEq)]
pub struct File {
    /// Its name.
    pub name: &'static str,
    /// Its text.
    pub text: String,
}

/// Names of all files that a deck can have.
pub const FILES: [&str; 3] = ["film.k", "film_0000.rad", "film_0001.rad"];

/// A deck as it is written.
#[derive(Clone, Debug, PartialEq)]
pub struct Written {
    /// Its files; the first is given to the solver.
    pub files: Vec<File>,
    /// What it has otherwise than the test.
    pub losses: Vec<DeckLoss>,
    /// What its material cards lose, each once.
    pub card_losses: Vec<Loss>,
}

/// Writes a test for the target of `request`, which says also how materials are written; its layers and number are not used.
///
/// # Errors
/// The solver has no decks, or does not take a material or the units.
pub fn write(deck: &Deck<'_>, request: &Request) -> Result<Written, Diagnostic> {
    if !matches!(request.target, Target::LsDyna | Target::OpenRadioss) {
        let target = request.target.name();
        let refusal =
            Diagnostic::new(format!("no decks are written for {target}: for LS-DYNA and OpenRadioss they are"));
        return Err(refusal.hint("its materials can be written: `droptower export card`"));
    }
    let materials = Materials::of(deck, request)?;
    let mounting = mounting(deck);
    let mut losses = deck.losses.clone();
    losses.extend((mounting.time > 0.0).then_some(DeckLoss::Mounting { time: mounting.begin }));
    let depends_on_time = |face: &Face<'_>| {
        let material = face.film.material;
        material.viscosity.is_some() || request.rate.is_none() && material.law.rates().is_some()
    };
    let is_rated = mounting.time > 0.0 && deck.faces.iter().any(depends_on_time);
    losses.extend(is_rated.then_some(DeckLoss::MountingRate { time: mounting.time }));
    let copies = deck.copies();
    losses.extend((copies > 1.0).then_some(DeckLoss::Part { copies }));
    let scene = Scene { deck, mounting, materials: &materials, system: request.system };
    let inset = deck.bodies.iter().map(|body| body.shape.inset()).fold(0.0, f64::max);
    losses.extend([DeckLoss::Facets { depth: scene.facet_depth() }, DeckLoss::Penalty { inset }]);
    let files = if request.target == Target::LsDyna {
        let text = written(&scene, &mut LsDyna::new(&scene, &mut losses)) + "*END\n";
        vec![File { name: FILES[0], text: head_of_deck("$ ", &scene, &losses, request) + "*KEYWORD\n" + &text }]
    } else {
        let starter = written(&scene, &mut OpenRadioss::new(&scene, &mut losses)?) + "/END\n";
        let head = head_of_deck("# ", &scene, &losses, request);
        vec![
            File { name: FILES[1], text: format!("#RADIOSS STARTER\n{head}{starter}") },
            File { name: FILES[2], text: openradioss::engine(&scene) },
        ]
    };
    Ok(Written { files, losses, card_losses: materials.losses })
}

/// How a solver writes the parts of a deck, in the order in which they stand.
trait DeckWriter {
    /// Its curves.
    const CURVE: WriteCurve;

    /// What stands above the materials.
    fn begin(&mut self) -> String;

    /// Part, property, nodes and elements of the face at `place`; the first node and element have these numbers.
    fn face(&mut self, face: &Face<'_>, place: usize, first: [usize; 2]) -> String;

    /// Part, property, material, nodes and elements of a body; moves the numbers of the `next` node and element on.
    fn body(&mut self, body: &Body, place: usize, next: &mut [usize; 2]) -> String;

    /// Nodes, counted from 0, that never move along an axis.
    fn fixed(&mut self, axis: usize, nodes: &[usize]) -> String;

    /// The motion to the frame at `place` among all of them.
    fn moved(&mut self, place: usize, one: &Move) -> String;

    /// The load on all nodes, of which there are so many.
    fn gravity(&mut self, nodes: usize) -> String;

    /// Contact of the nodes of a face with the body at `place`.
    fn contact(&mut self, body: &Body, place: usize, face: usize) -> String;
}

/// The deck without its head and the line that ends it.
fn written<W: DeckWriter>(scene: &Scene<'_, '_>, writer: &mut W) -> String {
    let (deck, mounting) = (scene.deck, &scene.mounting);
    let mut text = writer.begin() + &scene.materials.cards.concat();
    let mut next = [1; 2];
    for (place, face) in deck.faces.iter().enumerate() {
        text += &writer.face(face, place, next);
        next = [next[0] + face.mounted.len(), next[1] + face.quads.len() + face.tris.len()];
    }
    for (place, body) in deck.bodies.iter().enumerate() {
        text += &writer.body(body, place, &mut next);
    }
    for (axis, nodes) in mounting.fixed.iter().enumerate().filter(|(_, nodes)| !nodes.is_empty()) {
        text += &writer.fixed(axis, nodes);
    }
    let curve = |number, title, points: Vec<[f64; 2]>| W::CURVE(number, title, &points, [1.0, 1.0]);
    if !mounting.moves.is_empty() {
        text.extend(scene.motions().map(|(number, title, points)| curve(number, title, points)));
    }
    for (place, one) in mounting.moves.iter().enumerate() {
        text += &writer.moved(place, one);
    }
    text += &curve(GRAVITY, "gravity", scene.gravity());
    text += &writer.gravity(next[0] - 1);
    for (place, body) in deck.bodies.iter().enumerate() {
        text.extend((0..deck.faces.len()).map(|face| writer.contact(body, place, face)));
    }
    text
}

/// Numbers in columns of ten, so many a line.
fn listed(numbers: impl IntoIterator<Item = usize>, a_line: usize) -> String {
    let numbers: Vec<String> = numbers.into_iter().map(|number| format!("{number:>10}")).collect();
    numbers.chunks(a_line).map(|line| line.concat() + "\n").collect()
}

/// What the modules of solvers write from.
struct Scene<'s, 'a> {
    deck: &'s Deck<'a>,
    mounting: Mounting,
    materials: &'s Materials,
    system: System,
}

impl Scene<'_, '_> {
    /// Time of the deck at which the test ends, s: it begins after the mounting.
    fn end(&self) -> f64 {
        self.mounting.begin + self.deck.duration
    }

    /// Centre of a body when the mounting begins, m: it approaches with its velocity.
    fn start(&self, body: &Body) -> [f64; 3] {
        [0, 1, 2].map(|axis| body.position[axis] - body.velocity[axis] * self.mounting.begin)
    }

    /// Distance of the middle of a face from a body in contact with it, m: films without a gap lie on each other.
    fn offset(&self, face: usize) -> f64 {
        let before: f64 = self.deck.faces[..face].iter().map(Face::thickness).sum();
        before + 0.5 * self.deck.faces[face].thickness()
    }

    /// Rings of facets of a body: no edge below twice the largest gap of a penalty, nor below a tenth of the film's shortest one.
    fn rings(&self, body: &Body) -> usize {
        const SHARE: f64 = 0.1;
        let gap = body.shape.inset() + self.offset(self.deck.faces.len() - 1);
        let film = self.deck.faces.iter().map(Face::shortest).fold(f64::INFINITY, f64::min);
        body.shape.rings((2.05 * gap).max(SHARE * film))
    }

    /// Largest distance of facets below the surface of a body, m.
    fn facet_depth(&self) -> f64 {
        self.deck.bodies.iter().map(|body| body.shape.facet_depth(self.rings(body))).fold(0.0, f64::max)
    }

    /// Numbers and titles of the curves of the mounting, and their points over time in the units of the deck.
    fn motions(&self) -> [(i64, &'static str, Vec<[f64; 2]>); 2] {
        let (time, end) = (self.time(self.mounting.time), 2.0 * self.time(self.end()));
        let to_frame = shares().map(|[share, moved]| [share * time, moved]).chain([[end, 1.0]]);
        let rest = vec![[0.0, 0.0], [end, 0.0]];
        [(MOTION, "share of the motion to the frame", to_frame.collect()), (REST, "no motion", rest)]
    }

    /// Number and scale of the curve of a move. A scale of zero would be taken for its default.
    fn curve_of(&self, one: &Move) -> (i64, f64) {
        if one.by == 0.0 { (REST, 1.0) } else { (MOTION, self.length(one.by)) }
    }

    /// A length in the units of the deck.
    fn length(&self, length: f64) -> f64 {
        length / self.system.length()
    }

    fn time(&self, time: f64) -> f64 {
        time / self.system.time()
    }

    /// Points of gravity over time, in the units of the deck: it begins with the test.
    fn gravity(&self) -> Vec<[f64; 2]> {
        /// Share of the time before it within which it rises.
        const RISE: f64 = 1e-4;
        let [g, begin, end] = [
            self.deck.gravity * self.system.time().powi(2) / self.system.length(),
            self.time(self.mounting.begin),
            // Beyond the end, so that no solver reads past it.
            2.0 * self.time(self.end()),
        ];
        match begin > 0.0 {
            true => vec![[0.0, 0.0], [begin * (1.0 - RISE), 0.0], [begin, g], [end, g]],
            false => vec![[0.0, g], [end, g]],
        }
    }
}

/// The material cards of a deck, each material once.
struct Materials {
    /// Text of each card, without what begins and ends a file.
    cards: Vec<String>,
    /// Number of the material of each face, from 1.
    of_face: Vec<u32>,
    losses: Vec<Loss>,
}

impl Materials {
    fn of(deck: &Deck<'_>, request: &Request) -> Result<Materials, Diagnostic> {
        let mut found = Materials { cards: vec![], of_face: vec![], losses: vec![] };
        for (place, face) in deck.faces.iter().enumerate() {
            let before = deck.faces[..place].iter().zip(&found.of_face);
            let alike = |other: &Face<'_>| other.film.material == face.film.material && other.md_angle == face.md_angle;
            if let Some(known) = before.filter(|(other, _)| alike(other)).map(|(_, number)| *number).next() {
                found.of_face.push(known);
                continue;
            }
            let id = found.cards.len() as u32 + 1;
            let request = Request { id, layers: face.layers, md_angle: face.md_angle, ..request.clone() };
            let film = Film { name: &format!("{} {id}", face.film.name), origin: &[], ..face.film.clone() };
            let card = crate::pieces(&film, &request).map_err(|refusal| {
                let message = format!("face {}: {}", place + 1, refusal.message);
                Diagnostic { message, ..refusal }
            })?;
            let new = card.losses.into_iter().filter(|loss| !found.losses.contains(loss)).collect::<Vec<_>>();
            found.losses.extend(new);
            found.cards.push(card.head + &card.body);
            found.of_face.push(id);
        }
        Ok(found)
    }
}

/// The head of a deck: what it was made from, its units, what it does and what it lacks.
fn head_of_deck(mark: &str, scene: &Scene<'_, '_>, losses: &[DeckLoss], request: &Request) -> String {
    let [_, _, unit, ..] = scene.system.words();
    let [time, begin] = [scene.mounting.time, scene.mounting.begin].map(|time| significant(scene.time(time), 6));
    let mounting = match scene.mounting.time > 0.0 {
        true => format!(
            "pre-strain by a step of mounting: film is written without stress and moved to the frame until {time} {unit}; the test \
             begins at {begin} {unit}"
        ),
        false => "no pre-strain: film is written where the frame holds it".to_owned(),
    };
    let losses = losses.iter().map(DeckLoss::to_string);
    let of_materials = scene.materials.losses.iter().map(|loss| format!("material: {loss}"));
    let about = std::iter::once(mounting).chain(losses).chain(of_materials).collect();
    crate::commented(mark, &crate::head(scene.deck.title, scene.deck.origin, request, about))
}
