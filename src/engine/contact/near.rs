//! The neighbour list.

use nalgebra::{Isometry3, Point3};

use super::Contact;
use super::faces::FACE_BOUND;
use crate::engine::film::Film;
use crate::engine::nodes::Nodes;

/// Share of [`FACE_BOUND`] from which the sagitta of an element on a sphere, (longest line)²/(8 R), has it listed.
const LISTED_FROM: f64 = 0.7;

/// Skin of the neighbour list over the impactor's size.
const SKIN: f64 = 0.04;

/// Nodes and triangles that could touch before the list is made again.
#[derive(Default)]
pub(super) struct NearList {
    pub(super) nodes: Vec<u32>,
    pub(super) faces: Vec<[u32; 3]>,
    /// Relative motion that is left until then, m.
    pub(super) margin: f64,
}

impl Contact {
    /// Lists what could touch before film and impactor have moved by the skin.
    pub(super) fn list_neighbours(&mut self, films: &[Film], nodes: &Nodes, pose: &Isometry3<f64>) {
        let skin = SKIN * self.surface.size();
        let centre = Point3::from(pose.translation.vector);
        let within = |n: usize, margin: f64| {
            let point = Point3::from(nodes.position[n]);
            let reach = self.surface.reach() + self.offset[n] + margin;
            nalgebra::distance_squared(&point, &centre) < reach * reach
                && self.surface.touch(pose, &point).gap < self.offset[n] + margin
        };
        let all = 0..nodes.position.len();
        self.near.nodes = all.filter(|&n| within(n, skin)).map(|n| n as u32).collect();
        self.near.faces.clear();
        for film in films {
            film.for_each_intact(|corners| {
                let longest = longest_line(corners, nodes);
                let size = self.surface.size();
                if self.surface.is_sphere() && longest * longest < 8.0 * LISTED_FROM * FACE_BOUND * size * size {
                    return;
                }
                if corners.iter().any(|&n| within(n as usize, skin + longest)) {
                    for k in 2..corners.len() {
                        self.near.faces.push([corners[0], corners[k - 1], corners[k]]);
                    }
                }
            });
        }
        self.near.margin = skin;
    }
}

/// Longest line between any two corners, m.
fn longest_line(corners: &[u32], nodes: &Nodes) -> f64 {
    let at = |n: u32| Point3::from(nodes.position[n as usize]);
    let pairs = corners.iter().enumerate().flat_map(|(k, a)| corners[k + 1..].iter().map(move |b| (*a, *b)));
    pairs.map(|(a, b)| nalgebra::distance_squared(&at(a), &at(b))).fold(0.0, f64::max).sqrt()
}
