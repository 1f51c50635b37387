//! Tips of tears: where film releases what a tear takes, and the element that tears next (theory.md, section 25).

use super::element::{MeanState, corners};
use super::element_group::ElementGroup;
use crate::material::Tear;

/// An element of a film: its chunk, and its number there.
type Element = [u32; 2];

/// Rings of elements around one at a tip whose nodes move with the tip: the material force is that of the ring beyond.
const RINGS: usize = 2;

/// An element at a tip stores more than this over the square root of its area where the material force is near the
/// fracture energy (J/m²), by a margin of four on all shapes (theory.md, equation 304).
const LEAST: f64 = 1.0 / 16.0;

/// Share of what film releases that the means over coarse elements show: 0.91 to 0.97 of the energy of a wide strip, and all
/// of a crack's (theory.md, equation 304).
const SHOWN: f64 = 0.985;

/// Energy that film releases where a triangle at a tip tears, over that which it stores, as on squares of a wide
/// strip (theory.md, equation 303a).
const RELEASED_BY_TRIANGLES: f64 = 4.0;

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

/// Elements of a film that tears, and their neighbours.
#[derive(Clone, Debug)]
pub(super) struct Tips {
    /// Entries of `around` of each node: where they start, and where the last ones end.
    first: Vec<u32>,
    /// Elements at the nodes, in order.
    around: Vec<Element>,
    /// Nodes of each element, chunk by chunk.
    nodes: Vec<Vec<Vec<u32>>>,
    /// On which mirror planes a node lies, a bit each.
    mirrors: Vec<u8>,
    /// Normals of the planes.
    normals: [[f64; 2]; 2],
    places: Vec<Vec<Place>>,
    at_tip: Vec<Element>,
}

impl Tips {
    /// Elements of `groups` on so many nodes, with the mirror planes across x and y.
    pub(super) fn new(groups: &[&dyn ElementGroup], count: usize, planes: &[MirrorPlane; 2]) -> Tips {
        let mut nodes: Vec<Vec<Vec<u32>>> = vec![];
        let mut pairs: Vec<(u32, Element)> = vec![];
        for (c, group) in groups.iter().enumerate() {
            let mut of_chunk = vec![];
            group.for_each(0, false, &mut |corners| of_chunk.push(corners.to_vec()));
            for (e, corners) in of_chunk.iter().enumerate() {
                pairs.extend(corners.iter().map(|node| (*node, [c as u32, e as u32])));
            }
            nodes.push(of_chunk);
        }
        pairs.sort_unstable();
        let first = (0..=count as u32).map(|node| pairs.partition_point(|(n, _)| *n < node) as u32).collect();
        let mut mirrors = vec![0; count];
        for (axis, plane) in planes.iter().enumerate() {
            plane.nodes.iter().for_each(|node| mirrors[*node as usize] |= 1 << axis);
        }
        Tips {
            first,
            around: pairs.into_iter().map(|(_, element)| element).collect(),
            places: nodes.iter().map(|of_chunk| vec![Place::Whole; of_chunk.len()]).collect(),
            nodes,
            mirrors,
            normals: planes.each_ref().map(|plane| plane.normal),
            at_tip: vec![],
        }
    }

    /// Bytes of its arrays.
    pub(super) fn bytes(&self) -> usize {
        let of_element = |corners: &Vec<u32>| size_of::<Vec<u32>>() + size_of_val(&corners[..]) + size_of::<Place>();
        let elements: usize = self.nodes.iter().flatten().map(of_element).sum();
        let arrays = size_of_val(&self.first[..]) + size_of_val(&self.around[..]) + size_of_val(&self.mirrors[..]);
        elements + arrays + size_of_val(&self.at_tip[..])
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

    /// The elements at tips that start to tear, in film of this fracture energy (J/m²) and thickness (m, all layers).
    pub(super) fn starts(
        &self,
        groups: &[&dyn ElementGroup],
        position: &[&[f64]; 3],
        [energy, thickness]: [f64; 2],
    ) -> Vec<Start> {
        let state = |[c, e]: Element| groups[c as usize].mean_state(e as usize, position);
        let tear = |[c, e]: Element| groups[c as usize].tear(e as usize);
        let mut starts: Vec<Start> = vec![];
        for element in &self.at_tip {
            let (own, volume) = tear(*element);
            if own.has_started() || own.stored * (volume / thickness).sqrt() < LEAST * energy {
                continue;
            }
            if let Some(width) = self.width_of_triangle(*element, own.stored, energy, &state) {
                starts.push(Start { element: *element, width, offset: 0.0 });
                continue;
            }
            let near = self.ring(&[*element]);
            let around = self.ring(&near);
            // One element at a time, and of those at one tip the one with the largest energy stands for all.
            let yields = |other: &Element| {
                let (of_other, _) = tear(*other);
                let more = of_other.work() > own.work() || of_other.work() == own.work() && other < element;
                match self.place(*other) {
                    Place::Open => false,
                    _ if of_other.has_started() => of_other.is_loaded(),
                    place => place == Place::AtTip && more,
                }
            };
            if around.iter().filter(|other| *other != element).any(yields) {
                continue;
            }
            let force = self.material_force(*element, &state);
            let size = (force[0] * force[0] + force[1] * force[1]).sqrt();
            if size < SHOWN * energy * thickness {
                continue;
            }
            let along = [force[0] / size, force[1] / size];
            let may_tear = |other: &Element| {
                let (of_other, _) = tear(*other);
                self.place(*other) == Place::AtTip
                    && !of_other.has_started()
                    && of_other.work() >= 0.25 * own.work()
                    && !starts.iter().any(|start| start.element == *other)
            };
            let candidates = near.iter().filter(|other| may_tear(other));
            let next = candidates.filter_map(|other| self.ahead(*other, along, &state, &tear));
            // The one whose middle is next to the line of the tear, which therefore runs straight on any mesh.
            if let Some((element, offset)) = next.min_by(|(_, a), (_, b)| a.abs().total_cmp(&b.abs())) {
                let (of_next, _) = tear(element);
                let width = self.width(element, along, &state(element), [thickness, energy / of_next.stored]);
                starts.push(Start { element, width, offset });
            }
        }
        starts
    }

    /// Width (m) across a tear of a triangle that starts by what it stores (J/m³): the means over triangles, and over either of
    /// two that make a step of a tear, differ too much from each other for (304) alone.
    fn width_of_triangle(
        &self,
        element: Element,
        stored: f64,
        energy: f64,
        state: &impl Fn(Element) -> MeanState,
    ) -> Option<f64> {
        let wide_enough = |width: &f64| RELEASED_BY_TRIANGLES * stored * width >= energy;
        let is_triangle = self.of(element).len() == 3;
        is_triangle.then(|| state(element).width_across()).flatten().filter(wide_enough)
    }

    /// Elements at a node.
    fn at(&self, node: u32) -> &[Element] {
        &self.around[self.first[node as usize] as usize..self.first[node as usize + 1] as usize]
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

    /// Material force (N, along MD and TD) on the tip at an element: on all nodes of [`RINGS`] around it, by the ring
    /// beyond (theory.md, equation 304).
    fn material_force(&self, element: Element, state: &impl Fn(Element) -> MeanState) -> [f64; 2] {
        // Elements and nodes beyond mirror planes are images: each with the planes, a bit each, beyond which it lies.
        let nodes_of = |(element, beyond): (Element, u8)| {
            self.of(element).iter().map(move |node| (*node, beyond & !self.mirrors[*node as usize]))
        };
        let around = |images: &[(Element, u8)]| {
            let mut all: Vec<(Element, u8)> = vec![];
            for (node, beyond) in images.iter().flat_map(|image| nodes_of(*image)) {
                let on = self.mirrors[node as usize];
                for bits in (0..4).filter(|bits| bits & !on == 0) {
                    all.extend(self.at(node).iter().map(|element| (*element, beyond | bits)));
                }
            }
            all.sort_unstable();
            all.dedup();
            all
        };
        let mut moved = vec![(element, 0)];
        for _ in 0..RINGS {
            moved = around(&moved);
        }
        let mut nodes: Vec<(u32, u8)> = moved.iter().flat_map(|image| nodes_of(*image)).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let mean = state(element).f;
        let mut force = [0.0; 2];
        for image in around(&moved) {
            let within: Vec<bool> = nodes_of(image).map(|node| nodes.binary_search(&node).is_ok()).collect();
            if within.iter().all(|is_moved| *is_moved) {
                continue;
            }
            let (element, beyond) = image;
            let mut state = state(element);
            for axis in (0..2).filter(|axis| beyond & (1 << axis) != 0) {
                state = state.mirrored(self.normals[axis], axis);
            }
            let mut gradient = [0.0; 2];
            for (of_node, _) in state.gradients.iter().zip(&within).filter(|(_, is_moved)| **is_moved) {
                (0..2).for_each(|i| gradient[i] += of_node[i]);
            }
            let part = state.material_force(gradient, &mean);
            (0..2).for_each(|i| force[i] += part[i]);
        }
        force
    }

    /// An element at a tip and the distance (m) of its middle from the line of a tear that runs `along` (MD and TD), where
    /// it is ahead of an open one.
    fn ahead(
        &self,
        element: Element,
        along: [f64; 2],
        state: &impl Fn(Element) -> MeanState,
        tear: &impl Fn(Element) -> (Tear, f64),
    ) -> Option<(Element, f64)> {
        let steps = self.open_neighbours(element).filter_map(|other| {
            let (forward, aside) = self.step(other, element, along, state)?;
            Some((forward, tear(other).0.offset + aside))
        });
        // Of several the last one on the way.
        steps.min_by(|(a, _), (b, _)| a.total_cmp(b)).map(|(_, offset)| (element, offset))
    }

    /// How far (m) the middle of an element lies ahead of that of one with which it shares an edge, along a tear that runs
    /// `along` (MD and TD), and to the left of it; none where it is not ahead.
    fn step(
        &self,
        from: Element,
        to: Element,
        along: [f64; 2],
        state: &impl Fn(Element) -> MeanState,
    ) -> Option<(f64, f64)> {
        let [of_from, of_to] = [from, to].map(|element| corners(&state(element).gradients));
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
    /// gets on in it (theory.md, equation 300a). In a step aside that is more than its extent; it takes no less than it stores,
    /// so that at the width `most_aside` (m), where it stores just as
    /// much, it fails at once and nothing is lost.
    fn width(&self, element: Element, along: [f64; 2], state: &MeanState, [thickness, most_aside]: [f64; 2]) -> f64 {
        let is_open = |node: &u32| self.at(*node).iter().any(|other| self.place(*other) == Place::Open);
        let (mut reached, mut ahead) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
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
        let (area, extent) = (state.volume / thickness, most - least);
        let width = area / (ahead - reached).max(SHORTEST * area / extent);
        width.min(most_aside.max(extent))
    }
}
