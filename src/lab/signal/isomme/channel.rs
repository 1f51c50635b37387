//! One channel file: its header, then a value a line.

use super::fault::{Fault, Mistake, ReadError};
use super::files::{Member, MemberLines};
use super::header::{Header, stated};
use crate::signal::Warning;
use crate::signal::channel_fault::{ChannelFault, MOST_VALUES};
use crate::signal::text::Line;
use base::units::{Time, Unit};

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
    pub fn read(file: &Member) -> Result<ChannelHead, ReadError> {
        let header = head(file).map(|(header, ..)| header).map_err(|mistake| mistake.locate(&file.path))?;
        let name = header.text("Channel code").map_or_else(|| file.name(), str::to_owned);
        let label = header.text("Name of the channel").unwrap_or(&name).to_owned();
        Ok(ChannelHead { file: file.clone(), header, name, label })
    }

    /// Whether it is a time axis by its code or its dimension.
    pub fn is_time(&self) -> bool {
        let by_code = code(&self.name).is_some_and(|code| &code[12..14] == "TI");
        by_code || self.header.text("Dimension") == Some("TI")
    }

    /// The channel frequency class that it went through: as the header states, or else by the letter of the
    /// code; a warning where the header states something unknown.
    pub fn class(&self, warnings: &mut Vec<Warning>) -> Option<f64> {
        let stated = self.header.text("Channel frequency class");
        let class = stated.and_then(class_of);
        if let (Some(stated), None) = (stated, class) {
            let (channel, stated) = (self.name.clone(), stated.to_owned());
            warnings.push(Warning::UnknownFilterClass { channel, stated });
        }
        class.or_else(|| class_of_code(&self.name))
    }

    /// The values as they are written; `NaN` where there is none.
    pub fn values(&self) -> Result<Vec<f64>, ReadError> {
        self.read_values(|_| Ok(()))
    }

    /// The values as times in s; a warning where the header does not state their unit.
    pub fn times(&self, warnings: &mut Vec<Warning>) -> Result<Vec<f64>, ReadError> {
        let mut previous = f64::NEG_INFINITY;
        let mut times = self.read_values(|time| {
            if time.is_nan() {
                return Err(Fault::TimeGap { channel: self.name.clone() });
            }
            if time <= previous {
                return Err(ChannelFault::TimeNotIncreasing { time, previous }.into());
            }
            previous = time;
            Ok(())
        })?;
        let Some(symbol) = self.header.text("Unit") else {
            warnings.push(Warning::TimeUnitAssumed { channel: self.name.clone() });
            return Ok(times);
        };
        let unit = Unit::parse(symbol).ok().filter(|unit| unit.measures(Time::DIMENSION));
        let unit = unit.ok_or_else(|| {
            let fault = ChannelFault::TimeUnit { name: self.name.clone(), unit: symbol.to_owned() };
            self.fault_at("Unit", fault.into())
        })?;
        times.iter_mut().for_each(|time| *time = unit.to_si(*time));
        Ok(times)
    }

    /// A number of the header.
    pub fn number(&self, key: &str) -> Result<Option<f64>, ReadError> {
        self.header.number(key).map_err(|(line, fault)| Mistake { line, column: 1, fault }.locate(&self.file.path))
    }

    /// A mistake in the line of a key.
    pub fn fault_at(&self, key: &str, fault: Fault) -> ReadError {
        Mistake { line: self.header.line(key), column: 1, fault }.locate(&self.file.path)
    }

    fn read_values(&self, check: impl FnMut(f64) -> Result<(), Fault>) -> Result<Vec<f64>, ReadError> {
        let (values, last) = self.rows(check).map_err(|mistake| mistake.locate(&self.file.path))?;
        let (channel, found) = (self.name.clone(), values.len());
        let at_end = |fault| Mistake { line: last, column: 1, fault }.locate(&self.file.path);
        match self.number("Number of samples")? {
            Some(stated) if (found as f64) < stated => Err(at_end(Fault::Truncated { channel, stated, found })),
            Some(stated) if found as f64 > stated => Err(at_end(Fault::TooMany { channel, stated, found })),
            _ if found == 0 => Err(at_end(Fault::NoSamples { channel })),
            _ => Ok(values),
        }
    }

    /// The values, and the line that the last of them stands in.
    fn rows(&self, mut check: impl FnMut(f64) -> Result<(), Fault>) -> Result<(Vec<f64>, usize), Mistake> {
        let (_, first, mut lines) = head(&self.file)?;
        let (mut values, mut last) = (Vec::new(), 0);
        let mut push = |line: &Line| {
            let at = |fault| Mistake { line: line.number, column: 1, fault };
            let value = self.value(line.text.trim()).map_err(|fault| at(fault.into()))?;
            check(value).map_err(at)?;
            values.push(value);
            last = line.number;
            let full = values.len() > MOST_VALUES;
            if full { Err(at(Fault::TooLarge { channel: self.name.clone() })) } else { Ok(()) }
        };
        first.as_ref().map(&mut push).transpose()?;
        let mut gap = None;
        while let Some(line) = lines.line()? {
            // Blank lines end a file; one between values would hide that a sample is missing.
            if line.text.trim().is_empty() {
                gap.get_or_insert(line.number);
            } else if let Some(line) = gap {
                let fault = ChannelFault::NotANumber { name: self.name.clone(), found: String::new() };
                return Err(Mistake { line, column: 1, fault: fault.into() });
            } else {
                push(&line)?;
            }
        }
        Ok((values, last))
    }

    fn value(&self, text: &str) -> Result<f64, ChannelFault> {
        let name = || self.name.clone();
        if stated(text).is_none() {
            return Ok(f64::NAN);
        }
        match text.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            Ok(_) => Err(ChannelFault::NotFinite { name: name() }),
            Err(_) => Err(ChannelFault::NotANumber { name: name(), found: text.chars().take(40).collect() }),
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
fn head(file: &Member) -> Result<Head, Mistake> {
    let mut lines = file.lines()?;
    let mut header = Header::default();
    while let Some(line) = lines.line()? {
        if !line.text.trim().is_empty() && !take(&mut header, &line)? {
            let first = line.into_owned();
            return Ok((header, Some(first), lines));
        }
    }
    Ok((header, None, lines))
}

/// All lines of a file that has a header only; other lines are noted.
pub fn read_header(file: &Member, warnings: &mut Vec<Warning>) -> Result<Header, ReadError> {
    let (mut others, mut first) = (0, 0);
    let mut read = || {
        let (mut header, mut lines) = (Header::default(), file.lines()?);
        while let Some(line) = lines.line()? {
            if !line.text.trim().is_empty() && !take(&mut header, &line)? {
                others += 1;
                first = if others == 1 { line.number } else { first };
            }
        }
        Ok(header)
    };
    let header = read().map_err(|mistake: Mistake| mistake.locate(&file.path))?;
    if others > 0 {
        warnings.push(Warning::SkippedHeaderLines { file: file.name(), count: others, first });
    }
    Ok(header)
}

fn take(header: &mut Header, line: &Line) -> Result<bool, Mistake> {
    header.take(&line.text, line.number).map_err(|fault| Mistake { line: line.number, column: 1, fault })
}

/// The class that a header states: `1000`, `CFC 1000`, `CFC1000`, `CFC_1000`.
fn class_of(stated: &str) -> Option<f64> {
    let upper = stated.to_ascii_uppercase();
    let number = upper.strip_prefix("CFC").map_or(upper.as_str(), |rest| rest.trim_start_matches([' ', '_', '-']));
    number.parse::<f64>().ok().filter(|class| class.is_finite() && *class > 0.0)
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
}
