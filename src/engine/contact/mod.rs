//! Contact between the impactor and the film, met kinematically.
//!
//! After the forces of a step have acted, every node whose position at the end of the step would lie inside the impactor
//! gets the momentum that puts it on the surface, and the impactor gives that momentum (theory.md, section 6). There is no
//! penalty stiffness to guess: nodes do not penetrate, and nothing is added to the frequency that limits the time step.
//! Friction is the tangential momentum that makes a node follow the surface, bounded by μ times the normal one, so a
//! node within the bound sticks without creep.
//!
//! Faces between nodes penetrate by the sagitta of their edges. Where that may exceed `FACE_BOUND` of the
//! impactor's size, or the impactor has edges of its own, the deepest point of each triangle is met in the same way.

mod carried;
mod damped;
mod faces;
mod contact_state;
mod near;
mod search;
mod tally;
mod touching;

pub(super) use carried::Carried;
pub use contact_state::ContactState;
pub use search::{Surface, SurfaceError};

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::disjoint::Disjoint;
use super::film::Film;
use super::nodes::{Nodes, Remembered, Vectors};
use super::rigid_body::RigidBody;
use super::thread_pool::ThreadPool;
use near::NearList;
use tally::Tally;
use touching::{Giving, Looking, Piece};

/// Contact of one impactor with all faces of film.
pub struct Contact {
    surface: Surface,
    friction: f64,
    /// How many mirror images of the film the impactor meets.
    multiplicity: f64,
    /// Distance of each node's mid-surface from the impactor when in touch, m: the film in between.
    offset: Vec<f64>,
    near: NearList,
    /// The surface's normal at each node near it, zero elsewhere.
    normals: Vec<Vector3<f64>>,
    /// Velocity of the nodes near it half a step earlier, m/s.
    earlier: Vectors,
    /// Velocity of each remembered node after this step if it were not met, m/s; only with damping.
    unmet: Vec<Vector3<f64>>,
    pieces: Vec<Piece>,
    /// Sums since the start, J.
    pub work: Work,
}

/// Penetration of a face between its nodes that is left alone, over the impactor's size: a little less than what is
/// warned of.
const FACE_BOUND: f64 = 0.008;

/// Share of [`FACE_BOUND`] from which the sagitta of an element is watched.
const WATCHED_FROM: f64 = 0.7;

/// Nodes near the impactor that one thread looks at together.
const PIECE: usize = 256;

/// What went through contact since the start, J.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Work {
    /// Given by the impactor.
    pub given: f64,
    /// Lost where nodes first meet the surface.
    pub impact_loss: f64,
    /// Lost by sliding.
    pub friction_loss: f64,
    /// Momentum given to the impactor along z, N s.
    pub impulse: f64,
    /// Half of what was given in the last step: it belongs to the half step after the full one.
    pub ahead: f64,
}

/// What one node got from the impactor in this step, N s.
struct Impulse {
    node: usize,
    arm: Vector3<f64>,
    normal: Vector3<f64>,
    tangential: Vector3<f64>,
}

impl Contact {
    /// Contact of `surface` with film whose nodes keep `offset` (m) from it; `multiplicity` mirror images count.
    pub fn new(surface: Surface, friction: f64, multiplicity: f64, offset: Vec<f64>) -> Contact {
        let nodes = offset.len();
        Contact {
            surface,
            friction,
            multiplicity,
            offset,
            near: NearList::default(),
            normals: vec![Vector3::zeros(); nodes],
            earlier: Vectors::zero(nodes),
            unmet: vec![],
            pieces: vec![],
            work: Work::default(),
        }
    }

    /// The impactor's surface.
    pub fn surface(&self) -> &Surface {
        &self.surface
    }

    /// Tells that film and impactor moved towards each other by at most `distance` (m).
    pub(in crate::engine) fn moved(&mut self, distance: f64) {
        self.near.margin -= distance;
        self.near.pace = distance;
    }

    /// Invalidates the neighbour list, after elements have failed.
    pub(in crate::engine) fn forget(&mut self) {
        self.near.margin = -1.0;
    }

    /// Looks around before the nodes move: lists neighbours where that is due. What comes back takes their velocities.
    pub(super) fn prepare(&mut self, films: &[Film], nodes: &Nodes, body: &RigidBody) -> Remembered<'_> {
        // Nodes are looked at where they will be at the end of the step, so one more step has to fit in the skin.
        if self.near.margin.is_nan() || self.near.margin <= self.near.pace {
            self.list_neighbours(films, nodes, &body.pose);
        }
        Remembered { nodes: &self.near.remembered, velocity: self.earlier.axes_mut().map(Disjoint::new) }
    }

    /// Corrects the velocities of nodes and body, and the places of nodes, so that no node is inside at the end of the step
    /// of `dt` s. The nodes stand there already, the body stands where it was; `before` is its motion before the forces of
    /// this step. Returns the largest speed of a node that was met, m/s.
    pub(in crate::engine) fn meet(
        &mut self,
        nodes: &mut Nodes,
        body: &mut RigidBody,
        before: &RigidBody,
        dt: f64,
        pool: &ThreadPool,
    ) -> f64 {
        self.pieces.resize_with(self.near.pieces.len(), Piece::default);
        self.find_touching(nodes, body, dt, pool);
        let ahead = self.body_ahead(body);
        self.give(nodes, body, &ahead, dt, pool);
        let mut given = self.total();
        body.push_about(&(-self.multiplicity * given.impulse()), &(-self.multiplicity * given.moment()));
        if self.meet_faces(nodes, body, dt) {
            given = self.total();
        }
        self.work.add(&given, self.multiplicity, body, before);
        self.pieces.iter().map(|piece| piece.fastest).fold(0.0, f64::max).sqrt()
    }

    /// What all pieces gave.
    fn total(&self) -> Tally {
        self.pieces.iter().fold(Tally::default(), |sum, piece| sum + piece.tally)
    }

    /// Nodes that lie inside.
    fn find_touching(&mut self, nodes: &Nodes, body: &RigidBody, dt: f64, pool: &ThreadPool) {
        let near = &self.near;
        let mut body = body.clone();
        body.pose = body.predicted(dt);
        let looking = Looking {
            surface: &self.surface,
            friction: self.friction,
            multiplicity: self.multiplicity,
            offset: &self.offset,
            normals: (!near.watched.is_empty()).then(|| Disjoint::new(&mut self.normals)),
            nodes,
            body: &body,
            per_second: 1.0 / dt,
        };
        let pieces = Disjoint::new(&mut self.pieces);
        pool.each(near.pieces.len(), |part| {
            // SAFETY: every piece comes up once.
            let piece = unsafe { pieces.at(part) };
            touching::find(pool.width(), &looking, &near.nodes[near.pieces[part].clone()], piece);
        });
    }

    /// The body as it will move once all touching nodes have taken their momentum.
    fn body_ahead(&self, body: &RigidBody) -> RigidBody {
        let mut touching = self.pieces.iter().filter(|piece| piece.is_touched());
        let Some(first) = touching.next() else { return body.clone() };
        let all = touching.fold(first.gathered.clone(), |all, piece| all.and(&piece.gathered));
        body.after(&all)
    }

    /// Gives the touching nodes the momentum with which they follow the body as it will move `ahead`, moves them on, and adds up
    /// what went through them.
    fn give(&mut self, nodes: &mut Nodes, body: &RigidBody, ahead: &RigidBody, dt: f64, pool: &ThreadPool) {
        let pieces = Disjoint::new(&mut self.pieces);
        let (friction, earlier, nodes) = (self.friction, &self.earlier, nodes.met());
        let keep = !self.near.watched.is_empty();
        let giving = Giving { friction, earlier, nodes, body, ahead, dt, keep };
        pool.each(self.near.pieces.len(), |part| {
            // SAFETY: every piece comes up once.
            touching::give(pool.width(), &giving, unsafe { pieces.at(part) });
        });
    }

    /// Nodes that the impactor touched in the last step.
    pub fn nodes_in_contact(&self) -> impl Iterator<Item = usize> + '_ {
        let kept = self.pieces.iter().flat_map(|piece| &piece.impulses).map(|impulse| impulse.node);
        let given = self.pieces.iter().filter(|_| self.near.watched.is_empty()).flat_map(Piece::touched);
        kept.chain(given)
    }
}
