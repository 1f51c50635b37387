//! Blocks: a mark, links to others, and data.

use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};

use super::Fault;

/// A block that is read.
#[derive(Clone, Debug)]
pub struct Block {
    pub at: u64,
    pub links: Vec<u64>,
    /// Behind the links.
    pub data: Vec<u8>,
}

/// The file, and how many blocks were read.
pub struct Blocks {
    pub file: BufReader<File>,
    pub length: u64,
    read: u64,
}

/// Bytes before the links.
pub const HEAD: u64 = 24;
/// Most links of a block, most bytes of one that is no data, and most blocks.
const MOST_LINKS: u64 = 1 << 20;
const MOST_BYTES: u64 = 1 << 24;
const MOST_BLOCKS: u64 = 500_000;

impl Blocks {
    /// Of a file of this length.
    pub fn new(file: BufReader<File>, length: u64) -> Blocks {
        Blocks { file, length, read: 0 }
    }

    /// Mark, length and number of links of the block at a place.
    pub fn head(&mut self, at: u64) -> Result<(String, u64, u64), Fault> {
        self.read += 1;
        if self.read > MOST_BLOCKS {
            return Err(Fault::TooMany { at, most: MOST_BLOCKS, what: "blocks" });
        }
        let head = self.bytes(at, HEAD)?;
        let (length, links) = (u64_at(&head, 8), u64_at(&head, 16));
        let end = at.checked_add(length).filter(|end| *end <= self.length);
        if end.is_none() || links > MOST_LINKS || length < HEAD + 8 * links {
            return Err(Fault::Incomplete { at });
        }
        Ok((String::from_utf8_lossy(&head[..4]).into_owned(), length, links))
    }

    /// The block at a place, which has one of these marks.
    pub fn read(&mut self, at: u64, expected: &'static str) -> Result<Block, Fault> {
        let (found, length, links) = self.head(at)?;
        if !expected.split(' ').any(|mark| mark == found) {
            return Err(Fault::Block { at, expected, found });
        }
        if length > MOST_BYTES {
            return Err(Fault::TooMany { at, most: MOST_BYTES, what: "bytes of a block" });
        }
        let bytes = self.bytes(at + HEAD, length - HEAD)?;
        let (first, data) = bytes.split_at(8 * links as usize);
        Ok(Block { at, links: first.chunks_exact(8).map(|link| u64_at(link, 0)).collect(), data: data.to_vec() })
    }

    /// Bytes of the file; fewer are a fault.
    pub fn bytes(&mut self, at: u64, count: u64) -> Result<Vec<u8>, Fault> {
        let mut bytes = Vec::new();
        self.file.seek(SeekFrom::Start(at))?;
        self.file.by_ref().take(count).read_to_end(&mut bytes)?;
        if (bytes.len() as u64) < count { Err(Fault::Incomplete { at }) } else { Ok(bytes) }
    }

    /// The text of the block at a place: all of a text, the element TX of one in XML; none where the link is empty.
    pub fn text(&mut self, at: u64) -> Result<Option<String>, Fault> {
        if at == 0 {
            return Ok(None);
        }
        let block = self.read(at, "##TX ##MD")?;
        let end = block.data.iter().position(|byte| *byte == 0).unwrap_or(block.data.len());
        let text = String::from_utf8_lossy(&block.data[..end]).into_owned();
        let inner =
            text.split_once("<TX>").and_then(|(_, rest)| rest.split_once("</TX>")).map(|(inner, _)| inner.to_owned());
        let is_markup = text.trim_start().starts_with('<');
        Ok(inner
            .or_else(|| (!is_markup).then_some(text))
            .map(|text| text.trim().to_owned())
            .filter(|text| !text.is_empty()))
    }
}

impl Block {
    /// The link at a place; none where there are fewer.
    pub fn link(&self, place: usize) -> u64 {
        self.links.get(place).copied().unwrap_or(0)
    }

    /// The data, if they are at least so many bytes.
    pub fn at_least(&self, count: usize) -> Result<&[u8], Fault> {
        self.data.get(..count).map(|_| self.data.as_slice()).ok_or(Fault::Incomplete { at: self.at })
    }
}

/// Eight bytes at a place, which are there.
pub fn u64_at(bytes: &[u8], at: usize) -> u64 {
    let mut own = [0; 8];
    own.copy_from_slice(&bytes[at..at + 8]);
    u64::from_le_bytes(own)
}

/// Four bytes at a place, which are there.
pub fn u32_at(bytes: &[u8], at: usize) -> u32 {
    let mut own = [0; 4];
    own.copy_from_slice(&bytes[at..at + 4]);
    u32::from_le_bytes(own)
}

/// Two bytes at a place, which are there.
pub fn u16_at(bytes: &[u8], at: usize) -> u16 {
    u16::from_le_bytes([bytes[at], bytes[at + 1]])
}
