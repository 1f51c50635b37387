//! The header of an ISO-MME file: a key and a value a line.

use super::fault::Fault;

/// Most lines of a header: a list of as many channels as can be counted, and more.
const MOST_LINES: usize = 20_000;

/// Longest header, bytes.
const LONGEST: usize = 4 << 20;

/// Keys and values in the order of the file; keys may stand several times, as comments do.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Header {
    entries: Vec<Entry>,
    /// Of the lines that were added.
    bytes: usize,
}

/// One line of a header.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    /// As the file writes it.
    pub key: String,
    /// None where nothing is stated: NOVALUE, NONE or nothing at all.
    pub value: Option<String>,
    /// Counted from one.
    pub line: usize,
}

impl Header {
    /// Adds a line; false where it is not one of a header, with a key and a colon.
    pub fn take(&mut self, line: &str, number: usize) -> Result<bool, Fault> {
        let Some((key, value)) = line.split_once(':') else {
            return Ok(false);
        };
        self.bytes += line.len();
        if self.entries.len() >= MOST_LINES || self.bytes > LONGEST {
            return Err(Fault::HeaderTooLong);
        }
        self.entries.push(Entry { key: key.trim().to_owned(), value: stated(value), line: number });
        Ok(true)
    }

    /// All lines.
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// The value of the first line with this key, however it is capitalised; none where nothing is stated.
    pub fn text(&self, key: &str) -> Option<&str> {
        self.entry(key)?.value.as_deref()
    }

    /// The number that is stated for a key, and the line it stands in.
    pub fn number(&self, key: &str) -> Result<Option<f64>, (usize, Fault)> {
        let Some((entry, text)) = self.entry(key).and_then(|entry| Some((entry, entry.value.as_ref()?))) else {
            return Ok(None);
        };
        let number = text.parse::<f64>().ok().filter(|number| number.is_finite());
        let fault = || Fault::HeaderNumber { key: key.to_owned(), found: text.clone() };
        number.map(Some).ok_or_else(|| (entry.line, fault()))
    }

    /// The line of a key; zero where it is missing.
    pub fn line(&self, key: &str) -> usize {
        self.entry(key).map_or(0, |entry| entry.line)
    }

    fn entry(&self, key: &str) -> Option<&Entry> {
        self.entries.iter().find(|entry| entry.key.eq_ignore_ascii_case(key))
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
        assert_eq!(header.entries().iter().filter(|entry| entry.key == "Comments").count(), 2);
        assert_eq!(header.number("Sampling interval").unwrap(), Some(1e-4));
        assert!(matches!(header.number("Number of samples"), Err((7, Fault::HeaderNumber { .. }))));
    }
}
