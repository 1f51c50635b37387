//! The vocabulary of every part of droptower: numbers and units, diagnostics and findings, files and tables.
#![warn(missing_docs)]

pub mod number;
pub mod group;
pub mod units;
pub mod words;
pub mod written;
pub mod diagnostic;
pub mod markup;
pub mod scratch;
pub mod file;
pub mod finding;
pub mod shell;
pub mod cancellation;
pub mod budget;
pub mod periodic;
pub mod table;
pub mod removed;

use std::sync::{Mutex, MutexGuard, PoisonError};

/// Locks what is shared, also where a thread panicked with it: no change is half done where one may.
pub fn lock<T>(shared: &Mutex<T>) -> MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}
