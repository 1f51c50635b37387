//! The file about a cluster, and what a folder of results says of the jobs that were submitted.
#![no_main]

use libfuzzer_sys::fuzz_target;

use droptower_fuzz::{show, split, with_files};
use scene::scenario::Document;
use study::cluster::{Job, Resources, Scheduler};

const FILES: [&str; 2] = ["cluster.toml", "job.json"];

fuzz_target!(|input: &[u8]| {
    with_files(&split(&FILES, input), |folder| {
        match Document::read_cluster(&folder.join(FILES[0])) {
            Ok(document) => {
                for scheduler in [Scheduler::Slurm, Scheduler::HyperQueue] {
                    let resources = Resources::check(&document, scheduler).map_err(|mistakes| show(&mistakes));
                    drop(resources.map(|resources| resources.working_time()));
                }
            }
            Err(mistakes) => drop(show(&mistakes)),
        }
        drop(Job::read(folder).map_err(|error| error.to_string()));
    });
});
