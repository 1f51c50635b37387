//! The file about a cluster.
#![no_main]

use libfuzzer_sys::fuzz_target;

use droptower_fuzz::{show, with_file};
use scene::scenario::Document;
use study::cluster::{Resources, Scheduler};

fuzz_target!(|input: &[u8]| {
    with_file("cluster.toml", input, |path| match Document::read_cluster(path) {
        Ok(document) => {
            for scheduler in [Scheduler::Slurm, Scheduler::HyperQueue] {
                let resources = Resources::check(&document, scheduler).map_err(|mistakes| show(&mistakes));
                drop(resources.map(|resources| resources.working_time()));
            }
        }
        Err(mistakes) => drop(show(&mistakes)),
    });
});
