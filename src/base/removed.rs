//! What earlier versions had and this one has not, and what users look for under another name, each with what to use instead:
//! the one place that messages take it from.

/// What kind of name a user wrote.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Words of a command line in their order, the program's name aside: `repl`, `script --trace`, `card write --approximate`.
    Command,
    /// A key of a scenario or a material by the end of its path (`specimen.bending`), or a word as its value
    /// (`energy = wrinkling`).
    Key,
    /// A function of scripts (`profiles`), or an option of one (`minimize.fallback`).
    Function,
    /// The code of a finding.
    Finding,
}

/// What became of a name.
#[derive(Clone, Copy)]
enum Fate {
    /// It is gone; what stands instead completes "it was removed: ".
    Gone,
    /// It has another name, which completes "it is now ".
    Renamed,
    /// It never was; the whole sentence.
    Sought,
}

/// A name that is not there.
struct Removed {
    fate: Fate,
    kind: Kind,
    name: &'static str,
    instead: &'static str,
}

const fn row(kind: Kind, name: &'static str, instead: &'static str) -> Removed {
    Removed { fate: Fate::Gone, kind, name, instead }
}

/// A command under another name.
const fn now(name: &'static str, instead: &'static str) -> Removed {
    Removed { fate: Fate::Renamed, kind: Kind::Command, name, instead }
}

/// A command that users look for.
const fn sought(name: &'static str, instead: &'static str) -> Removed {
    Removed { fate: Fate::Sought, kind: Kind::Command, name, instead }
}

const DISTANCES: &str = "`distance` is \"residuals\", \"error-norm\" or \"rating\"";
const HISTORY: &str = "the store has the runs of a search, so that one that is started again repeats none";
const IMPORTANCE: &str =
    "`failure_probability` has the methods \"subset\" and \"monte-carlo\", not importance sampling";
const MASTER: &str =
    "the program of a DMA makes the master curve, which `fit prony` fits; `shift` of a material states its law";
const NEW_SLURM: &str = "`droptower new slurm` writes an array job to change and submit";
const PLASTIC: &str = "`calibrate` fits plastic film to coupons: scripts/plastic-coupons.rhai";
const PROFILES: &str =
    "`confidence` has the intervals of the linear model, `posterior` of a calibration those without it";

/// A row a line, by kind, then by name.
#[rustfmt::skip]
const REMOVED: &[Removed] = &[
    row(Kind::Command, "--parquet", "the tables are written as CSV, which pandas, Polars and R read"),
    row(Kind::Command, "--vtkhdf", "`--vtu` writes the same states and arrays, which ParaView opens as film.pvd"),
    row(Kind::Command, "card check", "`pull` in a script has the stresses of one element, `export card` its card"),
    now("card", "`droptower export card` and `droptower import card`"),
    now("card read", "`droptower import card`"),
    now("card write", "`droptower export card`"),
    row(Kind::Command, "card write --approximate", "write for a solver that has the law, or fit one that the target has"),
    now("deck", "`droptower export deck`"),
    now("deck write", "`droptower export deck`"),
    row(Kind::Command, "deck read", "`meshio convert --ascii --output-format gmsh` writes a mesh as .msh, which `specimen.shape.mesh` reads"),
    row(Kind::Command, "digitize", "WebPlotDigitizer reads curves out of pictures; put a line such as `time_s,force_N` on top of its CSV file"),
    row(Kind::Command, "fit plastic", PLASTIC),
    row(Kind::Command, "fit prony --reference", MASTER),
    row(Kind::Command, "fit prony --shift", MASTER),
    row(Kind::Command, "fit prony --shift-factors", MASTER),
    row(Kind::Command, "fit rubber plastic:table", PLASTIC),
    row(Kind::Command, "fit rubber plastic:voce", PLASTIC),
    row(Kind::Command, "new figure", "WebPlotDigitizer reads curves out of pictures"),
    row(Kind::Command, "new material nylon-fabric", "its values had no published source; `droptower new material fabric` is its law"),
    row(Kind::Command, "new material tpu", "its values had no published source; `droptower new material mooney-rivlin` is its law"),
    sought("plot", "`droptower picture RUN --plot NAME` draws a plot of a run; its report.html has all of them"),
    sought("predict", "`droptower calibrate STUDY` predicts the scenarios of the study's table [predict]"),
    row(Kind::Command, "repl", "`droptower script` computes no run twice, so a script grows line by line; so does a notebook with the Python package"),
    sought("report", "`droptower run` writes the page report.html into the folder of the run"),
    row(Kind::Command, "schema cluster", NEW_SLURM),
    row(Kind::Command, "schema figure", "WebPlotDigitizer reads curves out of pictures"),
    row(Kind::Command, "script --profile", "`print` in the script shows where it is"),
    row(Kind::Command, "script --trace", "`print` in the script shows where it is"),
    row(Kind::Command, "signal convert .mme", "write a table: -o FILE.csv; ISO-MME is still read"),
    row(Kind::Command, "signal convert .parquet", "write a table: -o FILE.csv, which pandas, Polars and R read"),
    row(Kind::Command, "signal convert .zip", "write a table: -o FILE.csv; zipped ISO-MME is still read"),
    now("signal drop", "`droptower reduce drop`"),
    sought("simulate", "`droptower run SCENARIO` simulates a scenario"),
    row(Kind::Command, "store why", "`droptower run --resume` names the keys that differ from those of a checkpoint"),
    row(Kind::Command, "sweep --cluster", NEW_SLURM),
    row(Kind::Command, "sweep --on", NEW_SLURM),
    now("tensile", "`droptower reduce coupon`, `bulge` and `wide`, and `droptower fit rubber` and `prony`"),
    now("tensile bulge", "`droptower reduce bulge`"),
    now("tensile fit", "`droptower fit rubber --law LAW`, or `droptower fit prony` for a relaxation"),
    row(Kind::Command, "tensile fit --directions", PLASTIC),
    row(Kind::Command, "tensile fit --offset", PLASTIC),
    row(Kind::Command, "tensile fit --reference", MASTER),
    now("tensile fit --relaxation", "`droptower fit prony`"),
    row(Kind::Command, "tensile fit --shift", MASTER),
    row(Kind::Command, "tensile fit --shift-factors", MASTER),
    row(Kind::Command, "tensile fit --window", PLASTIC),
    row(Kind::Command, "tensile fit plastic:table", PLASTIC),
    row(Kind::Command, "tensile fit plastic:voce", PLASTIC),
    now("tensile reduce", "`droptower reduce coupon`"),
    now("tensile wide", "`droptower reduce wide`"),
    sought("template", "`droptower new KIND FILE` writes a file to start from"),
    sought("validate", "`droptower check` checks scenarios, materials and studies"),
    row(Kind::Command, "watch --no-page", "`watch` serves no page; report.html in the folder of the run is the page"),
    row(Kind::Command, "watch --port", "open report.html in the folder of the run, and reload it"),
    row(Kind::Key, "cluster", NEW_SLURM),
    row(Kind::Key, "fabric.wrinkling", "slack fibres carry no stress; `elastic` and `hyperelastic` film wrinkles"),
    row(Kind::Key, "frame.springs.compression", "springs are slack where they are shorter than without force"),
    row(Kind::Key, "frame.springs.continuous", "`frame.springs.count` with a spring to each element of the edge is as even"),
    row(Kind::Key, "frame.springs.curve", "springs are linear: give a `stiffness`, that of the curve at the forces of the test"),
    row(Kind::Key, "frame.springs.damping", "springs are linear and without loss; `specimen.damping` damps film"),
    row(Kind::Key, "frame.springs.mass", "springs have no mass"),
    row(Kind::Key, "frame.springs.spacing", "give their number on the whole film, `frame.springs.count`"),
    row(Kind::Key, "plastic.rate", "give curves by rate, `hardening.rates`; the formula of Cowper and Symonds for a curve's rate r is a factor 1 + (r/d)^(1/p)"),
    row(Kind::Key, "rupture.rate", "one `limit`, that of the rate of the test"),
    row(Kind::Key, "rupture.triaxiality", "one `limit`, that of the state of stress under the impactor"),
    row(Kind::Key, "specimen.bending", "film is a membrane; docs/limits.md says from which thickness on bending matters"),
    row(Kind::Function, "calibrate.features", DISTANCES),
    row(Kind::Function, "calibrate.warping", DISTANCES),
    row(Kind::Function, "confidence.points", "it was an option of `profiles`, and `confidence` has none"),
    row(Kind::Function, "failure_probability.importance", IMPORTANCE),
    row(Kind::Function, "indices", "`surrogate` has the Sobol' indices from fewer runs, `sweep` the main effects"),
    row(Kind::Function, "minimize.fallback", "choose a start that has a value, or give several as `starts`"),
    row(Kind::Function, "minimize.on_failure", "a trial without a value counts as worse than all others"),
    row(Kind::Function, "minimize.spread", "\"cma-es\" begins with a deviation of a quarter; narrow the bounds instead"),
    row(Kind::Function, "plot.polar", "a plot of pairs [angles, values] shows values over the angle"),
    row(Kind::Function, "profiles", PROFILES),
    row(Kind::Function, "screening", "`sweep` has the main effects of every input, `surrogate` their Sobol' indices"),
    row(Kind::Finding, "card-approximated", "a law that a solver has not is refused"),
    row(Kind::Finding, "card-rate-law", "plastic film has curves by rate; a target without them is refused, and `--rate` writes one"),
    row(Kind::Finding, "colour-elsewhere", "it belonged to `digitize`"),
    row(Kind::Finding, "continued-from-profile", PROFILES),
    row(Kind::Finding, "curve-interrupted", "it belonged to `digitize`"),
    row(Kind::Finding, "curve-short", "it belonged to `digitize`"),
    row(Kind::Finding, "deck-bending", "film is a membrane here, too"),
    row(Kind::Finding, "deck-elements-not-read", "meshio converts meshes to .msh"),
    row(Kind::Finding, "deck-implicit", "decks are written for LS-DYNA and OpenRadioss"),
    row(Kind::Finding, "deck-no-friction", "decks are written for LS-DYNA and OpenRadioss"),
    row(Kind::Finding, "deck-other-parts", "meshio converts meshes to .msh"),
    row(Kind::Finding, "deck-rotation", "decks are written for LS-DYNA and OpenRadioss"),
    row(Kind::Finding, "hardening-scatters", PLASTIC),
    row(Kind::Finding, "impact-speed-differs", "a speed that the recording excludes is refused; beside a laser it is `drop-height-differs`"),
    row(Kind::Finding, "history-read", HISTORY),
    row(Kind::Finding, "history-set-aside", HISTORY),
    row(Kind::Finding, "lower-than-estimate", PROFILES),
    row(Kind::Finding, "no-bound", PROFILES),
    row(Kind::Finding, "no-design-point", IMPORTANCE),
    row(Kind::Finding, "one-sided-sample", IMPORTANCE),
    row(Kind::Finding, "open-indices", "it was of `indices`; `surrogate` says how well it predicts as `q2`"),
    row(Kind::Finding, "open-interval", PROFILES),
    row(Kind::Finding, "profile-failed", PROFILES),
    row(Kind::Finding, "springs-beyond-curve", "springs of the frame are linear"),
    row(Kind::Finding, "springs-collapsed", "springs of the frame do not push"),
    row(Kind::Finding, "start-replaced", "a start without a value ends the search; choose another one"),
    row(Kind::Finding, "unloading-not-measured", PLASTIC),
    row(Kind::Finding, "yield-ratio-assumed", PLASTIC),
    row(Kind::Finding, "zero-offset-doubtful", "the zero is fitted with its error: intervals hold it"),
];

/// What to do instead of the command line `words`, of which a row has all words in their order and the same command; with the
/// row's own words.
pub fn command(words: &[String]) -> Option<(&'static str, String)> {
    let words: Vec<&str> = words.iter().flat_map(|word| word.split('=')).collect();
    let first = words.iter().find(|word| !word.starts_with('-'));
    let is_meant = |row: &&Removed| {
        let mut rest = words.iter();
        let is_command = row.name.starts_with('-') || first == row.name.split(' ').next().as_ref();
        is_command && row.name.split(' ').all(|wanted| rest.any(|word| *word == wanted))
    };
    // The row with most words says most.
    let found = REMOVED.iter().filter(|row| row.kind == Kind::Command).filter(is_meant);
    found.max_by_key(|row| row.name.split(' ').count()).map(|row| (row.name, sentence(row)))
}

/// Commands that users look for and that never were.
pub fn sought_commands() -> impl Iterator<Item = &'static str> {
    REMOVED.iter().filter(|row| matches!(row.fate, Fate::Sought)).map(|row| row.name)
}

/// What to do instead of the key at `path`, in which numbers count entries of lists.
pub fn key(path: &str) -> Option<String> {
    let steps: Vec<&str> = path.split('.').filter(|step| step.parse::<usize>().is_err()).collect();
    let is_meant = |row: &&Removed| steps.ends_with(&row.name.split('.').collect::<Vec<_>>());
    REMOVED.iter().filter(|row| row.kind == Kind::Key).find(is_meant).map(sentence)
}

/// What to do instead of the value `word` of the key at `path`.
pub fn value(path: &str, word: &str) -> Option<String> {
    key(&format!("{path} = {word}"))
}

/// What to do instead of the function, or of the option `function.option`.
pub fn function(name: &str) -> Option<String> {
    named(Kind::Function, name)
}

/// What to do instead of waiting for the finding with this code.
pub fn finding(code: &str) -> Option<String> {
    named(Kind::Finding, code)
}

fn named(kind: Kind, name: &str) -> Option<String> {
    REMOVED.iter().find(|row| row.kind == kind && row.name == name).map(sentence)
}

fn sentence(row: &Removed) -> String {
    match row.fate {
        Fate::Gone => format!("it was removed: {}", row.instead),
        Fate::Renamed => format!("it is now {}", row.instead),
        Fate::Sought => row.instead.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_is_found_by_what_a_user_writes() {
        for row in REMOVED {
            let found = match row.kind {
                Kind::Command => {
                    let words: Vec<String> = row.name.split(' ').map(str::to_owned).collect();
                    command(&words).map(|(_, sentence)| sentence)
                }
                Kind::Key => key(&format!("layers.0.{}", row.name)),
                Kind::Function => function(row.name),
                Kind::Finding => finding(row.name),
            };
            assert_eq!(found, Some(sentence(row)), "{}", row.name);
            assert!(!row.instead.ends_with('.'), "{}: a hint is no full sentence", row.name);
        }
        assert_eq!(command(&["run".to_owned(), "a.toml".to_owned()]), None);
        assert_eq!(key("specimen.mesh"), None);
    }
}
