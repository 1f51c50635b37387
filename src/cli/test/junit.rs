//! Verdicts as JUnit XML, which servers for continuous integration read.

use std::io::{self, Write};
use std::path::Path;

use quick_xml::Writer;
use quick_xml::events::BytesText;

use crate::{Failure, output};
use base::file;
use scene::expectation::{Difference, Verdict};

/// How a file begins that [`write`] wrote.
const START: &str = "<testsuite name=\"droptower\"";

/// Longest file of verdicts that is replaced, bytes.
const MOST_BYTES: u64 = 64 << 20;

/// Refuses a file that cannot be written, and one of something else, unless by `force`.
pub(super) fn check(path: &Path, force: bool) -> Result<(), Failure> {
    let is_ours = file::read_text(path, MOST_BYTES).is_ok_and(|text| text.starts_with(START));
    output::check(path, "xml", None, Some(force || is_ours))
}

/// Writes one suite with a case for each verdict.
pub(super) fn write(file: &mut dyn Write, verdicts: &[Verdict]) -> io::Result<()> {
    let failed = verdicts.iter().filter(|verdict| !verdict.has_passed()).count();
    let seconds: f64 = verdicts.iter().map(|verdict| verdict.seconds).sum();
    let mut xml = Writer::new_with_indent(file, b' ', 2);
    let suite = xml.create_element("testsuite").with_attributes([
        ("name", "droptower"),
        ("tests", verdicts.len().to_string().as_str()),
        ("failures", failed.to_string().as_str()),
        ("time", format!("{seconds:.3}").as_str()),
    ]);
    let cases = |xml: &mut Xml<'_>| verdicts.iter().try_for_each(|verdict| case(xml, verdict));
    suite.write_inner_content(cases).map_err(io::Error::other)?;
    xml.into_inner().write_all(b"\n")
}

/// The document as it is written.
type Xml<'a> = Writer<&'a mut dyn Write>;

fn case(xml: &mut Xml<'_>, verdict: &Verdict) -> Result<(), quick_xml::Error> {
    let time = format!("{:.3}", verdict.seconds);
    let attributes = [("name", verdict.name.as_str()), ("classname", "droptower"), ("time", time.as_str())];
    let element = xml.create_element("testcase").with_attributes(attributes);
    if verdict.has_passed() {
        return element.write_empty().map(drop);
    }
    let lines: Vec<String> = verdict.differences.iter().map(Difference::to_string).collect();
    let first = lines.first().map_or("", String::as_str);
    let failure = |xml: &mut Xml<'_>| {
        let failure = xml.create_element("failure").with_attribute(("message", first));
        failure.write_text_content(BytesText::new(&lines.join("\n"))).map(drop)
    };
    element.write_inner_content(failure).map(drop)
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::expectation::{Expectations, Recorded};

    #[test]
    fn verdicts_are_cases_whose_text_is_escaped() {
        let verdict = |name: &str, differences: Vec<Difference>| Verdict {
            name: name.into(),
            expectations: Expectations::default(),
            differences,
            recorded: Recorded::default(),
            signals: None,
            seconds: 0.25,
            blessed: false,
        };
        let failed = vec![
            Difference::RunFailed { cause: "a < b & \"c\"".into() },
            Difference::NoFinding { finding: "coarse-contact".into() },
        ];
        let mut text = Vec::new();
        write(&mut text, &[verdict("a", vec![]), verdict("b \"<", failed)]).unwrap();
        let expected = r#"<testsuite name="droptower" tests="2" failures="1" time="0.500">
  <testcase name="a" classname="droptower" time="0.250"/>
  <testcase name="b &quot;&lt;" classname="droptower" time="0.250">
    <failure message="the run failed: a &lt; b &amp; &quot;c&quot;">the run failed: a &lt; b &amp; &quot;c&quot;
the finding coarse-contact did not come</failure>
  </testcase>
</testsuite>
"#;
        assert!(expected.starts_with(START));
        assert_eq!(String::from_utf8(text).unwrap(), expected);
    }
}
