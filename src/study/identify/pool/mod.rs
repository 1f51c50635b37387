//! Trials in parallel: the pool of threads and its schedule.

mod schedule;
pub(crate) mod trial_pool;
