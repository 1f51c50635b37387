//! Slurm: array jobs by `sbatch`, their tasks by `squeue`.

use std::process::Command;

use super::{Batch, SchedulerError, Tasks, answer, command_line, write_script};

/// Number of the task within a script.
const NUMBER: &str = "\"$SLURM_ARRAY_TASK_ID\"";

/// Time before the end of its limit at which a task is told to end, s.
const WARNING: u32 = 15;

/// Submits the batch as an array.
pub(super) fn submit(batch: &Batch<'_>) -> Result<String, SchedulerError> {
    let path = write_script(batch, &script(batch))?;
    let mut command = Command::new("sbatch");
    // Options on the command line, in which a path may hold anything.
    let output = batch.folder.display().to_string().replace('%', "%%");
    command.arg("--parsable").arg("--chdir").arg(batch.working_folder);
    command.arg(format!("--output={output}/task-%a.log")).args(&batch.resources.options).arg(&path);
    let text = answer("sbatch", &mut command)?;
    // The number of the job, and behind a semicolon the name of the cluster.
    let id = text.lines().last().unwrap_or_default().split(';').next().unwrap_or_default();
    match id.is_empty() || !id.bytes().all(|byte| byte.is_ascii_digit()) {
        true => Err(SchedulerError::Answer { program: "sbatch", text }),
        false => Ok(id.to_owned()),
    }
}

/// The script of an array: options of `sbatch` as comments, and the command.
fn script(batch: &Batch<'_>) -> String {
    let Batch { name, tasks, resources, .. } = batch;
    let name: String = name.chars().map(|c| if c.is_alphanumeric() { c } else { '-' }).collect();
    let mut lines = vec![
        "#!/bin/sh".to_owned(),
        format!("#SBATCH --job-name=droptower-{name}"),
        format!("#SBATCH --array=1-{tasks}"),
        "#SBATCH --nodes=1".into(),
        "#SBATCH --ntasks=1".into(),
        format!("#SBATCH --cpus-per-task={}", resources.cores),
        format!("#SBATCH --time={}", duration(resources.time)),
        format!("#SBATCH --signal=B:TERM@{WARNING}"),
        "#SBATCH --requeue".into(),
        "#SBATCH --open-mode=append".into(),
    ];
    let of_centre = [("account", &resources.account), ("partition", &resources.partition), ("mem", &resources.memory)];
    let given = of_centre.into_iter().filter_map(|(option, value)| Some((option, value.as_ref()?)));
    lines.extend(given.map(|(option, value)| format!("#SBATCH --{option}={value}")));
    lines.push(command_line(batch, NUMBER));
    lines.join("\n")
}

/// A time as Slurm writes it: days-hours:minutes:seconds.
fn duration(seconds: f64) -> String {
    let seconds = seconds as u64;
    let (days, hours, minutes) = (seconds / 86_400, seconds / 3_600 % 24, seconds / 60 % 60);
    format!("{days}-{hours:02}:{minutes:02}:{:02}", seconds % 60)
}

/// The tasks that have not ended.
pub(super) fn tasks(id: &str) -> Result<Tasks, SchedulerError> {
    let mut command = Command::new("squeue");
    command.args(["--noheader", "--array", "--format=%T|%r", "--jobs", id]);
    match answer("squeue", &mut command) {
        Ok(text) => Ok(counted(&text)),
        // A job that ended some minutes ago is forgotten.
        Err(SchedulerError::Refused { message, .. }) if message.contains("Invalid job id") => Ok(Tasks::default()),
        Err(error) => Err(error),
    }
}

/// The tasks in what `squeue` prints: a line for each, its state and a reason.
fn counted(text: &str) -> Tasks {
    let mut tasks = Tasks::default();
    for line in text.lines() {
        let (state, reason) = line.trim().split_once('|').unwrap_or((line.trim(), ""));
        match state {
            "RUNNING" | "COMPLETING" | "STAGE_OUT" | "SIGNALING" => tasks.running += 1,
            "PENDING" | "CONFIGURING" | "REQUEUED" | "REQUEUE_HOLD" | "REQUEUE_FED" | "RESIZING" | "RESV_DEL_HOLD"
            | "SPECIAL_EXIT" | "STOPPED" | "SUSPENDED" => {
                tasks.waiting += 1;
                let is_reason = !reason.is_empty() && reason != "None";
                tasks.reason = tasks.reason.or_else(|| is_reason.then(|| reason.to_owned()));
            }
            _ => {}
        }
    }
    tasks
}

#[cfg(test)]
mod tests {
    use super::super::Resources;
    use super::*;

    #[test]
    fn times_are_written_as_slurm_reads_them() {
        for (seconds, text) in [(60.0, "0-00:01:00"), (3000.0, "0-00:50:00"), (200_000.5, "2-07:33:20")] {
            assert_eq!(duration(seconds), text);
        }
    }

    #[test]
    fn tasks_are_counted_by_state() {
        let text = "RUNNING|None\nRUNNING|None\nPENDING|Resources\nPENDING|Priority\nCOMPLETED|None\nNODE_FAIL|x\n";
        let reason = Some("Resources".to_owned());
        assert_eq!(counted(text), Tasks { waiting: 2, running: 2, reason });
        assert_eq!(counted(""), Tasks::default());
    }

    #[test]
    fn a_script_holds_any_word() {
        let resources = Resources {
            account: Some("film-lab".into()),
            partition: None,
            time: 3000.0,
            cores: 16,
            nodes: 4,
            memory: None,
            container: vec![],
            program: None,
            options: vec![],
        };
        let command = ["a b/drop'tower", "--shard", "{task}/4", "--set", "title=\"$x\""].map(str::to_owned);
        let folder = std::path::Path::new("/tmp");
        let batch = Batch {
            name: "drop/1008\nx",
            tasks: 4,
            working_folder: folder,
            folder,
            resources: &resources,
            command: &command,
        };
        let text = script(&batch);
        assert!(text.contains("\n#SBATCH --job-name=droptower-drop-1008-x\n"), "{text}");
        assert!(text.contains("\n#SBATCH --account=film-lab\n") && !text.contains("partition"), "{text}");
        let last = r#"exec 'a b/drop'\''tower' --shard "$SLURM_ARRAY_TASK_ID"/4 --set 'title="$x"'"#;
        assert_eq!(text.lines().last(), Some(last));
    }
}
