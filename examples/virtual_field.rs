//! Makes the virtual displacement field of `scenarios/inflation/field.toml`:
//! `cargo run --release --example virtual_field -- data/virtual_field`.

use std::error::Error;
use std::fmt::Write;
use std::fs;
use std::path::Path;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Normal};

use droptower::diagnostic::{Diagnostic, render};
use droptower::dic::RigidMotion;
use droptower::field_comparison::FilmSurface;
use droptower::model::{self, Motion};
use droptower::scenario::{Assignment, Document};
use droptower::simulate;

/// Times of the files, s.
pub const TIMES: [f64; 4] = [0.25, 0.5, 0.75, 1.0];
/// Multipliers of MD and TD up to the first yield point.
pub const TRUE: [f64; 2] = [1.3, 0.8];
/// Standard deviation of a component of a displacement, m.
pub const NOISE: f64 = 10e-6;
/// Translation (m) and rotation (axis times angle, rad) from the axes of the run to those of the camera.
pub const CAMERA: [[f64; 3]; 2] = [[0.031, -0.012, 0.41], [0.12, -0.2, 0.5]];

/// Distance of the points, and radius within which they are seen, m.
const APART: f64 = 5e-3;
const SEEN: f64 = 44e-3;
/// Standard deviations beyond which a point is not matched: 8 % of them.
const MATCHED: f64 = 1.75;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("the folder is missing: cargo run --example virtual_field -- FOLDER")?;
    fs::create_dir_all(&folder)?;
    for (name, content) in files("2.5 mm")? {
        fs::write(Path::new(&folder).join(name), content)?;
    }
    Ok(())
}

/// The motion from the axes of the run to those of the camera.
pub fn camera() -> RigidMotion {
    let [translation, rotation] = CAMERA;
    RigidMotion::new(translation, rotation)
}

/// Names and contents of the files, of a run on a mesh of this size.
pub fn files(size: &str) -> Result<Vec<(String, String)>, Box<dyn Error>> {
    let mistakes = |mistakes: Vec<Diagnostic>| render(&mistakes, false);
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/inflation/field.toml");
    let [md, td] = TRUE;
    let changes = [
        format!("specimen.mesh.size={size}"),
        format!("specimen.material.fabric.md.scale={{ k1 = {md} }}"),
        format!("specimen.material.fabric.td.scale={{ k1 = {td} }}"),
    ];
    let changes = changes.iter().map(|change| Assignment::from_argument(change)).collect::<Result<Vec<_>, _>>();
    let changes = [changes.map_err(mistakes)?, vec![Assignment::unset("reference", "virtual_field")]].concat();
    let mut model = model::check(&Document::read(&path).map_err(mistakes)?.with(&changes)).map_err(mistakes)?;
    model.output.motion = Some(Motion { face: 0, times: TIMES.to_vec() });
    let outcome = simulate::run(&model, &mut |_| {})?;
    let motion = outcome.motion.ok_or("the motion was not recorded")?;
    let surface = FilmSurface::of_motion(&motion).ok_or("the film has no surface")?;

    let (camera, mut random) = (camera(), ChaCha8Rng::seed_from_u64(2026));
    let normal = Normal::new(0.0, NOISE)?;
    let count = (SEEN / APART) as i32;
    let grid = (-count..=count).flat_map(|i| (-count..=count).map(move |j| [i, j].map(|n| f64::from(n) * APART)));
    let points: Vec<[f64; 3]> =
        grid.filter(|[x, y]| x.hypot(*y) <= SEEN).map(|[x, y]| [x, y, motion.reference[0][2]]).collect();
    let mut files = Vec::new();
    for (number, state) in motion.states.iter().enumerate() {
        let mut text = format!(
            "# VIRTUAL field: nothing was measured; made by examples/virtual_field.rs on elements of {size}\n\
             \"Index [1]\",\"X [mm]\",\"Y [mm]\",\"Z [mm]\",\"U [mm]\",\"V [mm]\",\"W [mm]\",\"sigma [pixel]\"\n",
        );
        for (index, point) in points.iter().enumerate() {
            let is_missing = normal.sample(&mut random).abs() > NOISE * MATCHED;
            let moved = surface.displacement(*point, state);
            let moved = moved.map(|part| part + normal.sample(&mut random));
            let ([x, y, z], [u, v, w]) = (camera.apply(*point), camera.rotate(moved));
            let ([u, v, w], sigma) = if is_missing { ([0.0; 3], -1.0) } else { ([u, v, w], 0.012) };
            let [x, y, z, u, v, w] = [x, y, z, u, v, w].map(|length| length * 1e3);
            writeln!(text, "{index},{x:.5},{y:.5},{z:.5},{u:.5},{v:.5},{w:.5},{sigma}")?;
        }
        files.push((format!("bulge_{}.csv", number + 1), text));
    }
    Ok(files)
}
