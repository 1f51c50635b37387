//! Plots as diagrams of a recording.

use viz::{self, Diagram};

use plot::{Axis, Curve, Look, Plot, Scale};

/// A diagram for each plot, at an entity below `folder`.
pub(super) fn diagrams<'a>(
    folder: &'a str,
    plots: impl IntoIterator<Item = &'a Plot> + 'a,
) -> impl Iterator<Item = Diagram> + 'a {
    plots.into_iter().enumerate().map(move |(index, plot)| diagram(format!("{folder}/{index}"), plot))
}

/// A plot at the entity `path`.
fn diagram(path: String, plot: &Plot) -> Diagram {
    Diagram {
        path,
        title: plot.title.clone(),
        axes: [axis(&plot.x), axis(&plot.y)],
        curves: plot.curves.iter().map(curve).collect(),
        window: plot.window.as_ref().map(|window| viz::Window { label: window.label.clone(), ends: window.range }),
    }
}

fn curve(curve: &Curve) -> viz::Curve {
    let look = match curve.look {
        Look::Line => viz::Look::Line,
        Look::Dashed => viz::Look::Dashed,
        Look::Points => viz::Look::Points,
    };
    viz::Curve { name: curve.name.clone(), points: curve.points.clone(), look }
}

fn axis(axis: &Axis) -> viz::Axis {
    viz::Axis { label: axis.label.clone(), logarithmic: axis.scale == Scale::Logarithmic }
}
