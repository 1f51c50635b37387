//! Node contact with Coulomb's friction: predictor and corrector over the nodes of the neighbour list, a lane a node.

use nalgebra::Vector3;

use super::Impulse;
use super::impulse_sums::{Friction, ImpulseSums, LaneImpulseSums};
use super::surface::{Nearest, Surface};
use crate::engine::disjoint::Disjoint;
use crate::engine::nodes::{Correction, Nodes, Vectors, gather};
use crate::engine::rigid_body::{CoupledFilm, RigidBody};
use crate::lane::{LANES, Lane, Lane3, Mask, at_width, cross, dot, larger, splat};

/// Nodes of which some penetrate at the end of the step, a lane each.
#[derive(Default)]
struct Block {
    nodes: [u32; LANES],
    /// Where a node penetrates.
    penetrates: Mask,
    /// Where a node got an impulse.
    active: Mask,
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
            let nodes = block.nodes;
            block.active.lanes().map(move |l| nodes[l] as usize)
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
        let centre = Lane3::splat(at.body.centre().coords);
        let mut sums: [Lane; 2] = [splat(0.0); 2];
        for group in listed.chunks(LANES) {
            // The last group is padded with copies of its last node, which are never close: they count nowhere and are not
            // stored.
            let mut nodes = [0; LANES];
            for l in 0..LANES {
                nodes[l] = group[l.min(group.len() - 1)];
            }
            let arm = at.nodes.position.gather(&nodes) - centre;
            let offset = gather(at.offset, &nodes);
            // A sphere around the body sorts out most of the skin before any projection.
            let radius = at.surface.bounding_radius() + offset;
            let close = dot(&arm, &arm).at_most(radius * radius) & Mask::first(group.len());
            if !close.any() {
                store_normals(at, group, &Lane3::ZERO, close);
                continue;
            }
            let (distance, normal) = match &at.nearest {
                Some(nearest) => project_on_mesh(at, nearest, group, &arm, close),
                None => at.surface.project_lanes(&at.body.pose, &arm, close),
            };
            store_normals(at, group, &normal, close);
            let block = &mut contacts.blocks[contacts.count];
            // Written into the next free block, which is counted only if a lane penetrates: no copy, and no memory in a
            // step.
            block.mass = gather(&at.nodes.mass, &nodes);
            let free = at.nodes.effective_inverse_mass().gather(&nodes);
            let gap = distance - offset;
            // Held in all directions a node cannot yield, and would be a mass that the body has to carry.
            block.penetrates = close & gap.below(0.0) & (free[0] + free[1] + free[2]).above(0.0);
            if !block.penetrates.any() {
                continue;
            }
            // theory.md, equation 19: the normal velocity that is missing at the end of the step, not the present one.
            block.violation = -gap * at.per_second;
            block.nodes = nodes;
            block.normal = normal;
            block.arm = arm;
            let over = at.nodes.velocity.gather(&nodes) - velocity_at(&at.body.velocity, &at.body.spin, &arm);
            block.slip = over - dot(&over, &normal) * normal;
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
    close: Mask,
) -> (Lane, Lane3) {
    let (mut distance, mut normal): (Lane, Lane3) = (splat(0.0), Lane3::ZERO);
    // A walk over the triangles differs from lane to lane, so nodes of a mesh are projected one by one.
    for l in close.lanes() {
        let node = group[l] as usize;
        let beyond = Some(at.offset[node]);
        // SAFETY: the list has a node once, its ranges are disjoint, and one thread takes this one.
        let nearest = unsafe { nearest.entry(node) };
        let projection = at.surface.project_on_mesh(&at.body.pose, &arm.vector(l), beyond, nearest);
        distance[l] = projection.distance;
        normal.set(l, &projection.normal);
    }
    (distance, normal)
}

/// Stores the normals at a group of nodes, zero where they are not close.
#[inline(always)]
fn store_normals(at: &Predictor<'_>, group: &[u32], normal: &Lane3, close: Mask) {
    let Some(normals) = &at.normals else { return };
    for (l, n) in group.iter().enumerate() {
        let stored = if close.holds(l) { normal.vector(l) } else { Vector3::zeros() };
        // SAFETY: the list has a node once, its ranges are disjoint, and one thread takes this one.
        unsafe { *normals.entry(*n as usize) = stored };
    }
}

/// Adds the film in contact to the equations of motion of the body: to the `sums` of mass and momentum along z of a
/// guided one, else to `coupled`.
#[inline(always)]
fn couple(at: &Predictor<'_>, block: &Block, sums: &mut [Lane; 2], coupled: &mut CoupledFilm) {
    let (share, sticks) = slip_correction(&block.slip, block.violation, at.friction.lanes(&block.nodes));
    let mass = block.penetrates.select(at.multiplicity * block.mass, 0.0);
    // Right side of theory.md, equation 20: the change of momentum of the node if the body did not give way.
    let change = mass * (block.violation * block.normal - share * block.slip);
    if at.body.is_guided() {
        // P_a of equation 20 along z alone: identity where the node sticks, else ν νᵀ.
        let z = block.normal[2];
        sums[0] += mass * sticks.select(1.0, z * z);
        sums[1] += change[2];
        return;
    }
    for l in block.penetrates.lanes() {
        let normal = block.normal.vector(l);
        let along = (!sticks.holds(l)).then_some(&normal);
        at.body.couple(coupled, &block.arm.vector(l), mass[l], along, &change.vector(l));
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
            let change = velocity_at(&velocity, &spin, &block.arm);
            let normal_change = dot(&block.normal, &change);
            let violation = block.violation + normal_change;
            // A node from which the body recedes would have to be pulled: it gets no impulse (theory.md, equation 20).
            block.active = block.penetrates & violation.above(0.0);
            // The tangential part of the change, with the opposite sign: slip is the velocity of film over the surface.
            let slip = block.slip + (normal_change * block.normal - change);
            let (share, _) = slip_correction(&slip, violation, at.friction.lanes(&block.nodes));
            // The own mass, not the effective one, also at nodes held in one direction: `apply_impulses` leaves out what is
            // held, and its reaction is that of the support.
            let mass = block.active.select(block.mass, 0.0);
            let normal = (violation * mass) * block.normal;
            let tangential = (share * mass) * -slip;
            // SAFETY: the list has a node once, its ranges are disjoint, and one thread takes this one.
            let after = unsafe { at.nodes.apply_impulses(&block.nodes, block.active, &(normal + tangential), at.dt) };
            speeds = block.active.select(dot(&after, &after), 0.0).max(speeds);
            lane_sums.add(&normal, &tangential, &block.arm, [&at.previous_velocity.gather(&block.nodes), &after]);
            if at.lists_impulses {
                impulses.extend(block.active.lanes().map(|l| Impulse {
                    node: block.nodes[l] as usize,
                    arm: block.arm.vector(l),
                    normal: normal.vector(l),
                    tangential: tangential.vector(l),
                }));
            }
        }
        *sums = lane_sums.total();
        *largest_speed_squared = speeds.into_iter().fold(0.0, larger);
    }
}

/// Velocity of the points at `arm` of a body with `velocity` and `spin`.
#[inline(always)]
fn velocity_at(velocity: &Vector3<f64>, spin: &Vector3<f64>, arm: &Lane3) -> Lane3 {
    let velocity = Lane3::splat(*velocity);
    // A guided body never spins: the branch is the same for all nodes and saves each a cross product.
    if *spin == Vector3::zeros() { velocity } else { velocity + cross(&Lane3::splat(*spin), arm) }
}

/// Share of the slip that friction stops, bounded by `friction` times `violation` (theory.md, equation 21), and whether
/// the node sticks.
#[inline(always)]
fn slip_correction(slip: &Lane3, violation: Lane, friction: Lane) -> (Lane, Mask) {
    let squared = dot(slip, slip);
    let bound = friction * violation;
    let sticks = squared.at_most(bound * bound);
    // The quotient is infinite or NaN without slip, where the node sticks: both are computed so that no lane takes a branch.
    (sticks.select(1.0, bound / squared.sqrt()), sticks)
}
