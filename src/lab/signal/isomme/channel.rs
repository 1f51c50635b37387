//! One channel file: its header with a key and a value a line, then a value a line.

use super::files::{Member, MemberLines};
use crate::error::{Error, refusal};
use crate::signal::Warning;
use crate::signal::measurement::{MOST_VALUES, not_a_number, not_finite};
use crate::signal::text::Line;

/// A channel of which only the header was read.
#[derive(Clone, Debug)]
pub struct ChannelHead {
    pub file: Member,
    pub header: Header,
    /// The channel code, or the name of the file where none is stated.
    pub name: String,
    /// The long name, or else the code.
    pub label: String,
}

impl ChannelHead {
    /// Reads the header of `file`.
    pub fn read(file: &Member) -> Result<ChannelHead, Error> {
        let header = head(file).map(|(header, ..)| header).map_err(|error| error.in_file(&file.path))?;
        let name = header.text("Channel code").map_or_else(|| file.name(), str::to_owned);
        let label = header.text("Name of the channel").unwrap_or(&name).to_owned();
        Ok(ChannelHead { file: file.clone(), header, name, label })
    }

    /// Whether it is a time axis by its code or its dimension.
    pub fn is_time(&self) -> bool {
        let by_code = code(&self.name).is_some_and(|code| &code[12..14] == "TI");
        by_code || self.header.text("Dimension") == Some("TI")
    }

    /// The channel frequency class that it went through: as the header states, or else by the letter of the code.
    pub fn class(&self) -> Option<f64> {
        self.header.text("Channel frequency class").and_then(class_of).or_else(|| class_of_code(&self.name))
    }

    /// The warning of a class that the header states and that is unknown.
    pub fn unknown_class(&self) -> Option<Warning> {
        let stated = self.header.text("Channel frequency class").filter(|stated| class_of(stated).is_none())?;
        Some(Warning::UnknownFilterClass { channel: self.name.clone(), stated: stated.to_owned() })
    }

    /// Whether another channel has its times.
    pub fn is_explicit(&self) -> bool {
        self.axis_kind().as_deref() == Some("explicit")
    }

    /// Whether the header says how its times are given.
    pub fn has_axis_kind(&self) -> bool {
        matches!(self.axis_kind().as_deref(), Some("explicit" | "implicit"))
    }

    fn axis_kind(&self) -> Option<String> {
        self.header.text("Reference channel").map(str::to_lowercase)
    }

    /// The key of the line that gives its times.
    pub fn axis_key(&self) -> &'static str {
        if self.is_explicit() { "Reference channel name" } else { "Sampling interval" }
    }

    /// The values as they are written; `NaN` where there is none.
    pub fn values(&self) -> Result<Vec<f64>, Error> {
        let (values, last) = self.rows().map_err(|error| error.in_file(&self.file.path))?;
        let (channel, found) = (&self.name, values.len());
        let at_end = |error: Error| error.at(last, 1).in_file(&self.file.path);
        match self.number("Number of samples")? {
            Some(stated) if (found as f64) < stated => {
                Err(at_end(refusal!("`{channel}` is truncated: {found} of {stated} samples")))
            }
            Some(stated) if found as f64 > stated => {
                Err(at_end(refusal!("`{channel}` has {found} samples, but its header states {stated}")))
            }
            _ if found == 0 => Err(at_end(refusal!("`{channel}` has no samples"))),
            _ => Ok(values),
        }
    }

    /// A number of the header.
    pub fn number(&self, key: &str) -> Result<Option<f64>, Error> {
        self.header.number(key).map_err(|error| error.in_file(&self.file.path))
    }

    /// A mistake in the line of a key.
    pub fn fault_at(&self, key: &str, error: Error) -> Error {
        error.at(self.header.line(key), 1).in_file(&self.file.path)
    }

    /// A mistake in the line of a sample, counted from zero; the values follow each other.
    pub fn fault_in(&self, sample: usize, error: Error) -> Error {
        let first = head(&self.file).ok().and_then(|(_, first, _)| first).map_or(0, |line| line.number + sample);
        error.at(first, 1).in_file(&self.file.path)
    }

    /// The values, and the line that the last of them stands in.
    fn rows(&self) -> Result<(Vec<f64>, usize), Error> {
        let (_, first, mut lines) = head(&self.file)?;
        let (mut values, mut last) = (Vec::new(), 0);
        let mut push = |line: &Line| {
            let at = |error: Error| error.at(line.number, 1);
            values.push(self.value(line.text.trim()).map_err(at)?);
            last = line.number;
            if values.len() <= MOST_VALUES {
                return Ok(());
            }
            Err(at(refusal!("`{}` has more than {MOST_VALUES} samples", self.name)))
        };
        first.as_ref().map(&mut push).transpose()?;
        let mut gap = None;
        while let Some(line) = lines.line()? {
            // Blank lines end a file; one between values would hide that a sample is missing.
            if line.text.trim().is_empty() {
                gap.get_or_insert(line.number);
            } else if let Some(line) = gap {
                return Err(not_a_number(&self.name, "").at(line, 1));
            } else {
                push(&line)?;
            }
        }
        Ok((values, last))
    }

    fn value(&self, text: &str) -> Result<f64, Error> {
        if stated(text).is_none() {
            return Ok(f64::NAN);
        }
        match text.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            Ok(_) => Err(not_finite(&self.name).with_hint("write NOVALUE where nothing was measured")),
            Err(_) => Err(not_a_number(&self.name, &text.chars().take(40).collect::<String>())),
        }
    }
}

/// The channel code that `name` is, in capitals: sixteen letters, digits and question marks that say what was measured where; the
/// physical dimension is in two of them, the filter class in the last.
fn code(name: &str) -> Option<String> {
    let fits = name.len() == 16 && name.bytes().all(|letter| letter.is_ascii_alphanumeric() || letter == b'?');
    fits.then(|| name.to_ascii_uppercase())
}

/// The channel frequency class that the letter of a code names (SAE J211-1).
fn class_of_code(name: &str) -> Option<f64> {
    Some(match code(name)?.as_bytes()[15] {
        b'A' => 1000.0,
        b'B' => 600.0,
        b'C' => 180.0,
        b'D' => 60.0,
        _ => return None,
    })
}

type Head = (Header, Option<Line<'static>>, MemberLines);

/// The header of `file`, the first line of its values, and the lines that follow.
fn head(file: &Member) -> Result<Head, Error> {
    let mut lines = file.lines()?;
    let mut header = Header::default();
    while let Some(line) = lines.line()? {
        if !line.text.trim().is_empty() && !header.take(&line.text, line.number)? {
            let first = line.into_owned();
            return Ok((header, Some(first), lines));
        }
    }
    Ok((header, None, lines))
}

/// All lines of a file that has a header only; other lines are noted.
pub fn read_header(file: &Member, warnings: &mut Vec<Warning>) -> Result<Header, Error> {
    let (mut others, mut first) = (0, 0);
    let mut read = || {
        let (mut header, mut lines) = (Header::default(), file.lines()?);
        while let Some(line) = lines.line()? {
            if !line.text.trim().is_empty() && !header.take(&line.text, line.number)? {
                others += 1;
                first = if others == 1 { line.number } else { first };
            }
        }
        Ok(header)
    };
    let header = read().map_err(|error: Error| error.in_file(&file.path))?;
    if others > 0 {
        warnings.push(Warning::SkippedHeaderLines { file: file.name(), count: others, first });
    }
    Ok(header)
}

/// The class that a header states: `1000`, `CFC 1000`, `CFC1000`, `CFC_1000`.
fn class_of(stated: &str) -> Option<f64> {
    let upper = stated.to_ascii_uppercase();
    let number = upper.strip_prefix("CFC").map_or(upper.as_str(), |rest| rest.trim_start_matches([' ', '_', '-']));
    number.parse::<f64>().ok().filter(|class| class.is_finite() && *class > 0.0)
}

/// Most lines of a header: a list of as many channels as can be counted, and more.
const MOST_LINES: usize = 20_000;

/// Longest header, bytes.
const LONGEST: usize = 4 << 20;

/// Keys and values in the order of the file; keys may stand several times, as comments do.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Header {
    lines: Vec<HeaderLine>,
    /// Of the lines that were added.
    bytes: usize,
}

/// One line of a header.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HeaderLine {
    /// As the file writes it.
    pub key: String,
    /// None where nothing is stated: NOVALUE, NONE or nothing at all.
    pub value: Option<String>,
    /// Counted from one.
    pub line: usize,
}

impl Header {
    /// Adds a line; false where it is not one of a header, with a key and a colon.
    pub fn take(&mut self, line: &str, number: usize) -> Result<bool, Error> {
        let Some((key, value)) = line.split_once(':') else {
            return Ok(false);
        };
        self.bytes += line.len();
        if self.lines.len() >= MOST_LINES || self.bytes > LONGEST {
            return Err(refusal!("the header is too long").at(number, 1));
        }
        self.lines.push(HeaderLine { key: key.trim().to_owned(), value: stated(value), line: number });
        Ok(true)
    }

    /// All lines.
    pub fn lines(&self) -> &[HeaderLine] {
        &self.lines
    }

    /// The value of the first line with this key, however it is capitalised; none where nothing is stated.
    pub fn text(&self, key: &str) -> Option<&str> {
        self.entry(key)?.value.as_deref()
    }

    /// The number that is stated for a key.
    pub fn number(&self, key: &str) -> Result<Option<f64>, Error> {
        let Some((entry, text)) = self.entry(key).and_then(|entry| Some((entry, entry.value.as_ref()?))) else {
            return Ok(None);
        };
        let number = text.parse::<f64>().ok().filter(|number| number.is_finite());
        number.map(Some).ok_or_else(|| refusal!("`{key}` is not a number: `{text}`").at(entry.line, 1))
    }

    /// The line of a key; zero where it is missing.
    pub fn line(&self, key: &str) -> usize {
        self.entry(key).map_or(0, |entry| entry.line)
    }

    fn entry(&self, key: &str) -> Option<&HeaderLine> {
        self.lines.iter().find(|line| line.key.eq_ignore_ascii_case(key))
    }
}

/// A stated value; none for the words that stand for no value.
pub fn stated(value: &str) -> Option<String> {
    let value = value.trim();
    let nothing = value.is_empty() || ["NOVALUE", "NONE"].iter().any(|word| value.eq_ignore_ascii_case(word));
    (!nothing).then(|| value.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_code_names_time_and_filter_class() {
        assert_eq!(code("11headcg0000acxa").as_deref(), Some("11HEADCG0000ACXA"));
        assert_eq!([class_of_code("11HEADCG0000ACXA"), class_of_code("24NECKUP00P2MOZP")], [Some(1000.0), None]);
        for text in ["", "11HEADCG0000ACX", "11HEADCG0000ACXPP", "11HEAD CG000ACXP", "11HEADCG0000AC µ"] {
            assert_eq!(code(text), None, "{text}");
        }
    }

    #[test]
    fn classes_as_they_are_written() {
        for stated in ["1000", "CFC 1000", "cfc1000", "CFC_1000"] {
            assert_eq!(class_of(stated), Some(1000.0), "{stated}");
        }
        for stated in ["P", "prefiltered", "0", "-60", "inf", "CFC"] {
            assert_eq!(class_of(stated), None, "{stated}");
        }
    }

    #[test]
    fn a_header_has_an_end() {
        let mut header = Header::default();
        let taken = (1..).map(|line| header.take("Comments:", line)).take_while(Result::is_ok).count();
        assert_eq!(taken, MOST_LINES);
        let long = format!("Comments:{}", "x".repeat(1 << 20));
        let mut header = Header::default();
        let taken = (1..).map(|line| header.take(&long, line)).take_while(Result::is_ok).count();
        assert_eq!(taken, 3);
    }

    #[test]
    fn keys_and_values_as_they_occur() {
        let mut header = Header::default();
        for (number, line) in [
            "Channel code                :11HEADCG0000ACXP",
            "Movie reference\t\t:NOVALUE",
            "Regulation                  :",
            "Comments                    :Time zero: first contact",
            "Comments                    :second",
            "Sampling interval:1e-4",
            "Number of samples: many",
        ]
        .iter()
        .enumerate()
        {
            assert!(header.take(line, number + 1).unwrap());
        }
        assert!(!header.take("1.5E+00", 8).unwrap());
        assert_eq!(header.text("channel CODE"), Some("11HEADCG0000ACXP"));
        assert_eq!(header.text("Movie reference"), None);
        assert_eq!(header.text("Regulation"), None);
        assert_eq!(header.text("Comments"), Some("Time zero: first contact"));
        assert_eq!(header.lines().iter().filter(|line| line.key == "Comments").count(), 2);
        assert_eq!(header.number("Sampling interval").unwrap(), Some(1e-4));
        let error = header.number("Number of samples").unwrap_err();
        assert_eq!((error.line(), error.message()), (7, "`Number of samples` is not a number: `many`"));
    }
}
