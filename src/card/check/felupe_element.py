"""One element of film in FElupe: reads element.json, writes result.csv (nominal stresses along and across).

Written by droptower. Packages: felupe, tensortrax.
"""

import csv
import json

import felupe
from felupe.constitution.tensortrax import Hyperelastic
from felupe.constitution.tensortrax.models import hyperelastic


def material(law, bulk):
    """The film; rubber with a bulk modulus, since the element is a solid."""
    constants = {name: value for name, value in law.items() if name != "name"}
    film = Hyperelastic(getattr(hyperelastic, law["name"]), **constants)
    return film & felupe.Volumetric(bulk=bulk) if bulk else film


def pulled(film, path, stretches):
    """Nominal stresses along and across, a row a stretch: a cube of side one, of which each plane x, y, z = 0 is held."""
    region = felupe.RegionHexahedron(felupe.Cube(n=2))
    field = felupe.FieldContainer([felupe.Field(region, dim=3)])
    solid = felupe.SolidBody(umat=film, field=field)
    bounds = {
        name: felupe.Boundary(field[0], skip=tuple(int(axis != held) for axis in range(3)), **{f"f{name}": 0})
        for held, name in enumerate(["x", "y", "z"])
    }
    bounds["along"] = felupe.Boundary(field[0], fx=1, skip=(0, 1, 1))
    if path != "uniaxial":
        bounds["across"] = felupe.Boundary(field[0], fy=1, skip=(1, 0, 1))
    boundaries = felupe.BoundaryDict(bounds)
    steps = {boundaries["along"]: [stretch - 1 for stretch in stretches]}
    if path != "uniaxial":
        steps[boundaries["across"]] = [stretch - 1 if path == "equibiaxial" else 0.0 for stretch in stretches]
    rows = []
    for substep in felupe.Step(items=[solid], ramp=steps, boundaries=boundaries).generate(x0=field, verbose=0):
        # Forces that the held planes take are those on the moved ones, with the other sign.
        forces = substep.fun.reshape(-1, 3)
        points = region.mesh.points
        rows.append([float(forces[points[:, axis] == 1, axis].sum()) for axis in range(2)])
    return rows


def main():
    with open("element.json", encoding="utf-8") as file:
        element = json.load(file)
    film = material(element["law"], element["bulk"])
    with open("result.csv", "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(["path", "stretch", "along", "across"])
        for path in element["paths"]:
            for stretch, row in zip(path["stretches"], pulled(film, path["name"], path["stretches"]), strict=True):
                table.writerow([path["name"], stretch, *row])


if __name__ == "__main__":
    main()
