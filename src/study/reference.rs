//! The reference of scripts: every function that they can call, with an example.

use std::sync::LazyLock;

use serde::Deserialize;

/// One entry of the reference of script functions.
#[derive(Clone, Debug, Deserialize)]
pub struct Entry {
    /// The call, such as `signal.at(t)`.
    pub call: String,
    /// The result, with its units.
    pub gives: String,
    /// A script that ends in `true`; the tests run it.
    pub example: String,
}

/// A chapter of the reference.
#[derive(Clone, Debug, Deserialize)]
pub struct Chapter {
    /// Its title.
    pub title: String,
    /// With what examples begin that have `{begin}`.
    #[serde(default)]
    begin: String,
    /// Its entries.
    pub entries: Vec<Entry>,
}

/// The chapters of the reference, in the order in which it is printed.
pub fn chapters() -> &'static [Chapter] {
    #[derive(Deserialize)]
    struct Reference {
        chapter: Vec<Chapter>,
    }
    static CHAPTERS: LazyLock<Vec<Chapter>> = LazyLock::new(|| {
        // A test reads it.
        let reference = toml::from_str(include_str!("reference.toml"));
        let Reference { mut chapter } = reference.unwrap_or_else(|error| unreachable!("reference.toml: {error}"));
        for Chapter { begin, entries, .. } in &mut chapter {
            entries.iter_mut().for_each(|entry| entry.example = entry.example.replace("{begin}", begin));
        }
        chapter
    });
    &CHAPTERS
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::functions::{self, register_reading, tests::engine};
    use crate::script::{Limits, key_mistake};
    use crate::{identify, scenario_functions};

    #[test]
    fn every_function_of_shipped_modules_is_described() {
        for module in [functions::TABLES, scenario_functions::FILM] {
            let alias = module.name.rsplit('/').next().unwrap_or(module.name);
            let names = module.text.lines().filter_map(|line| line.strip_prefix("fn ")?.split('(').next());
            let functions: BTreeSet<String> = names.map(|name| format!("{alias}::{name}")).collect();
            let entries =
                chapters().iter().filter(|chapter| chapter.title.contains(module.name)).flat_map(|own| &own.entries);
            let described = entries.filter_map(|entry| entry.call.split('(').next()).map(str::to_owned);
            assert_eq!(functions, described.collect());
        }
    }

    /// Scripts of one line, each with the words of its refusal in the next.
    #[test]
    fn mistakes_are_told() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("r.csv"), "time [ms],acceleration [g]\n0,1\n1,2\n").unwrap();
        let mut study = functions::engine(Limits::STUDY);
        register_reading(&mut study);
        scenario_functions::register(&mut study, &scenario_functions::Scenarios::default());
        identify::register(&mut study, &identify::SearchHost::new(|_| {}));
        let cases = include_str!("mistakes.txt").replace("FOLDER", &folder.path().to_string_lossy());
        let lines: Vec<&str> = cases.lines().collect();
        for case in lines.chunks(2) {
            let of_studies = ["minimize", "confidence", "coupon_material"].iter().any(|name| case[0].contains(name));
            let error = if of_studies { study.run(case[0]) } else { engine().run(case[0]) }.expect_err(case[0]);
            let error = key_mistake(&error).unwrap_or_else(|| error.to_string());
            assert!(error.contains(case[1].trim_start()), "{} gave: {error}", case[0]);
        }
    }
}
