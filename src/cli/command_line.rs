//! The command that started this process.

use base::shell::quoted;

/// The command as it was given, in words that a shell takes again.
pub(super) fn command_line() -> String {
    let words = std::env::args_os().skip(1).map(|word| quoted(&word.to_string_lossy()));
    std::iter::once("droptower".to_owned()).chain(words).collect::<Vec<_>>().join(" ")
}
