//! Springs between the edge of film and its frame (theory.md, section 29).

use std::ops::Range;

use nalgebra::{Point3, Vector3};

use super::nodes::Nodes;
use super::spring_law::SpringLaw;

/// Share of a spring's mass that moves with its end: its other end is at rest, and its velocity is linear between them
/// (Rayleigh 1877, section 156).
const MOVING: f64 = 1.0 / 3.0;

/// Shortening over the length at rest below which a spring counts as one without force: round-off.
const ROUND_OFF: f64 = 1e-6;

/// Length over that without force below which a spring that pushes resists across itself by more than its stiffness.
const SHORTEST: f64 = 0.5;

/// Springs between the edge of film and its frame, all of one law.
pub struct Springs {
    springs: Vec<Spring>,
    law: SpringLaw,
    /// Of one spring, N s/m.
    damping: f64,
    /// Of one spring, kg.
    mass: f64,
    multiplicity: f64,
    /// Of the last pass over the forces, one entry a spring.
    passed: Vec<Passed>,
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
    /// Number of springs that it stands for, all alike; a share of one in a continuous support.
    pub count: f64,
}

/// A spring in the last pass over the forces.
#[derive(Clone, Copy, Debug)]
struct Passed {
    /// Force on the film, N.
    force: Vector3<f64>,
    /// The part of its dashpot, N.
    damping: Vector3<f64>,
    /// Velocity of its end half a step before, m/s.
    velocity: Vector3<f64>,
}

/// Load of one spring at a full step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringLoad {
    /// m.
    pub elongation: f64,
    /// Of one spring, with that of its dashpot, N; positive in tension.
    pub force: f64,
    /// Number of springs that it stands for ([`Spring::count`]).
    pub count: f64,
}

/// State of the springs at a full step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringsState {
    /// Largest elongation of a spring, m.
    pub elongation: f64,
    /// Largest force of one spring, with that of its dashpot, N.
    pub force: f64,
    /// Share of the springs that are slack; zero where they push.
    pub slack: f64,
    /// Largest elongation over that at which their curve ends, where any is beyond it.
    pub beyond: Option<f64>,
    /// Least length of a spring that pushes over its length without force, where any is shorter than half of that.
    pub collapsed: Option<f64>,
}

/// Bounds on the springs for the stable time step (theory.md, equation 344).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Support {
    /// Of the squared angular frequency of the edge on the springs alone, rad²/s².
    pub(super) squared_frequency: f64,
    /// Of the rate of its dashpots, 1/s.
    pub(super) rate: f64,
}

impl Springs {
    /// Springs of one `law` with a dashpot of `damping` (N s/m) and a `mass` (kg) each, counted for `multiplicity` mirror
    /// images.
    pub fn new(springs: Vec<Spring>, law: SpringLaw, [damping, mass]: [f64; 2], multiplicity: f64) -> Springs {
        Springs { springs, law, damping, mass, multiplicity, passed: vec![] }
    }

    /// The springs, in the order of their numbers.
    pub fn springs(&self) -> &[Spring] {
        &self.springs
    }

    /// Adds the mass that moves with their ends to the nodes.
    pub(super) fn add_mass(&self, nodes: &mut Nodes) {
        for spring in &self.springs {
            for (node, share) in spring.ends().filter(|(_, share)| *share > 0.0) {
                nodes.add_mass(node, MOVING * self.mass * spring.count * share);
            }
        }
    }

    /// Bounds for the stable time step with the mass of `nodes`.
    pub(super) fn support(&self, nodes: &Nodes) -> Support {
        let mut sums = vec![0.0; nodes.mass.len()];
        for spring in &self.springs {
            spring.ends().for_each(|(node, share)| sums[node] += spring.count * share);
        }
        // What one spring of unit stiffness at each end would have.
        let most = sums.iter().zip(&nodes.mass).map(|(sum, mass)| sum / mass).fold(0.0, f64::max);
        Support { squared_frequency: self.law.stiffest() * most, rate: self.damping * most }
    }

    /// Adds their forces to those of the `nodes`; their dashpots act where these `move`, else are at rest.
    pub(super) fn add_forces(&mut self, nodes: &mut Nodes, moves: bool) {
        self.passed.clear();
        for spring in &self.springs {
            let Stretched { direction, elongation } = spring.stretched(nodes);
            let velocity = spring.velocity(nodes);
            let elastic = self.law.force(elongation);
            let is_slack = elongation <= 0.0 && self.law.goes_slack();
            let rate = if moves && !is_slack { -direction.dot(&velocity) } else { 0.0 };
            let tension = elastic + self.damping * rate;
            // What is only pulled cannot be pushed by its dashpot either.
            let tension = if self.law.goes_slack() { tension.max(0.0) } else { tension };
            let force = direction * (spring.count * tension);
            let damping = direction * (spring.count * (tension - elastic));
            for (node, share) in spring.ends() {
                nodes.force.set(node, (Vector3::from(nodes.force.value_at(node)) + force * share).into());
            }
            self.passed.push(Passed { force, damping, velocity });
        }
    }

    /// Energy that their dashpots dissipate in a step whose kick is over `over` (s), J, and the part of it that belongs
    /// to the half step after the full one; `nodes` have the velocities after the kick (theory.md, equation 343).
    pub(super) fn loss(&self, nodes: &Nodes, over: f64) -> [f64; 2] {
        let half =
            |damping: &Vector3<f64>, velocity: &Vector3<f64>| -0.5 * self.multiplicity * over * damping.dot(velocity);
        let mut sums = [0.0; 2];
        for (spring, Passed { damping, velocity, .. }) in self.springs.iter().zip(&self.passed) {
            let ahead = half(damping, &spring.velocity(nodes));
            sums[0] += half(damping, velocity) + ahead;
            sums[1] += ahead;
        }
        sums
    }

    /// Energy stored in them, J.
    pub(super) fn stored(&self, nodes: &Nodes) -> f64 {
        let energy = |spring: &Spring| spring.count * self.law.energy(spring.stretched(nodes).elongation);
        self.multiplicity * self.springs.iter().map(energy).sum::<f64>()
    }

    /// Force that the springs of these numbers have on the frame in the last pass along an axis, N, without mirror images.
    pub(super) fn frame_force(&self, numbers: impl Iterator<Item = usize>, axis: usize) -> f64 {
        numbers.filter_map(|number| self.passed.get(number)).map(|passed| -passed.force[axis]).sum()
    }

    /// Vertical force of the whole film on the frame in the last pass, N, positive downwards.
    pub(super) fn vertical_force(&self) -> f64 {
        -self.multiplicity * self.frame_force(0..self.springs.len(), 2)
    }

    /// Sum of squares of the forces on the frame of springs at some nodes, N².
    pub(super) fn squared_forces(&self, nodes: &Range<usize>) -> f64 {
        let of_nodes = self.springs.iter().zip(&self.passed).filter(|(spring, _)| nodes.contains(&spring.nodes[0]));
        of_nodes.map(|(_, passed)| passed.force.norm_squared()).sum()
    }

    /// Stiffness of a spring across its own direction over that along it, and the square of its slope, the largest of
    /// any (theory.md, equation 345).
    pub(super) fn vertical_share(&self, nodes: &Nodes) -> f64 {
        let of_spring = |spring: &Spring| {
            let Stretched { direction, elongation } = spring.stretched(nodes);
            let length = spring.unstretched + elongation;
            let across = self.law.force(elongation) / (length * self.law.stiffest());
            across.max(0.0) + direction.z * direction.z
        };
        self.springs.iter().map(of_spring).fold(0.0, f64::max)
    }

    /// The loads of those at some nodes, in the order of their numbers; their forces are those of the last pass.
    pub(super) fn loads(&self, nodes: &Nodes, at: &Range<usize>) -> Vec<SpringLoad> {
        let load = |(number, spring): (usize, &Spring)| {
            let Stretched { direction, elongation } = spring.stretched(nodes);
            let force = self.passed.get(number).map_or(0.0, |passed| passed.force.dot(&direction) / spring.count);
            SpringLoad { elongation, force, count: spring.count }
        };
        let all = self.springs.iter().enumerate();
        all.filter(|(_, spring)| at.contains(&spring.nodes[0])).map(load).collect()
    }

    /// Their state.
    pub(super) fn state(&self, nodes: &Nodes) -> SpringsState {
        let mut state =
            SpringsState { elongation: f64::NEG_INFINITY, force: 0.0, slack: 0.0, beyond: None, collapsed: None };
        let (mut all, mut shortest) = (0.0, f64::INFINITY);
        for (number, spring) in self.springs.iter().enumerate() {
            let elongation = spring.stretched(nodes).elongation;
            let force = self.passed.get(number).map_or(0.0, |passed| passed.force.norm() / spring.count);
            state.elongation = state.elongation.max(elongation);
            shortest = f64::min(shortest, 1.0 + elongation / spring.unstretched);
            state.force = state.force.max(force);
            all += spring.count;
            if self.law.goes_slack() && elongation < -ROUND_OFF * spring.unstretched {
                state.slack += spring.count;
            }
        }
        state.slack /= all;
        state.collapsed = (!self.law.goes_slack() && shortest < SHORTEST).then_some(shortest);
        state.beyond = (state.elongation > self.law.end()).then_some(state.elongation / self.law.end());
        state
    }

    /// Bytes of their arrays.
    pub(super) fn bytes(&self) -> usize {
        self.springs.len() * (size_of::<Spring>() + size_of::<Passed>())
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

    /// Velocity of its end on the film, m/s.
    fn velocity(&self, nodes: &Nodes) -> Vector3<f64> {
        self.ends().map(|(node, share)| nodes.velocity_of(node) * share).sum()
    }

    fn stretched(&self, nodes: &Nodes) -> Stretched {
        let along = self.anchor - self.end(nodes);
        let length = along.norm();
        let direction = if length > 0.0 { along / length } else { Vector3::zeros() };
        Stretched { direction, elongation: length - self.unstretched }
    }
}
