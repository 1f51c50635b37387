//! Segments: what each holds, and how its data are divided among its channels, in chunks of one channel after the other,
//! in rows of one value a channel, or in the buffers of DAQmx.

use std::cell::RefCell;
use std::fs::File;
use std::io::{BufReader, Read};
use std::rc::Rc;

use super::objects::{Index, List, Member, Objects, Scaler};
use super::value::{Bytes, ends, too_many};
use super::{INDEX_TAG, TAG};
use crate::error::{Error, refusal};
use crate::signal::text::unreadable;

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
    pub fn read(file: &mut BufReader<File>, length: u64) -> Result<Segments, Error> {
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
                    return Err(refusal!("byte {at}: the segment lists objects in {size} bytes"));
                }
                let mut bytes = Vec::new();
                file.by_ref().take(size).read_to_end(&mut bytes).map_err(|error| unreadable(&error))?;
                let before = list.as_deref().filter(|_| lead.contents & HAS_NEW_LIST == 0);
                let mut bytes = Bytes::new(&bytes, at + LEAD_IN, lead.contents & IS_BIG != 0);
                list = Some(Rc::new(found.objects.read(&mut bytes, before, &mut held)?));
            } else {
                skip(file, lead.data - at - LEAD_IN)?;
            }
            if lead.contents & HAS_DATA != 0 && lead.end > lead.data {
                let none = || refusal!("byte {at}: the segment repeats a list of objects that was not given");
                let list = list.clone().ok_or_else(none)?;
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
                    return Err(too_many(at, MOST_SEGMENTS, "segments"));
                }
            }
            skip(file, lead.end - lead.data)?;
            found.missing = lead.missing;
            at = lead.end;
        }
        Ok(found)
    }
}

fn skip(file: &mut BufReader<File>, bytes: u64) -> Result<(), Error> {
    file.seek_relative(i64::try_from(bytes).unwrap_or(i64::MAX)).map_err(|error| unreadable(&error))
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
    fn read(file: &mut BufReader<File>, at: u64, length: u64) -> Result<Option<LeadIn>, Error> {
        let mut bytes = Vec::new();
        file.by_ref().take(LEAD_IN).read_to_end(&mut bytes).map_err(|error| unreadable(&error))?;
        let is_tag = bytes.starts_with(TAG) || TAG.starts_with(&bytes);
        let is_filler = at > 0 && bytes.iter().all(|byte| *byte == 0);
        if !is_tag && !is_filler {
            let found = String::from_utf8_lossy(&bytes[..bytes.len().min(TAG.len())]).into_owned();
            if at == 0 && found.as_bytes() == INDEX_TAG {
                let error = refusal!("it is the index of a TDMS file, without its values");
                return Err(error.with_hint("read the .tdms file beside it"));
            }
            return Err(refusal!("byte {at}: a segment begins with `TDSm`, found {found:?}"));
        }
        if !is_tag || (bytes.len() as u64) < LEAD_IN {
            return if at > 0 { Ok(None) } else { Err(ends(at, "the beginning of its first segment")) };
        }
        // The table of contents says in which order the bytes of the others are, and is itself little-endian.
        let contents = Bytes::new(&bytes[4..8], at + 4, false).u32("the table of contents")?;
        let mut bytes = Bytes::new(&bytes[12..], at + 12, contents & IS_BIG != 0);
        let (size, offset) = (bytes.u64("the length of the segment")?, bytes.u64("the length of the list")?);
        let start = at + LEAD_IN;
        let end = (size != u64::MAX).then(|| start.saturating_add(size));
        let data = start.saturating_add(offset);
        if end.is_some_and(|end| end < data) {
            return Err(refusal!("byte {at}: the raw data of the segment begin beyond its end"));
        }
        if data > length {
            return if at > 0 { Ok(None) } else { Err(ends(at, "its first list")) };
        }
        let missing = match end {
            Some(end) => end.checked_sub(length).filter(|missing| *missing > 0),
            None => Some(0),
        };
        Ok(Some(LeadIn { contents, data, end: end.unwrap_or(length).min(length), missing }))
    }
}

/// The lengths of a chunk.
#[derive(Clone, Debug, Default)]
pub struct Chunks {
    /// Bytes of a chunk before each member, and of a whole one.
    before: Vec<u64>,
    size: u64,
    /// Bytes of a row before each member, and of a whole one.
    row_before: Vec<u64>,
    row: u64,
    /// Rows and their bytes, of each buffer of DAQmx.
    buffers: Vec<[u64; 2]>,
    is_daqmx: bool,
    /// Whether some member is of texts, whose chunks cannot be cut.
    has_texts: bool,
    /// Whether the members have different numbers of values.
    is_uneven: bool,
    /// Why no data can be divided so.
    fault: Option<&'static str>,
    /// Bytes of the last chunk that was cut, and those before each member in it.
    shares: RefCell<(u64, Vec<u64>)>,
}

/// A segment with data: where it is, and how its values follow each other.
#[derive(Clone, Copy, Debug)]
pub struct Span {
    /// Place in the file.
    pub at: u64,
    /// Where its data begin.
    pub data: u64,
    /// Where its data end, at the latest at the end of the file.
    pub end: u64,
    /// Whether more significant bytes come first.
    pub is_big: bool,
    /// Whether the values of the channels alternate.
    pub is_interleaved: bool,
    /// Whether the file ends before its end.
    pub is_truncated: bool,
}

/// Values of one channel at equal distances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Run {
    /// Place of the first in the file.
    pub at: u64,
    pub count: u64,
    /// Bytes from one to the next.
    pub stride: u64,
}

/// The values of one channel in a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Runs {
    /// Those of the first chunk.
    first: Run,
    /// Whole chunks.
    chunks: u64,
    /// Bytes of a chunk.
    size: u64,
    /// Those of the chunk that is cut.
    last: Run,
}

impl Runs {
    /// Number of values.
    pub fn count(&self) -> u64 {
        self.first.count.saturating_mul(self.chunks).saturating_add(self.last.count)
    }

    /// One after the other.
    pub fn iter(self) -> impl Iterator<Item = Run> {
        let Runs { first, chunks, size, last } = self;
        // One value a chunk, as recorders write it that save every sample: its values are at equal distances, too.
        let joined = first.count == 1 && chunks > 1;
        let one = Run { at: first.at, count: chunks, stride: size };
        let whole = (0..if joined { 1 } else { chunks })
            .map(move |chunk| if joined { one } else { Run { at: first.at + chunk * size, ..first } });
        whole.chain(std::iter::once(last)).filter(|run| run.count > 0)
    }
}

impl Chunks {
    /// Of these members.
    pub fn from_members(members: &[Member]) -> Chunks {
        let mut chunks = Chunks::default();
        let mut counts = None;
        let mut widths: Option<&[u32]> = None;
        let mut plain = false;
        for (_, index) in members {
            chunks.before.push(chunks.size);
            chunks.row_before.push(chunks.row);
            let Some(index) = index else { continue };
            chunks.is_uneven |= *counts.get_or_insert(index.count) != index.count;
            match &index.daqmx {
                Some(daqmx) => {
                    chunks.is_daqmx = true;
                    if *widths.get_or_insert(&daqmx.widths) != daqmx.widths {
                        chunks.fault = Some("channels of DAQmx disagree about the widths of their buffers");
                    }
                    chunks.buffers.resize(daqmx.widths.len(), [0; 2]);
                    for (buffer, width) in chunks.buffers.iter_mut().zip(&daqmx.widths) {
                        buffer[1] = u64::from(*width);
                    }
                    for scaler in &daqmx.scalers {
                        if let Some(buffer) = chunks.buffers.get_mut(scaler.buffer) {
                            buffer[0] = buffer[0].max(index.count);
                        }
                    }
                }
                None => {
                    plain = true;
                    chunks.has_texts |= index.kind.width().is_none();
                    chunks.size = chunks.size.saturating_add(index.bytes);
                    chunks.row = chunks.row.saturating_add(index.kind.width().unwrap_or(0) as u64);
                }
            }
        }
        if chunks.is_daqmx && plain {
            chunks.fault = Some("channels of DAQmx and others share a segment");
        }
        if chunks.is_daqmx {
            let bytes = chunks.buffers.iter().map(|[rows, width]| rows.saturating_mul(*width));
            chunks.size = bytes.fold(0, u64::saturating_add);
        }
        chunks
    }

    /// Where the values of a member, or of one scaler of it, are in a `segment` of this list.
    pub fn runs(
        &self,
        segment: &Span,
        members: &[Member],
        place: usize,
        scaler: Option<&Scaler>,
    ) -> Result<Runs, Error> {
        let wrong = |why: &str| refusal!("byte {}: {why}", segment.at);
        let length = segment.end - segment.data;
        if let Some(why) = self.fault {
            return Err(wrong(why));
        }
        if self.size == 0 {
            return Err(wrong("the segment has data that are of none of its channels"));
        }
        if segment.is_interleaved && !self.is_daqmx && (self.is_uneven || self.has_texts) {
            return Err(wrong("interleaved channels need one number of values of one width each"));
        }
        let (chunks, rest) = (length / self.size, length % self.size);
        let data = segment.data;
        let Some(index) = &members[place].1 else {
            let none = Run { at: data, count: 0, stride: 1 };
            return Ok(Runs { first: none, chunks, size: self.size, last: none });
        };
        let end = data + chunks * self.size;
        let (first, last) = match scaler {
            _ if self.is_daqmx => self.in_buffers(index, scaler, rest),
            _ if segment.is_interleaved => {
                let run = Run { at: self.row_before[place], count: index.count, stride: self.row };
                (run, Run { count: rest / self.row.max(1), ..run })
            }
            _ => {
                let width = index.kind.width().unwrap_or(1).max(1) as u64;
                let run = Run { at: self.before[place], count: index.count, stride: width };
                (run, self.cut(segment, members, place, width, rest))
            }
        };
        let first = Run { at: data.saturating_add(first.at), ..first };
        // A chunk that lies beyond the end is not there: its place may be any.
        Ok(Runs { first, chunks, size: self.size, last: Run { at: end.saturating_add(last.at), ..last } })
    }

    /// The values of a member in a last chunk of `rest` bytes: where the file ends, as far as they were written; where the
    /// segment does, the same share of each channel.
    fn cut(&self, segment: &Span, members: &[Member], place: usize, width: u64, rest: u64) -> Run {
        let count = |index: &Index| index.count;
        if self.has_texts || rest == 0 {
            return Run { at: 0, count: 0, stride: width };
        }
        let at = self.before[place];
        if segment.is_truncated {
            let most = members[place].1.as_deref().map_or(0, count);
            return Run { at, count: most.min(rest.saturating_sub(at) / width), stride: width };
        }
        let share = |(_, index): &Member| {
            let count = index.as_deref().map_or(0, count);
            (u128::from(count) * u128::from(rest) / u128::from(self.size)) as u64
        };
        let mut shares = self.shares.borrow_mut();
        if shares.0 != rest {
            let width = |(_, index): &Member| index.as_ref().and_then(|index| index.kind.width()).unwrap_or(0) as u64;
            let before = members.iter().scan(0, |at: &mut u64, member| {
                Some(std::mem::replace(at, at.saturating_add(share(member).saturating_mul(width(member)))))
            });
            *shares = (rest, before.collect());
        }
        Run { at: shares.1[place], count: share(&members[place]), stride: width }
    }

    /// The values of a scaler of DAQmx in a whole chunk, and in one of `rest` bytes.
    fn in_buffers(&self, index: &Index, scaler: Option<&Scaler>, rest: u64) -> (Run, Run) {
        let none = Run { at: 0, count: 0, stride: 1 };
        let scaler = scaler.or_else(|| index.daqmx.as_ref()?.scalers.first());
        let Some((scaler, [_, width])) = scaler.and_then(|scaler| Some((scaler, *self.buffers.get(scaler.buffer)?)))
        else {
            return (none, none);
        };
        let before = self.buffers[..scaler.buffer]
            .iter()
            .map(|[rows, width]| rows.saturating_mul(*width))
            .fold(0, u64::saturating_add);
        let at = before.saturating_add(u64::from(scaler.offset));
        let run = Run { at, count: index.count, stride: width };
        let rows = rest.saturating_sub(before) / width.max(1);
        (run, Run { count: index.count.min(rows), ..run })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::tdms::value::Kind;

    /// To sum all members before each of them would take minutes.
    #[test]
    fn each_of_many_members_has_its_share_of_a_chunk_that_is_cut() {
        let index = |count: u64| Some(Rc::new(Index { kind: Kind::Timestamp, count, bytes: 16 * count, daqmx: None }));
        let members: Vec<Member> = (0..200_000).map(|place| (place, index(2 + place as u64 % 2 * 2))).collect();
        let chunks = Chunks::from_members(&members);
        assert_eq!(chunks.size, 9_600_000);
        for (rest, counts) in [(4_800_000, [1, 2]), (0, [0, 0]), (2_400_000, [0, 1])] {
            let end = 100 + chunks.size + rest;
            let span = Span { at: 0, data: 100, end, is_big: false, is_interleaved: false, is_truncated: false };
            for place in 0..members.len() {
                let last = chunks.runs(&span, &members, place, None).unwrap().last;
                let [even, odd] = counts;
                let before = place as u64 / 2 * (even + odd) + place as u64 % 2 * even;
                let at = if rest == 0 { last.at } else { 100 + chunks.size + 16 * before };
                assert_eq!(last, Run { at, count: counts[place % 2], stride: 16 }, "{rest}, {place}");
            }
        }
    }
}
