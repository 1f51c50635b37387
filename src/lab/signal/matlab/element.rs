//! Data elements: a kind, a length, and the bytes.

use super::Fault;

/// Kinds of elements.
pub const INT8: u32 = 1;
pub const INT32: u32 = 5;
pub const UINT32: u32 = 6;
pub const MATRIX: u32 = 14;
pub const COMPRESSED: u32 = 15;

/// Elements, one after the other.
#[derive(Clone, Copy)]
pub struct Elements<'a> {
    bytes: &'a [u8],
    at: usize,
    pub is_big: bool,
    pub is_unpacked: bool,
}

/// One element.
#[derive(Clone, Copy)]
pub struct Element<'a> {
    pub kind: u32,
    pub bytes: &'a [u8],
    /// Place of its bytes.
    pub at: usize,
}

impl<'a> Elements<'a> {
    /// Those in `bytes` from the place `at` on.
    pub fn new(bytes: &'a [u8], at: usize, is_big: bool, is_unpacked: bool) -> Elements<'a> {
        Elements { bytes, at, is_big, is_unpacked }
    }

    /// Those within `element`, which is one of these.
    pub fn within(&self, element: &Element<'a>) -> Elements<'a> {
        Elements { bytes: &self.bytes[..element.at + element.bytes.len()], at: element.at, ..*self }
    }

    /// Whether none is left; fewer bytes than a tag are filler.
    pub fn is_at_end(&self) -> bool {
        self.at + 8 > self.bytes.len()
    }

    /// The next one, which is `what`.
    pub fn next(&mut self, what: &'static str) -> Result<Element<'a>, Fault> {
        let ends = Fault::Ends { at: self.at, is_unpacked: self.is_unpacked, what };
        let tag = self.bytes.get(self.at..self.at + 8);
        let Some(tag) = tag else { return Err(ends) };
        let word = |at: usize| number(&tag[at..at + 4], self.is_big);
        let (first, second) = (word(0), word(4));
        // Up to four bytes are in the tag itself.
        if first >> 16 != 0 {
            let (kind, length) = (first & 0xffff, (first >> 16) as usize);
            let bytes = tag[4..].get(..length).ok_or(ends)?;
            let element = Element { kind, bytes, at: self.at + 4 };
            self.at += 8;
            return Ok(element);
        }
        let at = self.at + 8;
        let end = at.checked_add(second as usize).filter(|end| *end <= self.bytes.len());
        let Some(end) = end else { return Err(ends) };
        self.at = if first == COMPRESSED { end } else { end.next_multiple_of(8).min(self.bytes.len()) };
        Ok(Element { kind: first, bytes: &self.bytes[at..end], at })
    }

    /// The next one, of this kind.
    pub fn expect(&mut self, kind: u32, what: &'static str) -> Result<Element<'a>, Fault> {
        let element = self.next(what)?;
        if element.kind == kind { Ok(element) } else { Err(self.wrong(&element, what)) }
    }

    /// The fault of an element in place of `what`.
    pub fn wrong(&self, element: &Element, what: &'static str) -> Fault {
        Fault::Element { at: element.at, is_unpacked: self.is_unpacked, what, found: element.kind }
    }
}

/// Four bytes as a number.
pub fn number(bytes: &[u8], is_big: bool) -> u32 {
    let mut word = [0; 4];
    word.copy_from_slice(bytes);
    if is_big { u32::from_be_bytes(word) } else { u32::from_le_bytes(word) }
}

/// Bytes of a number of a kind; 1 of one that is no number.
pub fn number_width(kind: u32) -> usize {
    match kind {
        3 | 4 => 2,
        5..=7 => 4,
        9 | 12 | 13 => 8,
        _ => 1,
    }
}

/// The numbers of an element of a numeric kind.
pub fn numbers(element: &Element, is_big: bool) -> Option<Vec<f64>> {
    macro_rules! of {
        ($type:ty) => {
            element
                .bytes
                .chunks_exact(size_of::<$type>())
                .filter_map(|bytes| bytes.try_into().ok())
                .map(|bytes| if is_big { <$type>::from_be_bytes(bytes) } else { <$type>::from_le_bytes(bytes) } as f64)
                .collect()
        };
    }
    Some(match element.kind {
        INT8 => of!(i8),
        2 => of!(u8),
        3 => of!(i16),
        4 => of!(u16),
        INT32 => of!(i32),
        UINT32 => of!(u32),
        7 => of!(f32),
        9 => of!(f64),
        12 => of!(i64),
        13 => of!(u64),
        _ => return None,
    })
}

/// The text of an element of characters.
pub fn text(element: &Element, is_big: bool) -> String {
    match element.kind {
        4 | 17 => {
            let units = element.bytes.chunks_exact(2).map(|pair| match is_big {
                true => u16::from_be_bytes([pair[0], pair[1]]),
                false => u16::from_le_bytes([pair[0], pair[1]]),
            });
            char::decode_utf16(units).map(|letter| letter.unwrap_or(char::REPLACEMENT_CHARACTER)).collect()
        }
        _ => String::from_utf8_lossy(element.bytes).into_owned(),
    }
}
