//! Serialisation of rows of `K` numbers: serde has arrays of literal lengths only.

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Many rows as one flat list.
pub(super) fn serialize<S: Serializer, const K: usize>(rows: &[[f64; K]], to: S) -> Result<S::Ok, S::Error> {
    rows.as_flattened().serialize(to)
}

pub(super) fn deserialize<'de, D: Deserializer<'de>, const K: usize>(from: D) -> Result<Vec<[f64; K]>, D::Error> {
    let flat = Vec::<f64>::deserialize(from)?;
    let (rows, rest) = flat.as_chunks::<K>();
    if rest.is_empty() { Ok(rows.to_vec()) } else { Err(D::Error::invalid_length(flat.len(), &"whole rows")) }
}

/// One row as a list.
pub(super) mod one {
    use super::*;

    pub(in crate::simulate) fn serialize<S: Serializer, const K: usize>(
        row: &[f64; K],
        to: S,
    ) -> Result<S::Ok, S::Error> {
        row.as_slice().serialize(to)
    }

    pub(in crate::simulate) fn deserialize<'de, D: Deserializer<'de>, const K: usize>(
        from: D,
    ) -> Result<[f64; K], D::Error> {
        let row = Vec::<f64>::deserialize(from)?;
        row.try_into().map_err(|row: Vec<f64>| D::Error::invalid_length(row.len(), &"one row"))
    }
}
