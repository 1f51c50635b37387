//! Memory of the engine's arrays.

/// Bytes of the entries of a slice.
pub(super) fn bytes<T>(entries: &[T]) -> usize {
    size_of_val(entries)
}
