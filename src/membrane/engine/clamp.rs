//! A clamp in which film slips (theory.md, equations 73 and 74).

use nalgebra::{Isometry3, Vector3};

use super::contact::Contact;
use super::impact::Impact;
use super::nodes::Nodes;

/// The edge of film in a clamp: nodes that are held until the film pulls at them by more than Coulomb's bound.
pub struct Clamp {
    nodes: Vec<ClampedNode>,
    /// As mounted, m.
    start: Vec<Vector3<f64>>,
    /// Slip at which film has left the clamp, m; infinite where it never does.
    width: f64,
    multiplicity: f64,
    /// Nodes that have left the clamp.
    gone: Vec<bool>,
    /// Motion at the end of the step in hand.
    next: Vec<Moved>,
}

/// A node in a clamp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClampedNode {
    /// Its number, of a node that is held in every direction.
    pub node: usize,
    /// Largest force of friction on it, N.
    pub bound: f64,
    /// Directions in which no mirror plane holds it.
    pub free: [bool; 3],
}

/// Motion of a node: where it is at the end of a step, and its velocity half a step before.
#[derive(Clone, Copy, Debug)]
struct Moved {
    position: Vector3<f64>,
    velocity: Vector3<f64>,
}

/// Report of the clamp on a step.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Clamping {
    /// Dissipated in the half step before the full one, and in that after it, J.
    pub(super) loss: [f64; 2],
    /// Square of the largest speed of a node in it, m²/s².
    pub(super) fastest_squared: f64,
}

impl Clamp {
    /// A clamp of `width` (m) that holds `clamped` nodes, counted for `multiplicity` mirror images.
    pub fn new(clamped: Vec<ClampedNode>, nodes: &Nodes, width: f64, multiplicity: f64) -> Clamp {
        let start = clamped.iter().map(|clamped| nodes.position_of(clamped.node).coords).collect();
        Clamp { gone: vec![false; clamped.len()], nodes: clamped, start, width, multiplicity, next: vec![] }
    }

    /// Finds how its nodes move in a step: they get the forces of the film and their `gravity` (m/s², downward) over
    /// `over` (s), stay on their plane, or on `bars`, and slip by what friction does not stop, over `dt` (s).
    pub(super) fn predict(
        &mut self,
        nodes: &Nodes,
        bars: Option<&Impact>,
        gravity: &dyn Fn(usize) -> f64,
        [over, dt]: [f64; 2],
    ) -> Clamping {
        let mut sums = Clamping::default();
        self.next.clear();
        for (clamped, gone) in self.nodes.iter().zip(&self.gone) {
            let (n, at, before) = (clamped.node, nodes.position_of(clamped.node), nodes.velocity_of(clamped.node));
            let (mut position, mut velocity) = (at.coords, Vector3::zeros());
            if !gone {
                let force = Vector3::from(nodes.force.value_at(n)) - Vector3::z() * (nodes.mass[n] * gravity(n));
                // As a free node would move: a mirror plane through the node takes its part before friction is asked
                // for any.
                let pulled = clamped.free_part(&(before + force * (over / nodes.mass[n])));
                let normal = bars.map_or(Vector3::z(), |bars| on_bars(bars, n, &position).1);
                let along = pulled - normal * pulled.dot(&normal);
                let (momentum, bound) = (nodes.mass[n] * along.norm(), clamped.bound * over);
                // Else velocity is exactly zero and the position is not touched: film that does not slip stands still
                // to the bit (theory.md, equation 74).
                if momentum > bound {
                    velocity = along * (1.0 - bound / momentum);
                    position += velocity * dt;
                    if let Some(bars) = bars {
                        let (gap, normal) = on_bars(bars, n, &position);
                        // The step along the tangent leaves a round bar by a second-order gap, of either sign.
                        position -= clamped.free_part(&(normal * gap));
                    }
                }
                // Friction and the support's reaction together: the reaction does no work along the plane.
                let impulse = nodes.mass[n] * (velocity - pulled);
                let half = |velocity: &Vector3<f64>| -0.5 * self.multiplicity * impulse.dot(velocity);
                sums.loss[0] += half(&before);
                sums.loss[1] += half(&velocity);
                sums.fastest_squared = sums.fastest_squared.max(velocity.norm_squared());
            }
            self.next.push(Moved { position, velocity });
        }
        sums
    }

    /// Moves its nodes as predicted, after all others, and lets go of those that have left it. Returns whether there
    /// are any.
    pub(super) fn advance(&mut self, nodes: &mut Nodes) -> bool {
        let mut any = false;
        for (k, clamped) in self.nodes.iter().enumerate() {
            if self.gone[k] {
                continue;
            }
            let Moved { position, velocity } = self.next[k];
            nodes.velocity.set(clamped.node, velocity.into());
            nodes.position.set(clamped.node, position.into());
            if (position - self.start[k]).norm_squared() >= self.width * self.width {
                (self.gone[k], any) = (true, true);
                nodes.release(clamped.node, clamped.free);
            }
        }
        any
    }

    /// Largest slip of a node, m; of one that has left the clamp its width.
    pub(super) fn slip(&self, nodes: &Nodes) -> f64 {
        let of_node = |(k, clamped): (usize, &ClampedNode)| {
            let moved = (nodes.position_of(clamped.node).coords - self.start[k]).norm();
            if self.gone[k] { self.width } else { moved }
        };
        self.nodes.iter().enumerate().map(of_node).fold(0.0, f64::max)
    }

    /// Share of its force that holds film no longer.
    pub(super) fn gone(&self) -> f64 {
        let all: f64 = self.nodes.iter().map(|clamped| clamped.bound).sum();
        let gone = self.nodes.iter().zip(&self.gone).filter(|(_, gone)| **gone);
        gone.map(|(clamped, _)| clamped.bound).sum::<f64>() / all
    }

    /// Which of its nodes have left it: its state from step to step.
    pub(super) fn save(&self) -> Vec<bool> {
        self.gone.clone()
    }

    /// Restores its state, of as many nodes.
    pub(super) fn restore(&mut self, gone: Vec<bool>, nodes: &mut Nodes) {
        self.gone = gone;
        for (clamped, _) in self.nodes.iter().zip(&self.gone).filter(|(_, gone)| **gone) {
            nodes.release(clamped.node, clamped.free);
        }
    }

    /// Number of its nodes.
    pub(super) fn len(&self) -> usize {
        self.nodes.len()
    }
}

impl ClampedNode {
    /// The part of a vector along directions in which no mirror plane holds the node.
    fn free_part(&self, vector: &Vector3<f64>) -> Vector3<f64> {
        Vector3::from_fn(|axis, _| if self.free[axis] { vector[axis] } else { 0.0 })
    }
}

/// Gap between a node at `position` (m) and the bars, m, and their normal there.
fn on_bars(bars: &Impact, node: usize, position: &Vector3<f64>) -> (f64, Vector3<f64>) {
    let Impact { body, contact, .. } = bars;
    let pose: &Isometry3<f64> = &body.pose;
    Contact::gap_at(contact, &(*position).into(), pose, node)
}
