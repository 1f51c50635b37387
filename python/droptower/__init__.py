"""droptower from Python: runs scenarios by the program of the same name and reads what it writes.

>>> import droptower
>>> run = droptower.run("scenarios/drop/1008.toml", set={"layers.count": 9})
>>> run.peak_acceleration_m_s2
>>> run.signals.plot(x="time_s", y="displacement_m")
"""

from .commands import calibrate, check, compare, export_card, reduce, run, script, sweep, test
from .errors import BadInput, Diagnostic, DroptowerError, Failed, NumericalFailure, ProgramNotFound
from .program import program, version
from .results import Comparison, Reduction, Run, Study, Sweep
from .search import Search, minimize
from .states import States

__all__ = [
    "BadInput",
    "Comparison",
    "Diagnostic",
    "DroptowerError",
    "Failed",
    "NumericalFailure",
    "ProgramNotFound",
    "Reduction",
    "Run",
    "Search",
    "States",
    "Study",
    "Sweep",
    "calibrate",
    "check",
    "compare",
    "export_card",
    "minimize",
    "program",
    "reduce",
    "run",
    "script",
    "sweep",
    "test",
    "version",
]
