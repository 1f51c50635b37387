"""Plots for notebooks, by matplotlib."""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from matplotlib.figure import Figure

if TYPE_CHECKING:
    from .results import Run


def signals(run: Run, columns: Sequence[str]) -> Figure:
    """Signals over time, one below the other."""
    figure = Figure(figsize=(6.4, 2.4 * len(columns)), layout="constrained")
    axes: Any = figure.subplots(len(columns), 1, sharex=True, squeeze=False)[:, 0]
    for axis, column in zip(axes, columns, strict=True):
        axis.plot(1e3 * run.signals["time_s"], run.signals[column])
        axis.set_ylabel(column)
        axis.grid(alpha=0.3)
    axes[-1].set_xlabel("time (ms)")
    return figure


def svg(figure: Figure) -> str:
    """The figure as SVG within a page."""
    text = io.StringIO()
    figure.savefig(text, format="svg", metadata={"Date": None})
    drawn = text.getvalue()
    return drawn[drawn.index("<svg") :]
