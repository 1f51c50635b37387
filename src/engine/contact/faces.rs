//! Faces that reach into the impactor between their nodes.

use nalgebra::{Isometry3, Vector3};

use super::near::NearElement;
use super::tally::Tally;
use super::{Contact, FACE_BOUND, Impulse, WATCHED_FROM};
use crate::engine::nodes::Nodes;
use crate::engine::rigid_body::RigidBody;

/// Share of a penetration beyond the bound that is taken back in one step: a face that comes to be listed while it is
/// too deep is eased out instead of thrown out.
const RECOVERY: f64 = 0.02;

/// Sweeps over all contacts in a step.
const SWEEPS: usize = 10;

/// Change in a sweep over the largest impulse below which the contacts have settled.
const SETTLED: f64 = 1e-3;

/// A point of film that must not go deeper: a node, or the deepest point of an element.
struct Footing {
    nodes: [usize; 4],
    weights: [f64; 4],
    normal: Vector3<f64>,
    arm: Vector3<f64>,
    /// Velocity per impulse, 1/kg.
    compliance: f64,
    /// Least normal velocity over the surface, m/s.
    target: f64,
    /// Normal impulse so far, N s.
    pushed: f64,
    /// Tangential impulse so far, N s.
    dragged: Vector3<f64>,
}

/// What all footings have in common.
struct Sweep {
    multiplicity: f64,
    friction: f64,
    /// s.
    dt: f64,
}

impl Footing {
    fn slip(&self, nodes: &Nodes, body: &RigidBody) -> Vector3<f64> {
        let film = (0..4).filter(|a| self.weights[*a] > 0.0);
        let film: Vector3<f64> = film.map(|a| nodes.velocity_of(self.nodes[a]) * self.weights[a]).sum();
        film - body.velocity_at(&self.arm)
    }

    /// Gives `impulse` (N s) to the film, which moves on by it, and takes it from the body.
    fn spread(&self, impulse: Vector3<f64>, nodes: &mut Nodes, body: &mut RigidBody, sweep: &Sweep) {
        for (n, weight) in self.nodes.iter().zip(self.weights).filter(|(_, weight)| *weight > 0.0) {
            nodes.push(*n, &(impulse * weight), sweep.dt);
        }
        body.push(&(-sweep.multiplicity * impulse), &self.arm);
    }

    /// Brings the point to its least velocity and stops its slip, as far as impulses that only push and the cone of
    /// friction allow. What an earlier sweep gave may shrink again. Returns the size of the change, N s.
    fn settle(&mut self, nodes: &mut Nodes, body: &mut RigidBody, sweep: &Sweep) -> f64 {
        let lack = self.target - self.slip(nodes, body).dot(&self.normal);
        let pushed = (self.pushed + lack / self.compliance).max(0.0);
        let change = pushed - self.pushed;
        self.spread(self.normal * change, nodes, body, sweep);
        self.pushed = pushed;

        let slip = self.slip(nodes, body);
        let along = slip - self.normal * slip.dot(&self.normal);
        let wanted = self.dragged - along / self.compliance;
        let bound = sweep.friction * pushed;
        let dragged = if wanted.norm() <= bound { wanted } else { wanted * (bound / wanted.norm()) };
        let turned = dragged - self.dragged;
        self.spread(turned, nodes, body, sweep);
        self.dragged = dragged;
        change.abs().max(turned.norm())
    }

    fn impulses(self) -> impl Iterator<Item = Impulse> {
        (0..4).filter(move |a| self.weights[*a] > 0.0).map(move |a| Impulse {
            node: self.nodes[a],
            arm: self.arm,
            normal: self.normal * (self.pushed * self.weights[a]),
            tangential: self.dragged * self.weights[a],
        })
    }
}

impl Contact {
    /// Lets no listed element reach deeper than [`FACE_BOUND`]: Gauss–Seidel sweeps over the deepest point of each together
    /// with the nodes that were met (theory.md, section 6).
    /// Whether there was an element to be kept back, so that impulses are others than before.
    pub(super) fn meet_faces(&mut self, nodes: &mut Nodes, body: &mut RigidBody, dt: f64) -> bool {
        if self.near.watched.is_empty() {
            return false;
        }
        let pose = body.predicted(dt);
        let watched = self.near.watched.iter().filter(|element| !self.lies_flat(element));
        let faces: Vec<Footing> =
            watched.filter_map(|element| self.footing(element.corners, nodes, body, &pose, dt)).collect();
        if faces.is_empty() {
            return false;
        }
        let met = self.pieces.iter().flat_map(|piece| &piece.impulses);
        let mut footings: Vec<Footing> = met.map(|met| self.met_node(met, nodes, body)).chain(faces).collect();
        let sweep = Sweep { multiplicity: self.multiplicity, friction: self.friction, dt };
        for _ in 0..SWEEPS {
            let (mut moved, mut largest) = (0.0_f64, 0.0_f64);
            for footing in &mut footings {
                moved = moved.max(footing.settle(nodes, body, &sweep));
                largest = largest.max(footing.pushed);
            }
            if moved <= SETTLED * largest {
                break;
            }
        }
        self.replace_impulses(nodes, footings.into_iter().filter(|f| f.pushed > 0.0).flat_map(Footing::impulses));
        true
    }

    /// Puts other impulses in place of those that nodes were given, several of them perhaps at one node.
    fn replace_impulses(&mut self, nodes: &Nodes, impulses: impl Iterator<Item = Impulse>) {
        for piece in &mut self.pieces {
            piece.impulses.clear();
            (piece.tally, piece.fastest) = (Tally::default(), 0.0);
        }
        let Some(first) = self.pieces.first_mut() else { return };
        for impulse in impulses {
            let after = nodes.velocity_of(impulse.node);
            first.fastest = first.fastest.max(after.norm_squared());
            first.tally.add(&impulse, &(0.5 * (after + Vector3::from(self.earlier.at(impulse.node)))));
            first.impulses.push(impulse);
        }
    }

    /// Whether the surface turns so little between the corners of an element that its sagitta, (longest line) times
    /// angle over 8, stays far from the bound.
    fn lies_flat(&self, element: &NearElement) -> bool {
        let normals = element.corners.map(|n| self.normals[n as usize]);
        let straightest = normals[1..].iter().map(|n| normals[0].dot(n)).fold(normals[1].dot(&normals[3]), f64::min);
        let sagitta = 8.0 * WATCHED_FROM * FACE_BOUND * self.surface.size();
        2.0 * (1.0 - straightest) * element.longest_squared < sagitta * sagitta
    }

    /// A node that was met before the faces are looked at, with what it got.
    fn met_node(&self, met: &Impulse, nodes: &Nodes, body: &RigidBody) -> Footing {
        let pushed = met.normal.norm();
        let normal = met.normal / pushed;
        let mut footing = Footing {
            nodes: [met.node; 4],
            weights: [1.0, 0.0, 0.0, 0.0],
            normal,
            arm: met.arm,
            compliance: 1.0 / nodes.mass[met.node] + self.multiplicity * body.mobility(&normal, &met.arm),
            target: 0.0,
            pushed,
            dragged: met.tangential,
        };
        footing.target = footing.slip(nodes, body).dot(&normal);
        footing
    }

    /// The deepest point of an element, if it would come beyond the bound. An element at the clamped edge has none: it cannot
    /// give way, and the frame behind it is not modelled.
    fn footing(
        &self,
        corners: [u32; 4],
        nodes: &Nodes,
        body: &RigidBody,
        pose: &Isometry3<f64>,
        dt: f64,
    ) -> Option<Footing> {
        let corners = corners.map(|n| n as usize);
        if corners.iter().any(|n| nodes.is_held(*n)) {
            return None;
        }
        let places = corners.map(|n| nodes.place(n));
        let bound = self.offset[corners[0]] - FACE_BOUND * self.surface.size();
        let found = self.surface.deepest(pose, &places, bound)?;
        let place: Vector3<f64> = (0..4).map(|a| places[a].coords * found.weights[a]).sum();
        let arm = place - pose.translation.vector;
        let normal = found.touch.normal;
        let softness = |a: usize| found.weights[a].powi(2) / nodes.mass[corners[a]];
        let compliance = (0..4).map(softness).sum::<f64>() + self.multiplicity * body.mobility(&normal, &arm);
        let (weights, dragged) = (found.weights, Vector3::zeros());
        let mut footing =
            Footing { nodes: corners, weights, normal, arm, compliance, target: 0.0, pushed: 0.0, dragged };
        let to_bound = footing.slip(nodes, body).dot(&normal) + (bound - found.touch.gap) / dt;
        footing.target = if to_bound > 0.0 { RECOVERY * to_bound } else { to_bound };
        Some(footing)
    }
}
