//! `droptower schema`: the JSON Schema of the language.

use std::process::ExitCode;

use super::print_json;
use crate::scenario::schema;

pub fn run() -> ExitCode {
    print_json(&schema::published())
}
