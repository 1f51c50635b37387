//! The resources of a task, checked.

use base::diagnostic::Diagnostic;
use scene::scenario::{Cluster, Document};

use super::Scheduler;

/// Share of the time of a task that is left for its end, and its bounds, s.
const MARGIN: f64 = 0.1;
const MARGINS: [f64; 2] = [20.0, 300.0];

/// The resources of a task, and how its command is started.
#[derive(Clone, Debug, PartialEq)]
pub struct Resources {
    /// The account that pays.
    pub account: Option<String>,
    /// The partition.
    pub partition: Option<String>,
    /// Wall time, s.
    pub time: f64,
    /// Cores.
    pub cores: u16,
    /// Number of tasks.
    pub nodes: u16,
    /// Memory, as Slurm writes it.
    pub memory: Option<String>,
    /// The words before the program.
    pub container: Vec<String>,
    /// The program; none where it is this one.
    pub program: Option<String>,
    /// Further options of the command that submits.
    pub options: Vec<String>,
}

impl Resources {
    /// The resources that the file about a cluster states, for a scheduler.
    ///
    /// # Errors
    /// All mistakes of the file, at once.
    pub fn check(document: &Document, scheduler: Scheduler) -> Result<Resources, Vec<Diagnostic>> {
        let (written, mut mistakes) = document.cluster();
        mistakes.extend(misplaced(document, scheduler));
        mistakes.extend(written.as_ref().map(|written| unreadable(written, document)).unwrap_or_default());
        let Some(written) = written.filter(|_| mistakes.is_empty()) else { return Err(mistakes) };
        Ok(Resources {
            account: written.account,
            partition: written.partition,
            time: written.time.0,
            cores: written.cores,
            nodes: written.nodes,
            memory: written.memory,
            container: written.container,
            program: written.program,
            options: written.options,
        })
    }

    /// Wall time after which a task begins nothing more, s.
    pub fn working_time(&self) -> f64 {
        self.time - (MARGIN * self.time).clamp(MARGINS[0], MARGINS[1])
    }
}

/// Keys that only Slurm knows.
fn misplaced(document: &Document, scheduler: Scheduler) -> Vec<Diagnostic> {
    if scheduler == Scheduler::Slurm {
        return vec![];
    }
    let found = ["account", "partition", "memory"].into_iter().filter(|key| document.find(key).is_some());
    let mistake = |key| {
        let mistake = Diagnostic::new(format!("`{key}` is not allowed for HyperQueue")).at(&document.key_span(key));
        mistake.hint("leave it out: it belongs to the workers, `hq alloc add` or `hq worker start`")
    };
    found.map(mistake).collect()
}

/// Texts that a line of a job script cannot hold.
fn unreadable(written: &Cluster, document: &Document) -> Vec<Diagnostic> {
    let is_plain =
        |text: &str| !text.is_empty() && text.chars().all(|c| c.is_ascii_alphanumeric() || "_.,:+-".contains(c));
    let texts = [("account", &written.account), ("partition", &written.partition), ("memory", &written.memory)];
    let given = texts.into_iter().filter_map(|(key, text)| Some((key, text.as_ref()?)));
    let mistake = |(key, text): (&str, &String)| {
        let expected = "expected letters, digits and any of _ . , : + -";
        Diagnostic::new(format!("{expected}, found \"{text}\"")).at(&document.span(key))
    };
    given.filter(|(_, text)| !is_plain(text)).map(mistake).collect()
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    fn checked(text: &str, scheduler: Scheduler) -> Result<Resources, Vec<String>> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("cluster.toml");
        fs::write(&path, text).unwrap();
        let document = Document::read_cluster(&path).map_err(|mistakes| messages(&mistakes))?;
        Resources::check(&document, scheduler).map_err(|mistakes| messages(&mistakes))
    }

    fn messages(mistakes: &[Diagnostic]) -> Vec<String> {
        mistakes.iter().map(|mistake| mistake.message.clone()).collect()
    }

    #[test]
    fn a_centre_is_read_with_its_units() {
        let text = "account = \"lab\"\ntime = \"50 min\"\ncores = 16\ncontainer = [\"apptainer\", \"exec\", \"d.sif\"]";
        let found = checked(text, Scheduler::Slurm).unwrap();
        assert_eq!((found.time, found.cores, found.nodes), (3000.0, 16, 1));
        assert_eq!((found.account.as_deref(), found.partition, found.container.len()), (Some("lab"), None, 3));
    }

    #[test]
    fn a_task_ends_before_its_time_is_over() {
        for (time, working) in [("1 min", 40.0), ("50 min", 2700.0), ("24 h", 86_100.0)] {
            let found = checked(&format!("time = \"{time}\"\ncores = 1"), Scheduler::Slurm).unwrap();
            assert_eq!(found.working_time(), working);
        }
    }

    #[test]
    fn mistakes_are_told_all_at_once() {
        let text = "account = \"a\\n#SBATCH --x\"\npartition = \"\"\ntime = \"5 s\"\ncores = 0\nnode = 2";
        let found = checked(text, Scheduler::Slurm).unwrap_err();
        let expected = ["found \"a", "found \"\"", "at least 60 s", "at most 4096", "unknown key `node`"];
        assert_eq!(found.len(), expected.len(), "{found:?}");
        let all = found.join("\n");
        assert!(expected.iter().all(|words| all.contains(words)), "{all}");
        let found = checked("account = \"lab\"\ntime = \"1 h\"\ncores = 1", Scheduler::HyperQueue).unwrap_err();
        assert_eq!(found, ["`account` is not allowed for HyperQueue"]);
    }
}
