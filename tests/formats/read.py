"""What other programs' readers find in recordings: channels with times and values, in SI where their unit is known."""

import h5py
import numpy
import pandas
import scipy.io
from nptdms import TdmsFile

SI = {"g": 9.80665, "kN": 1e3, "N": 1.0, "kPa": 1e3, "MPa": 1e6, "mm": 1e-3, "ms": 1e-3, "s": 1.0, "mm/s2": 1e-3}


def factor(name, unit):
    """Factor to SI of a channel, by its unit or that in its name."""
    return SI.get(unit or name.partition("[")[2].rstrip("]"), 1.0)


def of_tdms(path):
    """Channels of numbers as npTDMS reads them: name with group, times or none, values."""
    found = {}
    for group in TdmsFile.read(path).groups():
        times = [one for one in group.channels() if one.name == "Time"]
        for channel in group.channels():
            values = numpy.asarray(channel[:])
            if values.dtype.kind not in "biuf" or not len(values):
                continue
            if "wf_increment" in channel.properties:
                start = channel.properties.get("wf_start_offset", 0.0)
                second = {"": 1.0, "s": 1.0, "ms": 1e-3}.get(channel.properties.get("wf_xunit_string", ""))
                if second is None:
                    continue
                time = second * (start + channel.properties["wf_increment"] * numpy.arange(len(values)))
            else:
                time = numpy.asarray(times[0][:]) if times and channel.name != "Time" else None
            unit = factor(channel.name, channel.properties.get("unit_string"))
            found[f"{group.name}/{channel.name}"] = (time, unit * values.astype(float))
    return found


def of_sheets(path):
    """Columns of the sheets that hold a table, as pandas reads them: below the row of names, and that of units."""
    sheets = {
        name: sheet for name, sheet in pandas.read_excel(path, sheet_name=None, header=None).items() if len(sheet) > 2
    }
    found = {}
    for sheet, table in sheets.items():
        first = next(row for row in range(len(table)) if isinstance(table.iloc[row, 1], str))
        names, below = list(table.iloc[first]), list(table.iloc[first + 1])
        units = below if isinstance(below[0], str) else [None] * len(names)
        rows = table.iloc[first + 1 + isinstance(below[0], str) :]
        columns = [
            factor(name, units[place]) * rows[place].to_numpy(float) for place, name in enumerate(names)
        ]
        for name, values in list(zip(names, columns, strict=True))[1:]:
            found[name if len(sheets) == 1 else f"{sheet}/{name}"] = (columns[0], values)
    return found


def with_times(arrays):
    """Channels of arrays by path: those of one group with its time, a column of a matrix each."""
    found = {}
    for path, values in arrays.items():
        group, _, name = path.rpartition("/")
        inside = {other.rpartition("/")[2]: other for other in arrays if other.rpartition("/")[0] == group}
        time = next((arrays[inside[word]] for word in ("time", "t") if word in inside), None)
        if name in ("time", "t") or time is None:
            continue
        suffix = name.rpartition("_")[2]
        time = time * 1e-3 if group == "drop/fast" else time
        unit = 9.80665 if name == "acceleration" or suffix == "g" else SI.get(suffix, 1.0)
        if values.ndim == 1:
            found[path] = (time, unit * values)
        else:
            found |= {f"{path}(:,{column + 1})": (time, values[:, column]) for column in range(values.shape[1])}
    return found


def is_real(values):
    return values.dtype.kind in "biuf" and values.size > 1


def shaped(values):
    values = numpy.asarray(values)
    return values.ravel().astype(float) if 1 in values.shape or values.ndim == 1 else values.astype(float)


def of_mat(path):
    """Variables and fields of structs as SciPy reads them, or h5py where they are HDF5."""
    arrays = {}

    def walk(value, name):
        if isinstance(value, numpy.ndarray) and value.dtype.names:
            for place, one in enumerate(value.ravel()):
                own = name if value.size == 1 else f"{name}({place + 1})"
                for field in value.dtype.names:
                    walk(one[field], f"{own}/{field}" if own else field)
        elif isinstance(value, numpy.ndarray) and is_real(value):
            arrays[name] = shaped(value)

    try:
        for name, value in scipy.io.loadmat(path).items():
            walk(value, name)
    except NotImplementedError:
        return of_hdf5(path)
    return with_times(arrays)


def of_hdf5(path):
    """Data sets and fields of records as h5py reads them."""
    arrays = {}

    def visit(name, item):
        if not isinstance(item, h5py.Dataset):
            return
        kind = item.attrs.get("MATLAB_class", b"")
        if item.dtype.names and kind == b"":
            for field in item.dtype.names:
                if is_real(item[field]):
                    arrays[f"{name}/{field}"] = shaped(item[field])
        elif item.dtype.kind in "biuf" and item.size > 1 and kind != b"char":
            scale, offset = item.attrs.get("scale_factor", 1.0), item.attrs.get("add_offset", 0.0)
            arrays[name] = scale * shaped(item[()].T if kind else item[()]) + offset

    with h5py.File(path) as file:
        file.visititems(visit)
    return with_times(arrays)
