//! Segments: what each holds, and where.

use std::fs::File;
use std::io::{BufReader, Read};
use std::rc::Rc;

use super::bytes::Bytes;
use super::chunks::Span;
use super::objects::{List, Objects};
use super::{Fault, TAG};

/// A segment with data.
#[derive(Clone, Debug)]
pub struct Segment {
    pub span: Span,
    pub list: Rc<List>,
}

/// The segments and objects of a file.
#[derive(Debug, Default)]
pub struct Segments {
    pub objects: Objects,
    pub segments: Vec<Segment>,
    /// Bytes that the last segment lacks, where the file ends within it; 0 where it does not state its length.
    pub missing: Option<u64>,
}

/// Bytes before the list of objects.
const LEAD_IN: u64 = 28;
/// Longest list of objects, bytes.
const LONGEST_LIST: u64 = 1 << 26;
/// Most segments of a file.
const MOST_SEGMENTS: usize = 4_000_000;

/// Bits of the table of contents.
const HAS_LIST: u32 = 1 << 1;
const HAS_NEW_LIST: u32 = 1 << 2;
const HAS_DATA: u32 = 1 << 3;
const IS_INTERLEAVED: u32 = 1 << 5;
const IS_BIG: u32 = 1 << 6;

impl Segments {
    /// Reads the segments of a file of `length` bytes, without their data.
    pub fn read(file: &mut BufReader<File>, length: u64) -> Result<Segments, Fault> {
        let mut found = Segments::default();
        let (mut at, mut list, mut held) = (0, None, 0);
        while at < length {
            // A recorder that is stopped leaves a beginning, or zeros that were to be filled.
            let Some(lead) = LeadIn::read(file, at, length)? else {
                found.missing = Some(0);
                break;
            };
            if lead.contents & HAS_LIST != 0 {
                let size = lead.data - at - LEAD_IN;
                if size > LONGEST_LIST {
                    return Err(Fault::LongList { at, bytes: size });
                }
                let mut bytes = Vec::new();
                file.by_ref().take(size).read_to_end(&mut bytes)?;
                let before = list.as_deref().filter(|_| lead.contents & HAS_NEW_LIST == 0);
                let mut bytes = Bytes::new(&bytes, at + LEAD_IN, lead.contents & IS_BIG != 0);
                list = Some(Rc::new(found.objects.read(&mut bytes, before, &mut held)?));
            } else {
                skip(file, lead.data - at - LEAD_IN)?;
            }
            if lead.contents & HAS_DATA != 0 && lead.end > lead.data {
                let list = list.clone().ok_or(Fault::NoObjects { at })?;
                let span = Span {
                    at,
                    data: lead.data,
                    end: lead.end,
                    is_big: lead.contents & IS_BIG != 0,
                    is_interleaved: lead.contents & IS_INTERLEAVED != 0,
                    is_truncated: lead.missing.is_some(),
                };
                found.segments.push(Segment { span, list });
                if found.segments.len() > MOST_SEGMENTS {
                    return Err(Fault::TooMany { at, most: MOST_SEGMENTS, what: "segments" });
                }
            }
            skip(file, lead.end - lead.data)?;
            found.missing = lead.missing;
            at = lead.end;
        }
        Ok(found)
    }
}

fn skip(file: &mut BufReader<File>, bytes: u64) -> Result<(), Fault> {
    Ok(file.seek_relative(i64::try_from(bytes).unwrap_or(i64::MAX))?)
}

/// The beginning of a segment.
struct LeadIn {
    contents: u32,
    data: u64,
    end: u64,
    /// Bytes that the file lacks; 0 where the segment does not state its length.
    missing: Option<u64>,
}

impl LeadIn {
    /// None where the file ends within it or its list of objects.
    fn read(file: &mut BufReader<File>, at: u64, length: u64) -> Result<Option<LeadIn>, Fault> {
        let mut bytes = Vec::new();
        file.by_ref().take(LEAD_IN).read_to_end(&mut bytes)?;
        let is_tag = bytes.starts_with(TAG) || TAG.starts_with(&bytes);
        let is_filler = at > 0 && bytes.iter().all(|byte| *byte == 0);
        if !is_tag && !is_filler {
            let found = String::from_utf8_lossy(&bytes[..bytes.len().min(TAG.len())]).into_owned();
            return Err(Fault::NoSegment { at, found });
        }
        if !is_tag || (bytes.len() as u64) < LEAD_IN {
            return if at > 0 { Ok(None) } else { Err(Fault::Ends { at, what: "the beginning of its first segment" }) };
        }
        // The table of contents says in which order the bytes of the others are, and is itself little-endian.
        let contents = Bytes::new(&bytes[4..8], at + 4, false).u32("the table of contents")?;
        let mut bytes = Bytes::new(&bytes[12..], at + 12, contents & IS_BIG != 0);
        let (size, offset) = (bytes.u64("the length of the segment")?, bytes.u64("the length of the list")?);
        let start = at + LEAD_IN;
        let end = (size != u64::MAX).then(|| start.saturating_add(size));
        let data = start.saturating_add(offset);
        if end.is_some_and(|end| end < data) {
            return Err(Fault::Offsets { at });
        }
        if data > length {
            return if at > 0 { Ok(None) } else { Err(Fault::Ends { at, what: "its first list" }) };
        }
        let missing = match end {
            Some(end) => end.checked_sub(length).filter(|missing| *missing > 0),
            None => Some(0),
        };
        Ok(Some(LeadIn { contents, data, end: end.unwrap_or(length).min(length), missing }))
    }
}
