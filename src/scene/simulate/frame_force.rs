//! Force of the film on the mounting frame (theory.md, section 17).

use std::collections::BTreeSet;

use super::fault::RunError;
use crate::mesh::{Mesh, Outline, Side};
use crate::model::{Hold, Model};
use membrane::engine::{Springs, View};

/// The sides of a rectangle that its frame holds, with their nodes on all faces. Other outlines have no sides, and the
/// force of jaws is a signal of its own.
#[derive(Clone, Debug, Default)]
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
            _ if !is_rectangle => vec![],
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
    /// [`RunError::SideWithoutSpring`] where a side hangs on none.
    pub(super) fn tie(&mut self, springs: &Springs) -> Result<(), RunError> {
        let springs = springs.springs();
        for held in &mut self.sides {
            let nodes: BTreeSet<usize> = held.nodes.iter().map(|node| *node as usize).collect();
            // A spring at a corner is on both sides.
            let hangs = |number: &usize| {
                let spring = &springs[*number];
                let mut ends = spring.nodes.iter().zip(spring.shares).filter(|(_, share)| *share > ROUND_OFF);
                ends.all(|(node, _)| nodes.contains(node))
            };
            held.springs = (0..springs.len()).filter(hangs).collect();
            // Mirror planes replace a side without nodes.
            if held.springs.is_empty() && !held.nodes.is_empty() {
                return Err(RunError::SideWithoutSpring { side: held.side });
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
            let of_springs = view.spring_force_of(&held.springs, axis);
            of_springs.unwrap_or_else(|| view.nodes.total_force(&held.nodes, axis))
        };
        let inward = |held: &HeldSide| -outward(held.side) * force(held);
        Some(copies * sides().map(inward).sum::<f64>() / sides().count() as f64)
    }

    fn across(&self, axis: usize) -> impl Iterator<Item = &HeldSide> {
        self.sides.iter().filter(move |held| held.side as usize / 2 == axis)
    }
}

/// Share of a spring that is round-off.
const ROUND_OFF: f64 = 1e-6;

/// Sign of the outward normal of a side.
fn outward(side: Side) -> f64 {
    match side {
        Side::XMinus | Side::YMinus => -1.0,
        Side::XPlus | Side::YPlus => 1.0,
    }
}
