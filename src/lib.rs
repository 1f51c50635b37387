//! A scripted virtual drop tower for thin films and membranes.
//!
//! Data flows one way, and the modules stand in the order of that flow: a scenario file is parsed
//! ([`scenario`]), checked into SI values ([`model`]), meshed ([`mesh`]), stepped through time
//! ([`engine`], [`simulate`]), measured ([`post`]) and written down ([`store`], [`report`]).
//! No module names one that stands below it; `tests/it/architecture.rs` keeps it so.

pub mod units;
pub mod diagnostic;
pub mod file;
pub mod finding;
pub mod lane;
pub mod signal;
pub mod plot;
pub mod experiment;
pub mod material;
pub mod scenario;
pub mod model;
pub mod mesh;
pub mod engine;
pub mod simulate;
pub mod store;
pub mod script;
pub mod functions;
pub mod post;
pub mod identify;
pub mod report;
pub mod cli;
