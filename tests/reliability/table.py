"""Writes the results of `tests/reliability/run` into docs/reliability.md: a row for each check, with its command, date and commit."""

import sys
from datetime import date
from pathlib import Path

BEGIN, END = "<!-- results -->", "<!-- end of results -->"
HEAD = "| command | date, commit | cases | result |\n|---|---|---|---|\n"


def rows(path):
    """The rows of tables, without their heads."""
    lines = [line.strip().strip("|").split("|") for line in path.read_text().splitlines() if line.startswith("|")]
    cells = [[cell.strip() for cell in line] for line in lines]
    return [row for row in cells if not row[0].startswith("---") and row[0] not in ("fault", "target")]


def result(good, bad):
    """`good`, or the names of what was not."""
    return good if not bad else "**not**: " + ", ".join(bad)


def main():
    work, scenes, seconds, flags, commit = Path(sys.argv[1]), *sys.argv[2:6]
    when = f"{date.today().isoformat()}, {commit}"
    faults, fuzz = rows(work / "faults"), rows(work / "fuzz")
    cases = ", ".join(f"{name} {count}" for name, count, *_ in faults)
    wrong = [name if "wrong" in found else f"{name} (skipped)" for name, _, found, *_ in faults if found != "as promised"]
    out = f"| `{f'tests/faults/run {flags}'.strip()}` | {when} | {cases} | {result('as promised', wrong)} |\n"
    cases = ", ".join(f"{name} {count}" for name, count, *_ in fuzz)
    found = [name for name, *_, found in fuzz if found != "nothing"]
    peak = max((int(row[3]) for row in fuzz), default=0)
    out += f"| `tests/fuzz/run {seconds}` | {when} | {cases} | {result('nothing found', found)}; {peak} MB at most |\n"
    tests = [line.removeprefix("test ").partition(" ... ") for line in (work / "tests").read_text().splitlines()]
    failed = [name for name, _, ended in tests if ended != "ok"]
    for group in ("links", "sick", "verification::properties"):
        count = sum(name.startswith(group) for name, *_ in tests)
        drawn = f", {scenes} scenes each" if "properties" in group else ""
        ended = result("ok", [name for name in failed if name.startswith(group)])
        out += f"| `cargo test --release --workspace --test it -- {group}` | {when} | {count} tests{drawn} | {ended} |\n"
    document = Path("docs/reliability.md")
    before, _, rest = document.read_text().partition(BEGIN)
    _, _, after = rest.partition(END)
    document.write_text(before + BEGIN + "\n" + HEAD + out + END + after)


if __name__ == "__main__":
    main()
