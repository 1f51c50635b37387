//! The reference of scripts: every function that they can call, with an example.

use crate::script::Chapter;
use crate::{calibrate, functions, identify, post, scenario_functions, sweep};

/// The chapters of the reference, in the order in which it is printed.
pub fn chapters() -> impl Iterator<Item = &'static Chapter> {
    let of_studies = scenario_functions::REFERENCE.iter().chain(identify::REFERENCE).chain(sweep::REFERENCE);
    let of_studies = of_studies.chain(calibrate::REFERENCE);
    post::REFERENCE.iter().chain(of_studies).chain(functions::REFERENCE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::functions::{check::engine, register_reading};
    use crate::script::{Limits, key_mistake};

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
