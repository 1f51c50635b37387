//! The mounting frame as a body: its bars, the clamp in which film slips, and the force of the film on it (theory.md,
//! section 17).

use std::collections::BTreeSet;

use nalgebra::Vector2;

use super::fault::RunError;
use super::mount;
use crate::mesh::{Mesh, Outline, Polygon, Side};
use crate::model::loading::Test;
use crate::model::{Bars, Clamp, Hold, Model};
use base::number::significant;
use membrane::engine::{ClampedNode, Contact, Film, Impact, Nodes, Springs, Surface, View};

/// Length by which a straight bar continues beyond the film where the side next to it is free, over its radius.
const BEYOND: f64 = 2.0;

/// Share of the extent of an outline, or of a force, that is round-off.
const NEAR: f64 = 1e-9;

/// The bars of `model` as a body on which film bends, where there are any.
///
/// # Errors
/// They have no volume.
pub(super) fn bars(model: &Model, films: &[Film]) -> Result<Option<Impact>, RunError> {
    let (Some(Bars { radius, friction }), [first, ..], [film, ..]) = (model.frame.bars, model.faces.as_slice(), films)
    else {
        return Ok(None);
    };
    let crest = first.height - 0.5 * film.thickness;
    let lowest = match (model.faces.last(), films.last()) {
        (Some(face), Some(film)) if films.len() > 1 => face.height + 0.5 * film.thickness,
        _ => crest - 2.0 * radius,
    };
    let half_height = (0.5 * (crest - lowest) - radius).max(0.0);
    let lines = match &model.specimen.shape {
        Outline::Rectangle { x, y } => around_rectangle([0.5 * x, 0.5 * y], &model.frame.hold, BEYOND * radius),
        Outline::Polygon(polygon) => around_polygon(polygon, model.specimen.symmetry.mirrors()),
        Outline::Circle { .. } | Outline::Mesh { .. } => return Ok(None),
    };
    let surface = Surface::bars(&lines, radius, half_height)?;
    let offset = films.iter().flat_map(|film| film.nodes.clone().map(|_| 0.5 * film.thickness)).collect();
    let contact = Contact::new(surface, friction, model.specimen.symmetry.copies(), offset);
    Ok(Some(Impact::frame(contact, 0.5 * (crest + lowest), film.thickness)))
}

/// The held edge of film on the crest of bars, whose vertical force on them the contact of the bars does not have.
#[derive(Clone, Debug)]
pub(super) struct Crest {
    /// Counted among all nodes; none without bars.
    nodes: Vec<u32>,
    copies: f64,
}

impl Crest {
    /// The crest of the frame of `model`, before any face is mounted.
    pub(super) fn from_model(model: &Model) -> Crest {
        Crest { nodes: vec![], copies: model.frame.bars.map_or(0.0, |_| model.specimen.symmetry.copies()) }
    }

    /// Adds the nodes of the `held` edges of a face whose first node is the `first` of all.
    pub(super) fn mount(&mut self, held: &[[u32; 2]], first: usize) {
        if self.copies > 0.0 {
            let mut nodes: Vec<u32> = held.iter().flatten().map(|n| first as u32 + n).collect();
            nodes.sort_unstable();
            nodes.dedup();
            self.nodes.append(&mut nodes);
        }
    }

    /// Vertical force of the whole film on it, N, positive downwards; none without bars.
    pub(super) fn force(&self, nodes: &Nodes) -> Option<f64> {
        (!self.nodes.is_empty()).then(|| -self.copies * nodes.held_force(&self.nodes, 2))
    }
}

/// The held sides of a rectangle of these half lengths; beyond a free side they continue.
fn around_rectangle([a, b]: [f64; 2], hold: &Hold, beyond: f64) -> Vec<[[f64; 2]; 2]> {
    let end = |side: Side, at: f64| if hold.holds(side) { at } else { at + beyond };
    let [left, right] = [-end(Side::XMinus, a), end(Side::XPlus, a)];
    let [front, back] = [-end(Side::YMinus, b), end(Side::YPlus, b)];
    let all = [
        (Side::XMinus, [[-a, front], [-a, back]]),
        (Side::XPlus, [[a, front], [a, back]]),
        (Side::YMinus, [[left, -b], [right, -b]]),
        (Side::YPlus, [[left, b], [right, b]]),
    ];
    all.into_iter().filter(|(side, _)| hold.holds(*side)).map(|(_, line)| line).collect()
}

/// The edges of the outline of `polygon` that no mirror plane replaces, and their mirror images.
fn around_polygon(polygon: &Polygon, mirrored: [bool; 2]) -> Vec<[[f64; 2]; 2]> {
    let corners = &polygon.outer;
    let near = NEAR * polygon.extent();
    let is_mirror =
        |[p, q]: &[[f64; 2]; 2]| (0..2).any(|axis| mirrored[axis] && p[axis].abs().max(q[axis].abs()) <= near);
    let edges = (0..corners.len()).map(|k| [corners[k], corners[(k + 1) % corners.len()]]);
    let mut lines: Vec<_> = edges.filter(|edge| !is_mirror(edge)).collect();
    for axis in (0..2).filter(|axis| mirrored[*axis]) {
        let image = |mut point: [f64; 2]| {
            point[axis] = -point[axis];
            point
        };
        let images: Vec<_> = lines.iter().map(|line| line.map(image)).collect();
        lines.extend(images);
    }
    lines
}

/// Largest force (N) of friction in the clamp on the `length` (m) of a face whose edges in it have the length `whole`
/// (m): 2 µF l/L (theory.md, equation 73).
fn friction_of(clamp: Clamp, length: f64, whole: f64) -> f64 {
    2.0 * clamp.friction * clamp.force.0 * length / whole
}

/// Length of the edge from one node of `mesh` to another, m.
fn length_of(mesh: &Mesh, [a, b]: [u32; 2]) -> f64 {
    (mesh.nodes[a as usize] - mesh.nodes[b as usize]).norm()
}

/// Refuses a clamp that cannot hold the pre-strain of the face with `mesh` and the `held` edges, the last of `faces`:
/// it would let go of the film as a shock at the start (theory.md, equation 73).
///
/// # Errors
/// [`RunError::Mounting`].
pub(super) fn check_clamp(model: &Model, faces: usize, mesh: &Mesh, held: &[[u32; 2]]) -> Result<(), RunError> {
    let (Some(clamp), Some(face)) = (model.frame.clamp, model.faces.get(faces - 1)) else { return Ok(()) };
    let pull = |edge: &[u32; 2]| {
        let along = mesh.nodes[edge[1] as usize] - mesh.nodes[edge[0] as usize];
        let normal = along.xy().try_normalize(0.0).map_or(Vector2::zeros(), |t| Vector2::new(t.y, -t.x));
        mount::line_force(face, &normal).norm()
    };
    let pull = held.iter().map(pull).fold(0.0, f64::max);
    let length = model.specimen.symmetry.copies() * held.iter().map(|edge| length_of(mesh, *edge)).sum::<f64>();
    let bound = friction_of(clamp, 1.0, length);
    if pull > bound * (1.0 + NEAR) {
        let message = format!(
            "the pre-strain of face {faces} pulls with {} N/m at its edge, and the clamp holds {} N/m",
            significant(pull, 4),
            significant(bound, 4)
        );
        // Rounded up, so that it holds.
        let hint = format!("a force of {} N holds it", (clamp.force.0 * pull / bound * (1.0 + 1e-9)).ceil());
        return Err(RunError::at_key("frame.clamp.force", message, hint));
    }
    Ok(())
}

/// Nodes of `mesh`, of which `first` is the first of all `nodes`, on the `held` edges, before they are held, with the
/// force that friction in the clamp of `model` can have on each: 2 µF spread evenly over the held length (theory.md,
/// equation 73).
pub(super) fn clamped(model: &Model, nodes: &Nodes, mesh: &Mesh, held: &[[u32; 2]], first: usize) -> Vec<ClampedNode> {
    let Some(clamp) = model.frame.clamp else { return vec![] };
    let mut lengths = vec![0.0; mesh.nodes.len()];
    for edge in held {
        edge.iter().for_each(|n| lengths[*n as usize] += 0.5 * length_of(mesh, *edge));
    }
    let whole = model.specimen.symmetry.copies() * lengths.iter().sum::<f64>();
    let node = |(n, length): (usize, &f64)| ClampedNode {
        node: first + n,
        bound: friction_of(clamp, *length, whole),
        free: nodes.free_axes(first + n),
    };
    lengths.iter().enumerate().filter(|(_, length)| **length > 0.0).map(node).collect()
}

/// The sides of a rectangle that its frame holds, with their nodes on all faces. Other outlines have no sides, and the
/// force of jaws is a signal of its own.
#[derive(Clone, Debug)]
pub(super) struct HeldSides {
    sides: Vec<HeldSide>,
    /// Whether x = 0 and y = 0 are mirror planes.
    mirrored: [bool; 2],
}

#[derive(Clone, Debug)]
struct HeldSide {
    side: Side,
    /// Counted among all nodes; empty where a mirror plane replaces the side.
    nodes: Vec<u32>,
    /// Numbers of the springs on which it hangs.
    springs: Vec<usize>,
}

impl HeldSides {
    /// The held sides of `model`, before any face is mounted.
    pub(super) fn from_model(model: &Model) -> HeldSides {
        let is_rectangle = matches!(model.specimen.shape, Outline::Rectangle { .. });
        let sides = match &model.frame.hold {
            _ if !is_rectangle || model.loading.test() == Test::Stretch => vec![],
            Hold::All => vec![Side::XMinus, Side::XPlus, Side::YMinus, Side::YPlus],
            Hold::Sides(sides) => sides.clone(),
            Hold::None => vec![],
        };
        let sides = sides.into_iter().map(|side| HeldSide { side, nodes: vec![], springs: vec![] }).collect();
        HeldSides { sides, mirrored: model.specimen.symmetry.mirrors() }
    }

    /// Adds the nodes of a face. `first` is the first of all nodes that belongs to `mesh`.
    pub(super) fn mount(&mut self, mesh: &Mesh, first: usize) {
        for held in &mut self.sides {
            held.nodes.extend(mesh.sides[held.side as usize].iter().map(|n| first as u32 + n));
        }
    }

    /// Finds the springs on which each side hangs, after all faces.
    ///
    /// # Errors
    /// [`RunError::Mounting`] where a side hangs on none.
    pub(super) fn tie(&mut self, springs: &Springs) -> Result<(), RunError> {
        let springs = springs.springs();
        for held in &mut self.sides {
            let nodes: BTreeSet<usize> = held.nodes.iter().map(|node| *node as usize).collect();
            // A spring at a corner is on both sides.
            let hangs = |number: &usize| {
                let spring = &springs[*number];
                let mut ends = spring.nodes.iter().zip(spring.shares).filter(|(_, share)| *share > SHARE_ROUND_OFF);
                ends.all(|(node, _)| nodes.contains(node))
            };
            held.springs = (0..springs.len()).filter(hangs).collect();
            // Mirror planes replace a side without nodes.
            if held.springs.is_empty() && !held.nodes.is_empty() {
                let message = format!("no spring stands on the held side `{}`", held.side.name());
                let hint = "use more springs, or name the sides that hang on some in `frame.hold`";
                return Err(RunError::at_key("frame.springs.count", message, hint));
            }
        }
        Ok(())
    }

    /// Mean inward force of the whole film on the held sides across an axis, N; none where no side across it is held,
    /// NaN where mirror planes replace all that are.
    pub(super) fn force(&self, view: &View<'_>, axis: usize) -> Option<f64> {
        self.across(axis).next()?;
        let sides = || self.across(axis).filter(|held| !held.nodes.is_empty());
        let copies = if self.mirrored[1 - axis] { 2.0 } else { 1.0 };
        let force = |held: &HeldSide| {
            let of_springs = view.springs().map(|springs| springs.frame_force(held.springs.iter().copied(), axis));
            of_springs.unwrap_or_else(|| view.nodes.held_force(&held.nodes, axis))
        };
        let inward = |held: &HeldSide| -sign_outward(held.side) * force(held);
        Some(copies * sides().map(inward).sum::<f64>() / sides().count() as f64)
    }

    fn across(&self, axis: usize) -> impl Iterator<Item = &HeldSide> {
        self.sides.iter().filter(move |held| held.side as usize / 2 == axis)
    }
}

/// Share of a spring that is round-off.
const SHARE_ROUND_OFF: f64 = 1e-6;

/// Sign of the outward normal of a side.
fn sign_outward(side: Side) -> f64 {
    match side {
        Side::XMinus | Side::YMinus => -1.0,
        Side::XPlus | Side::YPlus => 1.0,
    }
}
