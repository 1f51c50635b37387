//! The bytes of a list of objects, read from the first to the last.

use super::Fault;

/// Bytes of a file that are read in order.
pub struct Bytes<'a> {
    bytes: &'a [u8],
    read: usize,
    /// Place of the first of them in the file.
    base: u64,
    is_big: bool,
}

impl<'a> Bytes<'a> {
    pub fn new(bytes: &'a [u8], base: u64, is_big: bool) -> Bytes<'a> {
        Bytes { bytes, read: 0, base, is_big }
    }

    /// Place in the file.
    pub fn at(&self) -> u64 {
        self.base + self.read as u64
    }

    /// Whether more significant bytes come first.
    pub fn is_big(&self) -> bool {
        self.is_big
    }

    /// The next `count` bytes, which are those of `what`.
    pub fn take(&mut self, count: usize, what: &'static str) -> Result<&'a [u8], Fault> {
        let end = self.read.checked_add(count).filter(|end| *end <= self.bytes.len());
        let end = end.ok_or(Fault::Ends { at: self.at(), what })?;
        let taken = &self.bytes[self.read..end];
        self.read = end;
        Ok(taken)
    }

    pub fn u32(&mut self, what: &'static str) -> Result<u32, Fault> {
        self.array(what).map(|bytes| if self.is_big { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) })
    }

    pub fn u64(&mut self, what: &'static str) -> Result<u64, Fault> {
        self.array(what).map(|bytes| if self.is_big { u64::from_be_bytes(bytes) } else { u64::from_le_bytes(bytes) })
    }

    /// A text with its length before it.
    pub fn text(&mut self, what: &'static str) -> Result<String, Fault> {
        let length = self.u32(what)? as usize;
        Ok(String::from_utf8_lossy(self.take(length, what)?).into_owned())
    }

    fn array<const N: usize>(&mut self, what: &'static str) -> Result<[u8; N], Fault> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N, what)?);
        Ok(array)
    }
}
