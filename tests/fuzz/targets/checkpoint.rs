//! Checkpoints: their header, and a run that resumes from them.
//!
//! The first byte tells what the rest is: the bytes of a header, those of a state, or places and bytes that change a state that
//! the run has written, so that inputs outlive changes of the layout.
//!
//! Readers: src/study/store/checkpoints.rs src/scene/simulate src/membrane/engine/state.rs
#![no_main]

use libfuzzer_sys::fuzz_target;

use std::sync::OnceLock;

use droptower_fuzz::with_file;
use membrane::engine::ThreadPool;
use scene::model::{self, Identity, Model};
use scene::scenario::Document;
use scene::simulate::{Checkpoint, Checkpoints, Restart, RunOptions, run_with};
use study::store::checkpoints;

const SCENARIO: &[u8] = include_bytes!("../corpus/scenario/drop.toml");

/// Steps after which a run ends that resumed.
const STEPS: usize = 5;

/// The fields of the header of a checkpoint in their order.
type Header = (String, Option<f64>, bool, String, Identity);

fuzz_target!(|input: &[u8]| {
    let Some((kind, rest)) = input.split_first() else { return };
    let state = match kind {
        0 => return drop(postcard::from_bytes::<Header>(rest)),
        1 => rest.to_vec(),
        _ => changed(rest),
    };
    if let Ok(restart) = postcard::from_bytes::<Restart>(&state) {
        drop(run(Some(restart)));
    }
    with_file("1.state", rest, |path| drop(checkpoints::open(path)));
});

/// The state that a run has written, with the bytes at some places replaced.
fn changed(changes: &[u8]) -> Vec<u8> {
    static STATE: OnceLock<Vec<u8>> = OnceLock::new();
    let mut state = STATE.get_or_init(|| run(None)).clone();
    let (changes, _) = changes.as_chunks::<3>();
    for [high, low, byte] in changes {
        let length = state.len();
        state[usize::from(u16::from_be_bytes([*high, *low])) % length] = *byte;
    }
    state
}

/// A few steps of the run, and the state after them.
fn run(restart: Option<Restart>) -> Vec<u8> {
    static MODEL: OnceLock<Model> = OnceLock::new();
    let model = MODEL.get_or_init(model);
    let (mut state, mut steps) = (Vec::new(), 0);
    let options = RunOptions { restart, pool: Some(ThreadPool::new(1)), ..RunOptions::default() };
    let cancellation = options.cancellation.clone();
    let mut write = |checkpoint: &Checkpoint<'_>| {
        state = postcard::to_allocvec(checkpoint).expect("a state that is written");
        steps += 1;
        if steps > STEPS {
            cancellation.cancel();
        }
    };
    let options = RunOptions { checkpoints: Some(Checkpoints { every: 1e-12, write: &mut write }), ..options };
    drop(run_with(model, options, &mut |_| {}));
    state
}

fn model() -> Model {
    let mut model = None;
    with_file("drop.toml", SCENARIO, |path| {
        let document = Document::read(path).expect("a scenario");
        model = Some(model::check(&document).expect("a model"));
    });
    model.expect("a model")
}
