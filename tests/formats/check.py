"""Checks results of droptower in the formats of others, with the readers of others."""

import sys
import xml.etree.ElementTree as xml
from pathlib import Path

import numpy
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import VTK_LINE
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader


def numbers(array):
    return None if array is None else vtk_to_numpy(array)


def arrays(data):
    return {data.GetArrayName(place): numbers(data.GetArray(place)) for place in range(data.GetNumberOfArrays())}


def grid(found):
    """Points, corners, kinds of cells and all arrays of an unstructured grid of VTK."""
    cells = found.GetCells()
    return {
        "points": numbers(found.GetPoints().GetData()) if found.GetNumberOfPoints() else numpy.zeros((0, 3)),
        "connectivity": numbers(cells.GetConnectivityArray()),
        "offsets": numbers(cells.GetOffsetsArray()),
        "types": numpy.array([found.GetCellType(cell) for cell in range(found.GetNumberOfCells())]),
        **{f"point {name}": values for name, values in arrays(found.GetPointData()).items()},
        **{f"cell {name}": values for name, values in arrays(found.GetCellData()).items()},
    }


def of_series(folder, name):
    """Times and grids of a .pvd."""
    for state in xml.parse(folder / f"{name}.pvd").getroot().iter("DataSet"):
        path = folder / state.attrib["file"]
        reader = vtkXMLUnstructuredGridReader()
        reader.SetFileName(str(path))
        reader.Update()
        assert reader.GetErrorCode() == 0, path
        yield float(state.attrib["timestep"]), grid(reader.GetOutput())


def check_series(folder, name):
    """VTK reads every state of a .pvd: those with cells have the arrays of the first, a value for each point or cell."""
    states = [found for _, found in of_series(folder, name)]
    shown = [found for found in states if len(found["types"])]
    assert shown and shown[0] is states[0], f"{folder}/{name}.pvd begins without cells"
    for state, found in enumerate(shown):
        assert found.keys() == shown[0].keys(), f"{folder}/{name}.pvd, state {state}: {found.keys() ^ shown[0].keys()}"
        for key, values in found.items():
            count = {"point": "points", "cell": "types"}.get(key.split()[0])
            assert count is None or len(values) == len(found[count]), f"{folder}/{name}.pvd, state {state}, {key}"
    print(f"  {folder.name}/{name}.pvd: {len(shown)} of {len(states)} states with cells")


def main():
    results = Path(sys.argv[1])
    for run, parts in {
        "drop": ["film", "impactor"],
        "bars": ["film", "impactor", "frame"],
        "springs": ["film", "springs", "impactor"],
        "tear": ["film"],
        "rupture": ["film"],
    }.items():
        for name in parts:
            check_series(results / run, name)
    for time, lines in of_series(results / "springs", "springs"):
        assert len(lines["types"]) == 80 and (lines["types"] == VTK_LINE).all(), time
        ends = lines["points"][lines["connectivity"]].reshape(-1, 2, 3)
        lengths = numpy.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
        assert numpy.allclose(lengths - lines["cell elongation_m"], 0.18, rtol=0.0, atol=1e-6), time
    print("formats: read by VTK as droptower means them")


if __name__ == "__main__":
    main()
