//! The indentation.

mod depth;

pub(super) use depth::check as depth;
