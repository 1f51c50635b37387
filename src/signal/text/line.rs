//! The lines of a text of unknown length and encoding, one at a time.

use std::borrow::Cow;
use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use encoding_rs::WINDOWS_1252;

use super::error::{Mistake, TextError};
use crate::file;

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
    /// The same line on its own.
    pub fn into_owned(self) -> Line<'static> {
        Line { number: self.number, text: Cow::Owned(self.text.into_owned()), ended: self.ended }
    }
}

/// Reads lines; holds one at a time.
pub struct Lines<R> {
    source: R,
    bytes: Vec<u8>,
    number: usize,
}

impl<R: BufRead> Lines<R> {
    /// The lines of `source` from its first.
    pub fn new(source: R) -> Lines<R> {
        Lines { source, bytes: Vec::new(), number: 0 }
    }

    /// The next line, none at the end: UTF-8 with or without byte order mark, or else Windows-1252.
    pub fn line<F: From<TextError>>(&mut self) -> Result<Option<Line<'_>>, Mistake<F>> {
        self.bytes.clear();
        self.number += 1;
        let number = self.number;
        let at = |error: TextError| Mistake { line: number, column: 1, fault: F::from(error) };
        let read = self.source.by_ref().take(LONGEST).read_until(b'\n', &mut self.bytes);
        let read = read.map_err(|error| at(TextError::Read(error)))?;
        if read == 0 {
            return Ok(None);
        }
        let ended = self.bytes.ends_with(b"\n");
        if !ended && read as u64 == LONGEST {
            return Err(at(TextError::LineTooLong));
        }
        let bytes = without_mark(&self.bytes, self.number);
        if bytes.contains(&0) || (self.number == 1 && UTF_16.iter().any(|mark| bytes.starts_with(mark))) {
            return Err(at(TextError::NotText));
        }
        Ok(Some(Line { number: self.number, text: decoded(without_end(bytes)), ended }))
    }
}

/// The lines of the file at `path`.
pub fn open<F: From<TextError>>(path: &Path) -> Result<Lines<BufReader<File>>, Mistake<F>> {
    let file = file::open(path).map_err(|error| Mistake::whole(F::from(TextError::Open(error))))?;
    Ok(Lines::new(BufReader::with_capacity(1 << 16, file)))
}

/// Byte order marks of an encoding that is not read.
const UTF_16: [[u8; 2]; 2] = [[0xff, 0xfe], [0xfe, 0xff]];

fn without_mark(bytes: &[u8], line: usize) -> &[u8] {
    match bytes.strip_prefix(b"\xef\xbb\xbf") {
        Some(rest) if line == 1 => rest,
        _ => bytes,
    }
}

fn without_end(bytes: &[u8]) -> &[u8] {
    let bytes = bytes.strip_suffix(b"\n").unwrap_or(bytes);
    bytes.strip_suffix(b"\r").unwrap_or(bytes)
}

fn decoded(bytes: &[u8]) -> Cow<'_, str> {
    match std::str::from_utf8(bytes) {
        Ok(text) => Cow::Borrowed(text),
        Err(_) => WINDOWS_1252.decode_without_bom_handling(bytes).0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(bytes: &[u8]) -> Vec<String> {
        let mut lines = Lines::new(bytes);
        let mut texts = Vec::new();
        while let Some(line) = lines.line::<TextError>().unwrap() {
            texts.push(line.text.into_owned());
        }
        texts
    }

    #[test]
    fn encodings_are_detected() {
        assert_eq!(texts("\u{feff}a µ\r\nb".as_bytes()), ["a µ", "b"]);
        assert_eq!(texts(b"a \xb5m\nb \xb0\n"), ["a µm", "b °"]);
    }

    #[test]
    fn binary_files_and_endless_lines_are_refused() {
        assert!(matches!(
            Lines::new(&b"\xff\xfea\0"[..]).line::<TextError>(),
            Err(Mistake { fault: TextError::NotText, .. })
        ));
        assert!(matches!(
            Lines::new(&b"a\0b\n"[..]).line::<TextError>(),
            Err(Mistake { fault: TextError::NotText, .. })
        ));
        assert!(matches!(
            Lines::new(&vec![b'1'; 2 << 20][..]).line::<TextError>(),
            Err(Mistake { fault: TextError::LineTooLong, .. })
        ));
    }
}
