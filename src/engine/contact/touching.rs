//! Nodes that would be inside: found, and given their momentum, piece by piece of the neighbour list.

use nalgebra::{Isometry3, Point3, Vector3};

use super::Impulse;
use super::search::{Surface, Touch};
use super::tally::Tally;
use crate::engine::nodes::{Met, Nodes};
use crate::engine::rigid_body::{Gathered, RigidBody};
use crate::engine::team::Disjoint;
use crate::lane::at_width;

/// A node that would be inside.
struct Constraint {
    node: usize,
    normal: Vector3<f64>,
    /// Normal velocity that it lacks, m/s.
    lack: f64,
    /// From the body's centre of mass, m.
    arm: Vector3<f64>,
    /// Tangential velocity over the surface, m/s.
    slip: Vector3<f64>,
}

/// What was found at the nodes of one piece of the neighbour list.
#[derive(Default)]
pub(super) struct Piece {
    touching: Vec<Constraint>,
    gathered: Gathered,
    pub(super) impulses: Vec<Impulse>,
    pub(super) tally: Tally,
    /// Square of the largest speed after contact, m²/s².
    pub(super) fastest: f64,
}

/// What it takes to look at nodes.
pub(super) struct Looking<'a> {
    pub(super) surface: &'a Surface,
    pub(super) friction: f64,
    pub(super) multiplicity: f64,
    pub(super) offset: &'a [f64],
    /// Where the surface's normals go, where they are asked for.
    pub(super) normals: Option<Disjoint<'a, Vector3<f64>>>,
    pub(super) nodes: &'a Nodes,
    pub(super) body: &'a RigidBody,
    /// Of the body at the end of the step.
    pub(super) pose: Isometry3<f64>,
    /// One over the time step, 1/s.
    pub(super) per_second: f64,
}

/// What it takes to give nodes their momentum.
pub(super) struct Giving<'a> {
    pub(super) friction: f64,
    /// Velocities half a step earlier, m/s.
    pub(super) earlier: &'a [Vector3<f64>],
    pub(super) nodes: Met<'a>,
    pub(super) body: &'a RigidBody,
    pub(super) ahead: &'a RigidBody,
    /// s.
    pub(super) dt: f64,
}

impl Piece {
    /// Whether a node touches.
    pub(super) fn is_touched(&self) -> bool {
        !self.touching.is_empty()
    }

    /// The film that touches, as the body feels it.
    pub(super) fn gathered(&self) -> &Gathered {
        &self.gathered
    }
}

at_width! {
    /// Finds those of the nodes `near` that lie inside, each listed once.
    pub(super) fn find[](at: &Looking<'_>, near: &[u32], piece: &mut Piece) = find_lanewise
}

#[inline(always)]
fn find_lanewise(at: &Looking<'_>, near: &[u32], piece: &mut Piece) {
    piece.touching.clear();
    piece.gathered = Gathered::default();
    let centre = Point3::from(at.pose.translation.vector);
    for n in near.iter().map(|n| *n as usize) {
        let point = at.nodes.place(n);
        let reach = at.surface.reach() + at.offset[n];
        if nalgebra::distance_squared(&point, &centre) > reach * reach {
            continue;
        }
        let Touch { gap, normal } = at.surface.touch(&at.pose, &point);
        if let Some(normals) = &at.normals {
            // SAFETY: a node is listed once.
            unsafe { *normals.at(n) = normal };
        }
        let gap = gap - at.offset[n];
        if gap < 0.0 && !at.nodes.is_held(n) {
            let arm = point - centre;
            let relative = at.nodes.velocity_of(n) - at.body.velocity_at(&arm);
            let slip = relative - normal * relative.dot(&normal);
            let lack = -gap * at.per_second;
            let (tangential, sticks) = stopping(&slip, at.friction * lack);
            let along = if sticks { None } else { Some(&normal) };
            let mass = at.multiplicity * at.nodes.mass[n];
            at.body.gather(&mut piece.gathered, &arm, mass, along, &((normal * lack + tangential) * mass));
            piece.touching.push(Constraint { node: n, normal, lack, arm, slip });
        }
    }
}

at_width! {
    /// Gives the touching nodes of a piece the momentum with which they follow the body.
    pub(super) fn give[](at: &Giving<'_>, piece: &mut Piece) = give_lanewise
}

#[inline(always)]
fn give_lanewise(at: &Giving<'_>, piece: &mut Piece) {
    let Piece { touching, impulses, tally, fastest, .. } = piece;
    impulses.clear();
    (*tally, *fastest) = (Tally::default(), 0.0);
    for constraint in &*touching {
        let mass = at.nodes.mass(constraint.node);
        let Some(impulse) = node_impulse(constraint, mass, at.ahead, at.body, at.friction) else { continue };
        // SAFETY: a node is listed once.
        let after = unsafe { at.nodes.push(impulse.node, &impulse.total(), at.dt) };
        *fastest = fastest.max(after.norm_squared());
        tally.add(&impulse, &(0.5 * (after + at.earlier[impulse.node])));
        impulses.push(impulse);
    }
}

/// The change of tangential velocity by which friction stops `slip`, as far as `bound` (m/s) allows, and whether it does.
#[inline(always)]
fn stopping(slip: &Vector3<f64>, bound: f64) -> (Vector3<f64>, bool) {
    let squared = slip.norm_squared();
    if squared <= bound * bound { (-slip, true) } else { (-slip * (bound / squared.sqrt()), false) }
}

/// What a touching node gets when the body moves on as `ahead`; `None` where the body leaves it.
#[inline(always)]
fn node_impulse(c: &Constraint, mass: f64, ahead: &RigidBody, body: &RigidBody, friction: f64) -> Option<Impulse> {
    let change = ahead.velocity_at(&c.arm) - body.velocity_at(&c.arm);
    let away = c.normal.dot(&change);
    let lack = c.lack + away;
    if lack <= 0.0 {
        return None;
    }
    let (tangential, _) = stopping(&(c.slip - change + c.normal * away), friction * lack);
    Some(Impulse { node: c.node, arm: c.arm, normal: c.normal * (lack * mass), tangential: tangential * mass })
}
