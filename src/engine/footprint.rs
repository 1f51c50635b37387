//! What the engine's own arrays take.

use super::element::Blocks;
use super::{Engine, Film, PreviousStep};

/// Bytes of the entries of a slice.
pub(super) fn bytes<T>(entries: &[T]) -> usize {
    size_of_val(entries)
}

/// Bytes of elements of one kind.
pub(super) fn blocks<B, const NODES: usize, const L: usize>(elements: &Blocks<B, NODES, L>) -> usize {
    let Blocks { count: _, corners, blocks } = elements;
    bytes(corners) + bytes(blocks)
}

impl Engine {
    /// Bytes of all arrays that grow with the mesh: nodes, elements, contact, and the full step that is kept for observers.
    /// What a vector has in reserve does not count.
    pub fn bytes(&self) -> usize {
        let PreviousStep { position, force, velocity, .. } = &self.previous;
        let previous = position.bytes() + force.bytes() + velocity.bytes();
        let films: usize = self.films.iter().map(Film::bytes).sum();
        let contact = self.impact.as_ref().map_or(0, |impact| impact.contact.bytes());
        self.nodes.bytes() + previous + films + contact
    }
}
