//! What the simulation claims, held against closed forms, against itself by another road, and against the published
//! outcomes. `docs/verification.md` has the table; `cargo test verification -- --nocapture` prints its figures.

mod claims;
mod scene;
mod tower;

mod contact;
mod drop;
mod oscillation;
mod patch;
mod rupture;
mod shapes;
mod single_element;
mod warnings;
