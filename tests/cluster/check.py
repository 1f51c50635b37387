"""Runs the same sweep here, by Slurm and by HyperQueue, loses a task, a node and the program that waits on the way, and
compares the tables byte for byte.

    check.py DROPTOWER slurm|hyperqueue
"""

import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from slurm import Slurm, kill, wait

SCENARIO = """
extends = "{base}"
unset = ["reference", "post"]
specimen.mesh.size = "{mesh} mm"
loading.impact.duration = "60 ms"
[variation]
samples = {runs}
"impactor.mass" = ["10 kg", "11 kg", "12 kg"]
"impactor.friction" = {{ uniform = [0.1, 0.5] }}
specimen.material.thickness = {{ normal = {{ mean = "12 um", deviation = "0.6 um" }}, truncate = {{ low = "10 um" }} }}
"""

BASE = Path(__file__).resolve().parents[2] / "scenarios/drop/1008.toml"


class Sweep:
    """A sweep in a folder with a blank in its name."""

    def __init__(self, droptower, folder, runs, mesh):
        self.droptower = droptower
        self.folder = Path(folder) / "drop tests"
        self.folder.mkdir()
        self.runs = runs
        (self.folder / "drop.toml").write_text(SCENARIO.format(base=BASE, mesh=mesh, runs=runs))

    def command(self, name, *more):
        return [self.droptower, "sweep", "drop.toml", "--json", "--out", name, "--store", f"{name}.store", *more]

    def here(self):
        begin = time.monotonic()
        done = subprocess.run(self.command("here"), cwd=self.folder, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise SystemExit(done.stderr)
        print(f"here: {self.runs} runs in {time.monotonic() - begin:.1f} s")

    def start(self, scheduler, environment):
        events = open(self.folder / "events.jsonl", "ab")
        summary = open(self.folder / "summary.json", "wb")
        command = self.command("there", "--on", scheduler, "--cluster", "cluster.toml")
        return subprocess.Popen(command, cwd=self.folder, env=environment, stdout=summary, stderr=events)

    def events(self):
        lines = (self.folder / "events.jsonl").read_text().splitlines()
        return [json.loads(line) for line in lines if line.startswith("{")]

    def done(self):
        return max((event["done"] for event in self.events() if event["event"] == "progress"), default=0)

    def told(self):
        texts = [self.folder / "events.jsonl", *sorted((self.folder / "there.job").glob("*"))]
        return "\n".join(f"== {path.name}\n{path.read_text(errors='replace')[-4000:]}" for path in texts)

    def compare(self, submissions=1):
        here, there = ((self.folder / name / "table.csv").read_bytes() for name in ("here", "there"))
        if here != there:
            raise SystemExit("the tables differ")
        summary = json.loads((self.folder / "summary.json").read_text())
        if (summary["runs"], summary["failed"], summary["reused"]) != (self.runs, 0, 0):
            raise SystemExit(f"unexpected summary: {summary}")
        job = json.loads((self.folder / "there.job/job.json").read_text())
        if len(job["submissions"]) != submissions:
            raise SystemExit(f"submitted {len(job['submissions'])} times\n{self.told()}")
        print(f"the tables agree: {len(there)} bytes; submitted {len(job['submissions'])} times")

    def finish(self, process, begin):
        try:
            status = process.wait(timeout=900)
        except subprocess.TimeoutExpired:
            process.kill()
            raise SystemExit(f"the sweep does not end\n{self.told()}") from None
        if status != 0:
            raise SystemExit(f"exit status {status}\n{self.told()}")
        print(f"there: {time.monotonic() - begin:.1f} s")


def by_slurm(droptower, folder):
    sweep = Sweep(droptower, folder, runs=200, mesh=25)
    (sweep.folder / "cluster.toml").write_text('partition = "main"\ntime = "2 min"\ncores = 1\nnodes = 2\n')
    sweep.here()
    slurm = Slurm(Path(folder) / "slurm", cores=2).start()
    try:
        begin = time.monotonic()
        process = sweep.start("slurm", slurm.environment)
        wait(lambda: sweep.done() >= 30, "30 runs are done", sweep.told)
        kill(slurm.tasks()[0])
        print(f"a task was killed after {sweep.done()} runs")
        before = sweep.done()
        wait(lambda: sweep.done() >= before + 20, "20 more runs are done", sweep.told)
        slurm.kill_node()
        print(f"the node was lost after {sweep.done()} runs")
        process.send_signal(signal.SIGTERM)
        status = process.wait(timeout=60)
        if status != 1 or "goes on without this program" not in sweep.told():
            raise SystemExit(f"exit status {status}\n{sweep.told()}")
        print("the program that waits was ended")
        slurm.start_node()
        process = sweep.start("slurm", slurm.environment)
        before = sweep.done()
        wait(lambda: sweep.done() >= before + 20, "the node goes on", sweep.told)
        slurm.ask("scancel", "--state=RUNNING", "--user=root")
        slurm.ask("scancel", "--user=root")
        print(f"the whole job was cancelled after {sweep.done()} runs")
        sweep.finish(process, begin)
        sweep.compare(submissions=2)
    except BaseException:
        print(slurm.logs(), file=sys.stderr)
        raise
    finally:
        slurm.stop()


def by_hyperqueue(droptower, folder):
    sweep = Sweep(droptower, folder, runs=60, mesh=40)
    (sweep.folder / "cluster.toml").write_text('time = "10 min"\ncores = 1\nnodes = 2\n')
    sweep.here()
    here = Path(__file__).resolve().parent
    server_folder = Path(folder) / "server"
    server = subprocess.Popen([sys.executable, here / "hyperqueue_server.py", server_folder, "2"])
    try:
        wait(lambda: (server_folder / "ready").exists(), "the server starts")
        programs = Path(folder) / "bin"
        programs.mkdir()
        (programs / "hq").write_text(f"#!/bin/sh\nexec '{sys.executable}' '{here}/hq.py' \"$@\"\n")
        (programs / "hq").chmod(0o755)
        environment = {
            **os.environ,
            "PATH": f"{programs}:{os.environ['PATH']}",
            "HQ_SERVER_DIR": str(server_folder),
        }
        begin = time.monotonic()
        sweep.finish(sweep.start("hyperqueue", environment), begin)
        sweep.compare()
    finally:
        server.terminate()
        server.wait()


if __name__ == "__main__":
    program = str(Path(sys.argv[1]).resolve())
    with tempfile.TemporaryDirectory() as place:
        Path(place).chmod(0o755)
        {"slurm": by_slurm, "hyperqueue": by_hyperqueue}[sys.argv[2]](program, place)
