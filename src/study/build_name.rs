//! The name of the build: what another one computes may differ in its bits.

use std::hint::black_box;
use std::sync::LazyLock;

use crate::store::evaluations::Key;

/// The name of this build where it runs: its version, a digest of the sources, the compiler and the machine that it was
/// made for, and one of what the mathematical library of this machine answers. Equal names promise equal bits.
pub fn build_name() -> &'static str {
    static NAME: LazyLock<String> = LazyLock::new(|| name_of(&answers()));
    &NAME
}

fn name_of(answers: &[f64]) -> String {
    let bits: Vec<u8> = answers.iter().flat_map(|answer| answer.to_bits().to_le_bytes()).collect();
    let library = &Key::from_parts(&[&bits]).to_string()[..16];
    concat!(env!("CARGO_PKG_VERSION"), " ", env!("DROPTOWER_BUILD"), " ").to_owned() + library
}

/// Functions of one argument that the mathematical library of the machine computes.
const OF_ONE: [fn(f64) -> f64; 17] = [
    f64::exp,
    f64::exp2,
    f64::exp_m1,
    f64::ln,
    f64::ln_1p,
    f64::log2,
    f64::log10,
    f64::sin,
    f64::cos,
    f64::tan,
    f64::asin,
    f64::acos,
    f64::atan,
    f64::sinh,
    f64::cosh,
    f64::tanh,
    f64::cbrt,
];

/// Functions of two arguments.
const OF_TWO: [fn(f64, f64) -> f64; 3] = [f64::powf, f64::atan2, f64::hypot];

/// Number of arguments at which each function is asked.
const ARGUMENTS: u32 = 64;

/// Values of the functions at arguments that cover the unit interval, and some beyond it.
fn answers() -> Vec<f64> {
    const GOLDEN: f64 = 0.618_033_988_749_895;
    // Hidden from the compiler, which would else answer with the library of the machine that it runs on.
    let arguments = || (1..=ARGUMENTS).map(|number| black_box((f64::from(number) * GOLDEN).fract()));
    let of_one = |function: &fn(f64) -> f64| {
        let function = *black_box(function);
        arguments().flat_map(move |x| [x, 40.0 * x].map(function)).collect::<Vec<f64>>()
    };
    let of_two = |function: &fn(f64, f64) -> f64| {
        let function = *black_box(function);
        arguments().zip(arguments().skip(1)).map(move |(x, y)| function(x, 9.0 * y)).collect::<Vec<f64>>()
    };
    OF_ONE.iter().flat_map(of_one).chain(OF_TWO.iter().flat_map(of_two)).collect()
}

// Its `main` runs before the build.
#[cfg(test)]
#[allow(dead_code)]
#[path = "build.rs"]
mod build;

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    #[test]
    fn what_decides_the_bits_is_digested_and_nothing_else() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let files: Vec<String> = build::sources(&root).unwrap().into_iter().map(|(name, _)| name).collect();
        for name in [
            "src/membrane/engine/cushion.rs",
            "src/membrane/material/viscous/shift.rs",
            "src/scene/simulate/mod.rs",
            "src/lab/signal/filter.rs",
            "src/study/post/impact.rs",
            "scripts/droptower/film.rhai",
            "Cargo.lock",
        ] {
            assert!(files.iter().any(|file| file == name), "{name} is not in");
        }
        let is_other = |file: &&String| {
            let starts =
                ["src/cli", "src/report", "src/picture", "src/plot", "src/study/sweep", "src/study/store", "viz"];
            starts.iter().any(|start| file.starts_with(start)) || file.contains("tests")
        };
        assert_eq!(files.iter().find(is_other), None);
    }

    #[test]
    fn another_mathematical_library_is_another_build() {
        let mut answers = answers();
        assert_eq!(name_of(&answers), build_name());
        assert!(answers.iter().filter(|answer| answer.is_finite()).count() > answers.len() / 2);
        let last = answers.last_mut().unwrap();
        *last = f64::from_bits(last.to_bits() + 1);
        assert_ne!(name_of(&answers), build_name());
    }
}
