//! Narrow phase: which nodes and crossings may come too close in a step, a lane each, and their constraints.

use std::ops::Range;

use super::constraint::{FilmConstraint, Pair, Source, Unusable};
use super::crossing::{Crossings, PARALLEL};
use super::due::{self, Pairs};
use super::surface::{Surface, place};
use super::tracking::{self, BESIDE, Foot, Tracking};
use super::{FilmContact, History};
use crate::engine::disjoint::Disjoint;
use crate::engine::nodes::{Nodes, Vectors};
use crate::engine::thread_pool::ThreadPool;
use crate::lane::{LANES, Lane, at_width, cross, dot, one, splat};

/// Range of the pairs of one kind, by its place in [`KINDS`], that one call examines.
#[derive(Clone, Debug)]
struct Task {
    kind: usize,
    range: Range<usize>,
}

/// Pairs that follow each other in memory.
#[derive(Clone, Copy, Debug)]
enum Kind {
    /// Nodes and the triangles that they follow on one side.
    Nodes(usize),
    Crossings,
    /// Parts of one face.
    Itself,
}

/// All kinds, with the number of pairs of a task: in this order they come into the sweeps.
const KINDS: [(Kind, usize); 4] =
    [(Kind::Nodes(0), 1024), (Kind::Nodes(1), 1024), (Kind::Crossings, 512), (Kind::Itself, 512)];

/// Results of a task.
#[derive(Default)]
pub(super) struct Found {
    /// Places of what is looked at.
    pub(super) places: Vec<u32>,
    /// Film may cover this path, m, until each of these is looked at again.
    pub(super) spared: Vec<f64>,
    /// Entries among the places, and the points that may come too close.
    pub(super) close: Vec<(usize, Pair)>,
    /// Entries among the places of nodes that are not over their triangle, or on no side of it so far.
    beside: Vec<usize>,
    /// Nodes that do not lie on a corner any more; crossings that have become parallel, or are so no more.
    turned: Vec<u32>,
    /// Place of a pair of one face, its sign and its least allowed distance (m), where these have changed.
    pub(super) changed: Vec<(u32, [f64; 2])>,
    constraints: Vec<FilmConstraint>,
    /// Node and foot of those whose triangle or side has changed.
    moved: Vec<(u32, Foot)>,
    /// Nodes, crossings or pairs that do not lie on the sides of each other on which they were.
    lost: Vec<usize>,
}

impl Found {
    /// Nothing so far at these places.
    pub(super) fn at(places: Vec<u32>) -> Found {
        Found { places, ..Found::default() }
    }

    fn clear(&mut self) {
        self.spared.clear();
        self.close.clear();
        self.beside.clear();
        self.turned.clear();
        self.changed.clear();
        self.constraints.clear();
        self.moved.clear();
        self.lost.clear();
    }

    /// Adds the constraints of what is close, of which `source` tells to what it belongs by its place.
    fn add_close(&mut self, step: Step<'_>, source: impl Fn(usize) -> Source) {
        for (entry, pair) in &self.close {
            let place = self.places[*entry] as usize;
            match FilmConstraint::new(source(place), pair, step.nodes, step.dt) {
                Ok(constraint) => {
                    // Until the end of the step, for it has its constraint now.
                    self.spared[*entry] = f64::INFINITY;
                    self.constraints.push(constraint);
                }
                Err(Unusable::Held) => (),
                Err(Unusable::Beyond) => self.lost.push(place),
            }
        }
    }
}

/// A step in which films are looked at.
#[derive(Clone, Copy)]
pub(super) struct Step<'a> {
    pub(super) surface: &'a Surface,
    /// With their predicted positions.
    pub(super) nodes: &'a Nodes,
    /// s.
    pub(super) dt: f64,
    /// Distance beyond the least allowed one up to which there is a constraint, and the largest one in any step, m.
    pub(super) margins: [f64; 2],
}

impl FilmContact {
    /// Adds constraints of what is closer than allowed, or by less than `margin` (m) farther, at the end of a step of
    /// `dt` (s), for which the nodes have their predicted positions.
    pub(super) fn detect(&mut self, nodes: &Nodes, [dt, margin]: [f64; 2], pool: &ThreadPool) {
        let mut found = std::mem::take(&mut self.found);
        // Taken out, for tasks write them while they read the rest.
        let mut due = KINDS.map(|(kind, _)| self.pairs(kind).map_or(vec![], |pairs| std::mem::take(&mut pairs.due)));
        let tasks: Vec<Task> = (0..KINDS.len())
            .flat_map(|kind| {
                let (end, by) = (due[kind].len(), KINDS[kind].1);
                (0..end).step_by(by).map(move |from| Task { kind, range: from..end.min(from + by) })
            })
            .collect();
        // Kept from step to step for their capacity, also where fewer tasks need them now.
        found.resize_with(tasks.len().max(found.len()), Found::default);
        let results = Disjoint::new(&mut found);
        let due_of = due.each_mut().map(|due| Disjoint::new(due));
        let path_of_itself = self.itself.as_ref().map_or(0.0, |itself| itself.state.path);
        let step = Step { surface: &self.surface, nodes, dt, margins: [margin, 2.0 * self.largest_margin()] };
        pool.each(tasks.len(), |part| {
            // SAFETY: every part comes up once.
            let found = unsafe { results.entry(part) };
            found.clear();
            let Task { kind, range } = &tasks[part];
            // SAFETY: ranges of the same pairs do not overlap.
            let due = unsafe { due_of[*kind].range(range.clone()) };
            let kind = KINDS[*kind].0;
            let path = if let Kind::Itself = kind { path_of_itself } else { self.history.path };
            due::list(pool.width(), due, path, range.start, &mut found.places);
            match kind {
                Kind::Nodes(side) => self.detect_nodes(pool, step, side, found),
                Kind::Crossings => self.detect_crossings(pool, step, found),
                Kind::Itself => self.detect_itself(step, found),
            }
            for (place, spared) in found.places.iter().zip(&found.spared) {
                due[*place as usize - range.start] = path + spared;
            }
        });
        for ((kind, _), due) in KINDS.into_iter().zip(due) {
            if let Some(pairs) = self.pairs(kind) {
                pairs.due = due;
            }
        }
        // In the order of the tasks, whichever thread had them: the sweeps go through the constraints in this order.
        for (task, found) in tasks.iter().zip(&mut found) {
            self.constraints.append(&mut found.constraints);
            self.history.lost += found.lost.len() as u64;
            match KINDS[task.kind].0 {
                Kind::Nodes(side) => self.follow(side, found, nodes, dt),
                Kind::Crossings => {
                    let History { crossings, stale, .. } = &mut self.history;
                    let turned = found.turned.iter().map(|place| *place as usize);
                    stale.extend(found.lost.iter().copied().chain(turned).flat_map(|place| crossings.edges(place)));
                    found.lost.iter().for_each(|place| crossings.pairs.sign[*place] = 0.0);
                }
                Kind::Itself => {
                    let Some(itself) = &mut self.itself else { continue };
                    itself.follow(&found.changed);
                    found.lost.iter().for_each(|place| itself.lose(*place));
                }
            }
        }
        self.found = found;
    }

    /// The pairs of one kind; none of a kind of which there are none.
    fn pairs(&mut self, kind: Kind) -> Option<&mut Pairs> {
        match kind {
            // Faces that do not meet each other follow nothing.
            Kind::Nodes(side) => self.history.is_near.then_some(&mut self.history.tracking[side].pairs),
            Kind::Crossings => Some(&mut self.history.crossings.pairs),
            Kind::Itself => self.itself.as_mut().map(|itself| &mut itself.state.pairs.pairs),
        }
    }

    /// Lets nodes follow other triangles, and marks the edges whose crossings change by that.
    fn follow(&mut self, side: usize, found: &Found, nodes: &Nodes, dt: f64) {
        for (node, foot) in &found.moved {
            let n = *node as usize;
            let tracking = &mut self.history.tracking[side];
            let (before, sign, due) = (tracking.triangle[n], tracking.pairs.sign[n], tracking.pairs.due[n]);
            // A known side is kept, whatever the distance says: film that has passed through must come back (theory.md,
            // section 6).
            let sign = match (foot.is_over, sign == 0.0) {
                (true, false) => sign,
                // The side on which it was before the step.
                (true, true) => 1.0_f64.copysign(pair(&self.surface, *node, foot, [1.0, 0.0]).before(nodes, dt)),
                (false, _) => 0.0,
            };
            tracking.follow(n, foot.triangle, sign, &self.surface);
            // By the foot on the other triangle: it may have its constraint already.
            tracking.pairs.due[n] = due;
            self.mark(*node, before);
            self.mark(*node, foot.triangle);
        }
        for node in &found.turned {
            self.history.tracking[side].leave_corner(*node as usize);
            self.history.stale.extend_from_slice(self.surface.edges_at(*node));
        }
        // Given up, so that the next search decides anew on which side it lies.
        for n in &found.lost {
            self.mark(*n as u32, self.history.tracking[side].triangle[*n]);
            self.history.tracking[side].lose(*n);
            self.history.margin = 0.0;
        }
    }

    /// Constraints of the listed nodes, and those of them that follow another triangle from now on.
    fn detect_nodes(&self, pool: &ThreadPool, step: Step<'_>, side: usize, found: &mut Found) {
        let tracking = &self.history.tracking[side];
        close_nodes(pool.width(), tracking, &step.nodes.position, step.margins, found);
        for k in 0..found.beside.len() {
            let entry = found.beside[k];
            if let Some(pair) = self.pair_beside(step, side, entry, found) {
                found.close.push((entry, pair));
            }
        }
        found.add_close(step, |place| Source::Node { side, node: place as u32 });
    }

    /// The pair of a node beside its triangle and what it lies over, if these are close.
    fn pair_beside(&self, step: Step<'_>, side: usize, entry: usize, found: &mut Found) -> Option<Pair> {
        let (tracking, position) = (&self.history.tracking[side], &step.nodes.position);
        let n = found.places[entry] as usize;
        let (triangle, sign, bound) = (tracking.triangle[n], tracking.pairs.sign[n], tracking.pairs.bound[n]);
        // The walk over neighbours is a branch a step, so nodes beside their triangle leave the lanes for it.
        let foot = tracking::foot(&self.surface, position, &place(position, n), triangle);
        if foot.triangle != triangle || foot.is_over != (sign != 0.0) {
            found.moved.push((n as u32, foot));
        }
        // Beside the outline it stays due: where the walk ends there, the face may be nearer elsewhere.
        if !foot.is_over || sign == 0.0 {
            return None;
        }
        let pair = pair(&self.surface, n as u32, &foot, [sign, bound]);
        found.spared[entry] = due::spared(one(pair.distance - bound - step.margins[1]))[0];
        (pair.distance < tracking.pairs.limit(n, bound + step.margins[0])).then_some(pair)
    }

    /// Constraints of the listed crossings.
    fn detect_crossings(&self, pool: &ThreadPool, step: Step<'_>, found: &mut Found) {
        let crossings = &self.history.crossings;
        close_crossings(pool.width(), crossings, &step.nodes.position, step.margins, found);
        found.add_close(step, |place| Source::Crossing(crossings.edges(place)));
    }

    /// Constraints of the listed pairs of a face.
    fn detect_itself(&self, step: Step<'_>, found: &mut Found) {
        let Some(itself) = &self.itself else { return };
        itself.detect(step, found);
        found.add_close(step, |place| Source::Itself(itself.state.pairs.known(place).parts));
    }

    /// Least distance of the crossings, m, where one is less than `distance`.
    pub(super) fn least_of_crossings(&self, position: &Vectors, distance: f64, pool: &ThreadPool) -> f64 {
        let places = self.history.crossings.places().map(|place| place as u32).collect();
        let mut found = Found::at(places);
        close_crossings(pool.width(), &self.history.crossings, position, [f64::INFINITY; 2], &mut found);
        found.close.iter().map(|(_, pair)| pair.distance).fold(distance, f64::min)
    }
}

/// A node and its `foot`, on the side `sign` of it and kept apart by `bound` (m).
fn pair(surface: &Surface, node: u32, foot: &Foot, [sign, bound]: [f64; 2]) -> Pair {
    let ([a, b, c], [p, q, r]) = (surface.corners[foot.triangle as usize], foot.weights);
    Pair {
        nodes: [node, a, b, c],
        weights: [1.0, -p, -q, -r],
        normal: foot.normal * sign,
        distance: sign * foot.distance,
        bound,
    }
}

at_width! {
    /// Finds those of the nodes at the places that are closer to the plane of their triangle than allowed, or by less than
    /// the first of the `margins` (m) farther, those that are not over it any more, those that have left its corner, and the
    /// path that film may cover until each is looked at again.
    fn close_nodes[](tracking: &Tracking, position: &Vectors, margins: [f64; 2], found: &mut Found) {
        // One function: its parts would each gather the lanes again, or be calls.
        let Found { places: listed, spared, close, beside: not_over, turned, .. } = found;
        let [margin, widest] = margins;
        let Tracking { corners: [first, second, third], pairs, .. } = tracking;
        for start in (0..listed.len()).step_by(LANES) {
            let count = LANES.min(listed.len() - start);
            let (mut nodes, mut corners) = ([0_u32; LANES], [[0_u32; LANES]; 3]);
            let [mut sign, mut bound, mut limit, mut on_corner]: [Lane; 4] = [splat(0.0); 4];
            for l in 0..LANES {
                // The last group repeats its last node; only the first `count` lanes are read again below.
                nodes[l] = listed[start + l.min(count - 1)];
                let n = nodes[l] as usize;
                (corners[0][l], corners[1][l], corners[2][l]) = (first[n], second[n], third[n]);
                (sign[l], on_corner[l], bound[l]) = (pairs.sign[n], tracking.on_corner[n], pairs.bound[n]);
                limit[l] = pairs.limit(n, pairs.bound[n] + margin);
            }
            let p = position.gather(&nodes);
            let a = position.gather(&corners[0]);
            let (b, c) = (position.gather(&corners[1]), position.gather(&corners[2]));
            let (u, v, r) = (b - a, c - a, p - a);
            let area = cross(&u, &v);
            let (height, squared, from_corner) = (dot(&area, &r), dot(&area, &area), dot(&r, &r));
            // Weights of the corners times the square.
            let (of_b, of_c) = (dot(&cross(&r, &v), &area), dot(&cross(&u, &r), &area));
            let (beside, length) = (-BESIDE * squared, squared.sqrt());
            let distance = sign * (height / length);
            let inside = of_b.at_least(beside) & of_c.at_least(beside) & (squared - of_b - of_c).at_least(beside);
            let is_over = inside & !sign.equals(0.0);
            let is_close = is_over & distance.below(limit);
            // Pythagoras: the square of the distance along the triangle, without the foot itself.
            let is_off = is_over & (from_corner - distance * distance).above(on_corner);
            spared.extend_from_slice(&is_over.select(due::spared(distance - bound - widest), 0.0)[..count]);
            // In most groups no lane has anything to report, and what follows is scalar.
            if !(is_off | is_close | !is_over).any() {
                continue;
            }
            for l in 0..count {
                if !is_over.holds(l) {
                    not_over.push(start + l);
                }
                if is_off.holds(l) {
                    turned.push(nodes[l]);
                }
                if is_close.holds(l) {
                    let (b, c) = (of_b[l] / squared[l], of_c[l] / squared[l]);
                    let normal = area.vector(l) * (sign[l] / length[l]);
                    // In the order of the tracking, which may be turned so that the corner under the node comes first.
                    let nodes = [nodes[l], corners[0][l], corners[1][l], corners[2][l]];
                    let weights = [1.0, -(1.0 - b - c), -b, -c];
                    close.push((start + l, Pair { nodes, weights, normal, distance: distance[l], bound: bound[l] }));
                }
            }
        }
    }
}

at_width! {
    /// Finds those of the crossings at the places that are closer than allowed, or by less than the first of the `margins`
    /// (m) farther, those that have turned, and the path that film may cover until each is looked at again.
    pub(super) fn close_crossings[](crossings: &Crossings, position: &Vectors, margins: [f64; 2], found: &mut Found) {
        // One function, as that of nodes.
        let Found { places, spared, close, turned, .. } = found;
        let [margin, widest] = margins;
        let Crossings { nodes: [first, second, third, fourth], pairs, .. } = crossings;
        for start in (0..places.len()).step_by(LANES) {
            let count = LANES.min(places.len() - start);
            let mut nodes = [[0_u32; LANES]; 4];
            let [mut sign, mut bound, mut limit]: [Lane; 3] = [splat(0.0); 3];
            for l in 0..LANES {
                let n = places[start + l.min(count - 1)] as usize;
                (nodes[0][l], nodes[1][l], nodes[2][l], nodes[3][l]) = (first[n], second[n], third[n], fourth[n]);
                (sign[l], bound[l]) = (pairs.sign[n], pairs.bound[n]);
                limit[l] = pairs.limit(n, pairs.bound[n] + margin);
            }
            let (a, b) = (position.gather(&nodes[0]), position.gather(&nodes[1]));
            let (c, d) = (position.gather(&nodes[2]), position.gather(&nodes[3]));
            let (e, f, w) = (b - a, d - c, a - c);
            let across = cross(&e, &f);
            let squared = dot(&across, &across);
            let (of_e, of_f, of_w) = (dot(&e, &e), dot(&f, &f), dot(&w, &w));
            let (height, s, t) = (dot(&across, &w), dot(&cross(&f, &w), &across), dot(&cross(&e, &w), &across));
            // Infinite or NaN for parallel edges, of which nothing is read.
            let factor = sign / squared.sqrt();
            let distance = factor * height;
            let is_across = squared.above(PARALLEL * of_e * of_f);
            let is_inside = s.at_least(0.0) & s.at_most(squared) & t.at_least(0.0) & t.at_most(squared);
            // The sign was decided when the edges were listed; an edge that became or ceased to be parallel needs a new one.
            let has_none = sign.equals(0.0);
            let has_turned = (is_across & has_none) | !(is_across | has_none);
            let is_close = is_across & is_inside & distance.below(limit) & !has_turned;
            // Two parallel lines are nowhere nearer than one end of an edge to the line of the other, but for the angle
            // between them.
            let along = dot(&e, &w);
            let beside = of_w - along * along / of_e;
            let turn = PARALLEL.sqrt() * (of_e.sqrt() + of_f.sqrt());
            let apart = is_across.select(distance, beside.max(0.0).sqrt() - turn);
            spared.extend_from_slice(&has_turned.select(0.0, due::spared(apart - bound - widest))[..count]);
            if !(is_close | has_turned).any() {
                continue;
            }
            for l in 0..count {
                if has_turned.holds(l) {
                    turned.push(places[start + l]);
                }
                if is_close.holds(l) {
                    let (s, t) = (s[l] / squared[l], t[l] / squared[l]);
                    let normal = across.vector(l) * factor[l];
                    let nodes = [nodes[0][l], nodes[1][l], nodes[2][l], nodes[3][l]];
                    let weights = [1.0 - s, s, t - 1.0, -t];
                    close.push((start + l, Pair { nodes, weights, normal, distance: distance[l], bound: bound[l] }));
                }
            }
        }
    }
}
