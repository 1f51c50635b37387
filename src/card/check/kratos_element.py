"""One membrane element of film in Kratos: reads element.json and the card, film.json; writes result.csv.

Nominal stresses along and across. Written by droptower. Packages: KratosMultiphysics,
KratosStructuralMechanicsApplication.
"""

import csv
import json

import KratosMultiphysics as kratos
import KratosMultiphysics.StructuralMechanicsApplication  # noqa: F401 (registers elements and laws)

CORNERS = [(0, 0), (1, 0), (1, 1), (0, 1)]
DIRECTIONS = [
    (kratos.DISPLACEMENT_X, kratos.REACTION_X),
    (kratos.DISPLACEMENT_Y, kratos.REACTION_Y),
    (kratos.DISPLACEMENT_Z, kratos.REACTION_Z),
]


def square(model, name):
    """A square of side one of the film of the card."""
    part = model.CreateModelPart("Structure")
    part.ProcessInfo[kratos.DOMAIN_SIZE] = 3
    part.SetBufferSize(2)
    for variable in (kratos.DISPLACEMENT, kratos.REACTION, kratos.VOLUME_ACCELERATION):
        part.AddNodalSolutionStepVariable(variable)
    settings = {"Parameters": {"materials_filename": name}}
    for index, (x, y) in enumerate(CORNERS, 1):
        part.CreateNewNode(index, float(x), float(y), 0.0)
    with open(name, encoding="utf-8") as file:
        number = json.load(file)["properties"][0]["properties_id"]
    properties = part.CreateNewProperties(number)
    part.CreateNewElement("MembraneElement3D4N", 1, [1, 2, 3, 4], properties)
    kratos.ReadMaterialsUtility(kratos.Parameters(json.dumps(settings)), model)
    for node in part.Nodes:
        for moved, reaction in DIRECTIONS:
            node.AddDof(moved, reaction)
    return part, properties[kratos.THICKNESS]


def strategy(part):
    """Newton's method."""
    scheme = kratos.ResidualBasedIncrementalUpdateStaticScheme()
    criterion = kratos.ResidualCriteria(1e-10, 1e-14)
    criterion.SetEchoLevel(0)
    builder = kratos.ResidualBasedBlockBuilderAndSolver(kratos.SkylineLUFactorizationSolver())
    found = kratos.ResidualBasedNewtonRaphsonStrategy(part, scheme, criterion, builder, 50, True, False, True)
    found.SetEchoLevel(0)
    return found


def pulled(path, stretches):
    """Nominal stresses along and across, a row a stretch."""
    part, thickness = square(kratos.Model(), "film.json")
    for node in part.Nodes:
        node.Fix(kratos.DISPLACEMENT_Z)
        node.Fix(kratos.DISPLACEMENT_X)
        if node.Y0 == 0 or path != "uniaxial":
            node.Fix(kratos.DISPLACEMENT_Y)
    solver = strategy(part)
    solver.Initialize()
    rows = []
    for step, stretch in enumerate(stretches, 1):
        part.CloneTimeStep(float(step))
        across = stretch - 1 if path == "equibiaxial" else 0.0
        for node in part.Nodes:
            node.SetSolutionStepValue(kratos.DISPLACEMENT_X, (stretch - 1) * node.X0)
            if path != "uniaxial":
                node.SetSolutionStepValue(kratos.DISPLACEMENT_Y, across * node.Y0)
        solver.InitializeSolutionStep()
        solver.Predict()
        if not solver.SolveSolutionStep():
            raise SystemExit(f"no equilibrium at the stretch {stretch} ({path})")
        solver.FinalizeSolutionStep()
        moved = [[node for node in part.Nodes if node.X0 == 1], [node for node in part.Nodes if node.Y0 == 1]]
        rows.append(
            [
                sum(node.GetSolutionStepValue(reaction) for node in nodes) / thickness
                for nodes, (_, reaction) in zip(moved, DIRECTIONS, strict=False)
            ]
        )
    return rows


def main():
    kratos.Logger.GetDefaultOutput().SetSeverity(kratos.Logger.Severity.WARNING)
    with open("element.json", encoding="utf-8") as file:
        element = json.load(file)
    with open("result.csv", "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(["path", "stretch", "along", "across"])
        for path in element["paths"]:
            for stretch, row in zip(path["stretches"], pulled(path["name"], path["stretches"]), strict=True):
                table.writerow([path["name"], stretch, *row])


if __name__ == "__main__":
    main()
