"""Faults, and what droptower leaves and says after them; called by `tests/faults/run`."""

import argparse
import filecmp
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

ROOT = Path.cwd()
DROP = ROOT / "scenarios/drop/1008.toml"

# Exit statuses that docs/results.md promises: done, output failed, bad input, numerical failure.
DOCUMENTED = {0, 1, 2, 3}

# A run of some tenths of a second with everything that a run leaves.
SMALL = f"""extends = {str(DROP)!r}
[specimen.mesh]
size = "40 mm"
[loading.impact]
duration = "20 ms"
""".replace("'", '"')

SWEEP = SMALL + '[variation]\n"impactor.mass" = [9, 10, 11, 12, 13, 14]\n'

SEARCH = """let best = minimize("nelder-mead", [2.0, 1.0], #{ names: ["a", "b"] }, |x| {
    let sum = 0.0;
    for i in 0..2000 { sum += (x[0] - 0.3) ** 2 + (x[1] + 0.2) ** 2; }
    sum
});
measure("a", best.x[0]);
"""

# Files that are the same bits whenever they are computed.
SAME = ["signals.csv", "energies.csv"]

# Another user, who owns nothing here.
NOBODY = 65534


class Wrong(Exception):
    """What is not as promised."""


class Skipped(Exception):
    """Why a fault cannot be made here."""


class Desk:
    """A folder of its own for one fault, and the program."""

    def __init__(self, program, folder):
        self.program, self.folder, self.cases = program, Path(folder), 0

    def write(self, name, text):
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        return path

    def start(self, *arguments, **options):
        options.setdefault("cwd", self.folder)
        options.setdefault("stdout", subprocess.PIPE)
        options.setdefault("stderr", subprocess.PIPE)
        options.setdefault("stdin", subprocess.DEVNULL)
        return subprocess.Popen([self.program, *map(str, arguments)], **options)

    def run(self, *arguments, expected=DOCUMENTED, limit=120, **options):
        """Runs a command to its end; its status and what it said."""
        self.cases += 1
        process = self.start(*arguments, **options)
        try:
            out, err = process.communicate(timeout=limit)
        except subprocess.TimeoutExpired:
            process.kill()
            raise Wrong(f"{arguments} took more than {limit} s") from None
        said = (err or b"").decode(errors="replace")
        expected = {expected} if isinstance(expected, int) else expected
        if process.returncode not in expected:
            raise Wrong(f"{arguments} ended with {process.returncode}, not {sorted(expected)}:\n{said}")
        if "panicked" in said:
            raise Wrong(f"{arguments} panicked:\n{said}")
        if process.returncode in (1, 2) and said and not any(line.startswith("error: ") for line in said.splitlines()):
            raise Wrong(f"{arguments} failed without an error:\n{said}")
        return process.returncode, (out or b"").decode(errors="replace"), said

    def killed(self, seconds, *arguments):
        """Starts a command and kills it after so many seconds; whether it was still there."""
        self.cases += 1
        process = self.start(*arguments, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        time.sleep(seconds)
        process.kill()
        return process.wait() == -signal.SIGKILL

    def hidden(self):
        """What drafts are left."""
        return sorted(str(path.relative_to(self.folder)) for path in self.folder.rglob(".droptower-*"))


def check(condition, message):
    if not condition:
        raise Wrong(message)


def same(one, other, names=SAME):
    """Whether both folders hold the same bits."""
    return all((one / name).exists() and filecmp.cmp(one / name, other / name, shallow=False) for name in names)


def whole_run(folder):
    """A folder of results is whole or not there."""
    names = ["summary.json", "signals.csv", "energies.csv", "scenario.toml", "report.html"]
    missing = [name for name in names if not (folder / name).is_file()] if folder.exists() else []
    check(not missing, f"{folder} lacks {missing}")
    return folder.exists()


def duration(desk, *arguments):
    begin = time.monotonic()
    desk.run(*arguments, expected=0)
    return time.monotonic() - begin


def no_leftovers(desk, *arguments):
    """The next command, a second later, removes what killed ones left."""
    time.sleep(1.1)
    desk.run(*arguments, expected=0)
    check(not desk.hidden(), f"left after the next command: {desk.hidden()}")


# Kills


def kill_run(desk, kills):
    """SIGKILL of a run that replaces results: the earlier results or the new ones, whole."""
    desk.write("a.toml", SMALL)
    taken = duration(desk, "run", "a.toml", "--out", "reference", "--quiet")
    desk.run("run", "a.toml", "--out", "out", "--quiet", expected=0)
    for _ in range(kills):
        desk.killed(random.uniform(0.3, 1.05) * taken, "run", "a.toml", "--out", "out", "--quiet")
        # Between two renames the earlier results are beside; the next run brings them back first.
        if (desk.folder / "out").exists():
            check(whole_run(desk.folder / "out") and same(desk.folder / "reference", desk.folder / "out"), "half a run")
    no_leftovers(desk, "run", "a.toml", "--out", "out", "--quiet")
    check(same(desk.folder / "reference", desk.folder / "out"), "other bits after kills")


def kill_checkpoints(desk, kills):
    """SIGKILL of a run with checkpoints: resumed to the same bits."""
    desk.write("a.toml", SMALL)
    every = ["--checkpoint-every", "2 ms", "--quiet"]
    taken = duration(desk, "run", "a.toml", "--out", "reference", *every)
    for number in range(kills):
        out = f"out-{number}"
        desk.killed(random.uniform(0.2, 0.95) * taken, "run", "a.toml", "--out", out, *every)
        # Killed before its first checkpoint, it left none to resume from.
        begun = any((desk.folder / f"{out}.checkpoint").glob("*.state"))
        desk.run("run", "a.toml", "--out", out, *every, *(["--resume"] if begun else []), expected=0)
        check(same(desk.folder / "reference", desk.folder / out), f"other bits after kill {number}")
        check(not (desk.folder / f"{out}.checkpoint").exists(), "checkpoints of a complete run are left")


def kill_study(desk, kills):
    """SIGKILL of a search: continued from its history to the same best point."""
    desk.write("s.rhai", SEARCH)
    taken = duration(desk, "script", "s.rhai", "--out", "reference", "--quiet")
    expected = (desk.folder / "reference/summary.json").read_text()
    for number in range(kills):
        out = f"out-{number}"
        desk.killed(random.uniform(0.2, 0.95) * taken, "script", "s.rhai", "--out", out, "--quiet")
        desk.run("script", "s.rhai", "--out", out, "--quiet", "--force", expected=0)
        found = (desk.folder / out / "summary.json").read_text()
        best = [line for line in expected.splitlines() if '"a"' in line]
        check(best and best[0] in found, f"another best point after kill {number}")


def kill_sweep(desk, kills):
    """SIGKILL of one of two processes of a sweep: the other takes its runs at once, the table is the same."""
    desk.write("a.toml", SWEEP)
    taken = duration(desk, "sweep", "a.toml", "--out", "reference", "--store", "whole", "--quiet")
    for number in range(kills):
        arguments = ["sweep", "a.toml", "--store", f"store-{number}", "--quiet", "--out"]
        one, other = desk.start(*arguments, f"one-{number}"), desk.start(*arguments, f"other-{number}")
        time.sleep(random.uniform(0.1, 0.6))
        one.kill()
        one.wait()
        begin = time.monotonic()
        desk.cases += 1
        check(other.wait(timeout=60) == 0, other.stderr.read().decode())
        # Its claims would otherwise hold for 15 s, which shows where the whole takes much less.
        waited = time.monotonic() - begin > 3 * taken + 8
        check(taken > 2 or not waited, "claims of a killed process were waited for")
        check(same(desk.folder / "reference", desk.folder / f"other-{number}", ["table.csv"]), "another table of runs")


def kill_bless(desk, kills):
    """SIGKILL of `test --bless`: every golden file is that of before or the new one."""
    scenario = desk.write("a.toml", SMALL)
    desk.run("new", "test", "cases/one", "--scenario", scenario, "--quiet", expected=0)
    arguments = ["test", "cases", "--bless", "--quiet"]
    status, _, said = desk.run(*arguments, expected=DOCUMENTED)
    if status != 0:
        raise Wrong(said)
    golden = {path: path.read_bytes() for path in (desk.folder / "cases").rglob("*") if path.is_file()}
    for _ in range(kills):
        desk.killed(random.uniform(0.05, 0.6), *arguments)
        for path, content in golden.items():
            check(path.read_bytes() == content, f"{path} is neither the earlier nor the new one")
    no_leftovers(desk, *arguments)


def kill_conversion(desk, kills):
    """SIGKILL of conversions: no file, or a whole one."""
    rows = "".join(f"{i * 1e-4:.4f},{(i * 7919) % 1000}\n" for i in range(200_000))
    desk.write("in.csv", "time_s,force_N\n" + rows)
    arguments = ["signal", "convert", "in.csv", "--quiet", "--force", "-o", "out.csv"]
    taken = duration(desk, *arguments)
    out = desk.folder / "out.csv"
    whole = out.read_bytes()
    for _ in range(kills):
        desk.killed(random.uniform(0.2, 1.0) * taken, *arguments)
        check(not out.exists() or out.read_bytes() == whole, f"half of {out}")
        out.unlink(missing_ok=True)
    no_leftovers(desk, *arguments)


# Disks and folders


def full_disk(desk, _):
    """A full disk: one error with status 1, no half file; once there is room, the same command succeeds."""
    place = desk.folder / "disk"
    place.mkdir()
    desk.write("a.toml", SMALL)
    for kilobytes in [1, 64, 256, 700]:
        made = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={kilobytes}k", "tmpfs", place], capture_output=True)
        if made.returncode != 0:
            raise Skipped("no right to mount")
        try:
            for arguments in (
                ["run", "a.toml", "--out", "disk/out", "--quiet"],
                ["run", "a.toml", "--out", "disk/out", "--quiet", "--checkpoint-every", "2 ms"],
                ["new", "drop", "disk/new.toml"],
                [
                    "sweep",
                    "a.toml",
                    "--set",
                    'variation."impactor.mass"=[9, 10]',
                    "--out",
                    "disk/swept",
                    "--store",
                    "disk/store",
                ],
            ):
                status, _, said = desk.run(*arguments)
                check(status in (0, 1), f"{arguments} on a full disk: {status}\n{said}")
                if status == 1:
                    # A schema is replaced the next time.
                    kept = (".checkpoint", "store", ".schema.json", ".progress")
                    left = [path for path in place.iterdir() if not path.name.endswith(kept)]
                    check(not left, f"{arguments} left {left}")
                subprocess.run(["find", place, "-mindepth", "1", "-delete"], check=True)
            if kilobytes == 1:
                desk.write("disk/fill", "x" * 4000)
                desk.run("new", "drop", "disk/new.toml", expected=1)
                (place / "fill").unlink()
                subprocess.run(["mount", "-o", "remount,size=1m", place], check=True)
                desk.run("new", "drop", "disk/new.toml", expected=0)
        finally:
            subprocess.run(["umount", place], check=True)


def another_user(desk, _):
    """Read-only and forbidden folders: an error that names the folder, earlier results untouched."""
    if os.getuid() != 0:
        raise Skipped("no right to be another user")
    desk.folder.chmod(0o755)
    for parent in desk.folder.parents:
        if not parent.stat().st_mode & 0o005:
            raise Skipped(f"{parent} is closed to others")
    desk.write("a.toml", SMALL)
    desk.run("run", "a.toml", "--out", "out", "--quiet", expected=0)
    before = (desk.folder / "out/signals.csv").read_bytes()
    secret = desk.write("secret.toml", SMALL)
    secret.chmod(0)
    (desk.folder / "closed").mkdir()
    (desk.folder / "closed").chmod(0)
    other = {"user": NOBODY, "group": NOBODY, "extra_groups": []}
    # The program may lie where only its owner may look.
    program = desk.folder / "program"
    shutil.copy(desk.program, program)
    desk.program = program
    for arguments, expected, words in (
        (["run", "a.toml", "--out", "out", "--quiet"], 1, "cannot write"),
        (["run", "a.toml", "--out", "closed/out", "--quiet"], {1, 2}, "closed"),
        (["check", "secret.toml"], 2, "secret.toml"),
        (["run", "a.toml", "--quiet"], {1, 2}, "runs"),
        (["sweep", "a.toml", "--set", 'variation."impactor.mass"=[9]'], {1, 2}, "runs"),
        (["signal", "convert", "out/signals.csv", "-o", "b.csv"], 1, "b.csv"),
        (["new", "drop", "b.toml"], 1, "droptower.schema.json"),
    ):
        _, _, said = desk.run(*arguments, expected=expected, **other)
        check(words in said and "denied" in said.lower(), f"{arguments}: {said}")
    check((desk.folder / "out/signals.csv").read_bytes() == before, "results of another user changed")


def two_writers(desk, _):
    """Two processes on one results folder: it holds the whole results of one."""
    desk.write("a.toml", SMALL)
    desk.run("run", "a.toml", "--out", "reference", "--quiet", expected=0)
    for _ in range(3):
        processes = [desk.start("run", "a.toml", "--out", "out", "--quiet") for _ in range(3)]
        desk.cases += len(processes)
        statuses = [process.wait(timeout=120) for process in processes]
        check(set(statuses) <= {0, 1}, f"statuses {statuses}")
        check(whole_run(desk.folder / "out") and same(desk.folder / "reference", desk.folder / "out"), "half a run")
    no_leftovers(desk, "run", "a.toml", "--out", "out", "--quiet")


# Inputs and streams


def changing_inputs(desk, _):
    """Inputs that vanish, grow and are cut while they are read: a result or a mistake."""
    rows = "".join(f"{i * 1e-4:.4f},{i % 100}\n" for i in range(30_000))
    whole = "time_s,force_N\n" + rows
    path, ends = desk.write("in.csv", whole), threading.Event()
    scenario, small = desk.write("a.toml", SMALL), SMALL

    def change():
        turn = 0
        while not ends.is_set():
            turn += 1
            for file, text in ((path, whole), (scenario, small)):
                if turn % 3 == 0:
                    file.unlink(missing_ok=True)
                elif turn % 3 == 1:
                    file.write_text(text[: random.randrange(len(text))])
                else:
                    file.write_text(text)
            time.sleep(0.001)

    changer = threading.Thread(target=change)
    changer.start()
    try:
        for _ in range(15):
            desk.run("signal", "info", "in.csv")
            desk.run("check", "a.toml")
            desk.run("run", "a.toml", "--out", "out", "--quiet", "--set", 'loading.impact.duration="2 ms"')
            whole_run(desk.folder / "out")
    finally:
        ends.set()
        changer.join()


def streams(desk, _):
    """Broken pipes and closed standard streams: no panic, and results that are whole."""
    desk.write("a.toml", SMALL)
    for closed in (["0"], ["1"], ["2"], ["0", "1", "2"]):
        close = " ".join(f"{number}>&-" for number in closed)
        line = f'exec "{desk.program}" run a.toml --out out --force {close}'
        desk.cases += 1
        done = subprocess.run(["bash", "-c", line], cwd=desk.folder, capture_output=True, timeout=60)
        check(done.returncode in (0, 1), f"{close}: {done.returncode} {done.stderr}")
        check(whole_run(desk.folder / "out"), f"{close}: no results")
        shutil.rmtree(desk.folder / "out")
    for command in ("explain", "explain specimen", "schema", "list", "man"):
        desk.cases += 1
        line = f'set -o pipefail; "{desk.program}" {command} 2>said | head -c 10 > /dev/null'
        done = subprocess.run(["bash", "-c", line], cwd=desk.folder, timeout=60)
        said = (desk.folder / "said").read_text()
        check("panicked" not in said and done.returncode in (0, 1, 2), f"{command} | head: {done.returncode} {said}")
    if Path("/dev/full").exists():
        with open("/dev/full", "w") as full:
            _, _, said = desk.run("explain", stdout=full, expected=1)
            check("cannot print" in said, said)


# Clock and limits

CLOCK = """
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdlib.h>
#include <time.h>
int clock_gettime(clockid_t id, struct timespec *at) {
    int (*real)(clockid_t, struct timespec *) = dlsym(RTLD_NEXT, "clock_gettime");
    int done = real(id, at);
    if (id == CLOCK_REALTIME) at->tv_sec += atoll(getenv("SHIFT"));
    return done;
}
"""


def clock(desk, _):
    """A clock before 1970 is an error before anything is computed; one that is set back changes no bits."""
    compiler = shutil.which("cc") or shutil.which("gcc")
    if not compiler or sys.platform != "linux":
        raise Skipped("no C compiler")
    desk.write("clock.c", CLOCK)
    subprocess.run(
        [compiler, "-shared", "-fPIC", "-O1", "-o", desk.folder / "clock.so", desk.folder / "clock.c", "-ldl"],
        check=True,
    )
    desk.write("a.toml", SMALL)
    desk.run("run", "a.toml", "--out", "reference", "--quiet", expected=0)
    now = int(time.time())
    for shift, expected in ((-now - 86_400, 1), (-3600, 0), (-now + 10, 0), (10**10, 0)):
        env = {**os.environ, "LD_PRELOAD": str(desk.folder / "clock.so"), "SHIFT": str(shift)}
        _, _, said = desk.run("run", "a.toml", "--out", "out", "--quiet", expected=expected, env=env)
        if expected == 1:
            check("clock" in said and not (desk.folder / "out").exists(), said)
        else:
            check(same(desk.folder / "reference", desk.folder / "out"), f"other bits with the clock {shift} s away")
            shutil.rmtree(desk.folder / "out")
        desk.run(
            "sweep",
            "a.toml",
            "--set",
            'variation."impactor.mass"=[9, 10]',
            "--out",
            f"swept{shift}",
            env=env,
            expected={expected},
        )


def limits(desk, _):
    """Limits of the sizes of files, of memory and of open files: an error with status 1, nothing half."""
    desk.write("a.toml", SMALL)
    desk.run("run", "a.toml", "--out", "kept", "--quiet", expected=0)
    before = (desk.folder / "kept/signals.csv").read_bytes()

    def under(limit, value):
        def set_limit():
            resource.setrlimit(limit, (value, value))

        return {"preexec_fn": set_limit}

    some = [(resource.RLIMIT_FSIZE, kilobytes << 10) for kilobytes in (0, 4, 64, 300)]
    some += [(resource.RLIMIT_AS, megabytes << 20) for megabytes in (200, 350, 480, 520, 560, 640)]
    some += [(resource.RLIMIT_NOFILE, count) for count in (4, 6, 10, 20)]
    for limit, value in some:
        for arguments in (["run", "a.toml", "--out", "kept", "--quiet"], ["signal", "info", "kept/signals.csv"]):
            status, _, said = desk.run(*arguments, **under(limit, value))
            check(status in (0, 1, 2), f"limit {limit} of {value}: {status} {said}")
            check(status == 0 or said, f"limit {limit} of {value}: nothing was said")
            check((desk.folder / "kept/signals.csv").read_bytes() == before, "earlier results changed")
    no_leftovers(desk, "run", "a.toml", "--out", "kept", "--quiet")


# Growth


def cost(desk, *arguments, expected=DOCUMENTED):
    """CPU seconds (least of three, which others on the machine disturb least) and the largest memory in MB of a command."""
    times, memory = [], 0
    for _ in range(3):
        desk.cases += 1
        process = desk.start(*arguments, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        check(process.returncode in expected, f"{arguments}: {process.returncode}")
        times.append(used.ru_utime + used.ru_stime)
        memory = max(memory, used.ru_maxrss / 1024)
    return min(times), memory


def growth(desk, _):
    """Twice as many keys, mistakes, layers, impactors, columns, runs: at most 2.5 times the time; memory of a batch is flat."""
    mistakes = lambda n: desk.write(
        f"mistakes{n}.toml", SMALL + "[nosuch]\n" + "".join(f"k{i} = {i}\n" for i in range(n))
    )
    lines = lambda n: desk.write(f"lines{n}.toml", "= 1\n" * n)
    empty = lambda n: desk.write(f"empty{n}.toml", "[specimen]\n" + "[[impactor]]\n" * n)
    keys = lambda n: desk.write(f"keys{n}.toml", SMALL + '[variation]\n"impactor.mass" = [' + "9, " * n + "9]\n")
    impactors = lambda n: desk.write(
        f"impactors{n}.toml",
        f'extends = "{DROP}"\n[specimen.mesh]\nsize = "40 mm"\n[loading.impact]\nduration = "1 ms"\n'
        + "".join(
            f'[[impactor]]\nname = "b{i}"\nmass = 0.1\nshape.sphere.radius = "2 mm"\nposition = ["{5 * (i % 40) - 100} mm", "{5 * (i // 40) - 100} mm"]\n'
            for i in range(n)
        ),
    )
    columns = lambda n: desk.write(
        f"columns{n}.csv",
        ",".join(["time_s", *(f"c{i}_N" for i in range(n))]) + "\n" + ("1," * n + "1\n") + ("2," * n + "2\n"),
    )
    for name, n, make, arguments in (
        ("mistakes", 10_000, mistakes, ["check"]),
        ("lines with mistakes", 30_000, lines, ["check"]),
        ("empty impactors", 8_000, empty, ["check"]),
        ("values of a key", 20_000, keys, ["check"]),
        ("impactors", 100, impactors, ["check"]),
        ("columns", 40_000, columns, ["signal", "info"]),
    ):

        def both():
            return [cost(desk, *arguments, make(count)) for count in (n, 2 * n)]

        (once, small), (twice, large) = both()
        if twice > 2.5 * once:
            (once, small), (twice, large) = both()
        # What takes no time shows the scatter of the start alone.
        check(twice < max(2.5 * once, 0.2), f"{name}: {n} take {once:.2f} s, {2 * n} {twice:.2f} s")
        check(large < 500, f"{name}: {2 * n} take {large:.0f} MB, {n} {small:.0f} MB")
    run = ["run", "--quiet", "--force", "--out", "batch"]
    memory = []
    for n in (20, 80):
        for i in range(n):
            desk.write(f"batch{n}/r{i}.toml", SMALL.replace("20 ms", "2 ms"))
        memory.append(cost(desk, *run, f"batch{n}/*.toml", expected={0})[1])
    check(memory[1] < memory[0] + 20, f"20 runs take {memory[0]:.0f} MB, 80 runs {memory[1]:.0f} MB")


FAULTS = {
    "kill-run": kill_run,
    "kill-checkpoints": kill_checkpoints,
    "kill-study": kill_study,
    "kill-sweep": kill_sweep,
    "kill-bless": kill_bless,
    "kill-conversion": kill_conversion,
    "full-disk": full_disk,
    "another-user": another_user,
    "two-writers": two_writers,
    "changing-inputs": changing_inputs,
    "streams": streams,
    "clock": clock,
    "limits": limits,
    "growth": growth,
}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program", nargs="?", default="target/release/droptower")
    parser.add_argument("--full", action="store_true", help="200 kills each")
    parser.add_argument("--only", action="append", choices=FAULTS, help="this fault")
    parser.add_argument("--seed", type=int, default=int(time.time()))
    given = parser.parse_args()
    random.seed(given.seed)
    program, wrong = Path(given.program).resolve(), 0
    print(f"seed {given.seed}\n\n| fault | cases | result | s |\n|---|---|---|---|", flush=True)
    for name in given.only or FAULTS:
        begin = time.monotonic()
        with tempfile.TemporaryDirectory() as folder:
            desk, result = Desk(program, folder), "as promised"
            try:
                FAULTS[name](desk, 200 if given.full else 4)
            except Skipped as why:
                result = f"skipped: {why}"
            except Wrong as why:
                wrong, result = wrong + 1, f"**wrong**: {why}"
            except subprocess.TimeoutExpired as why:
                wrong, result = wrong + 1, f"**wrong**: {why}"
        print(f"| {name} | {desk.cases} | {result} | {time.monotonic() - begin:.0f} |", flush=True)
    sys.exit(wrong > 0)


if __name__ == "__main__":
    main()
