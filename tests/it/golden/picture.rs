//! Old against new, one diagram a channel.

use std::fs;
use std::path::{Path, PathBuf};

use droptower::signal::{Channel, Recording};
use plotters::prelude::*;

const WIDTH: u32 = 900;
const HEIGHT: u32 = 260;

/// Draws every channel of both recordings under `target/golden/<case>/` and says where.
pub fn draw(case: &str, expected: &Recording, actual: &Recording) -> Result<PathBuf, String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/golden").join(case);
    fs::create_dir_all(&folder).map_err(|error| error.to_string())?;
    let path = folder.join("old-against-new.svg");
    let channels = expected.channels.len().max(1);
    let area = SVGBackend::new(&path, (WIDTH, HEIGHT * channels as u32)).into_drawing_area();
    area.fill(&WHITE).map_err(|error| error.to_string())?;
    for (old, part) in expected.channels.iter().zip(area.split_evenly((channels, 1))) {
        let old_curve = curve(&expected.time, &old.values);
        let new = actual.channel(&old.name).unwrap_or_default();
        let new_curve = curve(&actual.time, new);
        diagram(&part, old, [&old_curve, &new_curve]).map_err(|error| error.to_string())?;
    }
    area.present().map_err(|error| error.to_string())?;
    drop(area);
    Ok(path)
}

type Curve = Vec<(f64, f64)>;

fn curve(time: &[f64], values: &[f64]) -> Curve {
    let samples = time.iter().copied().zip(values.iter().copied());
    samples.filter(|(_, value)| value.is_finite()).collect()
}

fn diagram<B: DrawingBackend>(
    area: &DrawingArea<B, plotters::coord::Shift>,
    channel: &Channel,
    [old, new]: [&Curve; 2],
) -> Result<(), DrawingAreaErrorKind<B::ErrorType>> {
    let range = |part: fn(&(f64, f64)) -> f64| {
        let values = old.iter().chain(new).map(part);
        let (low, high) = values.fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(v), h.max(v)));
        let margin = (0.05 * (high - low)).max(f64::MIN_POSITIVE);
        low - margin..high + margin
    };
    if old.is_empty() && new.is_empty() {
        return Ok(());
    }
    let mut chart = ChartBuilder::on(area)
        .caption(&channel.name, ("sans-serif", 16))
        .margin(8)
        .x_label_area_size(28)
        .y_label_area_size(80)
        .build_cartesian_2d(range(|p| p.0), range(|p| p.1))?;
    chart.configure_mesh().x_desc("s").draw()?;
    for (name, curve, colour) in [("old", old, BLUE), ("new", new, RED)] {
        chart
            .draw_series(LineSeries::new(curve.iter().copied(), colour))?
            .label(name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], colour));
    }
    chart.configure_series_labels().border_style(BLACK).draw()
}
