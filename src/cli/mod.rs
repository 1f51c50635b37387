//! The command line: one file a command, exit codes, and the one place that prints.
