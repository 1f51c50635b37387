//! The stored evaluation that is nearest to one that is not: what would have to be the same for it to be taken.

use std::collections::HashMap;
use std::io;
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::build_name::build_name;
use super::description::{Description, Difference, Stored};
use super::evaluations::unpacked;
use crate::store::EvaluationStore;
use crate::store::evaluations::{Key, SegmentDescriptions};

/// The nearest of the evaluations in a folder, of all builds.
#[derive(Clone, Debug, Default)]
pub struct Nearest {
    /// Evaluations with a description.
    pub described: usize,
    /// Evaluations without one: of older versions, or of very large scenarios.
    pub undescribed: usize,
    /// The nearest ones, the nearest first, at most 16.
    pub found: Vec<Found>,
}

/// Most evaluations that are found: keys that differ may decide nothing, so that the first need not be the nearest.
const MOST: usize = 16;

/// A stored evaluation, and how it differs.
#[derive(Clone, Debug)]
pub struct Found {
    /// Its description.
    pub description: Description,
    /// The build that computed it.
    pub build: String,
    /// The file that holds it.
    pub segment: PathBuf,
    /// Time since that file last grew, s.
    pub age_s: f64,
    /// The keys in which it differs.
    pub differences: Vec<Difference>,
}

/// A part of the name of a build in which another one differs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum OfBuild {
    /// The version.
    #[serde(rename = "version")]
    Version,
    /// The sources, the compiler or its target.
    #[serde(rename = "sources")]
    Sources,
    /// The mathematical library of the machine.
    #[serde(rename = "mathematical library")]
    Library,
}

impl OfBuild {
    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            OfBuild::Version => "version",
            OfBuild::Sources => "sources, compiler or processor",
            OfBuild::Library => "mathematical library of the machine",
        }
    }
}

/// A description that others are stored as differences from.
struct Base {
    description: Description,
    keys: Vec<String>,
    /// The number of keys in which the figures and the run that are asked for differ from it.
    distances: [usize; 2],
}

impl Nearest {
    /// The nearest of the evaluations in `folder` to that of `here`: of those that differ in the same number of keys those of
    /// this build first, and of these the newest.
    ///
    /// # Errors
    /// The folder or a segment in it cannot be read.
    pub fn find(folder: &Path, here: &Description) -> io::Result<Nearest> {
        let mut nearest = Nearest::default();
        let mut ranks: Vec<(usize, bool, f64)> = vec![];
        let run = here.clone().without_figures();
        for figures in EvaluationStore::list(folder)? {
            let Some(descriptions) = EvaluationStore::descriptions(&figures.path)? else { continue };
            let SegmentDescriptions { build, wholes, of_records, undescribed } = descriptions;
            nearest.described += of_records.len();
            nearest.undescribed += undescribed;
            let mut bases: HashMap<Key, Option<Base>> = HashMap::new();
            let is_other = build != build_name();
            for content in of_records {
                let Ok(stored) = postcard::from_bytes::<Stored>(&content) else { continue };
                let base = bases.entry(Key(stored.base)).or_insert_with(|| {
                    let base: Description = unpacked(wholes.get(&Key(stored.base))?)?;
                    let distances = [here.distance(&base), run.distance(&base)];
                    Some(Base { keys: base.keys(), description: base, distances })
                });
                let Some(Base { description: base, keys, distances: [of_figures, of_run] }) = base else { continue };
                let (compared, of_base) = if stored.has_figures() { (here, *of_figures) } else { (&run, *of_run) };
                let distance = stored.distance(compared, base, keys, of_base);
                let rank = (distance, is_other, figures.age_s);
                let place = ranks.partition_point(|other| *other <= rank);
                if place >= MOST {
                    continue;
                }
                let description = stored.description(base);
                let differences = compared.differences(&description);
                let (build, segment) = (build.clone(), figures.path.clone());
                let found = Found { description, build, segment, age_s: figures.age_s, differences };
                ranks.insert(place, rank);
                nearest.found.insert(place, found);
                ranks.truncate(MOST);
                nearest.found.truncate(MOST);
            }
        }
        Ok(nearest)
    }
}

/// The parts in which the names of two builds differ.
pub fn build_differences(one: &str, other: &str) -> Vec<OfBuild> {
    let parts = [OfBuild::Version, OfBuild::Sources, OfBuild::Library];
    let words = |name: &str| name.split(' ').map(str::to_owned).collect::<Vec<_>>();
    let (one, other) = (words(one), words(other));
    parts
        .into_iter()
        .enumerate()
        .filter(|(place, _)| one.get(*place) != other.get(*place))
        .map(|(_, part)| part)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_build_differs_in_a_part_of_its_name() {
        assert_eq!(build_differences("0.1.0 aa bb", "0.1.0 aa bb"), []);
        assert_eq!(build_differences("0.1.0 aa bb", "0.1.0 aa cc"), [OfBuild::Library]);
        assert_eq!(build_differences("0.1.0 aa bb", "0.2.0 cc bb"), [OfBuild::Version, OfBuild::Sources]);
    }
}
