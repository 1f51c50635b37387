//! Trials in parallel: the pool of threads, its schedule, the cache of trials and their history on disk.

pub(crate) mod history;
mod schedule;
mod trial_cache;
pub(crate) mod trial_pool;
mod trial_record;
