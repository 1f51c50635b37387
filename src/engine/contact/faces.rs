//! Faces that reach into the impactor between their nodes.

use nalgebra::{Isometry3, Point3, Vector3};

use super::search::FaceTouch;
use super::{Contact, Impulse};
use crate::engine::nodes::Nodes;
use crate::engine::rigid_body::RigidBody;

/// Penetration of a face between its nodes that is left alone, over the impactor's size: a little less than what is
/// warned of.
pub(super) const FACE_BOUND: f64 = 0.008;

/// Share of a penetration beyond the bound that is taken back in one step: a face that comes to be listed while it is
/// too deep is eased out instead of thrown out.
const FACE_RECOVERY: f64 = 0.02;

/// Sweeps over the faces in a step.
const FACE_SWEEPS: usize = 8;

/// The deepest point of a triangle of film and what keeps it from going deeper.
struct FacePoint {
    nodes: [usize; 3],
    weights: [f64; 3],
    normal: Vector3<f64>,
    arm: Vector3<f64>,
    /// Normal velocity per impulse, 1/kg.
    compliance: f64,
    /// Least normal velocity, m/s.
    target: f64,
    /// Normal impulse so far, N s.
    pushed: f64,
}

impl FacePoint {
    fn relative_velocity(&self, nodes: &Nodes, body: &RigidBody) -> Vector3<f64> {
        let film: Vector3<f64> = (0..3).map(|a| nodes.velocity_of(self.nodes[a]) * self.weights[a]).sum();
        film - body.velocity_at(&self.arm)
    }

    /// Gives `impulse` (N s) to the film and takes it from the body.
    fn spread(&self, impulse: Vector3<f64>, nodes: &mut Nodes, body: &mut RigidBody, multiplicity: f64) {
        for (n, weight) in self.nodes.iter().zip(self.weights) {
            for axis in 0..3 {
                nodes.velocity[*n][axis] += weight * impulse[axis] * nodes.inverse_mass[*n][axis];
            }
        }
        body.push(&(-multiplicity * impulse), &self.arm);
    }
}

impl Contact {
    /// Lets no listed triangle reach deeper than [`FACE_BOUND`]: Gauss–Seidel sweeps over the deepest point of each, with
    /// impulses that may shrink again but not pull (theory.md, section 6).
    pub(super) fn meet_faces(&mut self, nodes: &mut Nodes, body: &mut RigidBody, dt: f64) {
        if self.near.faces.is_empty() {
            return;
        }
        let pose = body.predicted(dt);
        let listed = self.near.faces.iter();
        let mut points: Vec<FacePoint> = listed.filter_map(|f| self.face_point(*f, nodes, body, &pose, dt)).collect();
        for _ in 0..FACE_SWEEPS {
            for point in &mut points {
                let lack = point.target - point.relative_velocity(nodes, body).dot(&point.normal);
                let pushed = (point.pushed + lack / point.compliance).max(0.0);
                let impulse = point.normal * (pushed - point.pushed);
                point.pushed = pushed;
                point.spread(impulse, nodes, body, self.multiplicity);
            }
        }
        for point in points.iter().filter(|p| p.pushed > 0.0) {
            let relative = point.relative_velocity(nodes, body);
            let slip = relative - point.normal * relative.dot(&point.normal);
            let stick = slip.norm() / point.compliance;
            let share = if stick > 0.0 { (self.friction * point.pushed / stick).min(1.0) } else { 0.0 };
            let tangential = -slip * (share / point.compliance);
            point.spread(tangential, nodes, body, self.multiplicity);
            for a in 0..3 {
                let normal = point.normal * (point.pushed * point.weights[a]);
                let tangential = tangential * point.weights[a];
                self.impulses.push(Impulse { node: point.nodes[a], arm: point.arm, normal, tangential });
            }
        }
    }

    /// The deepest point of a triangle, if it is near the bound.
    fn face_point(
        &self,
        face: [u32; 3],
        nodes: &Nodes,
        body: &RigidBody,
        pose: &Isometry3<f64>,
        dt: f64,
    ) -> Option<FacePoint> {
        let face = face.map(|n| n as usize);
        let allowed = FACE_BOUND * self.surface.size();
        let corners = face.map(|n| Point3::from(nodes.position[n]) + nodes.velocity_of(n) * dt);
        let bound = self.offset[face[0]] - allowed;
        let FaceTouch { touch, weights } = self.surface.deepest(pose, &corners, bound + allowed)?;
        let place: Vector3<f64> = (0..3).map(|a| corners[a].coords * weights[a]).sum();
        let arm = place - pose.translation.vector;
        let softness = |a: usize| {
            let w = nodes.inverse_mass[face[a]];
            weights[a] * weights[a] * (0..3).map(|i| touch.normal[i].powi(2) * w[i]).sum::<f64>()
        };
        let compliance = (0..3).map(softness).sum::<f64>() + self.multiplicity * body.mobility(&touch.normal, &arm);
        let mut point =
            FacePoint { nodes: face, weights, normal: touch.normal, arm, compliance, target: 0.0, pushed: 0.0 };
        let to_bound = point.relative_velocity(nodes, body).dot(&touch.normal) + (bound - touch.gap) / dt;
        point.target = if to_bound > 0.0 { FACE_RECOVERY * to_bound } else { to_bound };
        (compliance > 0.0).then_some(point)
    }
}
