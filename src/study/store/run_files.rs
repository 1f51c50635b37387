//! The table of the files of a run folder.

/// Longest text file of a run folder that is read back, bytes.
pub const MOST_BYTES: u64 = 1 << 30;

/// All channels over time.
pub const SIGNALS: &str = "signals.csv";
/// The energy audit over time.
pub const ENERGIES: &str = "energies.csv";
/// Measured and simulated displacements of the points of a field.
pub const FIELD: &str = "field.csv";
/// The figures and findings.
pub const SUMMARY: &str = "summary.json";
/// The resolved scenario.
pub const SCENARIO: &str = "scenario.toml";
/// The copy of the post script, which [`SCENARIO`] names.
pub const POST_SCRIPT: &str = "post.rhai";
/// The Rerun recording.
pub const RECORDING: &str = "recording.rrd";
/// Collection of the film's snapshots for ParaView.
pub const FILM_SERIES: &str = "film.pvd";
/// Collection of the impactor's snapshots for ParaView.
pub const IMPACTOR_SERIES: &str = "impactor.pvd";
/// Collection of the snapshots of the frame's bars for ParaView.
pub const FRAME_SERIES: &str = "frame.pvd";
/// Collection of the snapshots of the frame's springs for ParaView.
pub const SPRINGS_SERIES: &str = "springs.pvd";
/// Inputs and outputs of the runs of a sweep.
pub const TABLE: &str = "table.csv";
/// The page.
pub const REPORT: &str = "report.html";
/// Why a run failed.
pub const FAILURE: &str = "failure.txt";
/// Folder of the tables that a script wrote.
pub const TABLES: &str = "tables";
/// Folder of the snapshots that [`FILM_SERIES`], [`IMPACTOR_SERIES`], [`FRAME_SERIES`] and [`SPRINGS_SERIES`] collect.
pub const SNAPSHOTS: &str = "vtu";

/// Field of the summary of a comparison or of tests, and of the call in that of a study: the working folder, as a path from the folder
/// of the results.
pub const WORKING_FOLDER: &str = "folder";

/// Every file that droptower writes, and its description on a page. The files of a script are listed in
/// [`SUMMARY`]; anything else belongs to the user.
pub const RUN_FILES: [(&str, &str); 14] = [
    (SIGNALS, "all channels over time, SI"),
    (ENERGIES, "the energy audit over time"),
    (FIELD, "measured and simulated displacements of the points of the field"),
    (SUMMARY, "the figures, for other programs"),
    (SCENARIO, "the scenario with everything that it takes from elsewhere"),
    (POST_SCRIPT, "the script that added figures"),
    (RECORDING, "film, impactors and signals for the viewer: droptower view"),
    (FILM_SERIES, "the film for ParaView"),
    (IMPACTOR_SERIES, "the impactors for ParaView"),
    (FRAME_SERIES, "the frame's bars for ParaView"),
    (SPRINGS_SERIES, "the frame's springs for ParaView"),
    (TABLE, "inputs and figures of the runs of a sweep"),
    (REPORT, "this page"),
    (FAILURE, "why the run failed"),
];

/// A folder that holds one of these is a run folder.
pub(super) const MARKERS: [&str; 3] = [SUMMARY, SCENARIO, FAILURE];

/// Names in a run folder that a script cannot use for its own files and folders.
pub const RESERVED_NAMES: [&str; RUN_FILES.len() + 1] = {
    let mut names = [TABLES; RUN_FILES.len() + 1];
    let mut index = 0;
    while index < RUN_FILES.len() {
        names[index] = RUN_FILES[index].0;
        index += 1;
    }
    names
};

/// Whether the file `name` of a run folder is one of [`RUN_FILES`] or a snapshot for ParaView.
pub(super) fn is_written_by_run(name: &str) -> bool {
    RUN_FILES.iter().any(|(known, _)| *known == name) || is_snapshot(name)
}

/// Whether `name` is a snapshot for ParaView, such as `vtu/film_0012.vtu`.
fn is_snapshot(name: &str) -> bool {
    let snapshot = name.strip_prefix(SNAPSHOTS).and_then(|name| name.strip_prefix('/')?.strip_suffix(".vtu"));
    let kinds = ["film_", "impactor_", "frame_", "springs_"];
    let number = snapshot.and_then(|name| kinds.iter().find_map(|kind| name.strip_prefix(kind)));
    number.is_some_and(|number| !number.is_empty() && number.bytes().all(|digit| digit.is_ascii_digit()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_numbered_snapshots_are_written_by_a_run() {
        for (name, expected) in [
            ("vtu/film_0012.vtu", true),
            ("vtu/impactor_0.vtu", true),
            ("vtu/frame_0001.vtu", true),
            ("vtu/springs_0001.vtu", true),
            ("vtu/film_.vtu", false),
            ("vtu/mine.vtu", false),
            ("film_0012.vtu", false),
            ("signals.csv", true),
            ("tables", false),
        ] {
            assert_eq!(is_written_by_run(name), expected, "{name}");
        }
    }
}
