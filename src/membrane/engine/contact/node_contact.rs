//! Node contact with Coulomb's friction: predictor and corrector over the nodes of the neighbour list, a lane a node.

use nalgebra::Vector3;

use super::Impulse;
use super::impulse_sums::Friction;
use super::impulse_sums::{ImpulseSums, LaneImpulseSums};
use super::surface::{Nearest, Surface};
use crate::engine::disjoint::Disjoint;
use crate::engine::nodes::{Correction, Nodes, Vectors, gather};
use crate::engine::rigid_body::{CoupledFilm, RigidBody};
use crate::lane::{LANES, Lane, Lane3, at_width, cross, dot, larger, splat};

/// Nodes of which some penetrate at the end of the step, a lane each.
#[derive(Default)]
struct Block {
    nodes: [u32; LANES],
    /// One where a node penetrates, else zero.
    penetrates: Lane,
    /// One where a node got an impulse, else zero.
    active: Lane,
    /// Outward from the impactor.
    normal: Lane3,
    /// Normal velocity by which the constraint is violated, m/s: `c` of equation 19 in theory.md.
    violation: Lane,
    /// From the body's centre of mass, m.
    arm: Lane3,
    /// Tangential velocity over the surface, m/s.
    slip: Lane3,
    /// kg.
    mass: Lane,
}

/// Contacts at the nodes of one range of the neighbour list.
#[derive(Default)]
pub(super) struct NodeContacts {
    /// Allocated for the whole range; the first `count` are used.
    blocks: Vec<Block>,
    count: usize,
    /// The film in contact in the body's equations of motion.
    pub(super) coupled_film: CoupledFilm,
    /// Of each node, only where there are candidates for face contact.
    pub(super) impulses: Vec<Impulse>,
    pub(super) sums: ImpulseSums,
    /// Square of the largest speed after contact, m²/s².
    pub(super) largest_speed_squared: f64,
}

/// Inputs of the predictor.
pub(super) struct Predictor<'a> {
    pub(super) surface: &'a Surface,
    pub(super) friction: Friction,
    pub(super) multiplicity: f64,
    pub(super) offset: &'a [f64],
    /// Where the surface's normals are stored, if face contact needs them.
    pub(super) normals: Option<Disjoint<'a, Vector3<f64>>>,
    /// The nearest triangle of a mesh to each node.
    pub(super) nearest: Option<Disjoint<'a, Nearest>>,
    pub(super) nodes: &'a Nodes,
    /// The body at its pose at the end of the step.
    pub(super) body: &'a RigidBody,
    /// One over the time step, 1/s.
    pub(super) per_second: f64,
}

/// Inputs of the corrector, and the nodes that it corrects.
pub(super) struct Corrector<'a> {
    pub(super) friction: Friction,
    /// Velocities half a step earlier, m/s.
    pub(super) previous_velocity: &'a Vectors,
    pub(super) nodes: Correction<'a>,
    pub(super) body: &'a RigidBody,
    /// The body as it moves once all contacts have acted.
    pub(super) corrected: &'a RigidBody,
    /// s.
    pub(super) dt: f64,
    /// Whether the impulse of each node is listed.
    pub(super) lists_impulses: bool,
}

impl NodeContacts {
    /// Whether a node penetrates.
    pub(super) fn is_active(&self) -> bool {
        self.count > 0
    }

    /// Nodes that got an impulse.
    pub(super) fn active_nodes(&self) -> impl Iterator<Item = usize> + '_ {
        let of_block = |block: &Block| {
            let (nodes, active) = (block.nodes, block.active);
            (0..LANES).filter(move |l| active[*l] > 0.0).map(move |l| nodes[l] as usize)
        };
        self.blocks[..self.count].iter().flat_map(of_block)
    }
}

at_width! {
    /// Finds those of the `listed` nodes that penetrate. The neighbour list has a node once, and `listed` is a range of
    /// it that is disjoint from all others and that one thread takes.
    pub(super) fn predict[](at: &Predictor<'_>, listed: &[u32], contacts: &mut NodeContacts) {
        contacts.blocks.resize_with(listed.len().div_ceil(LANES), Block::default);
        contacts.count = 0;
        contacts.coupled_film = CoupledFilm::default();
        let centre = at.body.centre();
        let mut sums: [Lane; 2] = [splat(0.0); 2];
        for group in listed.chunks(LANES) {
            // The last group is padded with copies of its last node, whose `close` is zero below: they count nowhere and
            // are not stored.
            let mut nodes = [0; LANES];
            for l in 0..LANES {
                nodes[l] = group[l.min(group.len() - 1)];
            }
            let mut arm = at.nodes.position.gather(&nodes);
            let offset = gather(at.offset, &nodes);
            for axis in 0..3 {
                for l in 0..LANES {
                    arm[axis][l] -= centre[axis];
                }
            }
            // A sphere around the body sorts out most of the skin before any projection.
            let squared = dot(&arm, &arm);
            let mut close = splat(0.0);
            for l in 0..LANES {
                let radius = at.surface.bounding_radius() + offset[l];
                // Masks are numbers, not Booleans: a product is a vector instruction where a branch in a lane is not.
                close[l] = if squared[l] <= radius * radius { 1.0 } else { 0.0 };
            }
            for l in group.len()..LANES {
                close[l] = 0.0;
            }
            if close == splat(0.0) {
                store_normals(at, group, &[splat(0.0); 3], &close);
                continue;
            }
            let (distance, normal) = match &at.nearest {
                Some(nearest) => project_on_mesh(at, nearest, group, &arm, &close),
                None => at.surface.project_lanes(&at.body.pose, &arm, &close),
            };
            store_normals(at, group, &normal, &close);
            let block = &mut contacts.blocks[contacts.count];
            // Written into the next free block, which is counted only if a lane penetrates: no copy, and no memory in a
            // step.
            block.mass = gather(&at.nodes.mass, &nodes);
            let free = at.nodes.effective_inverse_mass().gather(&nodes);
            for l in 0..LANES {
                let gap = distance[l] - offset[l];
                // Held in all directions a node cannot yield, and would be a mass that the body has to carry. `&` instead
                // of `&&` keeps it free of branches.
                let inside = (gap < 0.0) & (free[0][l] + free[1][l] + free[2][l] > 0.0);
                block.penetrates[l] = if inside { close[l] } else { 0.0 };
                // theory.md, equation 19: the normal velocity that is missing at the end of the step, not the present one.
                block.violation[l] = -gap * at.per_second;
            }
            if block.penetrates == splat(0.0) {
                continue;
            }
            block.nodes = nodes;
            block.normal = normal;
            block.arm = arm;
            block.slip = at.nodes.velocity.gather(&nodes);
            let surface_velocity = velocity_lanes(&at.body.velocity, &at.body.spin, &arm);
            for axis in 0..3 {
                for l in 0..LANES {
                    block.slip[axis][l] -= surface_velocity[axis][l];
                }
            }
            let along = dot(&block.slip, &normal);
            for axis in 0..3 {
                for l in 0..LANES {
                    block.slip[axis][l] -= normal[axis][l] * along[l];
                }
            }
            couple(at, block, &mut sums, &mut contacts.coupled_film);
            contacts.count += 1;
        }
        // Lanes are added once a range, in one order, so that sums do not depend on the threads.
        let [mass, momentum] = sums.map(|lanes| lanes.iter().sum());
        contacts.coupled_film.add_along_z(mass, momentum);
    }
}

/// Signed distances and outward normals of a group of nodes at `arm` (m) from the centre of a mesh.
fn project_on_mesh(
    at: &Predictor<'_>,
    nearest: &Disjoint<'_, Nearest>,
    group: &[u32],
    arm: &Lane3,
    close: &Lane,
) -> (Lane, Lane3) {
    let (mut distance, mut normal): (Lane, Lane3) = (splat(0.0), [splat(0.0); 3]);
    // A walk over the triangles differs from lane to lane, so nodes of a mesh are projected one by one.
    for (l, n) in group.iter().enumerate().filter(|(l, _)| close[*l] > 0.0) {
        let node = *n as usize;
        let beyond = Some(at.offset[node]);
        let arm = Vector3::new(arm[0][l], arm[1][l], arm[2][l]);
        // SAFETY: the list has a node once, its ranges are disjoint, and one thread takes this one.
        let nearest = unsafe { nearest.entry(node) };
        let projection = at.surface.project_on_mesh(&at.body.pose, &arm, beyond, nearest);
        distance[l] = projection.distance;
        for axis in 0..3 {
            normal[axis][l] = projection.normal[axis];
        }
    }
    (distance, normal)
}

/// Stores the normals at a group of nodes, zero where they are not close.
#[inline(always)]
fn store_normals(at: &Predictor<'_>, group: &[u32], normal: &Lane3, close: &Lane) {
    let Some(normals) = &at.normals else { return };
    for (l, n) in group.iter().enumerate() {
        let stored = if close[l] > 0.0 { [normal[0][l], normal[1][l], normal[2][l]] } else { [0.0; 3] };
        // SAFETY: the list has a node once, its ranges are disjoint, and one thread takes this one.
        unsafe { *normals.entry(*n as usize) = stored.into() };
    }
}

/// Adds the film in contact to the equations of motion of the body: to the `sums` of mass and momentum along z of a
/// guided one, else to `coupled`.
#[inline(always)]
fn couple(at: &Predictor<'_>, block: &Block, sums: &mut [Lane; 2], coupled: &mut CoupledFilm) {
    let (share, sticks) = slip_correction(&block.slip, &block.violation, &at.friction.lanes(&block.nodes));
    let mut mass: Lane = splat(0.0);
    for l in 0..LANES {
        mass[l] = at.multiplicity * block.mass[l] * block.penetrates[l];
    }
    // Right side of theory.md, equation 20: the change of momentum of the node if the body did not give way.
    let change =
        |axis: usize, l: usize| (block.normal[axis][l] * block.violation[l] - block.slip[axis][l] * share[l]) * mass[l];
    if at.body.is_guided() {
        for l in 0..LANES {
            let z = block.normal[2][l];
            // P_a of equation 20 along z alone: identity where the node sticks, else ν νᵀ.
            sums[0][l] += mass[l] * if sticks[l] > 0.0 { 1.0 } else { z * z };
            sums[1][l] += change(2, l);
        }
        return;
    }
    let vector = |of: &Lane3, l: usize| Vector3::new(of[0][l], of[1][l], of[2][l]);
    for l in (0..LANES).filter(|l| block.penetrates[*l] > 0.0) {
        let normal = vector(&block.normal, l);
        let along = if sticks[l] > 0.0 { None } else { Some(&normal) };
        let change = Vector3::new(change(0, l), change(1, l), change(2, l));
        at.body.couple(coupled, &vector(&block.arm, l), mass[l], along, &change);
    }
}

at_width! {
    /// Gives the penetrating nodes of a range the impulses with which they follow the body. The neighbour list has a
    /// node once, and the range is disjoint from all others; one thread takes it.
    pub(super) fn correct[](at: &Corrector<'_>, contacts: &mut NodeContacts) {
        let NodeContacts { blocks, count, impulses, sums, largest_speed_squared, .. } = contacts;
        impulses.clear();
        let mut lane_sums = LaneImpulseSums::default();
        let mut speeds: Lane = splat(0.0);
        // The predictor stored violation and slip against the uncorrected body; only the difference is added, instead of
        // both anew.
        let (velocity, spin) = (at.corrected.velocity - at.body.velocity, at.corrected.spin - at.body.spin);
        for block in &mut blocks[..*count] {
            // The change of the surface's velocity by all contacts, and the violation and slip that it leaves.
            let change = velocity_lanes(&velocity, &spin, &block.arm);
            let normal_change = dot(&block.normal, &change);
            let mut violation: Lane = splat(0.0);
            let mut slip = block.slip;
            for l in 0..LANES {
                violation[l] = block.violation[l] + normal_change[l];
                // A node from which the body recedes would have to be pulled: it gets no impulse (theory.md, equation 20).
                block.active[l] = if violation[l] > 0.0 { block.penetrates[l] } else { 0.0 };
            }
            for axis in 0..3 {
                for l in 0..LANES {
                    // The tangential part of the change, with the opposite sign: slip is the velocity of film over the
                    // surface.
                    slip[axis][l] += block.normal[axis][l] * normal_change[l] - change[axis][l];
                }
            }
            let (share, _) = slip_correction(&slip, &violation, &at.friction.lanes(&block.nodes));
            let mut normal = [splat(0.0); 3];
            let mut tangential = [splat(0.0); 3];
            for l in 0..LANES {
                // The own mass, not the effective one, also at nodes held in one direction: `apply_impulses` leaves out
                // what is held, and its reaction is that of the support.
                let mass = block.active[l] * block.mass[l];
                for axis in 0..3 {
                    normal[axis][l] = block.normal[axis][l] * (violation[l] * mass);
                    tangential[axis][l] = -slip[axis][l] * (share[l] * mass);
                }
            }
            let mut impulse = normal;
            for axis in 0..3 {
                for l in 0..LANES {
                    impulse[axis][l] += tangential[axis][l];
                }
            }
            // SAFETY: the list has a node once, its ranges are disjoint, and one thread takes this one.
            let after = unsafe { at.nodes.apply_impulses(&block.nodes, &block.active, &impulse, at.dt) };
            let mut film = at.previous_velocity.gather(&block.nodes);
            let squared = dot(&after, &after);
            for l in 0..LANES {
                speeds[l] = larger(squared[l] * block.active[l], speeds[l]);
                for axis in 0..3 {
                    // Work of an impulse is that along the mean of the velocities before and after (theory.md, equation
                    // 22).
                    film[axis][l] = 0.5 * (after[axis][l] + film[axis][l]);
                }
            }
            lane_sums.add(&normal, &tangential, &block.arm, &film);
            if at.lists_impulses {
                let vector = |of: &Lane3, l: usize| Vector3::new(of[0][l], of[1][l], of[2][l]);
                impulses.extend((0..LANES).filter(|l| block.active[*l] > 0.0).map(|l| Impulse {
                    node: block.nodes[l] as usize,
                    arm: vector(&block.arm, l),
                    normal: vector(&normal, l),
                    tangential: vector(&tangential, l),
                }));
            }
        }
        *sums = lane_sums.total();
        *largest_speed_squared = speeds.into_iter().fold(0.0, larger);
    }
}

/// Velocity of the points at `arm` of a body with `velocity` and `spin`.
#[inline(always)]
fn velocity_lanes(velocity: &Vector3<f64>, spin: &Vector3<f64>, arm: &Lane3) -> Lane3 {
    let mut out = [splat(velocity.x), splat(velocity.y), splat(velocity.z)];
    // A guided body never spins: the branch is the same for all nodes and saves each a cross product.
    if *spin != Vector3::zeros() {
        let rotation = cross(&[splat(spin.x), splat(spin.y), splat(spin.z)], arm);
        for axis in 0..3 {
            for l in 0..LANES {
                out[axis][l] += rotation[axis][l];
            }
        }
    }
    out
}

/// Share of the slip that friction stops, bounded by `friction` times `violation` (theory.md, equation 21), and whether
/// the node sticks: one where the share is one, else zero.
#[inline(always)]
fn slip_correction(slip: &Lane3, violation: &Lane, friction: &Lane) -> (Lane, Lane) {
    let squared = dot(slip, slip);
    let (mut share, mut sticks): (Lane, Lane) = (splat(1.0), splat(0.0));
    for l in 0..LANES {
        let bound = friction[l] * violation[l];
        // Infinite or NaN without slip, where `within` holds: both shares are computed so that no lane takes a branch.
        let part = bound / squared[l].sqrt();
        let within = squared[l] <= bound * bound;
        share[l] = if within { 1.0 } else { part };
        sticks[l] = if within { 1.0 } else { 0.0 };
    }
    (share, sticks)
}
