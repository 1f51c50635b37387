//! Memory of the engine's arrays.

use super::element::{Blocks, ViscousPoints};

/// Bytes of the entries of a slice.
pub(super) fn bytes<T>(entries: &[T]) -> usize {
    size_of_val(entries)
}

/// Bytes of elements of one kind.
pub(super) fn blocks<B, const NODES: usize, const L: usize>(elements: &Blocks<B, NODES, L>) -> usize {
    let Blocks { count: _, corners, blocks, mass_factors, viscous } = elements;
    bytes(corners) + bytes(blocks) + bytes(mass_factors) + viscous.as_ref().map_or(0, ViscousPoints::bytes)
}
