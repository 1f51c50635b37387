//! HyperQueue: task arrays by `hq submit`, their tasks by `hq job info`.

use std::process::Command;

use serde_json::Value;

use super::{Batch, SchedulerError, Tasks, answer, command_line, write_script};

/// Number of the task within a script.
const NUMBER: &str = "\"$HQ_TASK_ID\"";

/// Times that a task is started again after its worker was lost.
const CRASHES: &str = "20";

/// Submits the batch as a task array.
pub(super) fn submit(batch: &Batch<'_>) -> Result<String, SchedulerError> {
    let path = write_script(batch, &format!("#!/bin/sh\n{}", command_line(batch, NUMBER)))?;
    let log = batch.folder.join("task-%{TASK_ID}.log");
    let mut command = Command::new("hq");
    command.args(["--output-mode=json", "submit", "--name"]).arg(format!("droptower {}", batch.name));
    command.arg("--array").arg(format!("1-{}", batch.tasks));
    command.arg("--cpus").arg(batch.resources.cores.to_string());
    let time = format!("{}s", batch.resources.time.ceil());
    command.arg("--time-limit").arg(&time).arg("--time-request").arg(&time).args(["--crash-limit", CRASHES]);
    command.arg("--cwd").arg(batch.working_folder).arg("--stdout").arg(&log).arg("--stderr").arg(&log);
    command.args(&batch.resources.options).arg("--").arg("sh").arg(&path);
    let text = answer("hq", &mut command)?;
    let id = serde_json::from_str::<Value>(&text).ok().and_then(|answer| answer.get("id")?.as_u64());
    id.map(|id| id.to_string()).ok_or(SchedulerError::Answer { program: "hq", text })
}

/// The tasks that have not ended.
pub(super) fn tasks(id: &str) -> Result<Tasks, SchedulerError> {
    let text = answer("hq", Command::new("hq").args(["--output-mode=json", "job", "info", id]))?;
    counted(&text).ok_or(SchedulerError::Answer { program: "hq", text })
}

/// The tasks in what `hq job info` prints: an object for each job, whose `info.task_stats` counts them by state. A server
/// that was started anew has forgotten the job.
fn counted(text: &str) -> Option<Tasks> {
    let found: Value = serde_json::from_str(text).ok()?;
    let job = match &found {
        Value::Array(jobs) => match jobs.first() {
            Some(job) => job,
            None => return Some(Tasks::default()),
        },
        job => job,
    };
    let counts = job.get("info")?.get("task_stats")?;
    let count = |state: &str| Some(counts.get(state)?.as_u64()? as usize);
    Some(Tasks { waiting: count("waiting")?, running: count("running")?, reason: None })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tasks_are_counted_by_state() {
        let counts = r#"{"running":2,"finished":1,"failed":0,"canceled":0,"waiting":3}"#;
        let expected = Some(Tasks { waiting: 3, running: 2, reason: None });
        assert_eq!(counted(&format!(r#"[{{"info":{{"id":1,"task_stats":{counts}}}}}]"#)), expected);
        assert_eq!(counted(&format!(r#"{{"info":{{"id":1,"task_stats":{counts}}}}}"#)), expected);
        assert_eq!(counted("[]"), Some(Tasks::default()));
        assert_eq!(counted(r#"{"error":"x"}"#), None);
        assert_eq!(counted("no server"), None);
    }
}
