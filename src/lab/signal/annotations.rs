//! Statements of a file beside its numbers, and the warnings of its reading.

use std::fmt::Display;

use super::Warning;
use base::finding::Finding;

/// Longest value that becomes a comment, characters.
const LONGEST: usize = 200;

/// The comments of a file and the warnings of its reading.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Annotations {
    comments: Vec<String>,
    virtual_mark: Option<String>,
    /// Assumptions of the reading, and doubts about the file.
    pub warnings: Vec<Warning>,
}

impl Annotations {
    /// Of a file with these comments in its header.
    pub fn new(comments: Vec<String>) -> Annotations {
        let virtual_mark = virtual_mark(&comments).cloned();
        Annotations { comments, virtual_mark, warnings: Vec::new() }
    }

    /// The comment that a text or a number beside the channels of a file becomes, in one line.
    pub fn value_comment(name: &str, value: impl Display) -> String {
        let value: String = value.to_string().chars().take(LONGEST).collect();
        format!("{name}: {value}").replace(char::is_control, " ")
    }

    /// Statements of the file itself: its comments, and lines before its numbers. They hold as long as the numbers do.
    pub fn comments(&self) -> &[String] {
        &self.comments
    }

    /// The comment that states the channel frequency class with which the channel called `name` was filtered, for
    /// tables, which have no other place for it.
    pub fn filter_comment(name: &str, class: f64) -> String {
        format!("filtered before: {name} with CFC {class}")
    }

    /// The channel frequency class that such a comment states.
    pub fn filter_class(&self, name: &str) -> Option<f64> {
        let stated = |comment: &String| {
            let (channel, class) = comment.strip_prefix("filtered before: ")?.rsplit_once(" with CFC ")?;
            class.parse::<f64>().ok().filter(|class| channel == name && class.is_finite() && *class > 0.0)
        };
        self.comments.iter().find_map(stated)
    }

    /// The comment that states the long name of the channel with the code `name`, for tables, whose columns have codes
    /// alone.
    pub fn name_comment(name: &str, long: &str) -> String {
        format!("long name of {name}: {long}")
    }

    /// The comments without the mark of a virtual recording, which is a finding.
    pub fn free_comments(&self) -> impl Iterator<Item = &String> {
        self.comments.iter().filter(|comment| Some(*comment) != self.virtual_mark.as_ref())
    }

    /// The comment that marks the recording as virtual: computed, not measured.
    pub fn virtual_mark(&self) -> Option<&str> {
        self.virtual_mark.as_deref()
    }

    /// Whether the file marks its recording as virtual.
    pub fn is_virtual(&self) -> bool {
        self.virtual_mark.is_some()
    }

    /// Comments and warnings as texts.
    pub fn notes(&self) -> Vec<String> {
        self.comments.iter().cloned().chain(self.warnings.iter().map(Warning::to_string)).collect()
    }

    /// The warnings as findings, the mark of a virtual recording first.
    pub fn findings(&self) -> Vec<Finding> {
        let mark = self.virtual_mark.clone().map(|comment| Warning::VirtualRecording { comment });
        mark.iter().chain(&self.warnings).map(Finding::new).collect()
    }
}

/// The value of the first line `key: value` among the lines of a header, however the key is capitalised.
pub fn stated<'a>(header: &'a [String], key: &str) -> Option<&'a str> {
    let pairs = header.iter().filter_map(|line| line.trim_start_matches(['#', ' ']).split_once(':'));
    pairs.filter(|(name, _)| name.trim().eq_ignore_ascii_case(key)).map(|(_, value)| value.trim()).next()
}

/// The first of a file's header comments that holds the word `virtual`, which marks what it describes as not measured.
fn virtual_mark(comments: &[String]) -> Option<&String> {
    let is_mark = |word: &str| word.eq_ignore_ascii_case("virtual");
    let has_mark = |comment: &&String| comment.split(|letter: char| !letter.is_alphanumeric()).any(is_mark);
    comments.iter().find(has_mark)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_comment_marks_a_virtual_recording() {
        let marked = Annotations::new(vec!["a".into(), "VIRTUAL recording: nothing was pulled".into()]);
        assert_eq!(marked.virtual_mark(), Some("VIRTUAL recording: nothing was pulled"));
        assert!(!Annotations::new(vec!["virtually nothing was pulled".into()]).is_virtual());
    }
}
