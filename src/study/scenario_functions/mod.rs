//! Functions of scenarios and their runs for studies: scripts that are started by `droptower script`.

mod coupon_material;
mod modules;
mod study;

use crate::script::Chapter;

pub(crate) use study::across_named;
pub use study::{Scenarios, Study, register};

/// The reference of scenarios in scripts.
pub const REFERENCE: &[Chapter] = &[
    Chapter { title: "scenarios (droptower script)", entries: study::ENTRIES },
    Chapter { title: "the module droptower/film (droptower script)", entries: modules::ENTRIES },
    Chapter { title: "materials from coupon tests (droptower script)", entries: coupon_material::ENTRIES },
];
