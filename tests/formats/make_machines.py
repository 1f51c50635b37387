"""Makes exports of tensile machines after descriptions and printed examples of them; nothing was measured.

Zwick (testXpert), Instron (Bluehill), MTS (TestSuite) and Shimadzu (Trapezium) publish no description of their formats.
"""

import json
from pathlib import Path


class Specimen:
    """A strip of film that yields and breaks; lengths in mm, forces in N."""

    def __init__(self, name, width, thickness, rows, gauge=50.0, speed=100.0):
        self.name, self.width, self.thickness, self.gauge, self.speed = name, width, thickness, gauge, speed
        travel = [0.25 * place for place in range(rows)]
        stress = [20.0 * (1 - 0.5 ** (8 * length / gauge)) + 10 * length / gauge for length in travel]
        force = [round(value * width * thickness, 4) for value in stress]
        self.rows = [
            (round(length / speed * 60, 4), length, value) for length, value in zip(travel, force, strict=True)
        ]
        self.rows.append((self.rows[-1][0] + 0.01, travel[-1] + 0.05, 0.01))

    def expected(self):
        return {
            "name": self.name, "width": self.width, "thickness": self.thickness, "gauge": self.gauge,
            "speed": self.speed, "rows": len(self.rows),
            "strength": max(row[2] for row in self.rows) / (self.width * self.thickness),
        }  # fmt: skip


def three(names):
    sizes = [(15.0, 0.05, 40), (15.1, 0.052, 31), (14.9, 0.049, 46)]
    return [Specimen(name, *size) for name, size in zip(names, sizes, strict=True)]


def comma(value, digits=4):
    return f"{value:.{digits}f}".replace(".", ",")


def side_by_side(specimens, cell, separator, order=(0, 1, 2), quote='"'):
    for place in range(max(len(one.rows) for one in specimens)):
        cells = []
        for one in specimens:
            row = one.rows[place] if place < len(one.rows) else None
            cells += [f"{quote}{cell(row[column])}{quote}" if row else "" for column in order]
        yield separator.join(cells)


def zwick_side_by_side():
    own = three(["Probe 1", "Probe 2", "Probe 3"])
    lines = [
        '"Prüfprotokoll";"Folie längs"',
        '"Prüfer";"made after a description of testXpert"',
        '"Prüfdatum";"01.05.2024"',
    ]
    lines += ['"Prüfgeschwindigkeit";100,00;"mm/min"', '"Einspannlänge";50,00;"mm"', '"Richtung";"MD"', ""]
    lines += ['"Legende";"Breite b0";"Dicke a0"', '"";"mm";"µm"']
    lines += [f'"{one.name}";{comma(one.width)};{comma(1e3 * one.thickness)}' for one in own]
    lines += ["", '"Probe 1";"";"";"Probe 2";"";"";"Probe 3";"";""']
    lines += [";".join(['"Prüfzeit";"Standardweg";"Standardkraft"'] * 3), ";".join(['"s";"mm";"N"'] * 3)]
    return "zwick-side-by-side.csv", "latin-1", [*lines, *side_by_side(own, comma, ";")], own


def zwick_own_heads():
    own = three(["Probe 1", "Probe 2", "Probe 3"])
    lines = ["Vorschub;;;;;;;;", "Prüfgeschwindigkeit [mm/min];100", "Einspannlänge [mm];50", "Probenrichtung;quer"]
    lines += [";".join(f"Probenbreite;{comma(one.width)};mm" for one in own)]
    lines += [";".join(f"Probendicke;{comma(one.thickness)};mm" for one in own)]
    lines += ["Probe 1;;;Probe 2;;;Probe 3;;", ";".join(["Zeit;Traversenweg;Kraft"] * 3), ";".join(["s;mm;N"] * 3)]
    return "zwick-own-heads.txt", "utf-8", [*lines, *side_by_side(own, comma, ";", quote="")], own


def testxpert_utf_16():
    own = three(["Specimen 1", "Specimen 2", "Specimen 3"])
    lines = ["Test speed\t100\tmm/min", "Grip to grip separation at the start position\t50\tmm", "Direction\tTD"]
    lines += [f"Specimen width\t{own[0].width}\t{own[1].width}\t{own[2].width}\tmm"]
    lines += [f"Thickness [µm]\t{50}\t{52}\t{49}", ""]
    lines += ["Specimen 1\t\tSpecimen 2\t\tSpecimen 3\t", "\t".join(["Standard travel\tStandard force"] * 3)]
    lines += ["\t".join(["mm\tN"] * 3)]
    return "testxpert.txt", "utf-16", [*lines, *side_by_side(own, str, "\t", (1, 2), "")], own


def names_alone():
    own = three(["specimen 1", "specimen 2", "specimen 3"])
    lines = ["Width [mm],15,15.1,14.9", "Thickness [mm],0.05,0.052,0.049", "Gauge length [mm],50", "Speed [mm/min],100"]
    lines += ["Direction,MD", ",".join(["Force [N],Displacement [mm]"] * 3)]
    return "names-alone.csv", "utf-8", [*lines, *side_by_side(own, str, ",", (2, 1), "")], own


def bluehill():
    own = three(["MD-a", "MD-b", "MD-c"])
    lines = []
    for one in own:
        lines += [f'Specimen label,"{one.name}"', f'Width,"{one.width}",mm', f'Thickness,"{one.thickness}",mm']
        lines += [
            'Length,"50.00000",mm',
            'Rate 1,"100.00000",mm/min',
            "Direction,MD",
            "",
            "Time,Extension,Load",
            "(s),(mm),(N)",
        ]
        lines += [",".join(f'"{value}"' for value in row) for row in one.rows] + [""]
    return "bluehill.csv", "utf-8", lines, own


def bluehill_colons():
    own = [Specimen("Specimen 4", 15.0, 0.05, 30)]
    lines = [
        "Sample : film, made after a description",
        "Width : 15.00 mm",
        "Thickness : 0.05 mm",
        "Gauge length : 50 mm",
    ]
    lines += ["Crosshead speed : 100 mm/min", "Direction : MD", "Specimen 4", "", "Extension (mm)\tLoad (N)"]
    return "bluehill-colons.txt", "utf-8", lines + [f"{row[1]}\t{row[2]}" for row in own[0].rows], own


def mts():
    own = three(["Specimen 1", "Specimen 2", "Specimen 3"])
    lines = [
        "MTS TestSuite\tmade after a description",
        "Grip Separation:\t50\tmm",
        "Test Speed:\t100\tmm/min",
        "Direction:\tTD",
    ]
    lines += ["Specimen\tWidth\tThickness", "\tmm\tmm"] + [f"{one.name}\t{one.width}\t{one.thickness}" for one in own]
    for one in own:
        lines += ["", one.name, "Crosshead \tLoad \tTime ", "mm\tN\tSec"]
        lines += [f"{travel}\t{force}\t{time}" for time, travel, force in one.rows]
    return "mts.txt", "utf-8", lines, own


def trapezium():
    own = three(["1 - 1", "1 - 2", "1 - 3"])
    lines = [
        '"Test Name","made after a description"',
        '"Speed","100","mm/min"',
        '"Direction","TD"',
        '"Gauge Length","50","mm"',
    ]
    lines += ['"Name","Width","Thickness"', '"","mm","mm"'] + [
        f'"{one.name}","{one.width}","{one.thickness}"' for one in own
    ]
    lines += ['"1 - 1","","","1 - 2","","","1 - 3","",""', ",".join(['"Time","Force","Stroke"'] * 3)]
    lines += [",".join(['"sec","N","mm"'] * 3)]
    return "trapezium.csv", "utf-8", [*lines, *side_by_side(own, str, ",", (0, 2, 1), "")], own


def chinese():
    own = three(["试样1", "试样2", "试样3"])
    lines = ["试验速度,100,mm/min", "标距,50,mm", "方向,纵向", "宽度,15,15.1,14.9,mm", "厚度,0.05,0.052,0.049,mm"]
    lines += ["试样1,,,试样2,,,试样3,,", ",".join(["时间,力,位移"] * 3), ",".join(["s,N,mm"] * 3)]
    return "chinese.csv", "gbk", [*lines, *side_by_side(own, str, ",", (0, 2, 1), "")], own


def blank_lines():
    own = three(["specimen 1", "specimen 2", "specimen 3"])
    lines = [
        "Breite;15,0;15,1;14,9;mm",
        "Dicke;50;52;49;µm",
        "Messlänge;50;mm",
        "Geschwindigkeit;100;mm/min",
        "Richtung;längs",
    ]
    lines += ["Weg in mm;Kraft in N"]
    for one in own:
        lines += [f"{comma(row[1])};{comma(row[2])}" for row in one.rows] + [""]
    return "blank-lines.csv", "utf-8", lines, own


ALL = [zwick_side_by_side, zwick_own_heads, testxpert_utf_16, names_alone, bluehill, bluehill_colons, mts, trapezium,
       chinese, blank_lines]  # fmt: skip


def make(folder):
    """All files, in the folder, and what is in them."""
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    expected = {}
    for maker in ALL:
        name, encoding, lines, specimens = maker()
        (folder / name).write_bytes("".join(f"{line}\r\n" for line in lines).encode(encoding))
        expected[name] = [one.expected() for one in specimens]
    import make_sheets

    expected |= make_sheets.of_machines(folder)
    (folder / "expected.json").write_text(json.dumps(expected, indent=1, ensure_ascii=False) + "\n")


if __name__ == "__main__":
    make(Path(__file__).resolve().parents[1] / "it/formats/machines")
