"""Slurm on the loopback interface, for tests: munged, slurmctld and slurmd as processes of this one, in a folder of its own."""

import os
import shutil
import signal
import socket
import subprocess
import time
from pathlib import Path

CONFIGURATION = """
ClusterName=droptower
SlurmctldHost={host}(127.0.0.1)
SlurmUser=root
SlurmctldPort={controller}
SlurmdPort={daemon}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket,cred_expire=5
CredType=cred/munge
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ReturnToService=2
JobRequeue=1
SlurmdTimeout=10
KillWait=5
SchedulerParameters=batch_sched_delay=1,sched_interval=2
NodeName={host} NodeAddr=127.0.0.1 CPUs={cores} State=UNKNOWN
PartitionName=main Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Slurm:
    """One controller and one node."""

    def __init__(self, folder, cores):
        self.folder = Path(folder)
        for name in ("state", "spool"):
            (self.folder / name).mkdir(parents=True)
        self.folder.chmod(0o755)
        host = socket.gethostname().split(".")[0]
        text = CONFIGURATION.format(
            host=host, folder=self.folder, cores=cores, controller=free_port(), daemon=free_port()
        )
        (self.folder / "slurm.conf").write_text(text)
        self.environment = {**os.environ, "SLURM_CONF": str(self.folder / "slurm.conf")}
        self.processes = {}

    def start(self):
        key = self.folder / "munge.key"
        key.write_bytes(os.urandom(128))
        key.chmod(0o400)
        self._start("munged", "--foreground", "--force", f"--key-file={key}", f"--socket={self.folder}/munge.socket",
                    f"--pid-file={self.folder}/munge.pid", f"--log-file={self.folder}/munge.log",
                    f"--seed-file={self.folder}/munge.seed", "--num-threads=2")
        wait(lambda: (self.folder / "munge.socket").exists(), "munged makes its socket")
        self._start("slurmctld", "-D")
        self.start_node()
        return self

    def start_node(self):
        self._start("slurmd", "-D")
        wait(lambda: "idle" in self.ask("sinfo", "--noheader", "--format=%T"), "the node is idle", self.logs)

    def kill_node(self):
        """What a node does that loses its power: the daemon and everything that it started are gone at once."""
        daemon = self.processes.pop("slurmd")
        os.kill(daemon.pid, signal.SIGKILL)
        daemon.wait()
        for process in [*self._found(b"slurmstepd"), *self.tasks()]:
            kill(process)

    def tasks(self):
        """The processes of tasks of droptower."""
        return self._found(b"\0sweep\0", b"SLURM_ARRAY_TASK_ID=")

    def _found(self, word, variable=b""):
        """The processes of this Slurm with a word in their command and a variable."""
        found = []
        own = f"SLURM_CONF={self.folder}/slurm.conf\0".encode()
        for folder in Path("/proc").iterdir():
            if folder.name.isdigit():
                try:
                    variables = (folder / "environ").read_bytes()
                    command = (folder / "cmdline").read_bytes()
                except OSError:
                    continue
                if own in variables and variable in variables and word in command:
                    found.append(int(folder.name))
        return found

    def ask(self, *command):
        done = subprocess.run(command, env=self.environment, capture_output=True, text=True, check=False)
        return done.stdout

    def logs(self):
        texts = [f"== {path.name}\n{path.read_text(errors='replace')[-3000:]}" for path in self.folder.glob("*.log")]
        return "\n".join(texts)

    def stop(self):
        for process in reversed(list(self.processes.values())):
            process.terminate()
        for process in self.processes.values():
            try:
                process.wait(timeout=10)
            except subprocess.TimeoutExpired:
                process.kill()

    def _start(self, name, *arguments):
        program = shutil.which(name) or f"/usr/sbin/{name}"
        with open(self.folder / f"{name}.out.log", "ab") as log:
            self.processes[name] = subprocess.Popen(
                [program, *arguments], env=self.environment, stdout=log, stderr=log, stdin=subprocess.DEVNULL
            )


def kill(process):
    try:
        os.kill(process, signal.SIGKILL)
    except ProcessLookupError:
        pass


def wait(condition, what, explain=lambda: "", limit=900):
    """Waits until the condition holds; `limit` (s) only ends what hangs."""
    begin = time.monotonic()
    while not condition():
        if time.monotonic() - begin > limit:
            raise SystemExit(f"waited in vain: {what}\n{explain()}")
        time.sleep(0.2)
