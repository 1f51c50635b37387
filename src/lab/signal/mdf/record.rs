//! Records: one value of each channel of a group.

use super::block::{u32_at, u64_at};

/// Where the value of a channel is in a record.
#[derive(Clone, Debug, PartialEq)]
pub struct Slot {
    /// Number of its kind: unsigned and signed integers and floating-point numbers, each little- and big-endian.
    pub kind: u8,
    pub byte: usize,
    pub bit: u32,
    pub bits: u32,
    /// Bit behind the values that is set where the value is none.
    pub invalid: Option<usize>,
    /// Whether it is the number of the record.
    pub is_number: bool,
}

/// The records of a group in the data of all groups that share them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Records {
    pub id: u64,
    /// Bytes of the values, and of the bits behind them; none of a group whose records have lengths of their own.
    pub lengths: Option<[usize; 2]>,
}

impl Slot {
    /// Whether a record of so many bytes holds it.
    pub fn fits(&self, [values, bits]: [usize; 2]) -> bool {
        let end = self.byte as u64 + (u64::from(self.bit) + u64::from(self.bits)).div_ceil(8);
        let is_inside =
            self.is_number || (end <= values as u64 && (1..=64).contains(&self.bits) && self.bit + self.bits <= 64);
        is_inside && self.invalid.is_none_or(|bit| bit / 8 < bits)
    }

    /// The value in a record that holds it, which is the one of this number.
    pub fn value(&self, record: &[u8], values: usize, number: u64) -> f64 {
        if self.invalid.is_some_and(|bit| record[values + bit / 8] >> (bit % 8) & 1 == 1) {
            return f64::NAN;
        }
        if self.is_number {
            return number as f64;
        }
        let bytes = (self.bit + self.bits).div_ceil(8) as usize;
        let mut own = [0; 8];
        own[..bytes].copy_from_slice(&record[self.byte..self.byte + bytes]);
        if self.kind % 2 == 1 {
            own[..bytes].reverse();
        }
        let unused = 64 - self.bits;
        let bits = u64::from_le_bytes(own) >> self.bit << unused;
        match self.kind {
            0 | 1 => (bits >> unused) as f64,
            2 | 3 => (bits as i64 >> unused) as f64,
            _ if self.bits == 32 => f32::from_bits((bits >> unused) as u32).into(),
            _ => f64::from_bits(bits >> unused),
        }
    }
}

/// Gives every record of the group `own` to `push`; `all` share the data, each record after its number of `id_bytes`. Ends
/// where a record is incomplete or of none of them.
pub fn each<'a>(data: &'a [u8], id_bytes: usize, all: &[Records], own: Records, mut push: impl FnMut(&'a [u8])) {
    let mut rest = data;
    while !rest.is_empty() {
        let Some((id, behind)) = rest.split_at_checked(id_bytes) else { return };
        let id = id.iter().rev().fold(0, |id: u64, byte| id << 8 | u64::from(*byte));
        // Without numbers, all records are those of one group.
        let records = if id_bytes == 0 { Some(&own) } else { all.iter().find(|records| records.id == id) };
        let Some(records) = records else { return };
        let length = match records.lengths {
            Some([values, bits]) => values + bits,
            None if behind.len() < 4 => return,
            None => 4 + u32_at(behind, 0) as usize,
        };
        let Some((record, after)) = behind.split_at_checked(length) else { return };
        if length + id_bytes == 0 {
            return;
        }
        if *records == own {
            push(record);
        }
        rest = after;
    }
}

/// Number of a record's group, and number of its records.
pub fn counts(data: &[u8]) -> [u64; 2] {
    [u64_at(data, 0), u64_at(data, 8)]
}
