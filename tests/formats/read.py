"""What other programs' readers find in recordings: channels with their times and values, in SI where their unit is known."""

import numpy
import pandas
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
                time = start + channel.properties["wf_increment"] * numpy.arange(len(values))
            else:
                time = numpy.asarray(times[0][:]) if times and channel.name != "Time" else None
            unit = factor(channel.name, channel.properties.get("unit_string"))
            found[f"{group.name}/{channel.name}"] = (time, unit * values.astype(float))
    return found


def of_sheets(path):
    """Columns of the sheets that hold a table, as pandas reads them: below the row of names, and that of units."""
    sheets = {name: sheet for name, sheet in pandas.read_excel(path, sheet_name=None, header=None).items() if len(sheet) > 2}
    found = {}
    for sheet, table in sheets.items():
        first = next(row for row in range(len(table)) if isinstance(table.iloc[row, 1], str))
        names, below = list(table.iloc[first]), list(table.iloc[first + 1])
        units = below if isinstance(below[0], str) else [None] * len(names)
        rows = table.iloc[first + 1 + isinstance(below[0], str) :]
        columns = [factor(name, unit) * rows[place].to_numpy(float) for place, (name, unit) in enumerate(zip(names, units))]
        for name, values in list(zip(names, columns))[1:]:
            found[name if len(sheets) == 1 else f"{sheet}/{name}"] = (columns[0], values)
    return found
