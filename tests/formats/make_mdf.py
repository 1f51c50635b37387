"""Makes MDF 4 files: with asammdf, and byte by byte where groups share their data; nothing was measured."""

import struct
from pathlib import Path

import numpy
from asammdf import MDF, Signal

TIMES = 0.001 * numpy.arange(40)


def written(folder):
    slow = 0.01 * numpy.arange(12)
    table = {f"raw_{place}": float(place * 10) for place in range(4)} | {
        f"phys_{place}": place**2 / 2 for place in range(4)
    }
    rational = {"P1": 0.0, "P2": 2.0, "P3": 1.0, "P4": 0.0, "P5": 0.0, "P6": 4.0}
    signals = [
        Signal(numpy.sin(TIMES), TIMES, name="acceleration", unit="g"),
        Signal((1000 * TIMES).astype("i2"), TIMES, name="force", unit="kN", conversion={"a": 0.5, "b": -3.0}),
        Signal((1000 * TIMES).astype("u1"), TIMES, name="quotient", conversion=rational),
        Signal((TIMES * 1000).astype("f4"), TIMES, name="table", conversion=table),
        Signal((numpy.arange(40) % 3).astype("u8"), TIMES, name="count"),
        Signal(numpy.array([b"a", b"bb"] * 20), TIMES, name="word", encoding="utf-8"),
        Signal(TIMES * 3, TIMES, name="invalid", invalidation_bits=numpy.arange(40) % 5 == 0),
    ]
    for packed, version in [(0, "4.10"), (1, "4.10"), (2, "4.10"), (2, "4.00")]:
        with MDF(version=version) as file:
            file.append(signals[: 7 if version == "4.10" else 6])
            file.append([Signal(slow * 2, slow, name="pressure", unit="kPa")])
            file.save(folder / f"packed-{packed}-{version}.mf4", compression=packed, overwrite=True)
    with MDF(version="4.10") as file:
        file.append(signals[:1])
        file.save(folder / "one-group.mf4", overwrite=True)


class Blocks:
    """Blocks one after the other, each with links to those before it."""

    def __init__(self):
        head = b"MDF     4.10    by hand " + bytes(4) + struct.pack("<H", 410)
        self.bytes = bytearray(head.ljust(64, b"\0") + bytes(104))

    def add(self, mark, links, data, at=None):
        block = b"##" + mark + bytes(4) + struct.pack("<QQ", 24 + 8 * len(links) + len(data), len(links))
        block += struct.pack(f"<{len(links)}Q", *links) + data
        if at is not None:
            self.bytes[at : at + len(block)] = block
            return at
        self.bytes += bytes(-len(self.bytes) % 8)
        self.bytes += block
        return len(self.bytes) - len(block)

    def text(self, text):
        return self.add(b"TX", [], text.encode() + b"\0")

    def channel(self, following, name, kind, data_type, byte, bits, bit=0, unit=0):
        data = struct.pack("<BBBBIIIIBBHdddddd", kind, kind // 2, data_type, bit, byte, bits, 0, 0, 0, 0, 0, *[0.0] * 6)
        return self.add(b"CN", [following, 0, self.text(name), 0, 0, 0, unit, 0], data)

    def group(self, following, channel, number, count, length):
        data = struct.pack("<QQHHIII", number, count, 0, 0, 0, length, 0)
        return self.add(b"CG", [following, channel, 0, 0, 0, 0], data)


def unsorted(folder):
    """Two groups whose records alternate, with big-endian numbers and ones of few bits, in a list of two blocks."""
    file = Blocks()
    volts = file.text("mm")
    first = file.channel(file.channel(0, "x", 0, 1, 8, 16, unit=volts), "time", 2, 4, 0, 64)
    bits = file.channel(file.channel(0, "low", 0, 0, 4, 3), "middle", 0, 2, 4, 4, 3)
    second = file.channel(bits, "time", 2, 4, 0, 32)
    records = []
    for place in range(10):
        records.append(struct.pack("<Bd", 1, place / 10) + struct.pack(">H", 7 * place))
        if place % 2:
            records.append(struct.pack("<BfB", 2, place / 4, 37 * place % 256))
    data = b"".join(records)
    parts = [file.add(b"DT", [], data[:37]), file.add(b"DT", [], data[37:])]
    last = file.group(0, second, 2, 5, 5)
    groups = file.group(last, first, 1, 10, 10)
    lists = file.add(b"DL", [0, *parts], struct.pack("<BBBBIQQ", 0, 0, 0, 0, 2, 0, 37))
    shared = file.add(b"DG", [0, groups, lists, 0], struct.pack("<B7x", 1))
    file.add(b"HD", [shared, 0, 0, 0, 0, 0], bytes(32), at=64)
    (folder / "unsorted.mf4").write_bytes(file.bytes)


def make(folder):
    """All files, in the folder."""
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    written(folder)
    unsorted(folder)
    return sorted(folder.glob("*.mf4"))
