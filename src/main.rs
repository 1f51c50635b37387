//! The `droptower` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    droptower::cli::main()
}
