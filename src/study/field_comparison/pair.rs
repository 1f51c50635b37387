//! States of a field and of a run at the same time.

use lab::field::FieldState;
use scene::simulate::FaceState;

/// A state of the field and that of the film at its time.
#[derive(Clone, Copy)]
pub struct Pair<'a> {
    pub film: &'a FaceState,
    pub field: &'a FieldState,
}
