//! `droptower schema`: the JSON Schema of the language.

use super::{Failure, print_json};
use crate::scenario::schema;

pub(super) fn run() -> Result<(), Failure> {
    print_json(&schema::published())
}
