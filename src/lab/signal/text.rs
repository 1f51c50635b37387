//! The lines of a text of unknown length and encoding, one at a time.

use std::borrow::Cow;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::Path;

use encoding_rs::{Encoding, GBK, UTF_16BE, UTF_16LE, WINDOWS_1252};

use crate::error::{Error, refusal};
use base::file;

/// Longest line that is read, bytes; a longer one is no table.
const LONGEST: u64 = 1 << 20;

/// One line without its end.
#[derive(Clone, Debug)]
pub struct Line<'a> {
    /// Counted from one.
    pub number: usize,
    /// Decoded, without its end.
    pub text: Cow<'a, str>,
    /// Whether the line has an end; the last one of a truncated file has none.
    pub ended: bool,
}

impl Line<'_> {
    /// The line with its own text.
    pub fn into_owned(self) -> Line<'static> {
        Line { number: self.number, text: Cow::Owned(self.text.into_owned()), ended: self.ended }
    }
}

/// Reads lines; holds one at a time.
pub struct Lines<R> {
    source: R,
    bytes: Vec<u8>,
    number: usize,
    /// The encoding that a byte order mark of UTF-16 states.
    utf_16: Option<&'static Encoding>,
    /// The encoding of lines that are not UTF-8.
    other: &'static Encoding,
}

impl<R: BufRead + 'static> Lines<R> {
    /// The lines of a source whose type is erased.
    pub fn boxed(self) -> Lines<Box<dyn BufRead>> {
        Lines {
            source: Box::new(self.source),
            bytes: self.bytes,
            number: self.number,
            utf_16: self.utf_16,
            other: self.other,
        }
    }
}

impl<R: BufRead> Lines<R> {
    /// The lines of `source` from its first.
    pub fn new(source: R) -> Lines<R> {
        Lines { source, bytes: Vec::new(), number: 0, utf_16: None, other: WINDOWS_1252 }
    }

    /// The next line, none at the end: UTF-8 with or without byte order mark, UTF-16 with it, or else GBK or
    /// Windows-1252.
    pub fn line(&mut self) -> Result<Option<Line<'_>>, Error> {
        self.bytes.clear();
        self.number += 1;
        let number = self.number;
        let read = self.read().map_err(|error| unreadable(&error).at(number, 1))?;
        if read == 0 {
            return Ok(None);
        }
        let text = match self.utf_16 {
            Some(encoding) => Cow::Owned(encoding.decode_without_bom_handling(&self.bytes).0.into_owned()),
            None => decoded(without_mark(&self.bytes, number), self.other),
        };
        let ended = text.ends_with('\n');
        if !ended && read as u64 >= LONGEST {
            return Err(refusal!("the line is longer than a mebibyte").at(number, 1));
        }
        if text.contains('\0') {
            let error =
                refusal!("text neither in UTF-8, nor in UTF-16 with its byte order mark, nor in GBK or Windows-1252");
            return Err(error.with_hint("save it as UTF-8").at(number, 1));
        }
        Ok(Some(Line { number, text: without_end(text), ended }))
    }

    /// Reads the bytes of one line, and their number with those of a byte order mark.
    fn read(&mut self) -> io::Result<usize> {
        if self.utf_16.is_some() {
            return self.read_units();
        }
        let read = self.source.by_ref().take(LONGEST).read_until(b'\n', &mut self.bytes)?;
        let encoding = UTF_16.into_iter().find(|(mark, _)| self.number == 1 && self.bytes.starts_with(mark));
        let Some((mark, encoding)) = encoding else {
            return Ok(read);
        };
        // The byte of a line feed may be half of another character, and the line go on behind it.
        self.utf_16 = Some(encoding);
        self.bytes.drain(..mark.len());
        let rest = if self.ends_within_unit() || !self.at_line_feed() { self.read_units()? } else { 0 };
        Ok(read + rest)
    }

    /// Reads up to a line feed of two bytes.
    fn read_units(&mut self) -> io::Result<usize> {
        let before = self.bytes.len();
        while (self.bytes.len() as u64) < LONGEST {
            let odd = self.ends_within_unit();
            let wanted = if odd { 1 } else { 2 };
            if self.source.by_ref().take(wanted).read_to_end(&mut self.bytes)? == 0 || self.at_line_feed() {
                break;
            }
        }
        Ok(self.bytes.len() - before)
    }

    fn ends_within_unit(&self) -> bool {
        self.bytes.len() % 2 == 1
    }

    fn at_line_feed(&self) -> bool {
        let feed: &[u8] = if self.utf_16 == Some(UTF_16BE) { b"\0\n" } else { b"\n\0" };
        !self.ends_within_unit() && self.bytes.ends_with(feed)
    }
}

/// The lines of the file at `path`.
pub fn open(path: &Path) -> Result<Lines<BufReader<File>>, Error> {
    let mut lines = Lines::new(BufReader::with_capacity(1 << 16, file::open(path)?));
    let start = lines.source.fill_buf().map_err(|error| unreadable(&error))?;
    if is_gbk(start) {
        lines.other = GBK;
    }
    Ok(lines)
}

/// Refuses a file of which reading failed.
pub(super) fn unreadable(error: &io::Error) -> Error {
    refusal!("cannot be read further: {error}")
}

/// The byte order marks of UTF-16.
const UTF_16: [([u8; 2], &Encoding); 2] = [([0xff, 0xfe], UTF_16LE), ([0xfe, 0xff], UTF_16BE)];

fn without_mark(bytes: &[u8], line: usize) -> &[u8] {
    match bytes.strip_prefix(b"\xef\xbb\xbf") {
        Some(rest) if line == 1 => rest,
        _ => bytes,
    }
}

fn without_end(mut text: Cow<'_, str>) -> Cow<'_, str> {
    let kept = text.strip_suffix('\n').map_or(text.len(), |text| text.strip_suffix('\r').unwrap_or(text).len());
    match &mut text {
        Cow::Borrowed(text) => Cow::Borrowed(&text[..kept]),
        Cow::Owned(text) => {
            text.truncate(kept);
            Cow::Owned(std::mem::take(text))
        }
    }
}

/// Words by one of which a text in GBK is known: names of columns of machines.
const CHINESE: [&str; 10] = ["时间", "力", "位移", "行程", "载荷", "负荷", "变形", "试样", "宽度", "厚度"];

/// Whether a text that starts so is in GBK: it can be read so, and has a word that recordings in Chinese have. Any text could
/// be in Windows-1252.
fn is_gbk(start: &[u8]) -> bool {
    // The last character may be cut.
    let whole = &start[..start.len().saturating_sub(usize::from(start.len() >= 1 << 16))];
    let (text, _, has_errors) = GBK.decode(whole);
    std::str::from_utf8(whole).is_err() && !has_errors && CHINESE.iter().any(|word| text.contains(word))
}

fn decoded<'a>(bytes: &'a [u8], other: &'static Encoding) -> Cow<'a, str> {
    match std::str::from_utf8(bytes) {
        Ok(text) => Cow::Borrowed(text),
        Err(_) => other.decode_without_bom_handling(bytes).0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(bytes: &[u8]) -> Vec<String> {
        let mut lines = Lines::new(bytes);
        let mut texts = Vec::new();
        while let Some(line) = lines.line().unwrap() {
            texts.push(line.text.into_owned());
        }
        texts
    }

    #[test]
    fn utf_16_is_read_by_its_mark() {
        // The bytes of `\u{10a}` and `\u{a01}` hold that of a line feed.
        let text = "Zeit in ms;µ\u{10a}\u{a01}\r\n0,5;1\r\n\u{a01}";
        let expected = ["Zeit in ms;µ\u{10a}\u{a01}", "0,5;1", "\u{a01}"];
        let units = || text.encode_utf16();
        let little = [0xfe_ff].into_iter().chain(units()).flat_map(u16::to_le_bytes);
        let big = [0xfe_ff].into_iter().chain(units()).flat_map(u16::to_be_bytes);
        assert_eq!(texts(&little.collect::<Vec<_>>()), expected);
        assert_eq!(texts(&big.collect::<Vec<_>>()), expected);
        assert_eq!(texts(b"\xff\xfe"), [""]);
    }

    #[test]
    fn binary_files_and_endless_lines_are_refused() {
        let endless = vec![b'1'; 2 << 20];
        for (bytes, expected) in [
            (&b"\xff\xfea\0\0\0"[..], "text neither in UTF-8"),
            (b"a\0b\n", "text neither in UTF-8"),
            (&endless, "the line is longer than a mebibyte"),
        ] {
            let error = Lines::new(bytes).line().unwrap_err();
            assert!(error.message().starts_with(expected), "{error}");
        }
    }
}
