"""The film over time as arrays, from the files for ParaView."""

from __future__ import annotations

import os
import xml.etree.ElementTree as xml
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy
from numpy.typing import NDArray

Array = NDArray[Any]


@dataclass(frozen=True)
class State:
    """The film at one time."""

    time: float
    """s."""
    points: Array
    """Coordinates of the nodes, m, shape (nodes, 3)."""
    cells: dict[str, Array]
    """Nodes of the elements, by kind ("quad", "triangle")."""
    point_data: dict[str, Array]
    """Values at the nodes by name, SI."""
    cell_data: dict[str, Array]
    """Values of the elements by name, SI; elements in the order of `cells`."""


class States:
    """The states of a run in their order: `len(states)`, `states[-1]`, `for state in states`."""

    def __init__(self, run: str | os.PathLike[str]) -> None:
        series = Path(run) / "film.pvd"
        if not series.is_file():
            raise FileNotFoundError(f"{series} is missing: run the scenario with vtu=True")
        sets = xml.parse(series).getroot().iter("DataSet")
        self._files = [(float(one.attrib["timestep"]), series.parent / one.attrib["file"]) for one in sets]

    def __len__(self) -> int:
        return len(self._files)

    def __iter__(self) -> Iterator[State]:
        return (self[place] for place in range(len(self)))

    @cached_property
    def times(self) -> Array:
        """Times of the states, s."""
        return numpy.array([time for time, _ in self._files])

    def at(self, time: float) -> State:
        """The state nearest to a time, s."""
        return self[int(numpy.abs(self.times - time).argmin())]

    def __getitem__(self, place: int) -> State:
        time, path = self._files[place]
        if _nothing_left(path):
            return State(time, numpy.zeros((0, 3)), {}, {}, {})
        import meshio

        mesh = meshio.read(path)
        cells: dict[str, list[Array]] = {}
        for block in mesh.cells:
            cells.setdefault(block.type, []).append(block.data)
        joined = {kind: numpy.concatenate(blocks) for kind, blocks in cells.items()}
        cell_data = {name: numpy.concatenate(blocks) for name, blocks in mesh.cell_data.items()}
        return State(time, numpy.asarray(mesh.points), joined, dict(mesh.point_data), cell_data)


def _nothing_left(path: Path) -> bool:
    """Whether no element is left in a state, which meshio does not read."""
    with path.open("rb") as file:
        return b'NumberOfCells="0"' in file.read(1000)
