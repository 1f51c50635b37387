//! The module of films that is part of droptower.

use crate::script::{Entry, ShippedModule};

/// The module, which scripts over scenarios can import.
pub(super) const MODULES: &[ShippedModule] =
    &[ShippedModule { name: "droptower/film", text: include_str!("../../../scripts/droptower/film.rhai") }];

/// The reference of its functions.
pub const ENTRIES: &[Entry] = &[
    Entry {
        call: "film::multipliers(k)",
        gives: "a map of k1, ke and ky, of a list; names and quasi-static values are `film::MULTIPLIERS`, `film::QUASI_STATIC`",
        example: r#"import "droptower/film" as film; film::multipliers([2.75, 3.4, 1.0]).ke == 3.4 && film::MULTIPLIERS[2] == "ky""#,
    },
    Entry {
        call: "film::scaled(scenario, k)",
        gives: "the scenario with the multipliers `k` of its fabric",
        example: r#"import "droptower/film" as film; let test = scenario(args.scenario); let curve = |k| film::scaled(test, k).curve("md", 0).at(0.1); curve.call([2.0, 1.0, 1.0]) > curve.call(film::QUASI_STATIC)"#,
    },
    Entry {
        call: "film::acceleration_misfit(scenario, k, reference)",
        gives: "relative residuals of the acceleration with the multipliers `k`, as the LLDPE study minimizes them",
        example: r#"import "droptower/film" as film; let test = scenario(args.scenario); film::acceleration_misfit(test, [2.75, 3.4, 1.0], test.reference.acceleration).len() > 1"#,
    },
    Entry {
        call: "film::fabric_key(name, value)",
        gives: "the change of one key of a fabric, for `scenario.with(…)`",
        example: r#"import "droptower/film" as film; film::fabric_key("biaxial", 0.3) == #{ "specimen.material.fabric.biaxial": 0.3 }"#,
    },
    Entry {
        call: "film::bisect(near, far, first, rounds, outcomes)",
        gives: "figures at which outcomes change, of lists of ends between which each does: all are halved together, `rounds` times; \
                `outcomes` gives those of a list of figures, that of `near` is `first`",
        example: r#"import "droptower/film" as film; let found = film::bisect([1.0, 1.0], [100.0, 9.0], [false, false], 30, |figures| figures.map(|figure| figure > 5.0)); (found[0] - 5.0).abs() < 1e-6 && (found[1] - 5.0).abs() < 1e-6"#,
    },
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::functions::check::assert_described;

    #[test]
    fn every_function_of_the_module_is_described() {
        assert_described(MODULES, ENTRIES);
    }
}
