//! Old against new, one plot a channel.

use std::fs;
use std::path::{Path, PathBuf};

use droptower::plot::{Curve, Plot};
use droptower::report;
use droptower::signal::{Channel, Recording};

/// Draws every channel of both recordings under `target/golden/<case>/` and prints the path.
pub fn draw(case: &str, expected: &Recording, actual: &Recording) -> Result<PathBuf, String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/golden").join(case);
    fs::create_dir_all(&folder).map_err(|error| error.to_string())?;
    let path = folder.join("old-against-new.html");
    let plots: Vec<Plot> = expected.channels.iter().map(|old| diagram(old, expected, actual)).collect();
    fs::write(&path, report::page(case, &report::figures(&plots))).map_err(|error| error.to_string())?;
    Ok(path)
}

fn diagram(old: &Channel, expected: &Recording, actual: &Recording) -> Plot {
    let curve = |name: &str, recording: &Recording| {
        let series = recording.series(&old.name);
        Curve::line(name, series.iter().flat_map(|series| series.samples()))
    };
    let curves = vec![curve("new", actual), curve("old", expected).dashed()];
    Plot::new(&*old.name, ["time (s)", &old.name], curves)
}
