//! Random numbers for virtual tests: the same for the same seed, on every machine.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal, StandardUniform};
use rhai::{Array, Dynamic, Engine, EvalAltResult, INT};

use crate::script::{Entry, refuse};

/// Most numbers that are drawn at once, the limit of lists.
const MOST: INT = 10_000;

/// A stream of random numbers.
type Stream = ChaCha8Rng;

/// Offers `random(seed)` to scripts.
pub(super) fn register(engine: &mut Engine) {
    engine
        .register_type_with_name::<Stream>("random")
        // By its bits, so that a negative number is a seed too.
        .register_fn("random", |seed: INT| Stream::seed_from_u64(seed.cast_unsigned()))
        .register_fn("uniform", |stream: &mut Stream| -> f64 { StandardUniform.sample(stream) })
        .register_fn("normal", |stream: &mut Stream| -> f64 { StandardNormal.sample(stream) })
        .register_fn("normals", normals);
}

fn normals(stream: &mut Stream, count: INT) -> Result<Array, Box<EvalAltResult>> {
    if !(0..=MOST).contains(&count) {
        return Err(refuse(format!("expected a count of 0 to {MOST} random numbers, found {count}")));
    }
    let draw = |_| -> f64 { StandardNormal.sample(stream) };
    Ok((0..count).map(draw).map(Dynamic::from).collect())
}

/// The reference of random numbers.
pub const ENTRIES: &[Entry] = &[
    Entry {
        call: "random(seed)",
        gives: "a stream of random numbers (ChaCha8), the same for the same whole number",
        example: "random(7).normal() == random(7).normal() && random(7).uniform() != random(8).uniform()",
    },
    Entry {
        call: "random.uniform(), random.normal()",
        gives: "the next number between 0 and 1, and the next of mean 0 and standard deviation 1",
        example: "let r = random(1); let u = r.uniform(); u >= 0 && u < 1 && r.normal() != r.normal()",
    },
    Entry {
        call: "random.normals(count)",
        gives: "a list of such numbers of mean 0 and standard deviation 1",
        example: "let r = random(1); let l = r.normals(4000); (l.reduce(|s, x| s + x, 0.0) / 4000).abs() < 0.05",
    },
];
