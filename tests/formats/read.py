"""What other programs' readers find in recordings: channels with their times and values, in SI where their unit is known."""

import numpy
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
