//! Nodes that would be inside: found, and given their momentum, a lane a node.

use nalgebra::Vector3;

use super::Impulse;
use super::search::Surface;
use super::tally::{LaneTally, Tally};
use crate::engine::disjoint::Disjoint;
use crate::engine::footprint::bytes;
use crate::engine::nodes::{Met, Nodes, Vectors, gather};
use crate::engine::rigid_body::{Gathered, RigidBody};
use crate::lane::{LANES, Lane, Lane3, at_width, cross, dot, larger, splat};

/// Nodes that would be inside at the end of the step.
#[derive(Default)]
struct Touching {
    nodes: [u32; LANES],
    /// One where a node touches, else zero.
    touches: Lane,
    /// One where a node was given momentum, else zero.
    given: Lane,
    /// Outward from the impactor.
    normal: Lane3,
    /// Normal velocity that they lack, m/s.
    lack: Lane,
    /// From the body's centre of mass, m.
    arm: Lane3,
    /// Tangential velocity over the surface, m/s.
    slip: Lane3,
    /// kg.
    mass: Lane,
}

/// What was found at the nodes of one piece of the neighbour list.
#[derive(Default)]
pub(super) struct Piece {
    /// Room for what touches; the first `count` are used.
    touching: Vec<Touching>,
    count: usize,
    /// The film that touches, as the body feels it.
    pub(super) gathered: Gathered,
    /// What each node got, kept only where faces are watched.
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
    /// The body as it moves, where it will be at the end of the step.
    pub(super) body: &'a RigidBody,
    /// One over the time step, 1/s.
    pub(super) per_second: f64,
}

/// What it takes to give nodes their momentum.
pub(super) struct Giving<'a> {
    pub(super) friction: f64,
    /// Velocities half a step earlier, m/s.
    pub(super) earlier: &'a Vectors,
    pub(super) nodes: Met<'a>,
    pub(super) body: &'a RigidBody,
    pub(super) ahead: &'a RigidBody,
    /// s.
    pub(super) dt: f64,
    /// Whether to keep what each node got.
    pub(super) keep: bool,
}

impl Piece {
    /// Whether a node touches.
    pub(super) fn is_touched(&self) -> bool {
        self.count > 0
    }

    /// Bytes of its arrays; room that is not used does not count, so that a run taken up again has the same.
    pub(super) fn bytes(&self) -> usize {
        bytes(&self.touching[..self.count]) + bytes(&self.impulses)
    }

    /// Nodes that were given momentum.
    pub(super) fn touched(&self) -> impl Iterator<Item = usize> + '_ {
        let of_block = |block: &Touching| {
            let (nodes, given) = (block.nodes, block.given);
            (0..LANES).filter(move |l| given[*l] > 0.0).map(move |l| nodes[l] as usize)
        };
        self.touching[..self.count].iter().flat_map(of_block)
    }
}

at_width! {
    /// Finds those of the nodes `near` that lie inside, each listed once.
    pub(super) fn find[](at: &Looking<'_>, near: &[u32], piece: &mut Piece) = find_lanewise
}

#[inline(always)]
fn find_lanewise(at: &Looking<'_>, near: &[u32], piece: &mut Piece) {
    piece.touching.resize_with(near.len().div_ceil(LANES), Touching::default);
    piece.count = 0;
    piece.gathered = Gathered::default();
    let centre = at.body.centre();
    let mut sums: [Lane; 2] = [splat(0.0); 2];
    for group in near.chunks(LANES) {
        let nodes: [u32; LANES] = std::array::from_fn(|l| group[l.min(group.len() - 1)]);
        let mut arm = at.nodes.position.gather(&nodes);
        let offset = gather(at.offset, &nodes);
        for axis in 0..3 {
            for l in 0..LANES {
                arm[axis][l] -= centre[axis];
            }
        }
        let squared = dot(&arm, &arm);
        let mut close = splat(0.0);
        for l in 0..LANES {
            let radius = at.surface.bounding_radius() + offset[l];
            close[l] = if squared[l] <= radius * radius { 1.0 } else { 0.0 };
        }
        close[group.len()..].fill(0.0);
        if close == splat(0.0) {
            keep_normals(at, group, &[splat(0.0); 3], &close);
            continue;
        }
        let (gap, normal) = at.surface.touch_lanes(&at.body.pose, &arm, &close);
        keep_normals(at, group, &normal, &close);
        let block = &mut piece.touching[piece.count];
        block.mass = gather(&at.nodes.mass, &nodes);
        let free = at.nodes.mobility().gather(&nodes);
        for l in 0..LANES {
            let deep = gap[l] - offset[l];
            let inside = (deep < 0.0) & (free[0][l] + free[1][l] + free[2][l] > 0.0);
            block.touches[l] = if inside { close[l] } else { 0.0 };
            block.lack[l] = -deep * at.per_second;
        }
        if block.touches == splat(0.0) {
            continue;
        }
        block.nodes = nodes;
        block.normal = normal;
        block.arm = arm;
        block.slip = at.nodes.velocity.gather(&nodes);
        let surface = velocity_lanes(&at.body.velocity, &at.body.spin, &arm);
        for axis in 0..3 {
            for l in 0..LANES {
                block.slip[axis][l] -= surface[axis][l];
            }
        }
        let along = dot(&block.slip, &normal);
        for axis in 0..3 {
            for l in 0..LANES {
                block.slip[axis][l] -= normal[axis][l] * along[l];
            }
        }
        resist(at, block, &mut sums, &mut piece.gathered);
        piece.count += 1;
    }
    let [mass, momentum] = sums.map(|lanes| lanes.iter().sum());
    piece.gathered.add_along_z(mass, momentum);
}

/// Keeps the normals at a group of nodes, zero where they are not close.
#[inline(always)]
fn keep_normals(at: &Looking<'_>, group: &[u32], normal: &Lane3, close: &Lane) {
    let Some(normals) = &at.normals else { return };
    for (l, n) in group.iter().enumerate() {
        let seen = if close[l] > 0.0 { [0, 1, 2].map(|axis| normal[axis][l]) } else { [0.0; 3] };
        // SAFETY: a node is listed once.
        unsafe { *normals.at(*n as usize) = seen.into() };
    }
}

/// What touching film adds to the body's own equations of motion: to `sums` of mass and momentum along z for a guided
/// one, else to `gathered`.
#[inline(always)]
fn resist(at: &Looking<'_>, block: &Touching, sums: &mut [Lane; 2], gathered: &mut Gathered) {
    let (stopped, sticks) = stopping(&block.slip, &block.lack, at.friction);
    let mut mass: Lane = splat(0.0);
    for l in 0..LANES {
        mass[l] = at.multiplicity * block.mass[l] * block.touches[l];
    }
    let change =
        |axis: usize, l: usize| (block.normal[axis][l] * block.lack[l] - block.slip[axis][l] * stopped[l]) * mass[l];
    if at.body.is_guided() {
        for l in 0..LANES {
            let z = block.normal[2][l];
            sums[0][l] += mass[l] * if sticks[l] > 0.0 { 1.0 } else { z * z };
            sums[1][l] += change(2, l);
        }
        return;
    }
    let vector = |of: &Lane3, l: usize| Vector3::new(of[0][l], of[1][l], of[2][l]);
    for l in (0..LANES).filter(|l| block.touches[*l] > 0.0) {
        let normal = vector(&block.normal, l);
        let along = if sticks[l] > 0.0 { None } else { Some(&normal) };
        let change = Vector3::new(change(0, l), change(1, l), change(2, l));
        at.body.gather(gathered, &vector(&block.arm, l), mass[l], along, &change);
    }
}

at_width! {
    /// Gives the touching nodes of a piece the momentum with which they follow the body.
    pub(super) fn give[](at: &Giving<'_>, piece: &mut Piece) = give_lanewise
}

#[inline(always)]
fn give_lanewise(at: &Giving<'_>, piece: &mut Piece) {
    let Piece { touching, count, impulses, tally, fastest, .. } = piece;
    impulses.clear();
    let mut sums = LaneTally::default();
    let mut speeds: Lane = splat(0.0);
    let (velocity, spin) = (at.ahead.velocity - at.body.velocity, at.ahead.spin - at.body.spin);
    for block in &mut touching[..*count] {
        // How the body's surface will have changed its velocity, and what that leaves to be given.
        let change = velocity_lanes(&velocity, &spin, &block.arm);
        let away = dot(&block.normal, &change);
        let mut lack: Lane = splat(0.0);
        let mut slip = block.slip;
        for l in 0..LANES {
            lack[l] = block.lack[l] + away[l];
            block.given[l] = if lack[l] > 0.0 { block.touches[l] } else { 0.0 };
        }
        for axis in 0..3 {
            for l in 0..LANES {
                slip[axis][l] += block.normal[axis][l] * away[l] - change[axis][l];
            }
        }
        let (stopped, _) = stopping(&slip, &lack, at.friction);
        let mut normal = [splat(0.0); 3];
        let mut tangential = [splat(0.0); 3];
        for l in 0..LANES {
            let mass = block.given[l] * block.mass[l];
            for axis in 0..3 {
                normal[axis][l] = block.normal[axis][l] * (lack[l] * mass);
                tangential[axis][l] = -slip[axis][l] * (stopped[l] * mass);
            }
        }
        let mut impulse = normal;
        for axis in 0..3 {
            for l in 0..LANES {
                impulse[axis][l] += tangential[axis][l];
            }
        }
        // SAFETY: a node is listed once.
        let after = unsafe { at.nodes.push_lanes(&block.nodes, &block.given, &impulse, at.dt) };
        let mut film = at.earlier.gather(&block.nodes);
        let squared = dot(&after, &after);
        for l in 0..LANES {
            speeds[l] = larger(squared[l] * block.given[l], speeds[l]);
            for axis in 0..3 {
                film[axis][l] = 0.5 * (after[axis][l] + film[axis][l]);
            }
        }
        sums.add(&normal, &tangential, &block.arm, &film);
        if at.keep {
            let vector = |of: &Lane3, l: usize| Vector3::new(of[0][l], of[1][l], of[2][l]);
            impulses.extend((0..LANES).filter(|l| block.given[*l] > 0.0).map(|l| Impulse {
                node: block.nodes[l] as usize,
                arm: vector(&block.arm, l),
                normal: vector(&normal, l),
                tangential: vector(&tangential, l),
            }));
        }
    }
    *tally = sums.total();
    *fastest = speeds.into_iter().fold(0.0, larger);
}

/// Velocity of points at `arm` of something that moves and spins.
#[inline(always)]
fn velocity_lanes(velocity: &Vector3<f64>, spin: &Vector3<f64>, arm: &Lane3) -> Lane3 {
    let mut out = [0, 1, 2].map(|axis| splat(velocity[axis]));
    if *spin != Vector3::zeros() {
        let turned = cross(&[splat(spin.x), splat(spin.y), splat(spin.z)], arm);
        for axis in 0..3 {
            for l in 0..LANES {
                out[axis][l] += turned[axis][l];
            }
        }
    }
    out
}

/// The share of the slip that friction stops where the bound on it is `friction` times `lack`; one where that is all of it, else
/// zero.
#[inline(always)]
fn stopping(slip: &Lane3, lack: &Lane, friction: f64) -> (Lane, Lane) {
    let squared = dot(slip, slip);
    let (mut share, mut sticks): (Lane, Lane) = (splat(1.0), splat(0.0));
    for l in 0..LANES {
        let bound = friction * lack[l];
        let part = bound / squared[l].sqrt();
        let within = squared[l] <= bound * bound;
        share[l] = if within { 1.0 } else { part };
        sticks[l] = if within { 1.0 } else { 0.0 };
    }
    (share, sticks)
}
