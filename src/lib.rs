//! A scripted virtual drop tower for thin films and membranes.
//!
//! ```
//! use droptower::diagnostic::{Diagnostic, render};
//! use droptower::{model, post::Plan, scenario, simulate};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let text = |mistakes: Vec<Diagnostic>| render(&mistakes, false);
//!
//! // A scenario file with one key changed, checked and in SI units.
//! let path = std::path::Path::new("scenarios/drop/1008.toml");
//! let coarse = scenario::Assignment::from_argument("specimen.mesh.size=40mm").map_err(text)?;
//! let document = scenario::Document::read(path).map_err(text)?.with(&[coarse]);
//! let model = model::check(&document).map_err(text)?;
//!
//! // Its run, measured and compared with the reference that it names.
//! let plan = Plan::prepare(&model)?;
//! let outcome = simulate::run(&model, &mut |_| {})?;
//! let results = plan.measure(&model, &outcome)?;
//!
//! let displacement = results.signals.series("displacement_m").ok_or("no such signal")?;
//! let [time, lowest] = displacement.smallest().ok_or("no samples")?;
//! println!("lowest point {lowest:.3} m at {time:.3} s, D = {}", results.summary(&model)["energy_absorption"]);
//! assert!(lowest < -0.1 && outcome.energy_balance_error < 0.01);
//! # Ok(())
//! # }
//! ```
//!
//! droptower simulates tests of films by explicit finite elements: impact of a rigid body, stretching between jaws,
//! slow indentation and inflation. It reduces recordings of such tests, compares both, and searches for the parameters
//! of a material. The program of the same name is one user of this library; `examples/` has others: a run and its
//! signals, a law of one's own on a single element, a search.
//!
//! The modules stand in the order in which data flows. A scenario file is read ([`scenario`]), checked into SI values
//! ([`model`]), meshed ([`mesh`]), stepped through time ([`engine`], [`simulate`]), measured ([`post`]) and written
//! ([`store`], [`report`]); [`signal`] and [`experiment`] reduce recordings, [`identify`] searches, and [`confidence`]
//! says how well what they find is known. No module uses one that stands below it, which `tests/it/architecture.rs`
//! checks. `docs/theory.md` and `docs/methods.md` have the equations that comments cite, `docs/glossary.md` the terms.
#![warn(missing_docs)]

#[doc(inline)]
pub use base::{cancellation, diagnostic, file, finding, number, periodic, shell, table, units};
#[doc(inline)]
pub use card;
#[doc(inline)]
pub use cli;
#[doc(inline)]
pub use lab::{confidence, dic, error, experiment, signal};
#[doc(inline)]
pub use membrane::{engine, lane, material};
#[doc(inline)]
pub use picture::{self, gltf};
#[doc(inline)]
pub use plot;
#[doc(inline)]
pub use report;
#[doc(inline)]
pub use scene::{expectation, mesh, model, scenario, simulate};
#[doc(inline)]
pub use study::{
    calibrate, evaluate, field_comparison, functions, identify, post, reference, scenario_functions, script, store,
    sweep,
};
#[doc(inline)]
pub use uncertainty;
