#!/usr/bin/env python3
"""pydyna reads every keyword of a deck of LS-DYNA.

    tests/solvers/deck.py target/release/droptower

Needs the Python package `ansys-dyna-core`. Exit status 1 where a keyword is not known or a field is not that of the test.
"""

import subprocess
import sys
import tempfile
from collections import Counter
from pathlib import Path

from ansys.dyna.core import Deck

# Keywords of the deck of test 1008, each as often as it must be there.
KEYWORDS = {"MatFabric": 1, "Part": 2, "PartInertia": 1, "MatRigid": 1, "SectionShell": 3, "ContactAutomaticNodesToSurface": 2}


def main():
    droptower = Path(sys.argv[1]).resolve()
    tower = Path(__file__).resolve().parents[2] / "scenarios" / "drop" / "1008.toml"
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "deck"
        subprocess.run([droptower, "export", "deck", tower, "--for", "ls-dyna", "-o", out, "--quiet"], check=True)
        deck = Deck()
        deck.loads((out / "film.k").read_text())
    names = Counter(type(keyword).__name__ for keyword in deck.all_keywords)
    body = next(keyword for keyword in deck.all_keywords if type(keyword).__name__ == "PartInertia")
    print(f"pydyna: {sum(names.values())} keywords, {len(deck.string_keywords)} that it does not know, mass {body.tm} t")
    is_known = not deck.string_keywords and all(names[name] == count for name, count in KEYWORDS.items())
    # A quarter of 10.72 kg at 4.16 m/s.
    is_test = abs(body.tm - 10.72e-3 / 4) < 1e-9 and abs(body.vtz + 4160.0) < 1e-3
    sys.exit(0 if is_known and is_test else 1)


if __name__ == "__main__":
    main()
