//! Conversions of stored numbers.

use super::Fault;
use super::block::{Blocks, u16_at, u64_at};

/// What a stored number means.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Conversion {
    #[default]
    Same,
    /// Offset and factor.
    Linear([f64; 2]),
    /// Coefficients of a quotient of two polynomials of second degree, the highest first.
    Rational([f64; 6]),
    /// Pairs by increasing input, linear between them or not.
    Table { pairs: Vec<[f64; 2]>, is_interpolated: bool },
    /// Its kind, which is not read.
    Unread(u8),
}

impl Conversion {
    /// Reads the block at a place, and the link to its unit.
    pub fn read(blocks: &mut Blocks, at: u64) -> Result<(Conversion, u64), Fault> {
        if at == 0 {
            return Ok((Conversion::Same, 0));
        }
        let block = blocks.read(at, "##CC")?;
        let data = block.at_least(24)?;
        let (kind, count) = (data[0], usize::from(u16_at(data, 6)));
        let values = block.at_least(24 + 8 * count)?[24..24 + 8 * count].chunks_exact(8);
        let values: Vec<f64> = values.map(|bytes| f64::from_bits(u64_at(bytes, 0))).collect();
        let conversion = match (kind, &values[..]) {
            (0, _) => Conversion::Same,
            (1, [offset, factor, ..]) => Conversion::Linear([*offset, *factor]),
            (2, [a, b, c, d, e, f, ..]) => Conversion::Rational([*a, *b, *c, *d, *e, *f]),
            (4 | 5, _) => {
                let pairs: Vec<[f64; 2]> = values.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect();
                let rises = !pairs.is_empty() && pairs.windows(2).all(|pair| pair[0][0] < pair[1][0]);
                if rises { Conversion::Table { pairs, is_interpolated: kind == 4 } } else { Conversion::Unread(kind) }
            }
            _ => Conversion::Unread(kind),
        };
        Ok((conversion, block.link(1)))
    }

    /// Why it is not applied.
    pub fn unread(&self) -> Option<String> {
        let what = match self {
            Conversion::Unread(3) => "a formula",
            Conversion::Unread(6) => "a table of ranges",
            Conversion::Unread(7 | 8) => "a table of texts",
            Conversion::Unread(_) => "a kind that is not known here",
            _ => return None,
        };
        Some(format!("its conversion is {what}"))
    }

    /// The value of which `x` is stored.
    pub fn apply(&self, x: f64) -> f64 {
        match self {
            Conversion::Same | Conversion::Unread(_) => x,
            Conversion::Linear([offset, factor]) => offset + factor * x,
            Conversion::Rational([a, b, c, d, e, f]) => ((a * x + b) * x + c) / ((d * x + e) * x + f),
            Conversion::Table { pairs, is_interpolated } => {
                let after = pairs.partition_point(|pair| pair[0] < x).min(pairs.len() - 1);
                let ([x1, y1], [x0, y0]) = (pairs[after], pairs[after.saturating_sub(1)]);
                match (x0 < x && x < x1, is_interpolated) {
                    (true, true) => y0 + (x - x0) * (y1 - y0) / (x1 - x0),
                    // The nearer one; of two that are as near the lower.
                    (true, false) if x - x0 <= x1 - x => y0,
                    _ => y1,
                }
            }
        }
    }
}
