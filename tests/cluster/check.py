"""Computes the same sweep by one process and by the array job of `droptower new slurm`, of which a task and then a node are lost,
and compares the tables byte for byte.

    check.py DROPTOWER
"""

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from slurm import Slurm, kill, wait

RUNS = 200
SCENARIO = """
extends = "{base}"
unset = ["reference", "post"]
specimen.mesh.size = "25 mm"
loading.impact.duration = "60 ms"
[variation]
"impactor.mass" = ["10 kg", "11 kg", "12 kg"]
"impactor.friction" = {{ uniform = [0.1, 0.5] }}
specimen.material.thickness = {{ normal = {{ mean = "12 um", deviation = "0.6 um" }}, truncate = {{ low = "10 um" }} }}
"""
NAME = "it's 12 um.toml"
BASE = Path(__file__).resolve().parents[2] / "scenarios/drop/1008.toml"


class Sweep:
    """A sweep in a folder, and of a scenario, with blanks in their names."""

    def __init__(self, droptower, folder):
        self.folder = Path(folder) / "drop tests"
        self.folder.mkdir()
        (self.folder / NAME).write_text(SCENARIO.format(base=BASE))
        programs = Path(folder) / "bin"
        programs.mkdir()
        (programs / "droptower").symlink_to(droptower)
        self.environment = {**os.environ, "PATH": f"{programs}:{os.environ['PATH']}"}

    def done(self, *command):
        """What the command prints."""
        done = subprocess.run(command, cwd=self.folder, env=self.environment, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise SystemExit(f"{command}: exit status {done.returncode}\n{done.stdout}{done.stderr}\n{self.logs()}")
        return done.stdout

    def records(self):
        """How many runs have a record."""
        return sum(1 for _ in self.folder.glob("runs/.evaluations/*/records/*/*.record"))

    def logs(self):
        return "\n".join(f"== {path.name}\n{path.read_text(errors='replace')[-4000:]}" for path in self.folder.glob("*.out"))


def main(droptower, folder):
    sweep = Sweep(droptower, folder)
    begin = time.monotonic()
    sweep.done("droptower", "sweep", NAME, "-n", str(RUNS), "--out", "here", "--store", "here.store")
    print(f"one process: {RUNS} runs in {time.monotonic() - begin:.1f} s")
    sweep.done("droptower", "new", "slurm", "sweep.sbatch", "--scenario", NAME, "-n", str(RUNS), "--tasks", "2")
    script = sweep.folder / "sweep.sbatch"
    # What a user does: the cores of this node, a partition of this cluster.
    text = script.read_text().replace("--cpus-per-task=16", "--cpus-per-task=1")
    script.write_text(text.replace("##SBATCH --partition=standard", "#SBATCH --partition=main"))
    slurm = Slurm(Path(folder) / "slurm", cores=2).start()
    sweep.environment = {**slurm.environment, "PATH": sweep.environment["PATH"]}

    def share():
        return sweep.records() / RUNS

    def told():
        return f"{sweep.logs()}\n{slurm.logs()}"

    try:
        begin = time.monotonic()
        print(sweep.done("sbatch", "sweep.sbatch").strip())
        wait(lambda: share() > 0.15 and len(slurm.tasks()) == 2, "15 % of the runs are done", told)
        kill(slurm.tasks()[0])
        print(f"a task was killed after {share():.0%} of the runs")
        wait(lambda: share() > 0.3, "30 % of the runs are done", told)
        slurm.kill_node()
        print(f"the node was lost after {share():.0%} of the runs")
        early = subprocess.run(["sh", "sweep.sbatch"], cwd=sweep.folder, env=sweep.environment, capture_output=True, text=True, check=False)
        if early.returncode != 1 or "runs are not done" not in early.stderr:
            raise SystemExit(f"merged too early: exit status {early.returncode}\n{early.stderr}")
        print(next(line for line in early.stderr.splitlines() if "runs are not done" in line))
        slurm.start_node()
        wait(lambda: slurm.tasks(), "the task of the lost node is started again", told)
        print("the task of the lost node was started again")
        wait(lambda: not slurm.ask("squeue", "--noheader").strip(), "all tasks end", told)
        print(sweep.done("sh", "sweep.sbatch").splitlines()[0])
        print(f"by Slurm: {time.monotonic() - begin:.1f} s")
    except BaseException:
        print(slurm.logs(), file=sys.stderr)
        raise
    finally:
        slurm.stop()
    here, there = ((sweep.folder / name / "table.csv").read_bytes() for name in ("here", f"runs/{NAME[:-5]}.sweep"))
    if here != there:
        raise SystemExit("the tables differ")
    print(f"the tables agree: {len(there)} bytes")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as place:
        Path(place).chmod(0o755)
        main(str(Path(sys.argv[1]).resolve()), place)
