//! Names that users write for titles: `acceleration-of-the-impactor`.

/// The title in small letters, its words joined by hyphens.
pub(super) fn name_of(title: &str) -> String {
    let letters = title.chars().map(|letter| if letter.is_alphanumeric() { letter } else { ' ' });
    let words = letters.flat_map(char::to_lowercase).collect::<String>();
    words.split_whitespace().collect::<Vec<_>>().join("-")
}

/// The index of the title that is named: itself, else the first that begins with it, else the only one that holds it.
pub(super) fn find<'a>(written: &str, titles: impl Iterator<Item = &'a str>) -> Option<usize> {
    let written = name_of(written);
    let names: Vec<String> = titles.map(name_of).collect();
    if written.is_empty() {
        return None;
    }
    let place = |is: &dyn Fn(&str) -> bool| names.iter().position(|name| is(name));
    let holds = |name: &&String| name.contains(&written);
    place(&|name| name == written).or_else(|| place(&|name| name.starts_with(&written))).or_else(|| {
        let is_only = names.iter().filter(holds).count() == 1;
        names.iter().position(|name| is_only && holds(&name))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn titles_are_found_by_their_beginning() {
        let titles = [
            "Displacement of the impactor",
            "Acceleration of the impactor",
            "Acceleration before the filter",
            "E/σ: run 1",
        ];
        for (written, expected) in [
            ("acceleration", Some(1)),
            ("Acceleration before the filter", Some(2)),
            ("acceleration-before", Some(2)),
            ("displ", Some(0)),
            ("filter", Some(2)),
            ("e-σ-run-1", Some(3)),
            ("impactor", None),
            ("force", None),
            ("--", None),
        ] {
            assert_eq!(find(written, titles.iter().copied()), expected, "{written}");
        }
    }
}
