//! `droptower schema`: the JSON Schema of the language.

use clap::{Args, ValueEnum};

use super::{Failure, print_json};
use scene::scenario::FileKind;

#[derive(Debug, Args)]
pub(super) struct SchemaArgs {
    /// The kind of file
    #[arg(value_enum, default_value_t)]
    kind: Kind,
}

/// Kinds of files.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
enum Kind {
    /// Scenarios
    #[default]
    Scenario,
    /// Material files of one layer
    Material,
    /// `expect.toml`: what a run must give
    Expect,
}

pub(super) fn run(args: &SchemaArgs) -> Result<(), Failure> {
    let kind = match args.kind {
        Kind::Scenario => FileKind::Scenario,
        Kind::Material => FileKind::Material,
        Kind::Expect => FileKind::Expectations,
    };
    print_json(&kind.schema())
}
