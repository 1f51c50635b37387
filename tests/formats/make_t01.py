"""Makes small time histories of OpenRadioss, byte by byte, and says what is in them.

Made after `engine/source/output/th/hist1.F` and `hist2.F` of OpenRadioss; nothing was measured. `tests/solvers/run` reads those that
the solver itself writes.
"""

import struct

import numpy

GLOBAL = [
    ("internal energy", "E"), ("kinetic energy", "E"), ("momentum x", "I"), ("momentum y", "I"), ("momentum z", "I"), ("mass", "M"),
    ("time step", "T"),
]  # fmt: skip
NODE = {3: ("DZ", "L"), 6: ("VZ", "V"), 9: ("AZ", "A")}
RIGID = {1: ("impulse FX", "I"), 3: ("impulse FZ", "I")}
OF_TEST = {3: "displacement_m", 6: "velocity_m_s", 9: "acceleration_m_s2"}


def record(content):
    length = struct.pack(">i", len(content))
    return length + content + length


def whole(*numbers):
    return struct.pack(f">{len(numbers)}i", *numbers)


def reals(values):
    return struct.pack(f">{len(values)}f", *values)


def build(path, groups, units=(1000.0, 1e-3, 1.0), version=4021, count=12, cut=0, parts=()):
    """A file; groups are kind, title, members and numbers of values. What is in it, by label."""
    title_length = 100 if version >= 4021 else 80
    mass, length, time = units
    factor = {
        "E": mass * length**2 / time**2, "I": mass * length / time, "M": mass, "T": time, "L": length, "V": length / time,
        "A": length / time**2,
    }  # fmt: skip

    def text(value, width):
        return value.encode().ljust(width)[:width]

    head = record(whole(version) + text("Ball on a film", 80)) + record(text("Sun Nov 29 2026 RADIOSS", 80))
    if version > 3050:
        head += record(whole(2)) + record(whole(title_length)) + record(reals(units))
    head += record(whole(len(parts), 1, 1, 1, len(groups), len(GLOBAL)))
    head += record(whole(*range(1, len(GLOBAL) + 1)))
    for number, values in enumerate(parts, 1):
        head += record(whole(number) + text(f"part {number}", title_length) + whole(0, 1, 1, values))
        if values:
            head += record(whole(*range(1, values + 1)))
    head += record(whole(7) + text("material", title_length)) + record(whole(8) + text("property", title_length))
    # A subset with a part and a value.
    head += record(whole(1, 0, 0, 1, 1) + text("subset", title_length)) + record(whole(1)) + record(whole(2))
    for number, (kind, title, members, values) in enumerate(groups, 1):
        head += record(whole(number, kind, 0, len(members), len(values)) + text(title, title_length))
        for member in members:
            head += record(whole(member) + text(f"member {member}", title_length))
        head += record(whole(*values))

    rng = numpy.random.default_rng(len(groups))
    times = numpy.cumsum(rng.uniform(0.9e-3, 1.1e-3, count)).astype("f4")
    lengths = [len(GLOBAL), sum(parts), 1, *(len(members) * len(values) for _, _, members, values in groups)]
    rows = [rng.uniform(-9, 9, (count, length)).astype("f4") for length in lengths if length]
    body = b""
    for instant in range(count):
        body += record(reals(times[instant : instant + 1])) + b"".join(record(reals(row[instant])) for row in rows)
    content = head + body
    path.write_bytes(content[: len(content) - cut])
    complete = count - (1 if cut else 0)

    def values(row, column, unit):
        return rows[row][:complete, column].astype(float) * factor[unit]

    clock = times[:complete].astype(float) * time
    found = {name: (clock, values(0, column, unit)) for column, (name, unit) in enumerate(GLOBAL)}
    tests = sum("; test from " in title for _, title, _, _ in groups)
    for place, (kind, title, members, numbers) in enumerate(groups):
        row = len(rows) - len(groups) + place
        name, _, begin = title.partition("; test from ")
        for member, node in enumerate(members):
            group = name if len(members) == 1 else f"{title}/{node}"
            for column, number in enumerate(numbers):
                known = {0: NODE, 103: RIGID}.get(kind, {}).get(number)
                if known is None:
                    continue
                signal = values(row, member * len(numbers) + column, known[1])
                found[f"{group}/{known[0]}"] = (clock, signal)
                if begin:
                    start = float(begin.removesuffix(" s"))
                    first = int(numpy.argmax(clock >= start - 1e-9))
                    signal = signal[first:]
                    signal = signal - signal[0] if number == 3 else signal
                    label = OF_TEST[number] if tests == 1 else f"{name}/{OF_TEST[number]}"
                    found[label] = (clock[first:] - start, signal)
    return found


MADE = {}


def make(folder):
    folder.mkdir(parents=True, exist_ok=True)
    node, rigid = [3, 6, 9], [1, 3, 40]
    ball = (0, "ball; test from 0.004 s", [883], node)
    dart = (0, "dart; test from 0.004 s", [9000], node)
    files = {
        "deckT01": dict(groups=[ball, (103, "ball", [1], rigid)]),
        "twoT01": dict(groups=[ball, dart], units=(1.0, 1.0, 1.0), parts=(0, 2)),
        "plainT01": dict(groups=[(0, "corners", [1, 2], node), (3, "shells", [5], [1])], units=(1e-3, 1e-3, 1e-3), version=3041 + 20),
        "cutT01": dict(groups=[ball], cut=37),
    }
    for name, options in files.items():
        MADE[name] = build(folder / name, **options)
    return [folder / name for name in files]


def read(path):
    return MADE[path.name]
