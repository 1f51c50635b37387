"""Makes MAT-files and HDF5 files with SciPy, h5py and pandas; nothing was measured."""

import os
from pathlib import Path

import h5py
import numpy
import pandas
import scipy.io

TIMES = 0.001 * numpy.arange(12)
FORCES = 5 + TIMES**2


def mat_5(folder):
    drop = {"time": TIMES[:, None], "force_kN": FORCES[:, None], "operator": "made by SciPy", "fs": 1000.0}
    both = {"t": TIMES, "acceleration_g": FORCES, "count": numpy.arange(12, dtype=numpy.int16), "direction": "MD"}
    matrix = {"time": TIMES, "a": numpy.column_stack([FORCES, -FORCES, TIMES]).astype(numpy.float32)}
    nested = {
        "test": {"first": drop, "second": {"time": TIMES[:5], "x_mm": TIMES[:5] * 3}},
        "empty": numpy.zeros((0, 0)),
    }
    odd = {"time": TIMES, "z": FORCES + 1j, "cell": numpy.array([1, "a"], dtype=object), "ok": FORCES > 5, "b": FORCES}
    for name, content in {
        "struct": {"drop": drop},
        "vectors": both,
        "matrix": matrix,
        "nested": nested,
        "odd": odd,
    }.items():
        scipy.io.savemat(folder / f"{name}.mat", content, do_compression=name in ("struct", "matrix"), oned_as="column")
    number = {"runs": numpy.array([(TIMES, FORCES), (TIMES, 2 * FORCES)], dtype=[("time", object), ("f", object)])}
    scipy.io.savemat(folder / "structs.mat", number)


def mat_73(folder):
    """As MATLAB saves with -v7.3, made after a description: 512 bytes before, columns as rows, classes beside them."""
    path = folder / "hdf5.mat"
    with h5py.File(path, "w", userblock_size=512) as file:

        def save(group, name, values, kind="double"):
            data = group.create_dataset(name, data=values)
            data.attrs["MATLAB_class"] = numpy.bytes_(kind)

        drop = file.create_group("drop")
        drop.attrs["MATLAB_class"] = numpy.bytes_("struct")
        save(drop, "time", TIMES[None, :])
        save(drop, "force_N", FORCES[:, None])
        save(drop, "a", numpy.column_stack([FORCES, -FORCES]).T)
        save(drop, "name", numpy.frombuffer("drop".encode("utf-16-le"), dtype="u2")[:, None], "char")
        save(file, "fs", numpy.array([[1000.0]]))
        complexes = numpy.zeros((1, 12), dtype=[("real", "f8"), ("imag", "f8")])
        save(drop, "z", complexes)
    content = bytearray(path.read_bytes())
    text = b"MATLAB 7.3 MAT-file, Platform: GLNXA64, Created on: made after a description"
    content[:128] = text.ljust(116) + bytes(8) + b"\x00\x02IM"
    path.write_bytes(content)


def hdf5(folder):
    with h5py.File(folder / "h5py.h5", "w") as file:
        file.attrs["title"] = "made by h5py"
        group = file.create_group("drop/fast")
        for name, values, unit in [("time", 1e3 * TIMES, "ms"), ("acceleration", FORCES, "g")]:
            group.create_dataset(name, data=values, compression="gzip", chunks=(5,)).attrs["units"] = unit
        group.create_dataset("count", data=numpy.arange(12, dtype=">i2"))
        group.create_dataset(
            "sides", data=numpy.column_stack([FORCES, -FORCES]).astype("f4"), shuffle=True, compression=9
        )
        packed = group.create_dataset("packed", data=numpy.arange(12, dtype="i2"))
        packed.attrs["scale_factor"], packed.attrs["add_offset"] = 0.01, 5.0
        group.create_dataset("is_on", data=FORCES > 5)
        group.create_dataset("remarks", data=["a", "b"])
        file.create_dataset("rate", data=1000.0)
        record = numpy.zeros(7, dtype=[("time", "f8"), ("force_N", "f4"), ("xyz", "f8", (3,)), ("word", "S3")])
        record["time"], record["force_N"], record["xyz"] = TIMES[:7], FORCES[:7], numpy.arange(21).reshape(7, 3)
        file.create_dataset("records", data=record)
    table = pandas.DataFrame({"time": TIMES, "force": FORCES, "count": numpy.arange(12)})
    table.to_hdf(folder / "pandas-table.h5", key="drop", format="table", data_columns=True)
    with h5py.File(folder / "latest.h5", "w", libver="latest") as file:
        file["time"], file["a"] = TIMES, FORCES


def make_mat(folder):
    """MAT-files, in the folder."""
    folder = Path(folder)
    os.makedirs(folder, exist_ok=True)
    mat_5(folder)
    mat_73(folder)
    return sorted(folder.glob("*.mat"))


def make_hdf5(folder):
    """HDF5 files, in the folder."""
    folder = Path(folder)
    os.makedirs(folder, exist_ok=True)
    hdf5(folder)
    return sorted(folder.glob("*.h5"))
