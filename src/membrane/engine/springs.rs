//! Springs between the edge of film and its frame (theory.md, section 29).

use std::ops::Range;

use nalgebra::{Point3, Vector3};

use super::nodes::Nodes;

/// Shortening over the length at rest below which a spring counts as one without force: round-off.
const ROUND_OFF: f64 = 1e-6;

/// Linear springs without mass between the edge of film and its frame, all of one stiffness; slack where they are shorter
/// than without force.
pub struct Springs {
    springs: Vec<Spring>,
    /// Of one spring, N/m.
    stiffness: f64,
    multiplicity: f64,
    /// On the film in the last pass over the forces, one of each spring, N.
    forces: Vec<Vector3<f64>>,
}

/// A spring between two nodes of an edge of film and the frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spring {
    /// Nodes of the edge.
    pub nodes: [usize; 2],
    /// Shares of its force that they get; their sum is one. Its end is at the mean of their positions with these weights.
    pub shares: [f64; 2],
    /// Its end on the frame, m.
    pub anchor: Point3<f64>,
    /// Length without force, m.
    pub unstretched: f64,
}

/// Load of one spring at a full step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringLoad {
    /// m.
    pub elongation: f64,
    /// N; positive in tension.
    pub force: f64,
}

/// State of the springs at a full step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringsState {
    /// Largest elongation of a spring, m.
    pub elongation: f64,
    /// Largest force of one spring, N.
    pub force: f64,
    /// Share of the springs that are slack.
    pub slack: f64,
}

impl Springs {
    /// Springs of one `stiffness` (N/m), counted for `multiplicity` mirror images.
    pub fn new(springs: Vec<Spring>, stiffness: f64, multiplicity: f64) -> Springs {
        Springs { springs, stiffness, multiplicity, forces: vec![] }
    }

    /// The springs, in the order of their numbers.
    pub fn springs(&self) -> &[Spring] {
        &self.springs
    }

    /// Force at an `elongation` (m), N (theory.md, equation 341).
    fn force(&self, elongation: f64) -> f64 {
        if elongation > 0.0 { self.stiffness * elongation } else { 0.0 }
    }

    /// Bound on the squared angular frequency of the edge on the springs alone, with the mass of `nodes`, rad²/s²
    /// (theory.md, equation 344).
    pub(super) fn squared_frequency(&self, nodes: &Nodes) -> f64 {
        let mut sums = vec![0.0; nodes.mass.len()];
        for spring in &self.springs {
            spring.ends().for_each(|(node, share)| sums[node] += share);
        }
        self.stiffness * sums.iter().zip(&nodes.mass).map(|(sum, mass)| sum / mass).fold(0.0, f64::max)
    }

    /// Adds their forces to those of the `nodes`.
    pub(super) fn add_forces(&mut self, nodes: &mut Nodes) {
        self.forces.clear();
        for spring in &self.springs {
            let Stretched { direction, elongation } = spring.stretched(nodes);
            let force = direction * self.force(elongation);
            for (node, share) in spring.ends() {
                nodes.force.set(node, (Vector3::from(nodes.force.value_at(node)) + force * share).into());
            }
            self.forces.push(force);
        }
    }

    /// Energy stored in them, J.
    pub(super) fn stored(&self, nodes: &Nodes) -> f64 {
        let energy = |spring: &Spring| {
            let elongation = spring.stretched(nodes).elongation.max(0.0);
            0.5 * self.stiffness * elongation * elongation
        };
        self.multiplicity * self.springs.iter().map(energy).sum::<f64>()
    }

    /// Force that the springs of these numbers have on the frame in the last pass along an axis, N, without mirror images.
    pub fn frame_force(&self, numbers: impl IntoIterator<Item = usize>, axis: usize) -> f64 {
        numbers.into_iter().filter_map(|number| self.forces.get(number)).map(|force| -force[axis]).sum()
    }

    /// Vertical force of the whole film on the frame in the last pass, N, positive downwards.
    pub fn vertical_force(&self) -> f64 {
        -self.multiplicity * self.frame_force(0..self.springs.len(), 2)
    }

    /// Sum of squares of the forces on the frame of springs at some nodes, N².
    pub(super) fn squared_forces(&self, nodes: &Range<usize>) -> f64 {
        let of_nodes = self.springs.iter().zip(&self.forces).filter(|(spring, _)| nodes.contains(&spring.nodes[0]));
        of_nodes.map(|(_, force)| force.norm_squared()).sum()
    }

    /// Stiffness of a spring across its own direction over that along it, and the square of its slope, the largest of
    /// any (theory.md, equation 173).
    pub(super) fn vertical_share(&self, nodes: &Nodes) -> f64 {
        let of_spring = |spring: &Spring| {
            let Stretched { direction, elongation } = spring.stretched(nodes);
            let length = spring.unstretched + elongation;
            self.force(elongation) / (length * self.stiffness) + direction.z * direction.z
        };
        self.springs.iter().map(of_spring).fold(0.0, f64::max)
    }

    /// The loads of those at some nodes, in the order of their numbers; their forces are those of the last pass.
    pub fn loads(&self, nodes: &Nodes, at: &Range<usize>) -> Vec<SpringLoad> {
        let load = |(number, spring): (usize, &Spring)| {
            let Stretched { direction, elongation } = spring.stretched(nodes);
            let force = self.forces.get(number).map_or(0.0, |force| force.dot(&direction));
            SpringLoad { elongation, force }
        };
        let all = self.springs.iter().enumerate();
        all.filter(|(_, spring)| at.contains(&spring.nodes[0])).map(load).collect()
    }

    /// Their state.
    pub fn state(&self, nodes: &Nodes) -> SpringsState {
        let mut state = SpringsState { elongation: f64::NEG_INFINITY, force: 0.0, slack: 0.0 };
        for (number, spring) in self.springs.iter().enumerate() {
            let elongation = spring.stretched(nodes).elongation;
            state.elongation = state.elongation.max(elongation);
            state.force = state.force.max(self.forces.get(number).map_or(0.0, Vector3::norm));
            if elongation < -ROUND_OFF * spring.unstretched {
                state.slack += 1.0;
            }
        }
        state.slack /= self.springs.len() as f64;
        state
    }
}

/// A spring at the present positions.
struct Stretched {
    /// From the film to the frame, of length one; zero where both are at one point.
    direction: Vector3<f64>,
    /// m.
    elongation: f64,
}

impl Spring {
    /// Its nodes with their shares.
    fn ends(&self) -> impl Iterator<Item = (usize, f64)> {
        self.nodes.into_iter().zip(self.shares)
    }

    /// Its end on the film, m.
    fn end(&self, nodes: &Nodes) -> Point3<f64> {
        Point3::from(self.ends().map(|(node, share)| nodes.position_of(node).coords * share).sum::<Vector3<f64>>())
    }

    fn stretched(&self, nodes: &Nodes) -> Stretched {
        let along = self.anchor - self.end(nodes);
        let length = along.norm();
        let direction = if length > 0.0 { along / length } else { Vector3::zeros() };
        Stretched { direction, elongation: length - self.unstretched }
    }
}
