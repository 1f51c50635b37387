//! Which pairs of a face would come too close in a step, and their constraints.
//!
//! A node over a triangle, or two edges that cross, are kept on the side on which they were before the step, looked at
//! where they are predicted: film that slides turns the direction of contact by itself. A node to which an edge or a corner
//! is the nearest part of the film, as at a ridge, a tip or an outline, is kept off it along the line between both before
//! the step: as if it were rounded.

use nalgebra::Vector3;

use super::closest::{Feature, at, distance_of_segments, distance_to_triangle, on_triangle};
use super::pairs::{Known, Parts};
use super::{LEAST, SelfContact};
use crate::engine::film_contact::constraint::Pair;
use crate::engine::film_contact::crossing::PARALLEL;
use crate::engine::film_contact::due::{self, Pairs};
use crate::engine::film_contact::narrow_phase::{Found, Step};
use crate::engine::film_contact::surface::{NONE, Surface, place};
use crate::engine::film_contact::tracking::{BESIDE, normal_of, project};
use crate::engine::nodes::Vectors;
use crate::lane::one;

/// Cosine of the angle between a direction of contact and film beside its foot above which another part of that film is
/// nearer, for a node beside an edge or a corner.
const LEANING: f64 = 0.05;

/// Share of the allowed distance before the step that two parts need which were not over each other: for less the side
/// on which they are is that of round-off.
const CERTAIN: f64 = 0.25;

/// Share of the allowed distance below which the side of a node that has come over a triangle is that of the one before.
const DOUBTFUL: f64 = 0.5;

/// Least area of a triangle over the square of its longest side for which it has a normal.
const NARROW: f64 = 1e-6;

/// What a pair is in a step.
struct Looked {
    /// As of [`Known`], before the step.
    sign: f64,
    /// Least possible distance at the predicted positions, m.
    apart: f64,
    /// The points whose distance is kept.
    close: Option<Pair>,
}

impl SelfContact {
    /// Looks at the pairs at the places.
    pub(in crate::engine::film_contact) fn detect(&self, step: Step<'_>, found: &mut Found) {
        let Found { places, spared, close: all_close, changed, .. } = found;
        for (entry, place) in places.iter().enumerate() {
            let at = *place as usize;
            let pair = self.state.pairs.known(at);
            let Looked { sign, apart, close } = match pair.parts {
                Parts::Node { node, triangle } => self.node(step, &pair, node, triangle),
                Parts::Edges(edges) => self.edges(step, &pair, edges),
            };
            // Twice what a pair of two faces is spared: the distance is that of the parts themselves, whatever they do.
            spared.push(2.0 * due::spared(one(apart - pair.bound - step.margins[1]))[0]);
            // Decided anew when it is looked at again: edges may turn meanwhile.
            let sign = if spared[entry] > 0.0 { 0.0 } else { sign };
            let close = close.map(|close| Pair { bound: self.allowed(step, at, &close), ..close });
            let bound = close.as_ref().map_or(pair.bound, |close| close.bound);
            if [sign, bound] != [pair.sign, pair.bound] {
                changed.push((*place, [sign, bound]));
            }
            if let Some(close) =
                close.filter(|close| close.distance < self.state.pairs.pairs.limit(at, bound + step.margins[0]))
            {
                all_close.push((entry, close));
            }
        }
    }

    /// Takes over signs and least allowed distances (m) that have changed, with the places of their pairs.
    pub(in crate::engine::film_contact) fn follow(&mut self, changed: &[(u32, [f64; 2])]) {
        for (place, [sign, bound]) in changed {
            let Pairs { sign: signs, bound: bounds, .. } = &mut self.state.pairs.pairs;
            (signs[*place as usize], bounds[*place as usize]) = (*sign, *bound);
        }
    }

    /// Gives the pair at `place` up: its side is decided anew.
    pub(in crate::engine::film_contact) fn lose(&mut self, place: usize) {
        self.state.pairs.pairs.sign[place] = 0.0;
    }

    /// Distance (m) that the points of the pair at `place` may not come closer than. Points that did not touch before and
    /// are found too close, as beside a new tear, are kept from coming closer, but not pushed apart until they are as far
    /// as any.
    fn allowed(&self, step: Step<'_>, place: usize, close: &Pair) -> f64 {
        let whole = self.state.pairs.whole[place];
        let before = close.before(step.nodes, step.dt);
        if before >= whole {
            whole
        } else if self.state.pairs.pairs.carried[place] == NONE {
            close.bound.min(before.max(LEAST * whole))
        } else {
            close.bound
        }
    }

    /// A node and a triangle.
    fn node(&self, step: Step<'_>, pair: &Known, node: u32, triangle: u32) -> Looked {
        let Step { surface, nodes, .. } = step;
        let corners = surface.corners[triangle as usize];
        let now = surface.corners_at(&nodes.position, triangle);
        let before = surface.corners_at(&self.start, triangle);
        let (point, old) = (place(&nodes.position, node as usize), place(&self.start, node as usize));
        if is_narrow(&now) || is_narrow(&before) {
            return Looked { sign: 0.0, apart: 0.0, close: None };
        }
        let (weights_before, feature) = on_triangle(&old, &before);
        let (over, _, height) = project(surface, &self.start, &old, triangle);
        let was_over = is_inside(&over);
        let sign = match (was_over, pair.sign != 0.0) {
            (true, true) => pair.sign,
            (true, false) => self.side_from_neighbours(step, pair, [node, triangle], height),
            (false, _) => 0.0,
        };
        let (weights, normal, distance) = project(surface, &nodes.position, &point, triangle);
        let is_over = is_inside(&weights);
        let apart = if is_over { distance.abs() } else { distance_to_triangle(&point, &now) };
        if !was_over {
            let close = self.beside(step, [node, triangle], (weights_before, feature), (&old, &before), pair.bound);
            if close.is_some() {
                return Looked { sign, apart, close };
            }
        }
        let side = if sign == 0.0 { 1.0_f64.copysign(height) } else { sign };
        // Over the edge by which it leaves the triangle in the step, as long as it is over no other: above a ridge.
        let [a, b, c] = if is_over { weights } else { on_triangle(&point, &now).0 };
        let close = Pair {
            nodes: [node, corners[0], corners[1], corners[2]],
            weights: [1.0, -a, -b, -c],
            normal: normal * side,
            distance: side * distance,
            bound: pair.bound,
        };
        let is_usable = (is_over || (was_over && apart < pair.bound + distance.abs()))
            && is_certain(step, sign, &close)
            && !self.is_over_other(step, &point, triangle, &weights);
        Looked { sign, apart, close: is_usable.then_some(close) }
    }

    /// The side of a node that has come over a triangle at this `height` (m): where it is hardly above or below, that on
    /// which it was of the triangle next to this one.
    fn side_from_neighbours(&self, step: Step<'_>, pair: &Known, [node, triangle]: [u32; 2], height: f64) -> f64 {
        let own = 1.0_f64.copysign(height);
        if height.abs() >= DOUBTFUL * pair.bound {
            return own;
        }
        let normal = normal_of(step.surface, &self.start, triangle);
        let known = step.surface.across[triangle as usize].into_iter().filter_map(|other| {
            // Past a sharp fold the film turns its other side to the node.
            if other == NONE || normal_of(step.surface, &self.start, other).dot(&normal) < 0.0 {
                return None;
            }
            let place = self.state.pairs.place(Parts::Node { node, triangle: other })?;
            let sign = self.state.pairs.pairs.sign[place];
            (sign != 0.0).then_some(sign)
        });
        known.into_iter().next().unwrap_or(own)
    }

    /// Whether a point at the edge of a triangle over which it has these weights, or beyond, is over the next one, which
    /// then has its distance.
    fn is_over_other(&self, step: Step<'_>, point: &Vector3<f64>, triangle: u32, weights: &[f64; 3]) -> bool {
        let is_beyond = !is_inside(weights);
        (0..3).any(|k| {
            let other = step.surface.across[triangle as usize][k];
            // Where both claim it the one with the smaller number.
            let may_leave = if is_beyond { weights[k] < 0.0 } else { weights[k] < BESIDE && other < triangle };
            may_leave && other != NONE && is_inside(&project(step.surface, &step.nodes.position, point, other).0)
        })
    }

    /// The points of a node and of the part of a triangle beside which it was before the step.
    fn beside(
        &self,
        step: Step<'_>,
        [node, triangle]: [u32; 2],
        (weights, feature): ([f64; 3], Feature),
        (old, before): (&Vector3<f64>, &[Vector3<f64>; 3]),
        bound: f64,
    ) -> Option<Pair> {
        let Step { surface, nodes, .. } = step;
        let corners = surface.corners[triangle as usize];
        let foot = at(weights, before);
        let apart = old - foot;
        let distance = apart.norm();
        if distance < 1e-3 * bound {
            return None;
        }
        let direction = apart / distance;
        // One pair of points for all triangles around them, and only where no other part of the film is nearer.
        let is_nearest = match feature {
            Feature::Inside => false,
            Feature::Edge(k) => {
                let edge = surface.edges_of[triangle as usize][k];
                self.topology.triangles_at(edge).all(|other| {
                    other == triangle
                        || (triangle < other && {
                            let (weights, ..) = project(surface, &self.start, old, other);
                            (0..3).any(|l| surface.edges_of[other as usize][l] == edge && weights[l] <= 0.0)
                        })
                })
            }
            Feature::Corner(k) => {
                let corner = corners[k];
                node < corner
                    && self.topology.triangle_of(corner) == triangle
                    && self.faces_away(surface, corner, &-direction)
            }
        };
        if !is_nearest || !self.faces_away(surface, node, &direction) {
            return None;
        }
        let [a, b, c] = weights;
        let now = surface.corners_at(&nodes.position, triangle);
        let distance = (place(&nodes.position, node as usize) - at(weights, &now)).dot(&direction);
        Some(Pair {
            nodes: [node, corners[0], corners[1], corners[2]],
            weights: [1.0, -a, -b, -c],
            normal: direction,
            distance,
            bound,
        })
    }

    /// Whether no edge of a node leads back along `direction`, towards what lies there: that other film is nearer to the
    /// node than to its edges.
    fn faces_away(&self, surface: &Surface, node: u32, direction: &Vector3<f64>) -> bool {
        let from = place(&self.start, node as usize);
        let leads_away = |edge: &u32| {
            let [a, b] = surface.edges[*edge as usize];
            let along = place(&self.start, if a == node { b } else { a } as usize) - from;
            along.dot(direction) >= -LEANING * along.norm()
        };
        let intact = |edge: &&u32| surface.is_intact_edge[**edge as usize];
        surface.edges_at(node).iter().filter(intact).all(leads_away)
    }

    /// Two edges.
    fn edges(&self, step: Step<'_>, pair: &Known, edges: [u32; 2]) -> Looked {
        let Step { surface, nodes, .. } = step;
        let ends = [surface.edges[edges[0] as usize], surface.edges[edges[1] as usize]];
        let before = Lines::new(surface, &self.start, edges);
        let now = Lines::new(surface, &nodes.position, edges);
        let (one, other) = (surface.ends_at(&nodes.position, edges[0]), surface.ends_at(&nodes.position, edges[1]));
        let apart = || distance_of_segments(&one, &other);
        // Nor where they turn over each other in the step: the direction between them is reversed by that.
        let is_steady = |(before, now): &(Lines, Lines)| before.normal.dot(&now.normal) > 0.0;
        let Some((before, now)) = before.zip(now).filter(is_steady) else {
            return Looked { sign: 0.0, apart: apart(), close: None };
        };
        let crossed = before.are_across();
        let sign = match (crossed, pair.sign != 0.0) {
            (true, true) => pair.sign,
            (true, false) => 1.0_f64.copysign(before.distance),
            (false, _) => 0.0,
        };
        if !now.are_across() {
            return Looked { sign, apart: apart(), close: None };
        }
        let side = if sign == 0.0 { 1.0_f64.copysign(before.distance) } else { sign };
        let [s, t] = now.shares;
        let [[a, b], [c, d]] = ends;
        let close = Pair {
            nodes: [a, b, c, d],
            weights: [1.0 - s, s, t - 1.0, -t],
            normal: now.normal * side,
            distance: side * now.distance,
            bound: pair.bound,
        };
        let is_usable = is_certain(step, sign, &close);
        Looked { sign, apart: now.distance.abs(), close: is_usable.then_some(close) }
    }
}

/// The lines of two edges.
struct Lines {
    /// Where they are next to each other, over the length of each edge.
    shares: [f64; 2],
    /// Unit vector along the product of the first and the second.
    normal: Vector3<f64>,
    /// Of the first from the second along it, m.
    distance: f64,
}

impl Lines {
    /// None where they are parallel.
    fn new(surface: &Surface, position: &Vectors, edges: [u32; 2]) -> Option<Lines> {
        let ([a, b], [c, d]) = (surface.ends_at(position, edges[0]), surface.ends_at(position, edges[1]));
        let (e, f, w) = (b - a, d - c, a - c);
        let across = e.cross(&f);
        let (squared, ee, ff) = (across.norm_squared(), e.norm_squared(), f.norm_squared());
        // Edges whose length is not a number are left out, too.
        if squared.is_nan() || squared <= PARALLEL * ee * ff {
            return None;
        }
        let shares = [f.cross(&w).dot(&across) / squared, e.cross(&w).dot(&across) / squared];
        let length = squared.sqrt();
        let normal = across / length;
        Some(Lines { shares, normal, distance: w.dot(&normal) })
    }

    /// Whether the edges themselves cross in projection.
    fn are_across(&self) -> bool {
        let [s, t] = self.shares;
        (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t)
    }
}

/// Whether two points may have a constraint: a side that was not known before the step needs a distance then.
fn is_certain(step: Step<'_>, sign: f64, close: &Pair) -> bool {
    sign != 0.0 || close.before(step.nodes, step.dt) >= CERTAIN * close.bound
}

#[inline(always)]
fn is_inside([a, b, c]: &[f64; 3]) -> bool {
    *a >= -BESIDE && *b >= -BESIDE && *c >= -BESIDE
}

/// Whether a triangle has hardly any area, and so no normal.
fn is_narrow([a, b, c]: &[Vector3<f64>; 3]) -> bool {
    let longest = (b - a).norm_squared().max((c - b).norm_squared()).max((a - c).norm_squared());
    let area = (b - a).cross(&(c - a)).norm();
    // What is not a number counts as narrow.
    area.is_nan() || area <= NARROW * longest
}

/// Distance of the parts of a pair, m, where they are over or across each other on the side on which they belong.
pub(super) fn signed_distance(surface: &Surface, position: &Vectors, pair: &Known) -> f64 {
    let on_side = match pair.parts {
        _ if pair.sign == 0.0 => None,
        Parts::Node { node, triangle } => {
            let is_narrow = is_narrow(&surface.corners_at(position, triangle));
            let (weights, _, distance) = project(surface, position, &place(position, node as usize), triangle);
            (!is_narrow && is_inside(&weights)).then_some(pair.sign * distance)
        }
        Parts::Edges(edges) => {
            let lines = Lines::new(surface, position, edges).filter(Lines::are_across);
            lines.map(|lines| pair.sign * lines.distance)
        }
    };
    on_side.unwrap_or_else(|| distance(surface, position, pair.parts))
}

/// Distance of two parts, m.
pub(super) fn distance(surface: &Surface, position: &Vectors, parts: Parts) -> f64 {
    match parts {
        Parts::Node { node, triangle } => {
            distance_to_triangle(&place(position, node as usize), &surface.corners_at(position, triangle))
        }
        Parts::Edges([one, other]) => {
            distance_of_segments(&surface.ends_at(position, one), &surface.ends_at(position, other))
        }
    }
}

/// Distance of two parts, m, if it is less than `reach` (m).
pub(super) fn distance_within(surface: &Surface, position: &Vectors, parts: Parts, reach: f64) -> Option<f64> {
    // Most are farther apart along an axis already.
    let is_apart = match parts {
        Parts::Node { node, triangle } => {
            let (p, [a, b, c]) = (place(position, node as usize), surface.corners_at(position, triangle));
            (0..3).any(|k| p[k] > a[k].max(b[k]).max(c[k]) + reach || p[k] < a[k].min(b[k]).min(c[k]) - reach)
        }
        Parts::Edges([one, other]) => {
            let ([a, b], [c, d]) = (surface.ends_at(position, one), surface.ends_at(position, other));
            (0..3).any(|k| a[k].min(b[k]) > c[k].max(d[k]) + reach || c[k].min(d[k]) > a[k].max(b[k]) + reach)
        }
    };
    if is_apart {
        return None;
    }
    Some(distance(surface, position, parts)).filter(|distance| *distance < reach)
}
