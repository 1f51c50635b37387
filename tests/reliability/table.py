"""Writes the results of `tests/reliability/run` into docs/reliability.md."""

import sys
from datetime import date
from pathlib import Path

BEGIN, END = "<!-- results -->", "<!-- end of results -->"


def rows(path):
    """The rows of tables, without their heads."""
    lines = [line.strip().strip("|").split("|") for line in path.read_text().splitlines() if line.startswith("|")]
    cells = [[cell.strip() for cell in line] for line in lines]
    return [row for row in cells if not row[0].startswith("---") and row[0] not in ("fault", "target")]


def main():
    work, scenes, commit = Path(sys.argv[1]), sys.argv[2], sys.argv[3]
    out = [f"{date.today().isoformat()}, {commit}:", "", "| what | cases | result |", "|---|---:|---|"]
    out += [f"| fault: {name} | {cases} | {result} |" for name, cases, result, *_ in rows(work / "faults")]
    for name, cases, edges, peak, found in rows(work / "fuzz"):
        out.append(f"| fuzz: {name} | {cases} | {found} found, {edges} edges more than its seeds, {peak} MB at most |")
    for line in (work / "tests").read_text().splitlines():
        name, _, result = line.removeprefix("test ").partition(" ... ")
        cases = scenes if "properties" in name else ""
        out.append(f"| {name.removeprefix('verification::').replace('_', ' ')} | {cases} | {result} |")
    document = Path("docs/reliability.md")
    before, _, rest = document.read_text().partition(BEGIN)
    _, _, after = rest.partition(END)
    document.write_text(before + BEGIN + "\n" + "\n".join(out) + "\n" + END + after)


if __name__ == "__main__":
    main()
