//! Narrow phase: which nodes and crossings may come too close in a step, a lane each, and their constraints.

use std::ops::Range;

use nalgebra::Vector3;

use super::FilmContact;
use super::constraint::{Constraint, Pair, Source, Unusable};
use super::crossing::Crossings;
use super::crossing::PARALLEL;
use super::due;
use super::self_contact::{self, FoundPairs};
use super::surface::place;
use super::tracking::{self, BESIDE, Foot, Tracking};
use crate::engine::disjoint::Disjoint;
use crate::engine::nodes::{Nodes, Vectors};
use crate::engine::thread_pool::ThreadPool;
use crate::lane::{LANES, Lane, Lane3, at_width, cross, dot, larger, splat};

/// Nodes of a task.
const NODES_PER_RANGE: usize = 1024;

/// Crossings of a task.
const CROSSINGS_PER_RANGE: usize = 512;

/// Pairs of a face with itself of a task.
const PAIRS_PER_RANGE: usize = 512;

/// Range of nodes, crossings or pairs that one call examines.
#[derive(Clone, Debug)]
struct Task {
    of: Pairs,
    range: Range<usize>,
}

/// Pairs that follow each other in memory.
#[derive(Clone, Copy, Debug)]
enum Pairs {
    /// Of nodes and the triangles that they follow on one side.
    Nodes(usize),
    Crossings,
    /// Of one face.
    Itself,
}

/// Results of a task.
#[derive(Default)]
pub(super) struct Found {
    /// Places of what is looked at.
    places: Vec<u32>,
    /// Film may cover this path, m, until each of these is looked at again.
    spared: Vec<f64>,
    nodes: FoundNodes,
    crossings: FoundCrossings,
    itself: FoundPairs,
    constraints: Vec<Constraint>,
    /// Node and foot of those whose triangle or side has changed.
    moved: Vec<(u32, Foot)>,
    /// Nodes, crossings or pairs that do not lie on the sides of each other on which they were.
    lost: Vec<usize>,
}

impl Found {
    fn clear(&mut self) {
        self.spared.clear();
        self.nodes.close.clear();
        self.nodes.beside.clear();
        self.nodes.off_corner.clear();
        self.crossings.close.clear();
        self.crossings.turned.clear();
        self.itself.clear();
        self.constraints.clear();
        self.moved.clear();
        self.lost.clear();
    }

    /// Adds the constraint of an entry among the places, if it has one.
    fn add(&mut self, entry: usize, constraint: Result<Constraint, Unusable>) {
        match constraint {
            Ok(constraint) => {
                // Until the end of the step, for it has its constraint now.
                self.spared[entry] = f64::INFINITY;
                self.constraints.push(constraint);
            }
            Err(Unusable::Held) => (),
            Err(Unusable::Beyond) => self.lost.push(self.places[entry] as usize),
        }
    }
}

/// A step in which films are looked at.
#[derive(Clone, Copy)]
struct Step<'a> {
    nodes: &'a Nodes,
    /// s.
    dt: f64,
    /// Distance beyond the least allowed one up to which there is a constraint, and the largest one in any step, m.
    margins: [f64; 2],
    /// Path of film so far, m.
    path: f64,
}

impl FilmContact {
    /// Adds constraints of what is closer than allowed, or by less than `margin` (m) farther, at the end of a step of
    /// `dt` (s), for which the nodes have their predicted positions.
    pub(super) fn detect(&mut self, nodes: &Nodes, [dt, margin]: [f64; 2], pool: &ThreadPool) {
        let (count, crossings) = (nodes.mass.len(), self.crossings.len());
        let cut = |end: usize, by: usize| (0..end).step_by(by).map(move |from| from..end.min(from + by));
        let of_nodes = |side| cut(count, NODES_PER_RANGE).map(move |range| Task { of: Pairs::Nodes(side), range });
        let of_crossings = cut(crossings, CROSSINGS_PER_RANGE).map(|range| Task { of: Pairs::Crossings, range });
        let pairs = self.itself.as_ref().map_or(0, |itself| itself.pairs.len());
        let of_itself = cut(pairs, PAIRS_PER_RANGE).map(|range| Task { of: Pairs::Itself, range });
        // Faces that do not meet each other follow nothing.
        let sides = if self.history.is_near { 0..2 } else { 0..0 };
        let tasks: Vec<Task> = sides.flat_map(of_nodes).chain(of_crossings).chain(of_itself).collect();
        let mut found = std::mem::take(&mut self.found);
        // Kept from step to step for their capacity, also where fewer tasks need them now.
        found.resize_with(tasks.len().max(found.len()), Found::default);
        let results = Disjoint::new(&mut found);
        let step = Step { nodes, dt, margins: [margin, 2.0 * self.largest_margin()], path: self.history.path };
        // Taken out, for tasks write them while they read the rest.
        let mut due_nodes = self.tracking.each_mut().map(|tracking| std::mem::take(&mut tracking.noted.due));
        let mut due_crossings = std::mem::take(&mut self.crossings.noted.due);
        let mut due_itself = self.itself.as_mut().map_or(vec![], |itself| std::mem::take(&mut itself.pairs.noted.due));
        let of_nodes = due_nodes.each_mut().map(|due| Disjoint::new(due));
        let [of_crossings, of_itself] = [&mut due_crossings, &mut due_itself].map(|due| Disjoint::new(due));
        let path_of_itself = self.itself.as_ref().map_or(0.0, |itself| itself.path);
        pool.each(tasks.len(), |part| {
            // SAFETY: every part comes up once.
            let found = unsafe { results.entry(part) };
            found.clear();
            let Task { of, range } = tasks[part].clone();
            let of_pairs = match of {
                Pairs::Nodes(side) => &of_nodes[side],
                Pairs::Crossings => &of_crossings,
                Pairs::Itself => &of_itself,
            };
            // SAFETY: ranges of the same pairs do not overlap.
            let due = unsafe { of_pairs.range(range.clone()) };
            let path = match of {
                Pairs::Itself => path_of_itself,
                _ => step.path,
            };
            due::list(pool.width(), due, path, range.start, &mut found.places);
            match of {
                Pairs::Nodes(side) => self.detect_nodes(pool, step, side, found),
                Pairs::Crossings => self.detect_crossings(pool, step, found),
                Pairs::Itself => self.detect_itself(step, found),
            }
            for (place, spared) in found.places.iter().zip(&found.spared) {
                due[*place as usize - range.start] = path + spared;
            }
        });
        self.tracking.iter_mut().zip(due_nodes).for_each(|(tracking, due)| tracking.noted.due = due);
        self.crossings.noted.due = due_crossings;
        self.itself.iter_mut().for_each(|itself| itself.pairs.noted.due = std::mem::take(&mut due_itself));
        // In the order of the tasks, whichever thread had them: the sweeps go through the constraints in this order.
        for (task, found) in tasks.iter().zip(&mut found) {
            self.constraints.append(&mut found.constraints);
            self.history.lost += found.lost.len() as u64;
            match task.of {
                Pairs::Nodes(side) => self.follow(side, found, nodes, dt),
                Pairs::Crossings => {
                    let again = found.lost.iter().chain(&found.crossings.turned);
                    self.history.stale.extend(again.flat_map(|place| self.crossings.edges(*place)));
                    found.lost.iter().for_each(|place| self.crossings.sign[*place] = 0.0);
                }
                Pairs::Itself => {
                    let Some(itself) = &mut self.itself else { continue };
                    itself.follow(&found.itself);
                    found.lost.iter().for_each(|place| itself.lose(*place));
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
            let due = self.tracking[side].noted.due[n];
            self.tracking[side].follow(n, foot.triangle, sign, &self.surface);
            // By the foot on the other triangle: it may have its constraint already.
            self.tracking[side].noted.due[n] = due;
            self.mark(*node, before);
            self.mark(*node, foot.triangle);
        }
        for node in &found.nodes.off_corner {
            self.tracking[side].leave_corner(*node as usize);
            self.history.stale.extend_from_slice(self.surface.edges_at(*node));
        }
        // Given up, so that the next search decides anew on which side it lies.
        for n in &found.lost {
            self.mark(*n as u32, self.tracking[side].triangle[*n]);
            self.tracking[side].lose(*n);
            self.history.margin = 0.0;
        }
    }

    /// Velocity of a node over its foot along the normal, m/s.
    fn approach(&self, nodes: &Nodes, node: usize, foot: &Foot) -> f64 {
        let corners = self.surface.corners[foot.triangle as usize];
        let film: Vector3<f64> = (0..3).map(|k| nodes.velocity_of(corners[k] as usize) * foot.weights[k]).sum();
        (nodes.velocity_of(node) - film).dot(&foot.normal)
    }

    /// Constraints of the listed nodes, and those of them that follow another triangle from now on.
    fn detect_nodes(&self, pool: &ThreadPool, step: Step<'_>, side: usize, found: &mut Found) {
        let Step { nodes, dt, margins, .. } = step;
        let (tracking, position) = (&self.tracking[side], &nodes.position);
        let Found { places, spared, nodes: of_nodes, .. } = &mut *found;
        close_nodes(pool.width(), tracking, position, places, margins, spared, of_nodes);
        for k in 0..found.nodes.close.len() {
            let CloseNode { entry, weights: [a, b, c], normal, distance } = found.nodes.close[k];
            let n = found.places[entry] as usize;
            // In the order of the tracking, which may be turned so that the corner under the node comes first.
            let [first, second, third] = &tracking.corners;
            let pair = Pair {
                nodes: [n as u32, first[n], second[n], third[n]],
                weights: [1.0, -a, -b, -c],
                normal: Vector3::from(normal),
                distance,
                bound: tracking.bound[n],
            };
            let source = Source::Node { side, node: n as u32 };
            found.add(entry, Constraint::new(source, pair, nodes, dt));
        }
        for k in 0..found.nodes.beside.len() {
            let entry = found.nodes.beside[k];
            if let Some(pair) = self.pair_beside(step, side, entry, found) {
                let source = Source::Node { side, node: found.places[entry] };
                found.add(entry, Constraint::new(source, pair, nodes, dt));
            }
        }
    }

    /// The pair of a node beside its triangle and what it lies over, if these are close.
    fn pair_beside(&self, step: Step<'_>, side: usize, entry: usize, found: &mut Found) -> Option<Pair> {
        let (tracking, position) = (&self.tracking[side], &step.nodes.position);
        let n = found.places[entry] as usize;
        let (triangle, sign, bound) = (tracking.triangle[n], tracking.sign[n], tracking.bound[n]);
        // The walk over neighbours is a branch a step, so nodes beside their triangle leave the lanes for it.
        let foot = tracking::foot(&self.surface, position, &place(position, n), triangle);
        if foot.triangle != triangle || foot.is_over != (sign != 0.0) {
            found.moved.push((n as u32, foot));
        }
        let corners = self.surface.corners[foot.triangle as usize];
        let [a, b, c] = foot.weights;
        // Beside the outline it stays due: where the walk ends there, the face may be nearer elsewhere.
        if !foot.is_over || sign == 0.0 {
            return None;
        }
        let distance = sign * foot.distance;
        found.spared[entry] = due::spared(distance - bound - step.margins[1]);
        (distance < tracking.limit(n, step.margins[0])).then_some(Pair {
            nodes: [n as u32, corners[0], corners[1], corners[2]],
            weights: [1.0, -a, -b, -c],
            normal: foot.normal * sign,
            distance,
            bound,
        })
    }

    /// Constraints of the listed crossings.
    fn detect_crossings(&self, pool: &ThreadPool, step: Step<'_>, found: &mut Found) {
        let Step { nodes, dt, margins, .. } = step;
        let crossings = &self.crossings;
        let Found { places, spared, crossings: of_crossings, .. } = &mut *found;
        close_crossings(pool.width(), crossings, &nodes.position, places, margins, spared, of_crossings);
        for k in 0..found.crossings.close.len() {
            let CloseCrossing { entry, shares: [s, t], normal, distance } = found.crossings.close[k];
            let place = found.places[entry] as usize;
            let [first, second, third, fourth] = &crossings.nodes;
            let pair = Pair {
                nodes: [first[place], second[place], third[place], fourth[place]],
                weights: [1.0 - s, s, t - 1.0, -t],
                normal: Vector3::from(normal),
                distance,
                bound: crossings.bound[place],
            };
            let source = Source::Crossing(crossings.edges(place));
            found.add(entry, Constraint::new(source, pair, nodes, dt));
        }
    }

    /// Constraints of the listed pairs of a face.
    fn detect_itself(&self, step: Step<'_>, found: &mut Found) {
        let Step { nodes, dt, margins, .. } = step;
        let Some(itself) = &self.itself else { return };
        let step = self_contact::Step { surface: &self.surface, nodes, dt, margins };
        let Found { places, spared, itself: of_pairs, .. } = &mut *found;
        itself.detect(step, places, spared, of_pairs);
        for (entry, parts, pair) in std::mem::take(&mut found.itself.close) {
            found.add(entry, Constraint::new(Source::Itself(parts), pair, nodes, dt));
        }
    }

    /// Least distance of the crossings, m, where one is less than `distance`.
    pub(super) fn least_of_crossings(&self, position: &Vectors, distance: f64, pool: &ThreadPool) -> f64 {
        let Found { mut places, mut spared, crossings: mut found, .. } = Found::default();
        places.extend(self.crossings.places().map(|place| place as u32));
        let margins = [f64::INFINITY; 2];
        close_crossings(pool.width(), &self.crossings, position, &places, margins, &mut spared, &mut found);
        found.close.iter().map(|close| close.distance).fold(distance, f64::min)
    }

    /// Number of nodes and crossings that are not due with nodes at `position`, and of those of them that are closer
    /// than allowed.
    #[cfg(test)]
    pub(super) fn count_spared(&self, position: &Vectors) -> [usize; 2] {
        use crate::lane::Width;
        let path = self.history.path + 2.0 * self.motion(position, Width::best());
        let is_spared = |due: f64| due.is_finite() && due > path;
        let [mut all, mut close] = [0; 2];
        for tracking in &self.tracking {
            for n in (0..tracking.noted.due.len()).filter(|n| is_spared(tracking.noted.due[*n])) {
                let foot = tracking::foot(&self.surface, position, &place(position, n), tracking.triangle[n]);
                all += 1;
                close += usize::from(foot.is_over && tracking.sign[n] * foot.distance < tracking.bound[n]);
            }
        }
        let spared = self.crossings.places().filter(|place| is_spared(self.crossings.noted.due[*place]));
        let places: Vec<u32> = spared.map(|place| place as u32).collect();
        let mut found = FoundCrossings::default();
        close_crossings(Width::best(), &self.crossings, position, &places, [0.0; 2], &mut vec![], &mut found);
        [all + places.len(), close + found.close.len()]
    }
}

/// A node over its triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
struct CloseNode {
    /// Its place among the listed ones.
    entry: usize,
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
    /// Places among the listed ones of nodes that are not over their triangle, or on no side of it so far.
    beside: Vec<usize>,
    /// Nodes that do not lie on a corner any more.
    off_corner: Vec<u32>,
}

at_width! {
    /// Adds those of the `listed` nodes that are closer to the plane of their triangle than allowed, or by less than the
    /// first of the `margins` (m) farther, those that are not over it any more, and those that have left its corner, to
    /// `found`; to `spared` the path that film may cover until each is looked at again.
    fn close_nodes[](
        tracking: &Tracking,
        position: &Vectors,
        listed: &[u32],
        margins: [f64; 2],
        spared: &mut Vec<f64>,
        found: &mut FoundNodes,
    ) {
        // One function: its parts would each gather the lanes again, or be calls.
        let [margin, widest] = margins;
        let [first, second, third] = &tracking.corners;
        for start in (0..listed.len()).step_by(LANES) {
            let count = LANES.min(listed.len() - start);
            let (mut nodes, mut corners) = ([0_u32; LANES], [[0_u32; LANES]; 3]);
            let [mut sign, mut bound, mut limit, mut on_corner]: [Lane; 4] = [splat(0.0); 4];
            for l in 0..LANES {
                // The last group repeats its last node; only the first `count` lanes are read again below.
                nodes[l] = listed[start + l.min(count - 1)];
                let n = nodes[l] as usize;
                (corners[0][l], corners[1][l], corners[2][l]) = (first[n], second[n], third[n]);
                (sign[l], on_corner[l], bound[l]) = (tracking.sign[n], tracking.on_corner[n], tracking.bound[n]);
                limit[l] = tracking.limit(n, margin);
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
            let [mut distance, mut length, mut left]: [Lane; 3] = [splat(0.0); 3];
            for l in 0..LANES {
                let beside = -BESIDE * squared[l];
                length[l] = squared[l].sqrt();
                distance[l] = sign[l] * (height[l] / length[l]);
                // Comparisons as numbers joined by `&`, for `&&` is a branch.
                let inside = u8::from(of_b[l] >= beside)
                    & u8::from(of_c[l] >= beside)
                    & u8::from(squared[l] - of_b[l] - of_c[l] >= beside);
                is_over[l] = inside & u8::from(sign[l] != 0.0);
                is_close[l] = is_over[l] & u8::from(distance[l] < limit[l]);
                left[l] = if is_over[l] != 0 { due::spared(distance[l] - bound[l] - widest) } else { 0.0 };
                // Pythagoras: the square of the distance along the triangle, without the foot itself.
                is_off[l] = is_over[l] & u8::from(from_corner[l] - distance[l] * distance[l] > on_corner[l]);
            }
            spared.extend_from_slice(&left[..count]);
            let mut any = 0;
            for l in 0..LANES {
                any |= is_off[l] | is_close[l] | (1 - is_over[l]);
            }
            // In most groups no lane has anything to report, and what follows is scalar.
            if any == 0 {
                continue;
            }
            for l in 0..count {
                if is_over[l] == 0 {
                    found.beside.push(start + l);
                }
                if is_off[l] != 0 {
                    found.off_corner.push(nodes[l]);
                }
                if is_close[l] != 0 {
                    let (b, c) = (of_b[l] / squared[l], of_c[l] / squared[l]);
                    let scale = sign[l] / length[l];
                    let normal = [area[0][l] * scale, area[1][l] * scale, area[2][l] * scale];
                    found.close.push(CloseNode {
                        entry: start + l,
                        weights: [1.0 - b - c, b, c],
                        normal,
                        distance: distance[l],
                    });
                }
            }
        }
    }
}

/// Two edges.
#[derive(Clone, Copy, Debug, PartialEq)]
struct CloseCrossing {
    /// Its place among the listed ones.
    entry: usize,
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
    /// Adds those of the crossings at `places` that are closer than allowed, or by less than the first of the `margins`
    /// (m) farther, and those that have turned, to `found`; to `spared` the path that film may cover until each is
    /// looked at again.
    fn close_crossings[](
        crossings: &Crossings,
        position: &Vectors,
        places: &[u32],
        margins: [f64; 2],
        spared: &mut Vec<f64>,
        found: &mut FoundCrossings,
    ) {
        // One function, as that of nodes.
        let [margin, widest] = margins;
        let [first, second, third, fourth] = &crossings.nodes;
        for start in (0..places.len()).step_by(LANES) {
            let count = LANES.min(places.len() - start);
            let mut nodes = [[0_u32; LANES]; 4];
            let [mut sign, mut bound, mut limit]: [Lane; 3] = [splat(0.0); 3];
            for l in 0..LANES {
                let n = places[start + l.min(count - 1)] as usize;
                (nodes[0][l], nodes[1][l], nodes[2][l], nodes[3][l]) = (first[n], second[n], third[n], fourth[n]);
                (sign[l], bound[l], limit[l]) = (crossings.sign[n], crossings.bound[n], crossings.limit(n, margin));
            }
            let (a, b) = (position.gather(&nodes[0]), position.gather(&nodes[1]));
            let (c, d) = (position.gather(&nodes[2]), position.gather(&nodes[3]));
            let (e, f, w) = (minus(&b, &a), minus(&d, &c), minus(&a, &c));
            let across = cross(&e, &f);
            let squared = dot(&across, &across);
            let (of_e, of_f, of_w) = (dot(&e, &e), dot(&f, &f), dot(&w, &w));
            let (height, s, t) = (dot(&across, &w), dot(&cross(&f, &w), &across), dot(&cross(&e, &w), &across));
            let (mut is_close, mut has_turned) = ([0_u8; LANES], [0_u8; LANES]);
            let along = dot(&e, &w);
            let [mut distance, mut factor, mut left]: [Lane; 3] = [splat(0.0); 3];
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
                // Two parallel lines are nowhere nearer than one end of an edge to the line of the other, but for the angle
                // between them.
                let beside = of_w[l] - along[l] * along[l] / of_e[l];
                let turn = PARALLEL.sqrt() * (of_e[l].sqrt() + of_f[l].sqrt());
                let apart = if is_across != 0 { distance[l] } else { larger(beside, 0.0).sqrt() - turn };
                left[l] = due::spared(apart - bound[l] - widest) * f64::from(1 - has_turned[l]);
            }
            spared.extend_from_slice(&left[..count]);
            let mut any = 0;
            for l in 0..LANES {
                any |= is_close[l] | has_turned[l];
            }
            if any == 0 {
                continue;
            }
            for l in 0..count {
                if has_turned[l] != 0 {
                    found.turned.push(places[start + l] as usize);
                }
                if is_close[l] != 0 {
                    found.close.push(CloseCrossing {
                        entry: start + l,
                        shares: [s[l] / squared[l], t[l] / squared[l]],
                        normal: [across[0][l] * factor[l], across[1][l] * factor[l], across[2][l] * factor[l]],
                        distance: distance[l],
                    });
                }
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
