"""Compares recordings as droptower reads them with what other programs' readers find in the same files.

    python tests/formats/recordings.py DROPTOWER       # compares files that it makes
    python tests/formats/recordings.py --keep FOLDER   # makes the files of tests/it/formats.rs, and what is expected of them
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import make_tdms
import numpy
import pandas
import read

# Makers of files, and their readers, by format.
FORMATS = {"tdms": (make_tdms.make, read.of_tdms)}
# Of numbers that scales compute in another order, or by iteration.
TOLERANCE = 1e-9


def timed(found):
    return {name: channel for name, channel in found.items() if channel[0] is not None}


def differs(found, expected):
    close = numpy.allclose(found, expected, rtol=TOLERANCE, atol=TOLERANCE * numpy.max(numpy.abs(expected), initial=0))
    return len(found) != len(expected) or not close


def compare(droptower, path, expected):
    """Every channel over its time, one call each."""
    listed = subprocess.run([droptower, "signal", "info", "--json", path], capture_output=True, text=True, check=True)
    channels = json.loads(listed.stdout)[0]["channels"]
    labels = {channel["label"] for channel in channels}
    assert labels == set(timed(expected)), f"{path}: {labels ^ set(timed(expected))}"
    for name, (time, values) in timed(expected).items():
        out = path.with_suffix(".csv")
        command = [droptower, "signal", "convert", "--quiet", "--force", path, "--column", name, "-o", out]
        subprocess.run(command, check=True)
        table = pandas.read_csv(out, comment="#")
        assert not differs(table.iloc[:, 0].to_numpy(), time), f"{path}: times of {name}"
        assert not differs(table.iloc[:, 1].to_numpy(), values), f"{path}: {name}"
    return len(expected)


def keep(folder):
    for kind, (make, reader) in FORMATS.items():
        expected = {}
        for path in make(folder / kind):
            channels = timed(reader(path))
            expected[path.name] = {
                name: {"time": list(time), "values": [float(value) for value in values]}
                for name, (time, values) in channels.items()
            }
        (folder / kind / "expected.json").write_text(json.dumps(expected, indent=0) + "\n")


def main():
    if sys.argv[1] == "--keep":
        keep(Path(sys.argv[2]))
        return
    for kind, (make, reader) in FORMATS.items():
        with tempfile.TemporaryDirectory() as folder:
            paths = make(folder)
            channels = sum(compare(sys.argv[1], path, reader(path)) for path in paths)
            print(f"  {kind}: {len(paths)} files, {channels} channels")


if __name__ == "__main__":
    main()
