//! The data of a group: in one block, or in a list of them, packed or not.

use std::io::Read;

use flate2::read::ZlibDecoder;

use super::Fault;
use super::block::{Blocks, HEAD, u32_at, u64_at};

/// Most bytes of the data of a group.
const MOST_BYTES: u64 = 1 << 30;

/// The data at a link, as one.
pub fn read(blocks: &mut Blocks, link: u64) -> Result<Vec<u8>, Fault> {
    let mut data = Vec::new();
    let mut next = link;
    while next != 0 {
        let at = next;
        let (kind, length, _) = blocks.head(at)?;
        next = 0;
        match kind.as_str() {
            "##DT" | "##DZ" => append(blocks, (at, &kind, length), &mut data)?,
            "##HL" => next = blocks.read(at, "##HL")?.link(0),
            "##DL" => {
                let list = blocks.read(at, "##DL")?;
                for part in list.links.iter().skip(1).filter(|part| **part != 0) {
                    let (kind, length, _) = blocks.head(*part)?;
                    append(blocks, (*part, &kind, length), &mut data)?;
                }
                next = list.link(0);
            }
            "##DV" | "##LD" => return Err(Fault::Columns { at, kind }),
            _ => return Err(Fault::Block { at, expected: "##DT ##DZ ##DL ##HL", found: kind }),
        }
    }
    Ok(data)
}

fn append(blocks: &mut Blocks, (at, kind, length): (u64, &str, u64), data: &mut Vec<u8>) -> Result<(), Fault> {
    let left = MOST_BYTES.saturating_sub(data.len() as u64);
    let too_many = Fault::TooMany { at, most: MOST_BYTES, what: "bytes of data in a group" };
    match kind {
        "##DT" if length - HEAD > left => Err(too_many),
        "##DT" => {
            data.extend(blocks.bytes(at + HEAD, length - HEAD)?);
            Ok(())
        }
        "##DZ" => {
            let packed = blocks.bytes(at + HEAD, length - HEAD)?;
            let packed_at = |count| packed.get(..count).ok_or(Fault::Incomplete { at });
            let head = packed_at(24)?;
            let (way, columns, stated) = (head[2], u32_at(head, 4) as usize, u64_at(head, 8));
            if stated > left {
                return Err(too_many);
            }
            let mut own = Vec::new();
            let read = ZlibDecoder::new(&packed[24..]).take(stated + 1).read_to_end(&mut own);
            read.map_err(|error| Fault::Packed { at, why: error.to_string() })?;
            if own.len() as u64 != stated {
                return Err(Fault::Packed { at, why: format!("{} bytes instead of {stated}", own.len()) });
            }
            match way {
                0 => data.append(&mut own),
                1 => transpose(&own, columns, data),
                _ => return Err(Fault::Packed { at, why: format!("the way {way} of packing is not known here") }),
            }
            Ok(())
        }
        _ => Err(Fault::Block { at, expected: "##DT ##DZ", found: kind.to_owned() }),
    }
}

/// Appends rows of which the columns are stored one after the other; what is no whole row is as it is.
fn transpose(stored: &[u8], columns: usize, data: &mut Vec<u8>) {
    let rows = stored.len().checked_div(columns).unwrap_or(0);
    data.extend((0..rows).flat_map(|row| (0..columns).map(move |column| stored[column * rows + row])));
    data.extend(&stored[rows * columns..]);
}
