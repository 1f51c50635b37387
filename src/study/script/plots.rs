//! Limits of the plots of a script.

use thiserror::Error;

use plot::Plot;

/// Most plots of one script, and most curves of one plot.
const MOST_PLOTS: usize = 100;
const MOST_CURVES: usize = 60;

/// Most points that the plots of one script hold together.
const MOST_POINTS: usize = 80_000;

/// Longest title, name or axis label, characters.
const LONGEST: usize = 200;

/// Why a plot is refused.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum PlotError {
    /// A text is empty or too long.
    #[error("a title, an axis label or a name of a plot has 1 to {LONGEST} characters, not `{}`", text.chars().take(40).collect::<String>())]
    Text {
        /// The title, name or axis label.
        text: String,
    },
    /// A plot has no curves, or too many.
    #[error("the plot `{title}` has {count} curves; a plot has 1 to {MOST_CURVES}")]
    Curves {
        /// Title of the plot.
        title: String,
        /// Number of its curves.
        count: usize,
    },
    /// All plots together are too large.
    #[error(
        "a script leaves at most {MOST_PLOTS} plots of {MOST_POINTS} points together: take slices, or resample signals"
    )]
    TooMuch,
}

/// Adds the plot, or replaces the one of this title.
pub(super) fn put(plots: &mut Vec<Plot>, plot: Plot) -> Result<(), PlotError> {
    if let Some(text) = texts(&plot).find(|text| text.trim().is_empty() || text.chars().count() > LONGEST) {
        return Err(PlotError::Text { text: text.clone() });
    }
    if !(1..=MOST_CURVES).contains(&plot.curves.len()) {
        return Err(PlotError::Curves { title: plot.title, count: plot.curves.len() });
    }
    let points = |plot: &Plot| plot.curves.iter().map(|curve| curve.points.len()).sum::<usize>();
    let same = plots.iter().position(|other| other.title == plot.title);
    let others = plots.iter().filter(|other| other.title != plot.title);
    let together = others.map(points).sum::<usize>() + points(&plot);
    if together > MOST_POINTS || (same.is_none() && plots.len() >= MOST_PLOTS) {
        return Err(PlotError::TooMuch);
    }
    match same {
        Some(place) => plots[place] = plot,
        None => plots.push(plot),
    }
    Ok(())
}

/// All its texts.
fn texts(plot: &Plot) -> impl Iterator<Item = &String> {
    let names = plot.curves.iter().map(|curve| &curve.name);
    let own = [&plot.title, &plot.x.label, &plot.y.label].into_iter();
    own.chain(names).chain(plot.window.iter().map(|window| &window.label))
}
