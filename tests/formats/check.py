"""Checks results of droptower in the formats of others, with the readers of others."""

import sys
import xml.etree.ElementTree as xml
from pathlib import Path

import h5py
import numpy
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import VTK_LINE
from vtkmodules.vtkIOHDF import vtkHDFReader
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


def check_states(folder, name):
    """Every state of a .vtkhdf as VTK reads it is that of the series."""
    path = folder / f"{name}.vtkhdf"
    reader = vtkHDFReader()
    assert reader.CanReadFile(str(path)), path
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    series = list(of_series(folder, name))
    assert reader.GetNumberOfSteps() == len(series), path
    times = reader.GetOutputInformation(0).Get(reader.GetExecutive().TIME_STEPS())
    assert list(times) == [time for time, _ in series], path
    shown = 0
    for step, (time, expected) in enumerate(series):
        reader.SetStep(step)
        reader.Update()
        assert reader.GetTimeValue() == time, path
        found = grid(reader.GetOutput())
        if not len(expected["types"]):
            assert not len(found["types"]), f"{path}, state {step}: cells"
            continue
        shown += 1
        assert found.keys() == expected.keys(), f"{path}, state {step}: {found.keys() ^ expected.keys()}"
        for key, values in expected.items():
            assert found[key].shape == values.shape, f"{path}, state {step}, {key}"
            assert numpy.array_equal(found[key], values, equal_nan=values.dtype.kind == "f"), f"{path}, {step}, {key}"
    with h5py.File(path) as file:
        root = file["VTKHDF"]
        assert root.attrs["Type"] == b"UnstructuredGrid" and list(root.attrs["Version"]) == [2, 2], path
        kind = root.attrs.get_id("Type").get_type()
        assert not kind.is_variable_str() and kind.get_cset() == h5py.h5t.CSET_ASCII, path
        meshes = len(root["NumberOfCells"])
    size = sum(state.stat().st_size for state in folder.glob(f"vtu/{name}_*.vtu"))
    print(f"  {path.parent.name}/{path.name}: {shown} states, {meshes} meshes, {path.stat().st_size} bytes of {size}")
    return meshes


def main():
    results = Path(sys.argv[1])
    for run, parts in {
        "drop": ["film", "impactor"],
        "bars": ["film", "impactor", "frame"],
        "springs": ["film", "springs", "impactor"],
        "tear": ["film"],
        "rupture": ["film"],
    }.items():
        found = {name: check_states(results / run, name) for name in parts}
        assert found.get("impactor", 1) == found.get("springs", 1) == 1, "rigid bodies and springs have one mesh"
    for time, lines in of_series(results / "springs", "springs"):
        assert len(lines["types"]) == 80 and (lines["types"] == VTK_LINE).all(), time
        ends = lines["points"][lines["connectivity"]].reshape(-1, 2, 3)
        lengths = numpy.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
        assert numpy.allclose(lengths - lines["cell elongation_m"], 0.18, rtol=0.0, atol=1e-6), time
    print("formats: read by VTK and h5py as droptower means them")


if __name__ == "__main__":
    main()
