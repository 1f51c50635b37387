//! Warnings about the checkpoint that a run resumes from.

use std::path::PathBuf;

use super::file_name;
use base::diagnostic::shown_path;
use base::findings;

findings! {
    /// A warning that comes before a run resumes.
    #[derive(Clone, Debug, PartialEq, Eq)]
    pub(crate) enum Warning {
        NoCheckpoint {
            run: String, "its name" => "run";
            folder: PathBuf, "the folder without checkpoints" => "folder" = shown_path(folder);
            replaced: Option<PathBuf>, "the folder of results that will be replaced, where it exists"
                => "replaced" = replaced.as_deref().map(shown_path);
        } = "no-checkpoint", Note;
            meaning "a batch resumes, and this run has no checkpoint: it had not started, or its results are of \
                another state of its scenario, so it starts from its beginning";
            remedy "leave its scenario out where its results are to stay";
            message "{run} starts from its beginning: there is no checkpoint in {}{}", shown_path(folder),
                replaced.as_deref().map_or_else(String::new, |results| {
                    let results = shown_path(results);
                    format!("; its results in {results} will be replaced: leave the scenario out to keep them")
                });
        Complete {
            run: String, "its name" => "run";
            folder: PathBuf, "the folder of its results" => "folder" = shown_path(folder);
        } = "already-complete", Note;
            meaning "a batch resumes, and the results of this run are those of its scenario as it is now: they are \
                left as they are";
            remedy "none is needed; without --resume the run is repeated";
            message "{run} is complete: {}", shown_path(folder);
        Damaged {
            run: String, "name of the run" => "run";
            damaged: PathBuf, "the checkpoint" => "damaged" = shown_path(damaged);
            used: PathBuf, "the one before it" => "used" = shown_path(used);
        } = "damaged-checkpoint", Warning;
            meaning "the newest checkpoint of a run is damaged, so the run resumes from the one before it";
            remedy "none is needed; what was computed between the two is computed again, with the same result";
            message "{run}: {} is damaged; the run resumes from {}, the one before it",
                shown_path(damaged), file_name(used);
    }
}
