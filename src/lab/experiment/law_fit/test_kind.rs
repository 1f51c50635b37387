//! Kinds of tests, and which one a file holds.

use std::fmt;
use std::str::FromStr;

use crate::error::{Error, refusal};
use membrane::material::Tension;

/// The kind of a test.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TestKind {
    /// One stretch and the stress along it.
    Tension(Tension),
    /// Two stretches and both stresses.
    Biaxial,
}

/// Words of a kind: that of a header, that of a name, and others that are read.
const WORDS: [(TestKind, &[&str]); 4] = [
    (TestKind::Tension(Tension::Uniaxial), &["uniaxial", "ut", "uniaxial tension"]),
    (TestKind::Tension(Tension::Equibiaxial), &["equibiaxial", "et", "equibiaxial tension"]),
    (TestKind::Tension(Tension::Plane), &["plane", "ps", "plane tension", "pure shear", "planar", "planar tension"]),
    (TestKind::Biaxial, &["biaxial", "bt", "biaxial tension"]),
];

impl TestKind {
    /// The kind of a file: what is `given`, or else the line `test: uniaxial` of its header or the last word of its
    /// name (`treloar-ut`), which must agree.
    pub fn of_file(name: &str, header: &[String], given: Option<TestKind>) -> Result<TestKind, Error> {
        if let Some(given) = given {
            return Ok(given);
        }
        let pairs = header.iter().filter_map(|line| line.trim_start_matches(['#', ' ']).split_once(':'));
        let mut stated = pairs.filter(|(key, _)| key.trim().eq_ignore_ascii_case("test")).map(|(_, word)| word.parse());
        let header: Option<TestKind> = stated.next().transpose()?;
        let last = name.rsplit(['-', '_', ' ']).next().unwrap_or_default();
        match (named(last), header) {
            (Some(name), Some(header)) if name != header => {
                let error = refusal!("its name states {name}, its header {header}");
                Err(error.with_hint("correct one of them, or give --test"))
            }
            (name, header) => header.or(name).ok_or_else(|| {
                refusal!("the kind of test is not known")
                    .with_hint("write `# test: uniaxial` into its header, name it like treloar-ut.csv, or give --test")
            }),
        }
    }
}

fn named(word: &str) -> Option<TestKind> {
    let word = word.trim().to_lowercase();
    WORDS.into_iter().find(|(_, words)| words.contains(&word.as_str())).map(|(kind, _)| kind)
}

impl FromStr for TestKind {
    type Err = Error;

    fn from_str(word: &str) -> Result<TestKind, Error> {
        named(word).ok_or_else(|| {
            refusal!("`{}` is no kind of test: expected uniaxial, equibiaxial, plane or biaxial", word.trim())
                .with_hint("plane tension is also called pure shear; short: ut, et, ps, biaxial")
        })
    }
}

impl fmt::Display for TestKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            TestKind::Tension(tension) => tension.fmt(f),
            TestKind::Biaxial => f.write_str("biaxial tension"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn header_and_name_state_the_kind() {
        for (name, header, expected) in [
            ("treloar-ut", &[][..], "uniaxial tension"),
            ("ET", &[], "equibiaxial tension"),
            ("sheet 3", &["test: pure shear"], "plane tension"),
            ("a_ps", &["# Test: PS"], "plane tension"),
            ("kawabata-biaxial", &["measured 1981"], "biaxial tension"),
        ] {
            let header: Vec<String> = header.iter().map(|line| (*line).to_owned()).collect();
            assert_eq!(TestKind::of_file(name, &header, None).map(|kind| kind.to_string()), Ok(expected.to_owned()));
        }
    }

    #[test]
    fn unknown_and_contradictory_kinds_are_refused() {
        for (name, header, expected) in [
            ("output", "", "the kind of test is not known"),
            ("x-ut", "test: et", "its name states uniaxial tension, its header equibiaxial tension"),
            ("x", "test: torsion", "`torsion` is no kind of test: expected uniaxial, equibiaxial, plane or biaxial"),
        ] {
            let error = TestKind::of_file(name, &[header.to_owned()], None).expect_err(name);
            assert_eq!(error.to_string(), expected);
            assert_eq!(TestKind::of_file(name, &[header.to_owned()], Some(TestKind::Biaxial)), Ok(TestKind::Biaxial));
        }
    }
}
