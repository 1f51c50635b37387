//! When pairs are looked at again: those that are far apart not before film may have closed their distance.
//!
//! From one detection to the next each node moves by some distance, and the sum of twice the largest of these is the
//! *path* of the film: two points have come nearer to each other by at most the path since. A pair that is farther apart
//! than allowed is therefore not due before film has covered half of what is left between them. Half, since a node may
//! pass to a neighbouring triangle meanwhile, whose plane is nearer by the cosine of the angle between both, and edges
//! come to cross each other: that is found out while the rest of the distance is left.

use serde::{Deserialize, Serialize};

use super::FilmContact;
use super::surface::NONE;
use crate::engine::nodes::Vectors;
use crate::lane::{LANES, Lane, Width, at_width, lanes, smaller, splat};

/// Pairs of which the soonest that is due is found at once.
const BLOCK: usize = 64;

/// The path that film may cover until two points are looked at again that are `apart` (m) by more than any constraint
/// needs.
#[inline(always)]
pub(super) fn spared<const L: usize>(apart: Lane<L>) -> Lane<L> {
    0.5 * apart.max(0.0)
}

/// Pairs of parts of film that may meet, an entry each: of nodes and the triangles that they follow, of edges that cross, or
/// of parts of one face.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct Pairs {
    /// Factor on the normal that makes it point to the side on which one part is of the other; zero where that is not
    /// decided, or contact was given up.
    pub(super) sign: Vec<f64>,
    /// Least allowed distance, m.
    pub(super) bound: Vec<f64>,
    /// Place of its impulse in the last step among those that are carried on, or [`NONE`]; within a step.
    pub(super) carried: Vec<u32>,
    /// Path of film up to which it need not be looked at, m; infinite where nothing is near.
    pub(super) due: Vec<f64>,
}

impl Pairs {
    /// Of `count` parts near which there is nothing.
    pub(super) fn none(count: usize) -> Pairs {
        Pairs {
            sign: vec![0.0; count],
            bound: vec![0.0; count],
            carried: vec![NONE; count],
            due: vec![f64::INFINITY; count],
        }
    }

    /// Adds a pair with its side and its least allowed distance (m), which is looked at once film has covered the path
    /// `due` (m).
    pub(super) fn push(&mut self, [sign, bound, due]: [f64; 3]) {
        self.sign.push(sign);
        self.bound.push(bound);
        self.carried.push(NONE);
        self.due.push(due);
    }

    /// What [`Pairs::push`] was called with, as it is now.
    pub(super) fn get(&self, place: usize) -> [f64; 3] {
        [self.sign[place], self.bound[place], self.due[place]]
    }

    /// Removes a pair, which the last one replaces.
    pub(super) fn swap_remove(&mut self, place: usize) {
        self.sign.swap_remove(place);
        self.bound.swap_remove(place);
        self.carried.swap_remove(place);
        self.due.swap_remove(place);
    }

    /// Distance (m) below which there is a constraint: `distance`, but any for what had an impulse in the last step, which has
    /// been applied already.
    #[inline(always)]
    pub(super) fn limit(&self, place: usize, distance: f64) -> f64 {
        if self.carried[place] == NONE { distance } else { f64::INFINITY }
    }

    /// Whether these are `count` pairs.
    pub(super) fn fits(&self, count: usize) -> bool {
        [self.sign.len(), self.bound.len(), self.carried.len(), self.due.len()] == [count; 4]
    }
}

at_width! {
    up to AVX2
    /// Replaces `to` by the places of those that are due once film has covered `path` (m), counted from `first`.
    pub(super) fn list[](due: &[f64], path: f64, first: usize, to: &mut Vec<u32>) {
        to.clear();
        for (block, due) in due.chunks(BLOCK).enumerate() {
            let mut soonest: Lane = splat(f64::INFINITY);
            let groups = due.chunks_exact(LANES);
            for last in groups.remainder() {
                soonest[0] = smaller(*last, soonest[0]);
            }
            for group in groups {
                soonest = lanes(|l| group[l]).min(soonest);
            }
            // Most blocks are far from any other face.
            if soonest.iter().all(|soonest| *soonest > path) {
                continue;
            }
            // Without a branch on each: which of a block are due follows no pattern.
            let (mut places, mut count) = ([0; BLOCK], 0);
            for (place, due) in due.iter().enumerate() {
                places[count] = (first + block * BLOCK + place) as u32;
                count += usize::from(*due <= path);
            }
            to.extend_from_slice(&places[..count]);
        }
    }
}

impl FilmContact {
    /// Largest motion of a node since the last detection, m.
    pub(super) fn motion(&self, position: &Vectors, width: Width) -> f64 {
        // Before the first one everything is due.
        if self.history.detected.is_empty() { 0.0 } else { largest_motion(width, &self.history.detected, position) }
    }

    /// Notes the positions of a detection, since the last of which nodes have moved by at most `motion` (m).
    pub(super) fn add_path(&mut self, position: &Vectors, motion: f64) {
        // Both nodes and what they are near may have moved by that.
        self.history.path += 2.0 * motion;
        self.history.detected.clone_from(position);
        self.itself.iter_mut().for_each(|itself| itself.add_path(position));
    }

    /// Makes the pairs with constraints due in the next step: in this one they had been spared.
    pub(super) fn make_constrained_due(&mut self) {
        for k in 0..self.constraints.len() {
            if let Some((pairs, place)) = self.place(self.constraints[k].source) {
                pairs.due[place] = 0.0;
            }
        }
    }
}

at_width! {
    up to AVX2
    /// Largest distance between the positions of a node, m.
    fn largest_motion[](before: &Vectors, after: &Vectors) -> f64 {
        let ([x, y, z], [u, v, w]) = (before.axes(), after.axes());
        let mut largest: Lane = splat(0.0);
        let squared = |n: usize| {
            let [a, b, c] = [u[n] - x[n], v[n] - y[n], w[n] - z[n]];
            a * a + b * b + c * c
        };
        let whole = x.len() - x.len() % LANES;
        for first in (0..whole).step_by(LANES) {
            largest = lanes(|l| squared(first + l)).max(largest);
        }
        (whole..x.len()).map(squared).chain(*largest).fold(0.0, f64::max).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lane::one;

    #[test]
    fn what_is_due_is_listed_in_order_whatever_the_length_and_the_instructions() {
        for length in [0, 1, 7, 8, 63, 64, 65, 200] {
            let due: Vec<f64> = (0..length).map(|k| f64::from(k * 37 % 23)).collect();
            for path in [-1.0, 0.0, 5.0, 22.0] {
                let expected: Vec<u32> =
                    (0..length as u32).filter(|k| due[*k as usize] <= path).map(|k| 10 + k).collect();
                for width in Width::available() {
                    let mut listed = vec![99];
                    list(width, &due, path, 10, &mut listed);
                    assert_eq!(listed, expected, "{length} up to {path} with {width:?}");
                }
            }
        }
    }

    #[test]
    fn a_path_that_is_not_a_number_spares_nothing() {
        assert_eq!([f64::NAN, -1.0, 2.0].map(|apart| spared(one(apart))[0]), [0.0, 0.0, 1.0]);
    }
}
