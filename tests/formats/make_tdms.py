"""Makes small TDMS files: with npTDMS, and byte by byte in the shapes that its writer does not make.

Made after National Instruments' "TDMS File Format Internal Structure"; nothing was measured.
"""

import math
import struct
from pathlib import Path

import numpy
from nptdms import ChannelObject, GroupObject, RootObject, TdmsWriter

LIST, NEW_LIST, DATA, INTERLEAVED, BIG, DAQMX = 2, 4, 8, 32, 64, 128
CODES = {"i1": 1, "i2": 2, "i4": 3, "i8": 4, "u1": 5, "u2": 6, "u4": 7, "u8": 8, "f4": 9, "f8": 10}
SCALER_CODES = {"u1": 0, "i1": 1, "u2": 2, "i2": 3, "u4": 4, "i4": 5}
RAW = 0xFFFFFFFF


def text(value, order):
    value = value.encode()
    return struct.pack(order + "I", len(value)) + value


def properties(values, order):
    packed = struct.pack(order + "I", len(values))
    for name, value in values.items():
        packed += text(name, order)
        if isinstance(value, str):
            packed += struct.pack(order + "I", 0x20) + text(value, order)
        elif isinstance(value, int):
            packed += struct.pack(order + "II", 7, value)
        else:
            packed += struct.pack(order + "Id", 10, value)
    return packed


def index(kind, count, order="<"):
    """Description of data of one type."""
    return struct.pack(order + "IIIQ", 20, CODES[kind], 1, count)


def daqmx(count, scalers, widths, lines=False, code=RAW):
    """Description of raw data of DAQmx; scalers are type, buffer, offset and number."""
    packed = struct.pack("<IIIQI", 0x126A if lines else 0x1269, code, 1, count, len(scalers))
    for kind, buffer, offset, number in scalers:
        packed += struct.pack("<III" + ("B" if lines else "I") + "I", SCALER_CODES[kind], buffer, offset, 0, number)
    return packed + struct.pack("<I", len(widths)) + b"".join(struct.pack("<I", width) for width in widths)


NOTHING, AS_BEFORE = struct.pack("<I", RAW), struct.pack("<I", 0)


def segment(contents, objects, data, order="<", length=None):
    """A segment; objects are path, description of data and properties."""
    meta = b""
    if contents & LIST:
        meta = struct.pack(order + "I", len(objects))
        for path, described, values in objects:
            meta += text(path, order) + described + properties(values, order)
    size = len(meta) + len(data) if length is None else length
    lead = b"TDSm" + struct.pack("<I", contents) + struct.pack(order + "IQQ", 4713, size, len(meta))
    return lead + meta + data


def waveform(step=0.001, start=0.0, **others):
    return {"wf_start_offset": start, "wf_increment": step, "wf_samples": 1, **others}


def scale(number, kind, source=RAW, **values):
    prefix = f"NI_Scale[{number}]_"
    named = {f"{prefix}{kind}_{name}": value for name, value in values.items()}
    return {prefix + "Scale_Type": kind, f"{prefix}{kind}_Input_Source": source, **named}


def linear(number, slope, intercept, source=RAW):
    return scale(number, "Linear", source, Slope=slope, Y_Intercept=intercept)


def polynomial(number, coefficients, source=RAW):
    own = {"Coefficients_Size": len(coefficients)}
    own |= {f"Coefficients[{place}]": value for place, value in enumerate(coefficients)}
    return scale(number, "Polynomial", source, **own)


def table(number, inputs, outputs, source=RAW):
    own = {"Pre_Scaled_Values_Size": len(inputs), "Scaled_Values_Size": len(outputs)}
    own |= {f"Pre_Scaled_Values[{place}]": value for place, value in enumerate(inputs)}
    own |= {f"Scaled_Values[{place}]": value for place, value in enumerate(outputs)}
    return scale(number, "Table", source, **own)


def pack(kind, values, order="<"):
    return numpy.array(values, dtype=order + kind).tobytes()


def drop(count=60):
    """A deceleration of a drop, in g."""
    return [14.0 * math.sin(math.pi * place / count) ** 2 for place in range(count)]


def write_with_nptdms(folder):
    with TdmsWriter(folder / "written.tdms") as out:
        root = RootObject({"title": "made by npTDMS; nothing was measured", "direction": "MD", "velocity": "0.02 m/s"})
        acceleration = {"unit_string": "g", "wf_increment": 1e-4, "wf_start_offset": -5e-4,
                        "wf_start_time": numpy.datetime64("2024-05-01T10:20:30.125")}  # fmt: skip
        force = {"unit_string": "kN", "wf_increment": 1e-4, "wf_start_offset": -5e-4}
        out.write_segment([
            root,
            GroupObject("Drop"),
            ChannelObject("Drop", "Acceleration", numpy.array(drop()), acceleration),
            ChannelObject("Drop", "Force", numpy.array(drop(), dtype=numpy.float32), force),
            ChannelObject("Slow", "Time", numpy.array([0.0, 0.5, 1.0]), {"unit_string": "s"}),
            ChannelObject("Slow", "Pressure [kPa]", numpy.array([100, 101, 103], dtype=numpy.int16), {}),
            ChannelObject("Slow", "Remark", ["a", "bb", "ccc"], {}),
        ])  # fmt: skip
        out.write_segment([ChannelObject("Drop", "Acceleration", numpy.array(drop(20)), {})])
        out.write_segment([ChannelObject("Drop", "Force", numpy.array(drop(20), dtype=numpy.float32), {})])
    with TdmsWriter(folder / "kinds.tdms") as out:
        kinds = ["int8", "int16", "int32", "int64", "uint8", "uint16", "uint32", "uint64", "float32", "float64", "bool"]
        out.write_segment([
            ChannelObject("Kinds", kind, numpy.array([0, 1, 100, 7]).astype(kind), waveform(0.5)) for kind in kinds
        ])  # fmt: skip


def shapes():
    """Files byte by byte: name, bytes."""
    a, b, c = "/'G'/'a'", "/'G'/'b'", "/'G'/'it''s/c'"
    first = LIST | NEW_LIST | DATA
    i4 = [index("i4", 2)] * 2
    yield (
        "chunks",
        segment(first, [("/'G'", NOTHING, {}), (a, i4[0], waveform()), (b, i4[1], waveform())], pack("i4", range(12))),
    )
    repeated = segment(first, [(a, i4[0], waveform()), (b, i4[1], waveform())], pack("i4", range(4)))
    yield "no-list", repeated + segment(DATA, [], pack("i4", range(4, 8))) + segment(DATA, [], pack("i4", range(8)))
    added = segment(LIST | DATA, [(c, index("f8", 1), waveform())], pack("i4", range(4)) + pack("f8", [0.5]))
    yield "object-added", repeated + added + segment(DATA, [], pack("i4", range(4)) + pack("f8", [0.75]))
    changed = segment(LIST | DATA, [(b, index("i4", 3), {"note": "longer"})], pack("i4", range(5)))
    yield "index-changed", repeated + changed
    silent = segment(LIST | DATA, [(a, NOTHING, {})], pack("i4", [70, 71]))
    again = segment(LIST | DATA, [(a, AS_BEFORE, {})], pack("i4", range(4)))
    yield "without-data-for-a-while", repeated + silent + again
    renewed = segment(first, [(b, AS_BEFORE, {}), (c, index("u2", 2), waveform())], pack("i4", [5, 6]) + b"\1\0\2\0")
    yield "new-list", repeated + renewed
    yield "properties-alone", repeated + segment(LIST, [(a, NOTHING, {"unit_string": "mm"})], b"")
    mixed = [(a, index("i2", 3), waveform()), (b, index("f8", 3), waveform()), (c, index("u1", 3), waveform())]
    rows = b"".join(pack("i2", [row]) + pack("f8", [row / 8]) + pack("u1", [row]) for row in range(9))
    yield "interleaved", segment(first | INTERLEAVED, mixed, rows)
    yield "interleaved-cut", segment(first | INTERLEAVED, mixed, rows[:-4], length=2**64 - 1)
    yield "one-value-a-chunk", segment(
        first, [(a, index("f8", 1), waveform()), (b, index("f4", 1), waveform())],
        b"".join(pack("f8", [row / 3]) + pack("f4", [row / 7]) for row in range(40)),
    )  # fmt: skip
    big = [(a, index("i2", 2, ">"), waveform()), (b, index("f8", 2, ">"), waveform())]
    yield "big-endian", segment(first | BIG, big, pack("i2", [1, -2], ">") + pack("f8", [0.25, -1e9], ">"), ">")
    long = [(a, index("f8", 4), waveform()), (b, index("f8", 4), waveform())]
    yield "cut-in-first", segment(first, long, pack("f8", range(11)), length=2**64 - 1)
    whole = segment(first, long, pack("f8", range(16)))
    yield "cut-file", whole[:-13]
    yield "cut-within-list", whole + segment(first, long, b"")[:40]
    yield "cut-within-lead-in", whole + b"TDSm\x0e"
    steps = [
        (a, index("f8", 4), waveform() | {"wf_xname": "Time", "wf_xunit_string": "ms"}),
        (b, index("f8", 4), waveform() | {"wf_xname": "Frequency", "wf_xunit_string": "Hz"}),
        ("/'G'/'c'", index("f8", 4), waveform() | {"wf_xunit_string": "s"}),
    ]
    yield "steps-with-units", segment(first, steps, pack("f8", range(12)))
    yield "rest-of-chunk", segment(first, long, pack("f8", range(12)))


def scaled():
    """Files with scales: name, bytes."""
    first, path = LIST | NEW_LIST | DATA, "/'G'/'{}'"

    def channel(name, values, stored, kind="f8"):
        return (path.format(name), index(kind, len(stored)), waveform() | values), pack(kind, stored)

    channels = [
        channel("linear", {"NI_Number_Of_Scales": 1} | linear(0, 2.5, -1.0), [0, 1, -7, 200], "i2"),
        channel("uncounted", linear(0, 0.1, 0.25), [0, 1, -7, 200], "i2"),
        channel("applied", {"NI_Scaling_Status": "scaled"} | linear(0, 2.0, 0.0), [1.0, 2.0, 3.0]),
        channel("polynomial", polynomial(0, [1.0, -2.0, 0.5, 0.125]), [0.0, 1.0, -3.0]),
        channel("chain", linear(0, 2.0, 1.0) | polynomial(1, [0.0, 0.0, 1.0], 0) | linear(2, -1.0, 5.0, 1), [0.5, 3.0]),
        channel("table", table(0, [0.0, 1.0, 4.0], [10.0, 20.0, -5.0]), [-1.0, 0.0, 0.25, 2.0, 9.0]),
        channel("falling table", table(0, [4.0, 1.0, 0.0], [1.0, 2.0, 3.0]), [-1.0, 0.5, 3.0, 9.0]),
        channel("as it is", scale(0, "AdvancedAPI") | linear(1, 2.0, 0.0, 0), [1.0, 2.0]),
    ]
    objects, data = zip(*channels, strict=True)
    yield "scales", segment(first, objects, b"".join(data))
    group = ("/'G'", NOTHING, linear(0, 3.0, 0.0))
    yield "scale-of-group", segment(first, [group, (path.format("a"), index("i2", 2), waveform())], pack("i2", [1, 2]))


def of_daqmx():
    """Files with raw data of DAQmx: name, bytes."""
    first = LIST | NEW_LIST | DATA | DAQMX
    a, b, c = "/'G'/'a'", "/'G'/'b'", "/'G'/'c'"

    def scales(count, *own):
        return waveform() | {"NI_Number_Of_Scales": count} | {key: value for one in own for key, value in one.items()}

    one = [(a, daqmx(4, [("i2", 0, 0, 0)], [4]), scales(2, linear(1, 0.5, 1.0, 0))),
           (b, daqmx(4, [("i2", 0, 2, 0)], [4]),
            scales(3, polynomial(1, [1.0, 2.0], 0), linear(2, 10.0, 0.0, 1)))]  # fmt: skip
    yield "daqmx", segment(first, one, pack("i2", range(16)))
    yield "daqmx-again", segment(first, one, pack("i2", range(8))) + segment(DATA | DAQMX, [], pack("i2", range(8, 16)))
    yield "daqmx-cut", segment(first, one, pack("i2", range(13)), length=2**64 - 1)
    both = [("i2", 0, 0, 0), ("i4", 0, 2, 1)]
    data = b"".join(pack("i2", [row]) + pack("i4", [100 * row]) for row in range(6))
    yield "daqmx-scalers", segment(first, [(a, daqmx(3, both, [6]), scales(3, linear(2, 1e-3, 0.0, 1)))], data)
    cards = [(a, daqmx(3, [("i2", 0, 0, 0)], [2, 4]), scales(2, linear(1, 2.0, 0.0, 0))),
             (b, daqmx(3, [("u4", 1, 0, 0)], [2, 4]), scales(2, linear(1, 3.0, 0.0, 0)))]  # fmt: skip
    data = b"".join(pack("i2", [1 + n, 2 + n, 3 + n]) + pack("u4", [7 + n, 8 + n, 9 + n]) for n in (0, 10))
    yield "daqmx-cards", segment(first, cards, data)
    lines = [
        (path, daqmx(4, [("u1", 0, bit, 0)], [1], lines=True), scales(1)) for path, bit in [(a, 0), (b, 1), (c, 5)]
    ]
    yield "daqmx-lines", segment(first, lines, bytes([0, 1, 34, 35, 255, 2, 32, 3]))
    typed = [(a, daqmx(2, [("i2", 0, 0, 0)], [2], code=2), waveform())]
    yield "daqmx-typed", segment(first, typed, pack("i2", [5, -6]))


def make(folder):
    """All files, in the folder."""
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    write_with_nptdms(folder)
    for name, content in [*shapes(), *scaled(), *of_daqmx()]:
        (folder / f"{name}.tdms").write_bytes(content)
    return sorted(folder.glob("*.tdms"))
