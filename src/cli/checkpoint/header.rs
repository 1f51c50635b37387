//! The header of a checkpoint: the run that it belongs to.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Read, Write};

use serde::{Deserialize, Serialize};

use scene::model::{Identity, Model};
use scene::scenario::{self, Document};
use study::evaluate::build_name;

/// Name and number of the layout, at the start of every checkpoint. The number is raised by hand whenever
/// [`CheckpointHeader`], `simulate::Checkpoint` or anything in them (the model, the engine's `State`, the probe's
/// `Record`) gains, loses or moves a field or gives it another type or meaning: the file holds bare numbers, which
/// another layout would misread, and builds of one version may differ.
const MAGIC: &[u8; 24] = b"droptower checkpoint 08\n";

/// The message for a checkpoint of another layout.
pub(super) const OTHER_LAYOUT: &str = "not a checkpoint of this build of droptower";

/// Tables of a scenario that are read after the run.
const AFTER_THE_RUN: [&str; 3] = ["title", "reference", "post"];

/// Characters beyond which a refusal does not print a value.
const LONGEST_VALUE: usize = 60;

/// Most differing keys that a refusal names.
const MOST_KEYS: usize = 3;

/// The run that a checkpoint belongs to; it precedes the state.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct CheckpointHeader {
    /// The build of droptower: another one may give other bits.
    build: String,
    /// Simulated time between two checkpoints, s; `None` where no further ones are written.
    pub every: Option<f64>,
    /// Whether snapshots have their detail.
    detailed: bool,
    /// The resolved scenario, for messages.
    scenario: String,
    /// All that decides the bits of the run.
    identity: Identity,
}

impl CheckpointHeader {
    /// The header of a run of `model`, checked from `document`.
    ///
    /// # Errors
    /// A mesh cannot be read.
    pub(super) fn new(
        document: &Document,
        model: &Model,
        every: Option<f64>,
        detailed: bool,
    ) -> io::Result<CheckpointHeader> {
        let (scenario, identity) = (document.resolved(), Identity::from_model(model)?);
        Ok(CheckpointHeader { build: build_name().into(), every, detailed, scenario, identity })
    }

    /// Reads the header at the start of a checkpoint.
    pub(super) fn read(file: &mut impl Read) -> io::Result<CheckpointHeader> {
        let mut magic = [0; MAGIC.len()];
        file.read_exact(&mut magic)?;
        if magic != *MAGIC {
            return Err(io::Error::other(OTHER_LAYOUT));
        }
        let mut length = [0; 8];
        file.read_exact(&mut length)?;
        let mut header = Vec::new();
        // As far as the file goes: the length in a damaged file may be any, and is not allocated beforehand.
        file.take(u64::from_le_bytes(length)).read_to_end(&mut header)?;
        postcard::from_bytes(&header).map_err(|_| io::Error::other(OTHER_LAYOUT))
    }

    /// Writes the header at the start of a checkpoint.
    pub(super) fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        let header = postcard::to_allocvec(self).map_err(io::Error::other)?;
        out.write_all(MAGIC)?;
        out.write_all(&(header.len() as u64).to_le_bytes())?;
        out.write_all(&header)
    }

    /// Why a run of this header cannot resume from a checkpoint of another; `None` where it can.
    pub(super) fn differs_from(&self, other: &CheckpointHeader) -> Option<String> {
        if self.build != other.build {
            let (now, then) = (&self.build, &other.build);
            return Some(format!("droptower {then} wrote it, this is {now}: the results may differ in their bits"));
        }
        if self.detailed != other.detailed {
            return Some(format!("it was started with{} --vtu", if other.detailed { "" } else { "out" }));
        }
        if self.identity == other.identity {
            return None;
        }
        let differences = differences(&other.scenario, &self.scenario);
        Some(match differences.as_slice() {
            [] => "the scenario is the same, but a file that it names has changed".into(),
            all if all.len() > MOST_KEYS => {
                format!("{}; and {} more", all[..MOST_KEYS].join("; "), all.len() - MOST_KEYS)
            }
            all => all.join("; "),
        })
    }
}

/// The keys in which the resolved scenario of a checkpoint, `then`, and that of a run, `now`, differ, worded for a
/// message.
fn differences(then: &str, now: &str) -> Vec<String> {
    let [then, now] = [leaves(then), leaves(now)];
    let keys: BTreeSet<&String> = then.keys().chain(now.keys()).collect();
    let difference = |key: &String| match (then.get(key), now.get(key)) {
        (there, here) if there == here => None,
        (Some(there), Some(here)) if there.len().max(here.len()) > LONGEST_VALUE => {
            Some(format!("there `{key}` is another one"))
        }
        (Some(there), Some(here)) => Some(format!("there `{key}` is {there}, here it is {here}")),
        (None, _) => Some(format!("there it has no `{key}`")),
        (_, None) => Some(format!("there it has `{key}`, here it has none")),
    };
    keys.into_iter().filter_map(difference).collect()
}

/// The values of a resolved scenario that determine the run, as TOML, by the paths of their keys.
fn leaves(scenario: &str) -> BTreeMap<String, String> {
    let mut leaves = scenario::leaves(scenario);
    leaves.retain(|path, _| !AFTER_THE_RUN.contains(&path.split('.').next().unwrap_or_default()));
    leaves
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    /// The header of a run of so many layers, whose resolved scenario is `scenario`.
    fn header(build: &str, scenario: &str, layers: u32) -> CheckpointHeader {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/drop/1008.toml");
        let document = Document::read(&path).expect("a document");
        let mut model = scene::model::check(&document).expect("a model");
        model.faces[0].layers = layers;
        let header = CheckpointHeader::new(&document, &model, None, false).expect("a header");
        CheckpointHeader { build: build.into(), scenario: scenario.into(), ..header }
    }

    #[test]
    fn long_values_and_long_lists_are_cut_short() {
        let lists = |last: u8| format!("a = [{}{last}]\n[[layer]]\nheight = {last}\n", "0.25, ".repeat(20));
        let found = differences(&lists(1), &lists(2));
        assert_eq!(found, ["there `a` is another one", "there `layer.0.height` is 1, here it is 2"]);
        let other = header(build_name(), "a = 1\nb = 1\nc = 1\nd = 1\ne = 1\n", 9);
        let hint = header(build_name(), "", 8).differs_from(&other).unwrap();
        assert!(hint.ends_with("there it has `c`, here it has none; and 2 more"), "{hint}");
    }

    #[test]
    fn a_refusal_names_the_keys_that_differ() {
        let own = header("0.1.0", "[layers]\ncount = 8\n", 8);
        for (build, scenario, layers, expected) in [
            ("0.1.0", "[layers]\ncount = 8\n", 8, None),
            ("0.1.0", "title = \"other\"\n", 8, None),
            (
                "0.0.9",
                "[layers]\ncount = 8\n",
                8,
                Some("droptower 0.0.9 wrote it, this is 0.1.0: the results may differ in their bits"),
            ),
            ("0.1.0", "[layers]\ncount = 9\n", 9, Some("there `layers.count` is 9, here it is 8")),
            ("0.1.0", "[layers]\ncount = 8\nmore = 1\n", 9, Some("there it has `layers.more`, here it has none")),
            ("0.1.0", "[layers]\n", 9, Some("there it has no `layers.count`")),
            ("0.1.0", "title = \"a\"\n[layers]\ncount = 9\n", 9, Some("there `layers.count` is 9, here it is 8")),
            (
                "0.1.0",
                "[layers]\ncount = 8\n",
                9,
                Some("the scenario is the same, but a file that it names has changed"),
            ),
        ] {
            assert_eq!(own.differs_from(&header(build, scenario, layers)).as_deref(), expected);
        }
    }

    #[test]
    fn a_header_is_read_as_it_was_written() {
        let header = header(build_name(), "[layers]\ncount = 8\n", 8);
        let mut file = Vec::new();
        header.write(&mut file).unwrap();
        assert_eq!(CheckpointHeader::read(&mut file.as_slice()).unwrap(), header);
        file[22] += 1;
        assert_eq!(CheckpointHeader::read(&mut file.as_slice()).unwrap_err().to_string(), OTHER_LAYOUT);
    }
}
