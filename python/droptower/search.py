"""Searches whose objective is a Python function of a run."""

from __future__ import annotations

import functools
import hashlib
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy
import pandas

from .commands import PathLike, _changes, run
from .errors import BadInput, NumericalFailure
from .results import Run


@dataclass(frozen=True)
class Search:
    """The result of `minimize`."""

    values: dict[str, float]
    """The best value of each parameter, SI."""
    value: float
    """The objective there; of residuals, the sum of their squares."""
    run: Run
    """The run with these values."""
    trials: pandas.DataFrame
    """A row for each trial in order: the parameters, `value`, and `path`, the folder of its run (none if it failed)."""
    converged: bool
    """Whether the search ended at a minimum within the bounds."""
    message: str
    """Why it ended."""


class _Enough(Exception):
    """The trials are used up."""


def minimize(
    scenario: PathLike,
    objective: Callable[[Run], float | Sequence[float]],
    parameters: Mapping[str, tuple[float, float]],
    set: Mapping[str, Any] | None = None,
    *,
    unset: Iterable[str] = (),
    start: Mapping[str, float] | None = None,
    tolerance: float = 1e-3,
    trials: int = 200,
    out: PathLike | None = None,
    threads: int | None = None,
    quiet: bool = True,
    **options: Any,
) -> Search:
    """Finds the values of keys for which `objective`, a function of a run, is least.

    `parameters` maps each key to its bounds, SI. The search begins at `start`, elsewhere in the middle of the bounds,
    and ends when it moves by less than `tolerance` of their distance, or after so many `trials`. Where the objective
    gives a sequence, the search minimizes the sum of its squares (scipy.optimize.least_squares), else the number itself
    (Nelder-Mead of scipy.optimize.minimize); `options` go there. A run that fails counts as infinite beside numbers;
    beside residuals it raises NumericalFailure.

    Runs are kept in `out`, or in runs/<file of the scenario>.search: a search that is repeated, with another objective
    too, computes none of them again.
    """
    try:
        from scipy import optimize
    except ImportError:
        raise ImportError("droptower.minimize needs SciPy: pip install scipy") from None
    low, high, first = _box(parameters, start or {})
    unset = tuple(unset)
    folder = Path(out) if out is not None else Path("runs") / f"{Path(scenario).stem}.search"
    rows: list[dict[str, Any]] = []
    sizes: list[int | None] = []  # of the residuals of each trial, None of a number

    @functools.cache
    def at(point: tuple[float, ...]) -> Any:
        if len(rows) >= trials:
            raise _Enough
        # A search moves between 1 and 2, where relative and absolute steps are alike.
        values = dict(zip(parameters, (low + (numpy.array(point) - 1) * (high - low)).tolist(), strict=True))
        found: Any = numpy.inf
        path = None
        try:
            result = _stored_run(scenario, {**(set or {}), **values}, unset, folder, threads)
            path = result.path
            found = numpy.asarray(objective(result), dtype=float)
            sizes.append(None if found.ndim == 0 else found.size)
            if sizes[-1] != sizes[0] or found.ndim > 1 or not _is_allowed(found):
                raise ValueError(f"the objective must be a number, or as many finite residuals as before: {found}")
        except NumericalFailure:
            if not sizes or sizes[0] is not None:
                raise
        value = float(numpy.sum(found**2) if numpy.ndim(found) else found)
        rows.append({**values, "value": value, "path": path})
        if not quiet:
            told = ", ".join(f"{name} {number:.5g}" for name, number in values.items())
            print(f"trial {len(rows)}: {told}: {value:.6g}", file=sys.stderr, flush=True)
        return found

    def function(point: Any) -> Any:
        return at(tuple(point.tolist()))

    converged, message = False, f"all {trials} trials are used up"
    try:
        if numpy.ndim(function(first)):
            given = {"xtol": tolerance, "ftol": tolerance**2, "diff_step": 1e-3, **options}
            ended = optimize.least_squares(function, first, bounds=(1, 2), **given)
        else:
            given = {"xatol": tolerance, "fatol": numpy.inf, **options}
            ended = optimize.minimize(
                function, first, method="Nelder-Mead", bounds=[(1, 2)] * len(first), options=given
            )
        converged, message = bool(ended.success), str(ended.message)
    except _Enough:
        pass
    best = min(rows, key=lambda row: float(row["value"]))
    values = {name: float(best[name]) for name in parameters}
    near = tolerance * (high - low)
    on_bound = [name for i, name in enumerate(values) if not low[i] + near[i] < values[name] < high[i] - near[i]]
    if on_bound:
        converged, message = False, f"on a bound: {', '.join(on_bound)}"
    return Search(values, best["value"], Run(best["path"]), pandas.DataFrame(rows), converged, message)


def _box(parameters: Mapping[str, tuple[float, float]], start: Mapping[str, float]) -> tuple[Any, Any, Any]:
    """Lower and upper bounds, and the start between 1 and 2."""
    low, high = numpy.array(list(parameters.values()), dtype=float).reshape(-1, 2).T
    if not low.size or not numpy.all(low < high):
        raise ValueError('parameters must map keys to bounds, such as {"impactor.mass": (9, 12)}')
    unknown = [name for name in start if name not in parameters]
    if unknown:
        raise ValueError(f"start: {', '.join(unknown)} has no bounds in parameters")
    middle = dict(zip(parameters, (0.5 * (low + high)).tolist(), strict=True))
    first = (numpy.array([start.get(name, value) for name, value in middle.items()]) - low) / (high - low)
    if not numpy.all((first >= 0) & (first <= 1)):
        raise ValueError("start must lie within the bounds")
    return low, high, 1 + first


def _is_allowed(found: Any) -> bool:
    """Whether a search can use this: a number may be infinite, which is worse than all others."""
    return bool(not numpy.isnan(found) and found > -numpy.inf if found.ndim == 0 else numpy.isfinite(found).all())


def _stored_run(
    scenario: PathLike, set: Mapping[str, Any], unset: tuple[str, ...], folder: Path, threads: int | None
) -> Run:
    """The run with these changes; computed where the folder of that name does not hold it as its files are now."""
    name = hashlib.sha256("\0".join(_changes(set, unset)).encode()).hexdigest()[:16]
    place = folder / name
    if (place / "summary.json").is_file():
        try:
            return run(scenario, set, unset=unset, out=place, resume=True, threads=threads)
        except BadInput:
            pass  # its files have changed, or they have a mistake that is found again
    return run(scenario, set, unset=unset, out=place, threads=threads)
