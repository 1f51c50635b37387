//! Records of evaluations and runs that are kept whole.
//!
//! The first byte tells what the rest is: a file as it is, or a record or a whole run, which is packed and written with its
//! checksum.
//!
//! Readers: src/study/store/evaluations.rs src/study/evaluate.rs
#![no_main]

use libfuzzer_sys::fuzz_target;

use base::file::checksum;
use droptower_fuzz::with_files;
use study::evaluate::{EvaluationKeys, Evaluations, build_name};
use study::store::EvaluationStore;
use study::store::evaluations::Key;

fuzz_target!(|input: &[u8]| {
    let Some((kind, rest)) = input.split_first() else { return };
    let [folder, extension] = if kind % 2 == 0 { ["records", "record"] } else { ["runs", "run"] };
    let key = Key([0; 16]);
    let name = format!("{}/{folder}/00/{key}.{extension}", build_name());
    let packed = packed(rest);
    let content = if *kind < 2 { rest.to_vec() } else { [&checksum(&packed).to_le_bytes(), &packed[..]].concat() };
    with_files(&[(&name, &content)], |folder| {
        drop(EvaluationStore::list(folder));
        let evaluations = Evaluations::new(folder);
        drop(evaluations.record(EvaluationKeys { run: key, figures: key }));
        drop((evaluations.store().refusal(key), evaluations.outcome(key)));
    });
});

/// The bytes in the format of zlib, not compressed, so that what libFuzzer changes is what is read.
fn packed(bytes: &[u8]) -> Vec<u8> {
    let bytes = &bytes[..bytes.len().min(usize::from(u16::MAX))];
    let length = bytes.len() as u16;
    let [low, high] = bytes.iter().fold([1_u32, 0], |[low, high], byte| {
        let low = (low + u32::from(*byte)) % 65_521;
        [low, (high + low) % 65_521]
    });
    let sum = (high << 16) | low;
    [&[0x78, 1, 1][..], &length.to_le_bytes(), &(!length).to_le_bytes(), bytes, &sum.to_be_bytes()].concat()
}
