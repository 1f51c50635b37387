"""Reads LS-DYNA cards of droptower by the keyword classes of ansys-dyna-core, field by field.

    dyna.py DROPTOWER

What each field must hold follows from the material files here, by formulas of this file.
"""

import math
import subprocess
import sys
import tomllib
from pathlib import Path

from ansys.dyna.core import Deck

DROPTOWER = sys.argv[1]
MPA = 1.0


def number(text):
    """A quantity of a material file in t, mm, s, N, MPa."""
    units = {"MPa": MPA, "Pa": 1e-6, "GPa": 1000.0, "kPa": 1e-3, "kg/m3": 1e-12, "": 1.0, "um": 1e-3, "mm": 1.0, "1/s": 1.0}
    if isinstance(text, (int, float)):
        return float(text)
    value, _, unit = text.partition(" ")
    return float(value) * units[unit]


def card(film, *more):
    """The keywords of the card that droptower writes of a film."""
    out = Path("card.k")
    command = [DROPTOWER, "--quiet", "export", "card", str(film), "--for", "ls-dyna", "-o", str(out), "--force", *more]
    subprocess.run(command, check=True)
    deck = Deck()
    deck.loads(out.read_text())
    unread = [keyword for keyword in deck.all_keywords if isinstance(keyword, str)]
    assert not unread, f"{film}: not read: {unread}"
    return deck


def only(deck, kind):
    found = [keyword for keyword in deck.all_keywords if type(keyword).__name__ == kind]
    assert len(found) == 1, f"{len(found)} keywords are {kind}"
    return found[0]


def same(what, found, expected):
    assert math.isclose(found, expected, rel_tol=1e-6, abs_tol=1e-12), f"{what}: {found}, expected {expected}"


def fields(keyword, **expected):
    for name, value in expected.items():
        same(f"{type(keyword).__name__} {name}", getattr(keyword, name), value)


def curve(deck, number_of_curve):
    """Points of a curve: abscissa, ordinate, with the scales of its head."""
    found = [
        keyword
        for keyword in deck.all_keywords
        if type(keyword).__name__ == "DefineCurve" and keyword.lcid == number_of_curve
    ]
    assert len(found) == 1, f"{len(found)} curves have the number {number_of_curve}"
    head = found[0]
    assert (head.sfa, head.sfo, head.offa, head.offo) == (1.0, 1.0, 0.0, 0.0)
    return [(float(row["a1"]), float(row["o1"])) for _, row in head.curves.iterrows()]


def points(what, found, expected):
    assert len(found) == len(expected), f"{what}: {found}, expected {expected}"
    for got, wanted in zip(found, expected, strict=True):
        for value, other in zip(got, wanted, strict=True):
            same(what, value, other)


def elastic(film):
    law = film["elastic"]
    fields(only(card("elastic.toml"), "MatElastic"), ro=number(film["density"]), e=number(law["young"]), pr=law["poisson"])


def rubber(name, film, kind, **constants):
    fields(only(card(f"{name}.toml", "--poisson", "0.4995"), kind), ro=number(film["density"]), n=0, pr=0.4995, **constants)


def plastic(film):
    law = film["plastic"]
    deck = card("mises.toml")
    keyword = only(deck, "MatPiecewiseLinearPlasticity")
    flow = [(strain, number(stress)) for strain, stress in law["hardening"]["curve"]]
    fields(keyword, ro=number(film["density"]), e=number(law["young"]), pr=law["poisson"], sigy=flow[0][1])
    points("flow curve", curve(deck, keyword.lcss), flow)


def fabric():
    """Engineering strain and nominal stress of fibres with multipliers of one: the curves of the material file."""
    text = """
name = "film"
density = "915 kg/m3"
thickness = "12 um"
[fabric]
absorption = 0.75
md = { curve = [[0.26, "8.4 MPa"], [0.84, "20 MPa"], [1.39, "29.3 MPa"]] }
td = { curve = [[0.33, "8 MPa"], [0.69, "10 MPa"], [7.01, "16.2 MPa"]] }
shear = { curve = [[0.27, "4.73 MPa"], [0.8, "8.66 MPa"]] }
"""
    Path("fabric.toml").write_text(text)
    law = tomllib.loads(text)["fabric"]
    deck = card("fabric.toml")
    keyword = only(deck, "MatFabric")
    expected = {
        name: [(0.0, 0.0)] + [(strain, number(stress)) for strain, stress in law[name]["curve"]]
        for name in ("md", "td", "shear")
    }
    slope = {
        name: max((y - b) / (x - a) for (a, b), (x, y) in zip(rows, rows[1:], strict=False))
        for name, rows in expected.items()
    }
    fields(keyword, ro=915e-12, form=-14, h=0.75, ea=slope["md"], eb=slope["td"], gab=slope["shear"], cse=1.0, aopt=2.0)
    for name, number_of_curve in (("md", keyword.lca), ("td", keyword.lcb), ("shear", keyword.lcab)):
        # Shear to both sides.
        negative = [(-x, -y) for x, y in expected[name][:0:-1]] if name == "shear" else []
        points(name, curve(deck, number_of_curve), negative + expected[name])
    # Unloading curves in place of the hysteresis: from 0.5 back to the strain that remains.
    deck = card("fabric.toml", "--unloading-from", "0.5")
    keyword = only(deck, "MatFabric")
    fields(keyword, form=14)
    for loading, unloading in ((keyword.lca, keyword.lcua), (keyword.lcb, keyword.lcub)):
        top = curve(deck, unloading)[-1]
        rows = curve(deck, loading)
        (a, b), (x, y) = next(pair for pair in zip(rows, rows[1:], strict=False) if pair[1][0] >= 0.5)
        same("top of unloading", top[0], 0.5)
        same("top of unloading", top[1], b + (y - b) * (0.5 - a) / (x - a))
        down = curve(deck, unloading)
        assert top in rows and all(p[1] < q[1] for p, q in zip(down, down[1:], strict=False)), f"{down} and {rows}"


def main():
    films = {name: tomllib.loads(Path(f"{name}.toml").read_text()) for name in
             ("elastic", "neo-hookean", "mooney-rivlin", "yeoh", "ogden", "mises")}
    elastic(films["elastic"])
    law = films["ogden"]["hyperelastic"]
    terms = {f"mu{place}": number(mu) for place, mu in enumerate(law["mu"], 1)}
    terms |= {f"alpha{place}": alpha for place, alpha in enumerate(law["alpha"], 1)}
    rubber("ogden", films["ogden"], "MatOgdenRubber", **terms)
    law = films["neo-hookean"]["hyperelastic"]
    none = dict.fromkeys(("c01", "c11", "c20", "c02", "c30"), 0.0)
    rubber("neo-hookean", films["neo-hookean"], "MatHyperelasticRubber", **{**none, "c10": number(law["mu"]) / 2})
    law = films["mooney-rivlin"]["hyperelastic"]
    both = {"c10": number(law["c10"]), "c01": number(law["c01"])}
    rubber("mooney-rivlin", films["mooney-rivlin"], "MatHyperelasticRubber", **{**none, **both})
    law = films["yeoh"]["hyperelastic"]
    three = {name: number(law[name]) for name in ("c10", "c20", "c30")}
    rubber("yeoh", films["yeoh"], "MatHyperelasticRubber", **{**none, **three})
    plastic(films["mises"])
    fabric()


if __name__ == "__main__":
    main()
