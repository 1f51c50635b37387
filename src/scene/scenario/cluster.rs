//! `cluster.toml`: a cluster, as `droptower sweep --on` uses it.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use base::units::Time;

/// A cluster.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Cluster {
    /// A file of the same kind whose keys hold where this one has none.
    #[schemars(extend("x-path" = true))]
    pub extends: Option<PathBuf>,
    /// The account that pays; only of Slurm.
    pub account: Option<String>,
    /// The partition; only of Slurm. Left out, the default one.
    pub partition: Option<String>,
    /// Wall time that a task may take. A task ends before it is over, and what is left is submitted again.
    #[schemars(extend("minimum" = 60, "maximum" = 1e7, "x-likely" = [300.0, 2.6e5]))]
    pub time: Time,
    /// Cores of a task, all on one node.
    #[schemars(range(min = 1, max = 4096))]
    pub cores: u16,
    /// Number of tasks, each on a node or a part of one.
    #[serde(default = "one")]
    #[schemars(range(min = 1, max = 10_000))]
    pub nodes: u16,
    /// Memory of a task, as Slurm writes it ("4G"); only of Slurm. Left out, the default of the partition.
    pub memory: Option<String>,
    /// The words before the program that start it in a container: ["apptainer", "exec", "droptower.sif"].
    #[serde(default)]
    pub container: Vec<String>,
    /// The program on the nodes. Left out, this one; in a container "droptower".
    pub program: Option<String>,
    /// Further options of the command that submits: ["--qos=short"].
    #[serde(default)]
    pub options: Vec<String>,
}

fn one() -> u16 {
    1
}
