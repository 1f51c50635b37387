//! Tips of tears: where film releases what a tear takes, and the element that tears next (theory.md, section 25).

mod domain;

use super::adjacency::Around;
use super::element::{ElementGroup, MeanState, corners, place};
use super::failure::smaller;
use crate::material::Tear;

/// An element of a film: its chunk, and its number there.
type Element = [u32; 2];

/// Work is done on an element at a tip by more than this over the square root of its area where the material force is near the
/// fracture energy (J/m²), by a margin of four on all shapes (theory.md, equation 304).
const LEAST: f64 = 1.0 / 16.0;

/// Share of the work done on it that film returns, above which the fracture energy decides.
const RETURNING: f64 = 0.8;

/// Share of the work done on the element that stands for a tip from which on the tear may go on in another one.
const BESIDE: f64 = 0.25;

/// Smallest length of a tear in an element over its area for its width.
const SHORTEST: f64 = 0.2;

/// Where an element lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Place {
    /// Beside no open element.
    Whole,
    /// It shares an edge with an open element.
    AtTip,
    /// Deleted, or as much of its fracture energy is spent that the tear goes on beyond it.
    Open,
}

/// A mirror plane of a film.
#[derive(Clone, Debug)]
pub(super) struct MirrorPlane {
    /// Nodes on it.
    pub nodes: Vec<u32>,
    /// Its normal along MD and TD.
    pub normal: [f64; 2],
}

/// A part of a tear that starts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Start {
    pub element: Element,
    /// Its width across the tear, m.
    pub width: f64,
    /// Distance of its middle from the line of the tear, m.
    pub offset: f64,
}

/// What happens at the tips of a film.
#[derive(Clone, Debug, Default)]
pub(super) struct Events {
    /// Elements that start to tear.
    pub starts: Vec<Start>,
    /// Elements that have started, and wait though the tip releases what their tear takes.
    pub waiting: Vec<Element>,
    /// Least share of the work done on film around a tip that it would return, where all work would suffice for its tear,
    /// that share does not, and is below [`RETURNING`].
    pub returned: Option<f64>,
}

/// A film that tears at the present positions.
#[derive(Clone, Copy)]
pub(super) struct TearingFilm<'a> {
    /// Its elements, chunk by chunk.
    pub groups: &'a [&'a dyn ElementGroup],
    /// Of its nodes, m.
    pub position: &'a [&'a [f64]; 3],
    /// Fracture energy, J/m².
    pub energy: f64,
    /// Of all layers, m.
    pub thickness: f64,
}

impl TearingFilm<'_> {
    fn state(&self, [c, e]: Element) -> MeanState {
        self.groups[c as usize].mean_state(e as usize, self.position)
    }

    /// The tear of an element, and the volume of the element (m³).
    fn tear(&self, [c, e]: Element) -> (Tear, f64) {
        let tearing = self.groups[c as usize].common().tearing.as_ref().expect("film with a rupture criterion");
        tearing.tear_and_volume(place(e as usize))
    }

    /// Material force (N) at which a tear goes on.
    fn needed(&self) -> f64 {
        self.energy * self.thickness
    }

    /// Whether film around an element of this volume (m³) that stores so much (J/m³) may release what a tear takes.
    fn may_release(&self, stored: f64, volume: f64) -> bool {
        stored * (volume / self.thickness).sqrt() >= LEAST * self.energy
    }
}

/// Elements of a film that tears, and their neighbours.
#[derive(Clone, Debug)]
pub(super) struct Tips {
    /// Elements at the nodes.
    around: Around<Element>,
    /// Nodes of each element, chunk by chunk.
    nodes: Vec<Vec<Vec<u32>>>,
    /// On which mirror planes a node lies, a bit each.
    mirrors: Vec<u8>,
    /// Normals of the planes.
    normals: [[f64; 2]; 2],
    /// Which nodes lie on an outer edge of the film.
    outer: Vec<bool>,
    places: Vec<Vec<Place>>,
    at_tip: Vec<Element>,
}

impl Tips {
    /// Elements of `groups` on so many nodes, with the mirror planes across x and y.
    pub(super) fn new(groups: &[&dyn ElementGroup], count: usize, planes: &[MirrorPlane; 2]) -> Tips {
        let mut nodes: Vec<Vec<Vec<u32>>> = vec![];
        let mut pairs: Vec<(u32, Element)> = vec![];
        for (c, group) in groups.iter().enumerate() {
            let of_element = |element| group.common().corners.of(element).to_vec();
            let of_chunk: Vec<Vec<u32>> = group.elements(false).map(of_element).collect();
            for (e, corners) in of_chunk.iter().enumerate() {
                pairs.extend(corners.iter().map(|node| (*node, [c as u32, e as u32])));
            }
            nodes.push(of_chunk);
        }
        let mut mirrors = vec![0; count];
        for (axis, plane) in planes.iter().enumerate() {
            plane.nodes.iter().for_each(|node| mirrors[*node as usize] |= 1 << axis);
        }
        let outer = outer_nodes(&nodes, &mirrors);
        Tips {
            outer,
            around: Around::new(count, pairs),
            places: nodes.iter().map(|of_chunk| vec![Place::Whole; of_chunk.len()]).collect(),
            nodes,
            mirrors,
            normals: planes.each_ref().map(|plane| plane.normal),
            at_tip: vec![],
        }
    }

    /// Finds the elements at tips anew.
    pub(super) fn find(&mut self, groups: &[&dyn ElementGroup]) {
        for (of_chunk, group) in self.places.iter_mut().zip(groups) {
            for (e, place) in of_chunk.iter_mut().enumerate() {
                *place = if group.is_open(e) { Place::Open } else { Place::Whole };
            }
        }
        self.at_tip.clear();
        for c in 0..self.nodes.len() {
            for e in 0..self.nodes[c].len() {
                let element = [c as u32, e as u32];
                if self.place(element) == Place::Whole && self.open_neighbours(element).next().is_some() {
                    self.at_tip.push(element);
                }
            }
        }
        for [c, e] in &self.at_tip {
            self.places[*c as usize][*e as usize] = Place::AtTip;
        }
    }

    /// The elements at tips that start to tear, or go on to. Whether it `looks` at film that stores little of the work done on
    /// it, too.
    pub(super) fn events(&self, film: &TearingFilm<'_>, looks: bool) -> Events {
        let mut events = Events::default();
        for element in &self.at_tip {
            let (own, volume) = film.tear(*element);
            // Film that absorbs most of the work done on it stores little: it is looked at, and does not start.
            let may_start = film.may_release(own.stored, volume);
            if own.has_started() {
                let goes_on = own.waits(film.energy) && (may_start || own.is_loaded()) && {
                    let [force, _] = self.material_force(*element, film);
                    size(force) >= film.needed()
                };
                events.waiting.extend(goes_on.then_some(*element));
                continue;
            }
            if (may_start || looks && film.may_release(own.work(), volume)) && self.stands_for_its_tip(*element, film) {
                self.start_at(*element, film, may_start, &mut events);
            }
        }
        events
    }

    /// Whether of the elements within two rings none tears, and in none that is at a tip more work was done.
    fn stands_for_its_tip(&self, element: Element, film: &TearingFilm<'_>) -> bool {
        let (own, _) = film.tear(element);
        let yields = |other: &Element| {
            let (of_other, _) = film.tear(*other);
            let more = of_other.work() > own.work() || of_other.work() == own.work() && *other < element;
            match self.place(*other) {
                Place::Open => false,
                // Film beside the tear may store as much as when it started, and yet far less than what is ahead.
                _ if of_other.has_started() => of_other.is_loaded() && of_other.work() >= BESIDE * own.work(),
                place => place == Place::AtTip && more,
            }
        };
        !self.ring(&self.ring(&[element])).iter().filter(|other| **other != element).any(yields)
    }

    /// Adds to `events` what happens at the tip for which an element stands: whether one there may start at all.
    fn start_at(&self, element: Element, film: &TearingFilm<'_>, may_start: bool, events: &mut Events) {
        let [force, of_work] = self.material_force(element, film);
        let (released, needed) = (size(force), film.needed());
        if released < needed {
            let share = released / size(of_work);
            if size(of_work) >= needed && share < RETURNING {
                events.returned = smaller(events.returned, Some(share));
            }
            return;
        }
        if !may_start {
            return;
        }
        let (own, _) = film.tear(element);
        let along = force.map(|part| part / released);
        let may_tear = |other: &Element| {
            let (of_other, _) = film.tear(*other);
            self.place(*other) == Place::AtTip
                && !of_other.has_started()
                && of_other.work() >= BESIDE * own.work()
                && !events.starts.iter().any(|start| start.element == *other)
        };
        // The one whose middle is next to the line of the tear, which therefore runs straight on any mesh.
        let next = |among: &[Element]| {
            let candidates = among.iter().filter(|other| may_tear(other));
            let ahead = candidates.filter_map(|other| self.ahead(*other, along, film));
            ahead.min_by(|(_, a), (_, b)| a.abs().total_cmp(&b.abs()))
        };
        let beside = self.ring(&[element]);
        // Where rows on both sides of the line are open, it may pass beyond the elements beside this one.
        if let Some((element, offset)) = next(&beside).and_then(|_| next(&self.ring(&beside))) {
            let width = self.width(element, along, film);
            events.starts.push(Start { element, width, offset });
        }
    }

    /// Elements at a node.
    fn at(&self, node: u32) -> &[Element] {
        self.around.at(node)
    }

    /// Nodes of an element.
    fn of(&self, [c, e]: Element) -> &[u32] {
        &self.nodes[c as usize][e as usize]
    }

    fn place(&self, [c, e]: Element) -> Place {
        self.places[c as usize][e as usize]
    }

    /// Open elements that share an edge with one.
    fn open_neighbours(&self, element: Element) -> impl Iterator<Item = Element> {
        let own = self.of(element);
        let shares_edge = move |other: &Element| own.iter().filter(|node| self.of(*other).contains(node)).count() > 1;
        let others = own.iter().flat_map(|node| self.at(*node)).copied();
        others.filter(move |other| self.place(*other) == Place::Open && shares_edge(other))
    }

    /// Elements that share a node with some, these included, in order.
    fn ring(&self, elements: &[Element]) -> Vec<Element> {
        let nodes = elements.iter().flat_map(|element| self.of(*element));
        let mut all: Vec<Element> = nodes.flat_map(|node| self.at(*node)).copied().collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    /// An element at a tip and the distance (m) of its middle from the line of a tear that runs `along` (MD and TD), where
    /// it is ahead of an open one.
    fn ahead(&self, element: Element, along: [f64; 2], film: &TearingFilm<'_>) -> Option<(Element, f64)> {
        let steps = self.open_neighbours(element).filter_map(|other| {
            let (forward, aside) = self.step(other, element, along, film)?;
            Some((forward, film.tear(other).0.offset + aside))
        });
        // Of several the last one on the way.
        steps.min_by(|(a, _), (b, _)| a.total_cmp(b)).map(|(_, offset)| (element, offset))
    }

    /// How far (m) the middle of an element lies ahead of that of one with which it shares an edge, along a tear that runs
    /// `along` (MD and TD), and to the left of it; none where it is not ahead.
    fn step(&self, from: Element, to: Element, along: [f64; 2], film: &TearingFilm<'_>) -> Option<(f64, f64)> {
        let [of_from, of_to] = [from, to].map(|element| corners(&film.state(element).gradients));
        let (mut between, mut shared) = ([0.0; 2], 0.0);
        for (node, x) in self.of(to).iter().zip(of_to) {
            if let Some(b) = self.of(from).iter().position(|n| n == node) {
                (0..2).for_each(|i| between[i] += of_from[b][i] - x[i]);
                shared += 1.0;
            }
        }
        let [a, b] = between.map(|x| x / shared);
        let (forward, aside) = (along[0] * a + along[1] * b, along[0] * b - along[1] * a);
        let span = of_to.iter().map(|x| along[0] * x[0] + along[1] * x[1]).fold(0.0, f64::max);
        (forward > SHORTEST * span).then_some((forward, aside))
    }

    /// Width (m) of an element across a tear that runs `along` (MD and TD): its area over the length by which the tear
    /// gets on in it (theory.md, equation 300a). In a step aside that is more than its extent; it takes no less than it
    /// stores, so that at the width where it stores just as much it fails at once and nothing is lost.
    fn width(&self, element: Element, along: [f64; 2], film: &TearingFilm<'_>) -> f64 {
        let is_open = |node: &u32| self.at(*node).iter().any(|other| self.place(*other) == Place::Open);
        let (mut reached, mut ahead) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        let state = film.state(element);
        for (node, [a, b]) in self.of(element).iter().zip(corners(&state.gradients)) {
            let forward = along[0] * a + along[1] * b;
            let aside = along[0] * b - along[1] * a;
            (least, most) = (least.min(aside), most.max(aside));
            ahead = ahead.max(forward);
            if is_open(node) {
                reached = reached.max(forward);
            }
        }
        if self.of(element).len() == 3 {
            // Two triangles make one step of a tear: either has half of it.
            return most - least;
        }
        let (area, extent) = (state.volume / film.thickness, most - least);
        let width = area / (ahead - reached).max(SHORTEST * area / extent);
        let (own, _) = film.tear(element);
        width.min((film.energy / own.stored).max(extent))
    }
}

/// Which nodes lie on an edge that one element alone has and no mirror plane: cut and deleted elements count, so that tears
/// have none.
fn outer_nodes(elements: &[Vec<Vec<u32>>], mirrors: &[u8]) -> Vec<bool> {
    let edges_of = |corners: &Vec<u32>| -> Vec<[u32; 2]> {
        (0..corners.len())
            .map(|k| [corners[k], corners[(k + 1) % corners.len()]])
            .map(|[a, b]| [a.min(b), a.max(b)])
            .collect()
    };
    let mut edges: Vec<[u32; 2]> = elements.iter().flatten().flat_map(edges_of).collect();
    edges.sort_unstable();
    let mut outer = vec![false; mirrors.len()];
    for same in edges.chunk_by(|one, other| one == other) {
        let [a, b] = same[0].map(|node| node as usize);
        if same.len() == 1 && mirrors[a] & mirrors[b] == 0 {
            (outer[a], outer[b]) = (true, true);
        }
    }
    outer
}

/// Length of a vector.
fn size([a, b]: [f64; 2]) -> f64 {
    (a * a + b * b).sqrt()
}
