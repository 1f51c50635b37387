//! Segments of stored evaluations, the records in them, and runs that are kept whole.
//!
//! The first byte tells what the rest is: a segment as it is, a whole run, or a list of entries, each a kind, a key, a length and
//! so many bytes. Runs and entries are written with their checksums, and packed where they are so.
//!
//! Readers: src/study/store/evaluations src/study/evaluate
#![no_main]

use libfuzzer_sys::fuzz_target;

use base::file::checksum;
use droptower_fuzz::with_files;
use study::evaluate::{EvaluationKeys, Evaluations, build_name};
use study::store::EvaluationStore;
use study::store::evaluations::Key;

const MAGIC: &[u8] = b"droptower evaluations 01\n";

/// The kind of the entries that hold records, which are packed.
const PACKED: u8 = 1;

/// Number of kinds of entries.
const KINDS: u8 = 10;

const RUN: &str = "runs/00/00000000000000000000000000000000.run";

fuzz_target!(|input: &[u8]| {
    let Some((kind, rest)) = input.split_first() else { return };
    let run = [&checksum(&packed(rest)).to_le_bytes(), packed(rest).as_slice()].concat();
    let (name, content) = match kind {
        0 => ("1.evaluations", [MAGIC, rest].concat()),
        1 => (RUN, run),
        _ => ("1.evaluations", segment(rest)),
    };
    with_files(&[(name, &content)], |folder| {
        drop(EvaluationStore::list(folder));
        let Ok(evaluations) = Evaluations::open(folder) else { return };
        for byte in 0..4 {
            let key = Key([byte; 16]);
            drop(evaluations.record(EvaluationKeys { run: key, figures: key }));
            drop((evaluations.store().refusal(key), evaluations.outcome(key)));
        }
    });
});

/// A segment of this build with the entries of the input.
fn segment(input: &[u8]) -> Vec<u8> {
    let mut segment = MAGIC.to_vec();
    append(&mut segment, 0, 0, build_name().as_bytes());
    let mut rest = input;
    while let [kind, key, length, after @ ..] = rest {
        let (content, after) = after.split_at(after.len().min(4 * usize::from(*length)));
        let kind = kind % KINDS;
        let content = if kind == PACKED { packed(content) } else { content.to_vec() };
        append(&mut segment, kind, key % 4, &content);
        rest = after;
    }
    segment
}

fn append(segment: &mut Vec<u8>, kind: u8, key: u8, content: &[u8]) {
    let summed = [&[kind][..], &[key; 16], content].concat();
    segment.extend((content.len() as u32).to_le_bytes());
    segment.extend(checksum(&summed).to_le_bytes());
    segment.extend(summed);
}

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
