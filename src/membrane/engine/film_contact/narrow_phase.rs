//! Narrow phase: which nodes and crossings may come too close in a step, a lane each, and their constraints.

use std::ops::Range;

use nalgebra::Vector3;

use super::FilmContact;
use super::constraint::{Constraint, Pair, Source, Unusable};
use super::crossing::PARALLEL;
use super::crossings::Crossings;
use super::surface::NONE;
use super::tracking::{self, BESIDE, Foot, Tracking, place};
use crate::engine::disjoint::Disjoint;
use crate::engine::nodes::{Nodes, Vectors};
use crate::engine::thread_pool::ThreadPool;
use crate::lane::{LANES, Lane, Lane3, at_width, cross, dot, splat};

/// Nodes of a task.
const NODES_PER_RANGE: usize = 1024;

/// Crossings of a task.
const CROSSINGS_PER_RANGE: usize = 512;

/// Range of nodes or crossings that one call examines.
#[derive(Clone, Debug)]
struct Task {
    /// The side of nodes; none of crossings.
    side: Option<usize>,
    range: Range<usize>,
}

/// Results of a task.
#[derive(Default)]
pub(super) struct Found {
    nodes: FoundNodes,
    crossings: FoundCrossings,
    constraints: Vec<Constraint>,
    /// Node and foot of those whose triangle or side has changed.
    moved: Vec<(u32, Foot)>,
    /// Nodes or crossings that do not lie on the sides of each other on which they were.
    lost: Vec<usize>,
}

impl Found {
    fn clear(&mut self) {
        self.nodes.close.clear();
        self.nodes.beside.clear();
        self.nodes.off_corner.clear();
        self.crossings.close.clear();
        self.crossings.turned.clear();
        self.constraints.clear();
        self.moved.clear();
        self.lost.clear();
    }
}

/// A step in which films are looked at.
#[derive(Clone, Copy)]
struct Step<'a> {
    nodes: &'a Nodes,
    /// s.
    dt: f64,
    /// Distance beyond the least allowed one up to which there is a constraint, m.
    margin: f64,
}

impl FilmContact {
    /// Adds constraints of what is closer than allowed, or by less than `margin` (m) farther, at the end of a step of
    /// `dt` (s), for which the nodes have their predicted positions.
    pub(super) fn detect(&mut self, nodes: &Nodes, [dt, margin]: [f64; 2], pool: &ThreadPool) {
        let (count, crossings) = (nodes.mass.len(), self.crossings.len());
        let cut = |end: usize, by: usize| (0..end).step_by(by).map(move |from| from..end.min(from + by));
        let of_nodes = [0, 1]
            .into_iter()
            .flat_map(|side| cut(count, NODES_PER_RANGE).map(move |range| Task { side: Some(side), range }));
        let of_crossings = cut(crossings, CROSSINGS_PER_RANGE).map(|range| Task { side: None, range });
        let tasks: Vec<Task> = of_nodes.chain(of_crossings).collect();
        let mut found = std::mem::take(&mut self.found);
        // Kept from step to step for their capacity, also where fewer tasks need them now.
        found.resize_with(tasks.len().max(found.len()), Found::default);
        let results = Disjoint::new(&mut found);
        let step = Step { nodes, dt, margin };
        pool.each(tasks.len(), |part| {
            // SAFETY: every part comes up once.
            let found = unsafe { results.entry(part) };
            found.clear();
            let Task { side, range } = tasks[part].clone();
            match side {
                Some(side) => self.detect_nodes(pool, step, side, range, found),
                None => self.detect_crossings(pool, step, range, found),
            }
        });
        // In the order of the tasks, whichever thread had them: the sweeps go through the constraints in this order.
        for (task, found) in tasks.iter().zip(&mut found) {
            self.constraints.append(&mut found.constraints);
            self.lost += found.lost.len() as u64;
            match task.side {
                Some(side) => self.follow(side, found, nodes, dt),
                None => {
                    let again = found.lost.iter().chain(&found.crossings.turned);
                    self.stale.extend(again.flat_map(|place| self.crossings.edges(*place)));
                    found.lost.iter().for_each(|place| self.crossings.sign[*place] = 0.0);
                }
            }
        }
        self.found = found;
    }

    /// Lets nodes follow other triangles, and marks the edges whose crossings change by that.
    fn follow(&mut self, side: usize, found: &Found, nodes: &Nodes, dt: f64) {
        for (node, foot) in &found.moved {
            let n = *node as usize;
            let (before, sign) = (self.tracking[side].triangle[n], self.tracking[side].sign[n]);
            // A known side is kept, whatever the distance says: film that has passed through must come back (theory.md,
            // section 6).
            let sign = match (foot.is_over, sign == 0.0) {
                (true, false) => sign,
                // The side on which it was before the step.
                (true, true) => 1.0_f64.copysign(foot.distance - dt * self.approach(nodes, n, foot)),
                (false, _) => 0.0,
            };
            self.tracking[side].follow(n, foot.triangle, sign, &self.surface);
            self.mark(*node, before);
            self.mark(*node, foot.triangle);
        }
        for node in &found.nodes.off_corner {
            self.tracking[side].leave_corner(*node as usize);
            self.stale.extend_from_slice(self.surface.edges_at(*node));
        }
        // Given up, so that the next search decides anew on which side it lies.
        for n in &found.lost {
            self.mark(*n as u32, self.tracking[side].triangle[*n]);
            self.tracking[side].lose(*n);
            self.margin = 0.0;
        }
    }

    /// Velocity of a node over its foot along the normal, m/s.
    fn approach(&self, nodes: &Nodes, node: usize, foot: &Foot) -> f64 {
        let corners = self.surface.corners[foot.triangle as usize];
        let film: Vector3<f64> = (0..3).map(|k| nodes.velocity_of(corners[k] as usize) * foot.weights[k]).sum();
        (nodes.velocity_of(node) - film).dot(&foot.normal)
    }

    /// Constraints of nodes of `range`, and those of them that follow another triangle from now on.
    fn detect_nodes(&self, pool: &ThreadPool, step: Step<'_>, side: usize, range: Range<usize>, found: &mut Found) {
        let Step { nodes, dt, margin } = step;
        let tracking = &self.tracking[side];
        close_nodes(pool.width(), tracking, &nodes.position, range, margin, &mut found.nodes);
        let mut add = |node: u32, pair: Pair| match Constraint::new(Source::Node { side, node }, pair, nodes, dt) {
            Ok(constraint) => found.constraints.push(constraint),
            Err(Unusable::Held) => (),
            Err(Unusable::Beyond) => found.lost.push(node as usize),
        };
        for CloseNode { node, weights: [a, b, c], normal, distance } in &found.nodes.close {
            let n = *node as usize;
            // In the order of the tracking, which may be turned so that the corner under the node comes first.
            let [first, second, third] = &tracking.corners;
            let pair = Pair {
                nodes: [*node, first[n], second[n], third[n]],
                weights: [1.0, -a, -b, -c],
                normal: Vector3::from(*normal),
                distance: *distance,
                bound: tracking.bound[n],
            };
            add(*node, pair);
        }
        for node in &found.nodes.beside {
            let n = *node as usize;
            let (triangle, sign, bound) = (tracking.triangle[n], tracking.sign[n], tracking.bound[n]);
            // `additional` is infinite where the pair had an impulse in the last step, which has been applied already
            // and must find its constraint.
            let limit = bound + margin + tracking.additional[n];
            // The walk over neighbours is a branch a step, so nodes beside their triangle leave the lanes for it.
            let foot = tracking::foot(&self.surface, &nodes.position, &place(&nodes.position, n), triangle);
            if foot.triangle != triangle || foot.is_over != (sign != 0.0) {
                found.moved.push((*node, foot));
            }
            if !foot.is_over || sign == 0.0 || sign * foot.distance >= limit {
                continue;
            }
            let [a, b, c] = self.surface.corners[foot.triangle as usize];
            let pair = Pair {
                nodes: [*node, a, b, c],
                weights: [1.0, -foot.weights[0], -foot.weights[1], -foot.weights[2]],
                normal: foot.normal * sign,
                distance: sign * foot.distance,
                bound,
            };
            add(*node, pair);
        }
    }

    /// Constraints of the crossings of `range`.
    fn detect_crossings(&self, pool: &ThreadPool, step: Step<'_>, range: Range<usize>, found: &mut Found) {
        let Step { nodes, dt, margin } = step;
        let crossings = &self.crossings;
        close_crossings(pool.width(), crossings, &nodes.position, range, margin, &mut found.crossings);
        for CloseCrossing { place, shares: [s, t], normal, distance } in &found.crossings.close {
            let [first, second, third, fourth] = &crossings.nodes;
            let pair = Pair {
                nodes: [first[*place], second[*place], third[*place], fourth[*place]],
                weights: [1.0 - s, *s, *t - 1.0, -*t],
                normal: Vector3::from(*normal),
                distance: *distance,
                bound: crossings.bound[*place],
            };
            match Constraint::new(Source::Crossing(crossings.edges(*place)), pair, nodes, dt) {
                Ok(constraint) => found.constraints.push(constraint),
                Err(Unusable::Held) => (),
                Err(Unusable::Beyond) => found.lost.push(*place),
            }
        }
    }

    /// Least distance of the crossings, m, where one is less than `distance`.
    pub(super) fn least_of_crossings(&self, position: &Vectors, distance: f64, pool: &ThreadPool) -> f64 {
        let mut found = FoundCrossings::default();
        close_crossings(pool.width(), &self.crossings, position, self.crossings.places(), f64::INFINITY, &mut found);
        found.close.iter().map(|close| close.distance).fold(distance, f64::min)
    }
}

/// A node over its triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
struct CloseNode {
    node: u32,
    /// Of the triangle's corners, in the order of [`Tracking::corners`].
    weights: [f64; 3],
    /// Unit normal on the side on which the node belongs.
    normal: [f64; 3],
    /// Along it, m.
    distance: f64,
}

/// Results of a task among nodes.
#[derive(Clone, Debug, Default)]
struct FoundNodes {
    close: Vec<CloseNode>,
    /// Nodes that are not over their triangle, or on no side of it so far.
    beside: Vec<u32>,
    /// Nodes that do not lie on a corner any more.
    off_corner: Vec<u32>,
}

at_width! {
    /// Adds those of the nodes `range` that are closer to the plane of their triangle than allowed, or by less than
    /// `margin` (m) farther, those that are not over it any more, and those that have left its corner, to `found`.
    fn close_nodes[](
        tracking: &Tracking,
        position: &Vectors,
        range: Range<usize>,
        margin: f64,
        found: &mut FoundNodes,
    ) = close_nodes_lanewise
}

#[inline(always)]
fn close_nodes_lanewise(
    tracking: &Tracking,
    position: &Vectors,
    range: Range<usize>,
    margin: f64,
    found: &mut FoundNodes,
) {
    let [first, second, third] = &tracking.corners;
    for start in range.clone().step_by(LANES) {
        let count = LANES.min(range.end - start);
        let all = &tracking.triangle[start..start + count];
        // Most groups of a face are far from any other.
        if all.iter().all(|triangle| *triangle == NONE) {
            continue;
        }
        let (mut nodes, mut corners) = ([0_u32; LANES], [[0_u32; LANES]; 3]);
        let [mut sign, mut limit, mut on_corner]: [Lane; 3] = [splat(0.0); 3];
        for l in 0..LANES {
            // The last group repeats its last node; only the first `count` lanes are read again below.
            let n = start + l.min(count - 1);
            nodes[l] = n as u32;
            (corners[0][l], corners[1][l], corners[2][l]) = (first[n], second[n], third[n]);
            (sign[l], on_corner[l]) = (tracking.sign[n], tracking.on_corner[n]);
            limit[l] = tracking.bound[n] + margin + tracking.additional[n];
        }
        let p = position.gather(&nodes);
        let a = position.gather(&corners[0]);
        let (b, c) = (position.gather(&corners[1]), position.gather(&corners[2]));
        let (u, v, r) = (minus(&b, &a), minus(&c, &a), minus(&p, &a));
        let area = cross(&u, &v);
        let (height, squared, from_corner) = (dot(&area, &r), dot(&area, &area), dot(&r, &r));
        // Weights of the corners times the square.
        let (of_b, of_c) = (dot(&cross(&r, &v), &area), dot(&cross(&u, &r), &area));
        let (mut is_over, mut is_close, mut is_off) = ([0_u8; LANES], [0_u8; LANES], [0_u8; LANES]);
        let [mut distance, mut length]: [Lane; 2] = [splat(0.0); 2];
        for l in 0..LANES {
            // No division by the square of the area: it would be by zero where a node follows nothing, and lanes do not
            // branch.
            let beside = -BESIDE * squared[l];
            length[l] = squared[l].sqrt();
            distance[l] = sign[l] * (height[l] / length[l]);
            // Comparisons as numbers joined by `&`, for `&&` is a branch.
            let inside = u8::from(of_b[l] >= beside)
                & u8::from(of_c[l] >= beside)
                & u8::from(squared[l] - of_b[l] - of_c[l] >= beside);
            is_over[l] = inside & u8::from(sign[l] != 0.0);
            is_close[l] = u8::from(distance[l] < limit[l]);
            // Pythagoras: the square of the distance along the triangle, without the foot itself.
            is_off[l] = u8::from(from_corner[l] - distance[l] * distance[l] > on_corner[l]);
        }
        let mut any = 0;
        for l in 0..LANES {
            // Where the node follows nothing, its triangle has no area.
            let follows = u8::from(squared[l] > 0.0);
            is_off[l] &= is_over[l] & follows;
            is_close[l] &= is_over[l] & follows;
            is_over[l] |= 1 - follows;
            any |= is_off[l] | is_close[l] | (1 - is_over[l]);
        }
        // In most groups no lane has anything to report, and what follows is scalar.
        if any == 0 {
            continue;
        }
        for l in 0..count {
            if is_over[l] == 0 {
                found.beside.push(nodes[l]);
            }
            if is_off[l] != 0 {
                found.off_corner.push(nodes[l]);
            }
            if is_close[l] != 0 {
                let (b, c) = (of_b[l] / squared[l], of_c[l] / squared[l]);
                let scale = sign[l] / length[l];
                let normal = [area[0][l] * scale, area[1][l] * scale, area[2][l] * scale];
                found.close.push(CloseNode {
                    node: nodes[l],
                    weights: [1.0 - b - c, b, c],
                    normal,
                    distance: distance[l],
                });
            }
        }
    }
}

/// Two edges.
#[derive(Clone, Copy, Debug, PartialEq)]
struct CloseCrossing {
    /// Place of the crossing in the list.
    place: usize,
    /// Where they cross, over the length of each.
    shares: [f64; 2],
    /// Unit vector from the second edge to the first.
    normal: [f64; 3],
    /// Along it, m.
    distance: f64,
}

/// Results of a task among crossings.
#[derive(Clone, Debug, Default)]
struct FoundCrossings {
    close: Vec<CloseCrossing>,
    /// Places of those that have become parallel, or are so no more.
    turned: Vec<usize>,
}

at_width! {
    /// Adds those of the crossings `range` that are closer than allowed, or by less than `margin` (m) farther, and
    /// those that have turned, to `found`.
    fn close_crossings[](
        crossings: &Crossings,
        position: &Vectors,
        range: Range<usize>,
        margin: f64,
        found: &mut FoundCrossings,
    ) = close_crossings_lanewise
}

#[inline(always)]
fn close_crossings_lanewise(
    crossings: &Crossings,
    position: &Vectors,
    range: Range<usize>,
    margin: f64,
    found: &mut FoundCrossings,
) {
    let [first, second, third, fourth] = &crossings.nodes;
    for start in range.clone().step_by(LANES) {
        let count = LANES.min(range.end - start);
        let mut nodes = [[0_u32; LANES]; 4];
        let [mut sign, mut limit]: [Lane; 2] = [splat(0.0); 2];
        for l in 0..LANES {
            let n = start + l.min(count - 1);
            (nodes[0][l], nodes[1][l], nodes[2][l], nodes[3][l]) = (first[n], second[n], third[n], fourth[n]);
            (sign[l], limit[l]) = (crossings.sign[n], crossings.bound[n] + margin + crossings.additional[n]);
        }
        let (a, b) = (position.gather(&nodes[0]), position.gather(&nodes[1]));
        let (c, d) = (position.gather(&nodes[2]), position.gather(&nodes[3]));
        let (e, f, w) = (minus(&b, &a), minus(&d, &c), minus(&a, &c));
        let across = cross(&e, &f);
        let squared = dot(&across, &across);
        let (of_e, of_f) = (dot(&e, &e), dot(&f, &f));
        let (height, s, t) = (dot(&across, &w), dot(&cross(&f, &w), &across), dot(&cross(&e, &w), &across));
        let (mut is_close, mut has_turned) = ([0_u8; LANES], [0_u8; LANES]);
        let [mut distance, mut factor]: [Lane; 2] = [splat(0.0); 2];
        for l in 0..LANES {
            // Infinite or NaN for parallel edges; `is_across` is zero there, and nothing of it is read.
            factor[l] = sign[l] / squared[l].sqrt();
            distance[l] = factor[l] * height[l];
            let is_across = u8::from(squared[l] > PARALLEL * of_e[l] * of_f[l]);
            let is_inside = u8::from(s[l] >= 0.0)
                & u8::from(s[l] <= squared[l])
                & u8::from(t[l] >= 0.0)
                & u8::from(t[l] <= squared[l]);
            // The sign was decided when the edges were listed; an edge that became or ceased to be parallel needs a new
            // one.
            has_turned[l] = is_across ^ u8::from(sign[l] != 0.0);
            is_close[l] = is_across & is_inside & u8::from(distance[l] < limit[l]) & (1 - has_turned[l]);
        }
        let mut any = 0;
        for l in 0..LANES {
            any |= is_close[l] | has_turned[l];
        }
        if any == 0 {
            continue;
        }
        for l in 0..count {
            if has_turned[l] != 0 {
                found.turned.push(start + l);
            }
            if is_close[l] != 0 {
                found.close.push(CloseCrossing {
                    place: start + l,
                    shares: [s[l] / squared[l], t[l] / squared[l]],
                    normal: [across[0][l] * factor[l], across[1][l] * factor[l], across[2][l] * factor[l]],
                    distance: distance[l],
                });
            }
        }
    }
}

#[inline(always)]
fn minus(a: &Lane3, b: &Lane3) -> Lane3 {
    let mut out = [splat(0.0); 3];
    for axis in 0..3 {
        for l in 0..LANES {
            out[axis][l] = a[axis][l] - b[axis][l];
        }
    }
    out
}
