//! Memory of the engine's arrays.

use super::element::{Blocks, Heating, Tearing, ViscousPoints};

/// Bytes of the entries of a slice.
pub(super) fn bytes<T>(entries: &[T]) -> usize {
    size_of_val(entries)
}

/// Bytes of elements of one kind.
pub(super) fn blocks<B, const NODES: usize, const L: usize>(elements: &Blocks<B, NODES, L>) -> usize {
    let Blocks { count: _, corners, blocks, mass_factors, viscous, heating, tearing } = elements;
    let beside = viscous.as_ref().map_or(0, ViscousPoints::bytes)
        + heating.as_ref().map_or(0, Heating::bytes)
        + tearing.as_ref().map_or(0, Tearing::bytes);
    bytes(corners) + bytes(blocks) + bytes(mass_factors) + beside
}
