//! `droptower explain formats`: the formats of recordings that are read, and how to convert others.

use serde::Serialize;

use super::{Failure, Shared, print, print_json};
use lab::signal::format::{FORMATS, Format, Support};

/// The word in place of a key that lists all formats.
pub(super) const WORD: &str = "formats";

/// A format as it is explained.
#[derive(Serialize)]
struct Explanation {
    format: &'static str,
    endings: &'static str,
    is_read: bool,
    /// What becomes of its parts.
    read: Option<&'static str>,
    /// The conversion that helps where it is not read.
    convert: Option<&'static str>,
}

impl From<&Format> for Explanation {
    fn from(format: &Format) -> Explanation {
        let (read, convert) = match format.support {
            Support::Read(how) => (Some(how), None),
            Support::Refused(conversion) => (None, Some(conversion)),
        };
        let Format { name, endings, .. } = *format;
        Explanation { format: name, endings, is_read: read.is_some(), read, convert }
    }
}

/// Prints what every format is.
pub(super) fn run(shared: &Shared) -> Result<(), Failure> {
    let all: Vec<Explanation> = FORMATS.iter().map(Explanation::from).collect();
    if shared.json {
        return print_json(&all);
    }
    let text = |one: &Explanation| {
        let what = match (one.read, one.convert) {
            (Some(read), _) => read.to_owned(),
            (None, convert) => format!("not read; {}", convert.unwrap_or_default()),
        };
        format!("{} ({})\n    {what}", one.format, one.endings)
    };
    print(&all.iter().map(text).collect::<Vec<_>>().join("\n\n"))
}
