//! The film that moves with a tip, and the material force on it (theory.md, equation 304).

use std::collections::BTreeMap;

use super::{Element, Place, TearingFilm, Tips};
use crate::engine::element::{MeanState, corners};

/// Rings of elements around one at a tip whose nodes move with the tip: the material force is that of the ring beyond.
const RINGS: usize = 2;

/// Elements up to which a tear is followed back from its tip: more than film still tears behind one.
const LONGEST: usize = 64;

/// An element and the mirror planes beyond which it lies, a bit each: elements and nodes beyond a plane are images.
type Image = (Element, u8);

/// A node and the mirror planes beyond which it lies.
type Node = (u32, u8);

impl Tips {
    /// Material force (N, along MD and TD) on the tip at an element: on all nodes of [`RINGS`] around it and of the film
    /// that still tears behind it, by the elements beyond; and what it would be if these returned all work.
    pub(super) fn material_force(&self, element: Element, film: &TearingFilm<'_>) -> [[f64; 2]; 2] {
        let mut moved = vec![(element, 0)];
        for _ in 0..RINGS {
            moved = self.around(&moved);
        }
        // What film takes up behind the tip is part of what its tear takes.
        moved.extend(self.connected(element, |image| film.tear(image.0).0.is_tearing(), |_| true));
        moved.sort_unstable();
        moved.dedup();
        let mut nodes = self.nodes_of_all(&moved);
        // An outer edge stays: film ahead of the tip that moved with it to the edge would release nothing.
        nodes.retain(|(node, _)| !self.outer[*node as usize]);
        // A tear as short as this has its other tip in here.
        let is_within = |image: &Image| moved.binary_search(image).is_ok();
        let body = self.connected(element, |image| self.place(image.0) == Place::Open, is_within);
        if body.iter().all(is_within) {
            nodes = self.ahead_of_middle(element, &body, &moved, nodes, film);
        }
        let mean = film.state(element).f;
        let (mut force, mut of_work) = ([0.0; 2], [0.0; 2]);
        for image in self.around(&moved) {
            let within: Vec<bool> = self.nodes_of(image).map(|node| nodes.binary_search(&node).is_ok()).collect();
            if within.iter().all(|is_moved| *is_moved) || !within.contains(&true) {
                continue;
            }
            let state = self.image(image, film);
            let mut gradient = [0.0; 2];
            for (of_node, _) in state.gradients.iter().zip(&within).filter(|(_, is_moved)| **is_moved) {
                (0..2).for_each(|i| gradient[i] += of_node[i]);
            }
            let part = state.material_force(gradient, &mean);
            let returned = state.returned();
            (0..2).for_each(|i| force[i] += returned * part[i]);
            (0..2).for_each(|i| of_work[i] += part[i]);
        }
        [force, of_work]
    }

    /// Those of the `nodes` of the elements `moved` that lie on the side of an element at a tip, seen from the middle of its
    /// tear, whose elements are `body`.
    fn ahead_of_middle(
        &self,
        element: Element,
        body: &[Image],
        moved: &[Image],
        nodes: Vec<Node>,
        film: &TearingFilm<'_>,
    ) -> Vec<Node> {
        let places = self.places_from(element, moved, film);
        let middle = |image: &Image| -> [f64; 2] {
            let (mut sum, mut count) = ([0.0; 2], 0.0);
            for [a, b] in self.nodes_of(*image).filter_map(|node| places.get(&node)) {
                sum = [sum[0] + a, sum[1] + b];
                count += 1.0;
            }
            sum.map(|x| x / count)
        };
        let count = body.len() as f64;
        let of_body = body.iter().map(middle).fold([0.0; 2], |[a, b], [c, d]| [a + c / count, b + d / count]);
        // From the element's own middle, where its places are counted from.
        let is_ahead = |[a, b]: &[f64; 2]| (a - of_body[0]) * of_body[0] + (b - of_body[1]) * of_body[1] <= 0.0;
        nodes.into_iter().filter(|node| places.get(node).is_some_and(is_ahead)).collect()
    }

    /// Places (m, along MD and TD of stress-free film) of the nodes of elements, from the middle of one of them.
    fn places_from(&self, element: Element, among: &[Image], film: &TearingFilm<'_>) -> BTreeMap<Node, [f64; 2]> {
        let mut places = BTreeMap::new();
        let mut left: Vec<Image> = among.to_vec();
        let mut from = vec![(element, 0)];
        while !from.is_empty() {
            for image in &from {
                let own = corners(&self.image(*image, film).gradients);
                let known: Vec<[f64; 2]> = self
                    .nodes_of(*image)
                    .zip(own)
                    .filter_map(|(node, [a, b])| places.get(&node).map(|[x, y]: &[f64; 2]| [x - a, y - b]))
                    .collect();
                // Corners are those of a parallelogram, so that the middles by each of them differ a little.
                let count = known.len().max(1) as f64;
                let [a, b] = known.iter().fold([0.0; 2], |[a, b], [x, y]| [a + x / count, b + y / count]);
                for (node, [x, y]) in self.nodes_of(*image).zip(own) {
                    places.entry(node).or_insert([a + x, b + y]);
                }
            }
            let is_beside = |image: &Image| self.nodes_of(*image).any(|node| places.contains_key(&node));
            (from, left) = left.into_iter().partition(is_beside);
        }
        places
    }

    /// Mean state of an element or an image of one.
    fn image(&self, (element, beyond): Image, film: &TearingFilm<'_>) -> MeanState {
        let mut state = film.state(element);
        for axis in (0..2).filter(|axis| beyond & (1 << axis) != 0) {
            state = state.mirrored(self.normals[axis], axis);
        }
        state
    }

    /// Elements that are connected with one by nodes and are such, this one left out, in order: at most about [`LONGEST`], as
    /// far as they `lead_on`.
    fn connected(
        &self,
        element: Element,
        is_such: impl Fn(&Image) -> bool,
        lead_on: impl Fn(&Image) -> bool,
    ) -> Vec<Image> {
        let (mut all, mut last): (Vec<Image>, _) = (vec![], vec![(element, 0)]);
        while !last.is_empty() && all.len() < LONGEST && all.iter().all(&lead_on) {
            let mut next = self.around(&last);
            next.retain(|image| image.0 != element && is_such(image) && !all.contains(image));
            all.extend(&next);
            last = next;
        }
        all.sort_unstable();
        all
    }

    fn nodes_of(&self, (element, beyond): Image) -> impl Iterator<Item = Node> {
        self.of(element).iter().map(move |node| (*node, beyond & !self.mirrors[*node as usize]))
    }

    /// The nodes of elements, in order.
    fn nodes_of_all(&self, images: &[Image]) -> Vec<Node> {
        let mut nodes: Vec<Node> = images.iter().flat_map(|image| self.nodes_of(*image)).collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }

    /// Elements that share a node with some, these included, in order.
    fn around(&self, images: &[Image]) -> Vec<Image> {
        let mut all: Vec<Image> = vec![];
        for (node, beyond) in images.iter().flat_map(|image| self.nodes_of(*image)) {
            let on = self.mirrors[node as usize];
            for bits in (0..4).filter(|bits| bits & !on == 0) {
                all.extend(self.at(node).iter().map(|element| (*element, beyond | bits)));
            }
        }
        all.sort_unstable();
        all.dedup();
        all
    }
}
