//! A list of all that can be drawn of the results in a folder.

use serde_json::json;

use super::words::name_of;
use crate::{Failure, Shared, print_figures};
use base::diagnostic::Diagnostic;
use base::number::duration;
use report::{Field, RunScene, StoredPage, StoredPageError};

pub(super) fn run(page: &StoredPage, shared: &Shared) -> Result<(), Failure> {
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
