#!/usr/bin/env python3
"""Decks in other solvers: CalculiX runs one, and pydyna reads every keyword of one of LS-DYNA.

    tests/solvers/deck.py target/release/droptower

Needs `ccx` and the Python package `ansys-dyna-core`. The film is a rubber, coarse, so that CalculiX takes seconds; a body falls onto
it, and its motion is compared with that of droptower. Exit status 1 where they differ.
"""

import bisect
import csv
import os
import subprocess
import sys
import tempfile
from collections import Counter
from pathlib import Path

SCENARIO = """
title = "a ball on rubber"
[specimen]
shape = { rectangle = ["300 mm", "300 mm"] }
mesh = { element = "quad4", size = "25 mm" }
symmetry = "quarter"
[specimen.material]
name = "rubber"
density = "915 kg/m3"
thickness = "12 um"
[specimen.material.hyperelastic]
law = "neo-hookean"
mu = "3 MPa"
[layers]
count = 8
faces = ["0 mm"]
prestrain = { md = 0.1, td = 0.0 }
[frame]
hold = "all"
[impactor]
shape = { sphere = { radius = "120 mm" } }
mass = "20 g"
guide = "z"
friction = 0.0
[loading.impact]
velocity = "3 m/s"
gravity = "9.81 m/s2"
duration = "8 ms"
[output]
sample_rate = "10 kHz"
"""

# The time of the solver at which the test begins, s.
BEGIN = 0.0105

# Largest differences: of the displacement over the largest, of the change of velocity over the largest. The mesh is coarse, and
# contact of nodes there stands against that of elements here.
DISPLACEMENT = 0.02
VELOCITY = 0.1

# Keywords of the deck of test 1008, each as often as it must be there.
KEYWORDS = {"MatFabric": 1, "Part": 2, "PartInertia": 1, "MatRigid": 1, "SectionShell": 3, "ContactAutomaticNodesToSurface": 2}


def run(*command, **options):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, **options)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: status {done.returncode}\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    return done.stdout


def motion(path):
    """Displacement (mm) and velocity (mm/s) along z of the reference node over time (s)."""
    found, time, kind = {"displacements": [], "velocities": []}, None, None
    for line in path.read_text().splitlines():
        words = line.split()
        if "time" in words:
            time, kind = float(words[-1]), words[0]
        elif len(words) == 4 and kind in found:
            found[kind].append((time, float(words[3])))
    return found


def at(points, time):
    place = bisect.bisect([point[0] for point in points], time)
    (t0, y0), (t1, y1) = points[max(place - 1, 0)], points[min(place, len(points) - 1)]
    return y0 if t1 == t0 else y0 + (y1 - y0) * (time - t0) / (t1 - t0)


def calculix(droptower, folder):
    scenario = folder / "ball.toml"
    scenario.write_text(SCENARIO)
    run(droptower, "run", scenario, "--out", folder / "run", "--quiet")
    run(droptower, "deck", "write", scenario, "--for", "calculix", "-o", folder / "deck", "--quiet")
    run("ccx", "-i", "film", cwd=folder / "deck", env={**os.environ, "OMP_NUM_THREADS": "1"}, timeout=300)
    found = motion(folder / "deck" / "film.dat")
    with open(folder / "run" / "signals.csv", newline="") as file:
        rows = [{key: float(value) for key, value in row.items() if value} for row in csv.DictReader(file)]
    start = at(found["displacements"], BEGIN)
    first = rows[0]["velocity_m_s"]
    differences = [0.0, 0.0]
    largest = [max(abs(row["displacement_m"]) for row in rows), max(abs(row["velocity_m_s"] - first) for row in rows)]
    for row in rows:
        time = row["time_s"] + BEGIN
        displacement = 1e-3 * (at(found["displacements"], time) - start)
        velocity = 1e-3 * at(found["velocities"], time)
        differences[0] = max(differences[0], abs(displacement - row["displacement_m"]) / largest[0])
        differences[1] = max(differences[1], abs(velocity - row["velocity_m_s"]) / largest[1])
    print(
        f"CalculiX: displacement up to {1e3 * largest[0]:.2f} mm differs by {100 * differences[0]:.2f} %, "
        f"the change of velocity of {largest[1]:.3f} m/s by {100 * differences[1]:.1f} %"
    )
    return differences[0] <= DISPLACEMENT and differences[1] <= VELOCITY


def pydyna(droptower, folder):
    from ansys.dyna.core import Deck

    tower = Path(__file__).resolve().parents[2] / "scenarios" / "drop" / "1008.toml"
    run(droptower, "deck", "write", tower, "--for", "ls-dyna", "-o", folder / "dyna", "--quiet")
    deck = Deck()
    deck.loads((folder / "dyna" / "film.k").read_text())
    names = Counter(type(keyword).__name__ for keyword in deck.all_keywords)
    body = next(keyword for keyword in deck.all_keywords if type(keyword).__name__ == "PartInertia")
    print(f"pydyna: {sum(names.values())} keywords, {len(deck.string_keywords)} that it does not know, mass {body.tm} t")
    is_known = not deck.string_keywords and all(names[name] == count for name, count in KEYWORDS.items())
    # A quarter of 10.72 kg at 4.16 m/s.
    return is_known and abs(body.tm - 10.72e-3 / 4) < 1e-9 and abs(body.vtz + 4160.0) < 1e-3


def main():
    droptower = Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        good = [calculix(droptower, folder), pydyna(droptower, folder)]
    sys.exit(0 if all(good) else 1)


if __name__ == "__main__":
    main()
