"""Makes workbooks with openpyxl; nothing was measured."""

from pathlib import Path

import make_machines
import openpyxl


def save(folder, name, sheets):
    book = openpyxl.Workbook()
    book.remove(book.active)
    for title, rows in sheets.items():
        sheet = book.create_sheet(title)
        for row in rows:
            sheet.append(row)
    book.save(folder / name)


def make(folder):
    """Workbooks of recordings, in the folder."""
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    times = [0.001 * place for place in range(12)]
    units = [["Time", "Force", "Travel"], ["s", "kN", "mm"], *[[time, 2 * time, time * time] for time in times]]
    named = [["made by openpyxl"], [], ["Time [ms]", "Acceleration [g]"], *[[1e3 * time, 5 + time] for time in times]]
    gaps = [["Time [s]", "a", "b"], [0.0, 1, 7], [0.5, None, 8], [1.0, 3, None]]
    save(folder, "units.xlsx", {"Sheet1": units})
    save(folder, "sheets.xlsx", {"Notes": [["nothing was measured"]], "Slow": units, "Fast": named, "Empty": []})
    save(folder, "gaps.xlsx", {"Tabelle1": gaps})
    return sorted(folder.glob("*.xlsx"))


def curve(folder):
    """A workbook with a curve of stress over strain."""
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    rows = [["Dehnung", "Spannung"], ["%", "MPa"], [1, 2.5], [10, 8], [300, 24]]
    save(folder, "curve.xlsx", {"MD": rows})


def of_machines(folder):
    """A workbook with a specimen a sheet, as testXpert exports it, and what is in it."""
    own = make_machines.three(["Probe 1", "Probe 2", "Probe 3"])
    sheets = {}
    for one in own:
        head = [["Breite b0", one.width, "mm"], ["Dicke a0", 1e3 * one.thickness, "µm"], ["Einspannlänge", 50, "mm"]]
        head += [["Prüfgeschwindigkeit", 100, "mm/min"], ["Richtung", "MD"], []]
        sheets[one.name] = head + [["Prüfzeit", "Standardweg", "Standardkraft"], ["s", "mm", "N"], *one.rows]
    save(Path(folder), "zwick.xlsx", sheets)
    return {"zwick.xlsx": [one.expected() for one in own]}
