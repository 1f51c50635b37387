//! What the engine's own arrays take.

use super::element::Blocks;
use super::{Engine, Film, Nodes};

/// Bytes of the entries of a slice.
pub(super) fn bytes<T>(entries: &[T]) -> usize {
    size_of_val(entries)
}

impl Engine {
    /// Bytes of all arrays that grow with the mesh: nodes, elements, contact, and the velocities kept for the audit. What
    /// a vector has in reserve does not count.
    pub fn bytes(&self) -> usize {
        let contact = self.impact.as_ref().map_or(0, |impact| impact.contact.bytes());
        let films: usize = self.films.iter().map(Film::bytes).sum();
        nodes(&self.nodes) + bytes(&self.before.velocity) + films + contact
    }
}

fn nodes(nodes: &Nodes) -> usize {
    let Nodes { position, velocity, force, mass, inverse_mass } = nodes;
    bytes(position) + bytes(velocity) + bytes(force) + bytes(mass) + bytes(inverse_mass)
}

/// Bytes of elements of one kind.
pub(super) fn blocks<const NODES: usize, const POINTS: usize>(blocks: &Blocks<NODES, POINTS>) -> usize {
    let Blocks { count: _, nodes, points, hourglass } = blocks;
    bytes(nodes) + bytes(points) + bytes(hourglass)
}
