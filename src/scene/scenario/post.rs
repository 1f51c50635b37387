//! `[post]`: processing of the results.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Processing of the results.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Post {
    /// Rhai script that adds to the summary.
    #[schemars(extend("x-path" = true))]
    pub script: PathBuf,
}
