"""Compares recordings as droptower reads them with what other programs' readers find in the same files.

python tests/formats/recordings.py DROPTOWER       # compares files that it makes
python tests/formats/recordings.py --keep FOLDER   # makes the files of tests/it/formats, and what is expected
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import make_arrays
import make_machines
import make_sheets
import make_t01
import make_tdms
import numpy
import pandas
import read

# Makers of files, and their readers, by format.
FORMATS = {
    "tdms": (make_tdms.make, read.of_tdms),
    "xlsx": (make_sheets.make, read.of_sheets),
    "mat": (make_arrays.make_mat, read.of_mat),
    "hdf5": (make_arrays.make_hdf5, read.of_hdf5),
    "t01": (make_t01.make, make_t01.read),
}
# Of numbers that scales compute in another order, or by iteration.
TOLERANCE = 1e-9


def timed(found):
    return {name: channel for name, channel in found.items() if channel[0] is not None}


def differs(found, expected):
    if len(found) != len(expected):
        return True
    largest = numpy.nanmax(numpy.abs(expected), initial=0)
    return not numpy.allclose(found, expected, rtol=TOLERANCE, atol=TOLERANCE * largest, equal_nan=True)


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
    make_machines.make(folder / "machines")
    make_sheets.curve(folder / "curves")
    for kind, (make, reader) in FORMATS.items():
        expected = {}
        for path in make(folder / kind):
            channels = timed(reader(path))
            expected[path.name] = {
                name: {"time": list(time), "values": [None if numpy.isnan(value) else float(value) for value in values]}
                for name, (time, values) in channels.items()
            }
        (folder / kind / "expected.json").write_text(json.dumps(expected, indent=0) + "\n")


def compare_specimens(droptower, folder):
    """Every specimen of machines' exports has the dimensions, speed and strength that it was made with."""
    make_machines.make(folder)
    expected = json.loads((folder / "expected.json").read_text())
    for name, specimens in expected.items():
        reduced = subprocess.run(
            [droptower, "reduce", "coupon", "--json", folder / name], capture_output=True, text=True, check=True
        )
        found = json.loads(reduced.stdout)["specimens"]
        assert [one["specimen"] for one in found] == [one["name"] for one in specimens], name
        for one, own in zip(found, specimens, strict=True):
            keys = ["width_m", "thickness_m", "gauge_m", "velocity_m_s", "strength_Pa"]
            made = [
                own["width"] / 1e3,
                own["thickness"] / 1e3,
                own["gauge"] / 1e3,
                own["speed"] / 6e4,
                own["strength"] * 1e6,
            ]
            assert numpy.allclose([one[key] for key in keys], made, rtol=1e-6, atol=0), (name, one, made)
    return len(expected), sum(len(specimens) for specimens in expected.values())


def main():
    if sys.argv[1] == "--keep":
        keep(Path(sys.argv[2]))
        return
    for kind, (make, reader) in FORMATS.items():
        with tempfile.TemporaryDirectory() as folder:
            paths = make(Path(folder))
            channels = sum(compare(sys.argv[1], path, reader(path)) for path in paths)
            print(f"  {kind}: {len(paths)} files, {channels} channels")
    with tempfile.TemporaryDirectory() as folder:
        print("  machines: {} files, {} specimens".format(*compare_specimens(sys.argv[1], Path(folder))))


if __name__ == "__main__":
    main()
