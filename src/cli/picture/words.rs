//! Names that users write for titles, `acceleration-of-the-impactor`, and the list of what there is to draw.

use serde_json::json;

use crate::{Failure, Shared, print_figures};
use base::diagnostic::Diagnostic;
use base::number::duration;
use report::{Field, RunScene, StoredPage, StoredPageError};

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

/// Prints what of a page can be drawn.
pub(super) fn list(page: &StoredPage, shared: &Shared) -> Result<(), Failure> {
    let scene = match page.scene() {
        Ok(scene) => Some(scene),
        Err(StoredPageError::NoFilm { .. }) => None,
        Err(error) => return Err(Diagnostic::new(error.to_string()).into()),
    };
    let plots: Vec<String> = page.plots.iter().map(|plot| name_of(&plot.title)).collect();
    let scene = scene.as_ref();
    let moments = || scene.into_iter().flat_map(|scene| &scene.moments);
    let figures = json!({
        "title": page.title,
        "plots": plots,
        "states_s": scene.map(|scene| scene.states.iter().map(|state| state.time).collect::<Vec<_>>()),
        "moments_s": moments().map(|moment| (name_of(&moment.words), moment.time)).collect::<Vec<_>>(),
        "fields": scene.map(|scene| fields(scene).collect::<Vec<_>>()),
    });
    print_figures(shared, &figures, || {
        let mut lines = vec![page.title.clone()];
        if let Some(scene) = scene {
            let [first, last] = [&scene.states[0], &scene.states[scene.states.len() - 1]];
            let (from, to) = (duration(first.time), duration(last.time));
            lines.push(format!("  --at     {} states from {from} to {to}", scene.states.len()));
            lines.extend(
                moments().map(|moment| format!("           {} ({})", name_of(&moment.words), duration(moment.time))),
            );
            lines.push(format!("  --field  {}", fields(scene).collect::<Vec<_>>().join(", ")));
        }
        let heads = std::iter::once("--plot").chain(std::iter::repeat("      "));
        lines.extend(heads.zip(&plots).map(|(head, plot)| format!("  {head}   {plot}")));
        lines.join("\n")
    })
}

fn fields(scene: &RunScene) -> impl Iterator<Item = &'static str> {
    Field::all_in(&scene.states[0].films).map(|field| field.key)
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
