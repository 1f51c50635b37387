"""What droptower wrote, read back: folders of runs, sweeps, studies and comparisons."""

from __future__ import annotations

import html
import json
import os
import re
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pandas

from .states import States

if TYPE_CHECKING:
    import polars

PathLike = str | os.PathLike[str]


class Figures:
    """Figures by name, which are attributes too: `figures.peak_acceleration_m_s2`."""

    summary: dict[str, Any]
    """All figures in SI units, the unit at the end of the name."""

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_") or name in ("path", "summary"):
            raise AttributeError(name)
        try:
            return self.summary[name]
        except KeyError:
            raise AttributeError(f"{self!r} has no figure {name}") from None

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *(name for name in self.summary if name.isidentifier())})

    @cached_property
    def findings(self) -> pandas.DataFrame:
        """Warnings and notes: code, severity, message and figures."""
        return pandas.DataFrame(self.summary.get("findings", []))


class Reduction(Figures):
    """What recordings give."""

    def __init__(self, summary: dict[str, Any], out: Path | None) -> None:
        self.summary = summary
        """Everything that the command prints with `--json`."""
        self.path = out
        """The file of the option `out`: signals of a drop, a material of coupons."""

    def __repr__(self) -> str:
        return f"Reduction({', '.join(self.summary)})"

    @cached_property
    def table(self) -> pandas.DataFrame:
        """A row for each drop, direction of coupons, bulge or wide coupon; `table.to_xarray()` is a Dataset.

        Fields of fields, and both ends of an interval, are columns: `young_modulus_Pa.mean`,
        `energy_absorption_interval.low`.
        """
        lists = (self.summary.get(name) for name in ("directions", "tests", "recordings"))
        rows: list[dict[str, Any]] = next((rows for rows in lists if isinstance(rows, list)), [self.summary])
        return pandas.json_normalize([{name: _ends(name, value) for name, value in row.items()} for row in rows])

    @cached_property
    def signals(self) -> pandas.DataFrame:
        """The signals of a drop from contact on, which `out` names."""
        if self.path is None or self.path.suffix != ".csv":
            raise FileNotFoundError('no signals were written: reduce a drop with out="drop.csv"')
        return pandas.read_csv(self.path, comment="#")


def _ends(name: str, value: Any) -> Any:
    """Both ends of an interval by name; other values as they are."""
    is_interval = "_interval" in name and isinstance(value, list) and len(value) == 2
    return dict(zip(("low", "high"), value, strict=True)) if is_interval else value


class Results(Figures):
    """A folder of results. Figures of `summary.json` are attributes: `results.peak_acceleration_m_s2`."""

    def __init__(self, path: PathLike) -> None:
        self.path = Path(path)
        """The folder."""
        if not (self.path / "summary.json").is_file():
            raise FileNotFoundError(f"{self.path} holds no results of droptower: summary.json is missing")

    @cached_property
    def summary(self) -> dict[str, Any]:  # type: ignore[override]
        """Everything in `summary.json`; figures in SI units, the unit at the end of the name."""
        summary: dict[str, Any] = json.loads((self.path / "summary.json").read_text(encoding="utf-8"))
        return summary

    def __repr__(self) -> str:
        return f"{type(self).__name__}({str(self.path)!r})"

    @property
    def report(self) -> Path:
        """The page, which any browser opens."""
        return self.path / "report.html"

    @property
    def tables(self) -> dict[str, pandas.DataFrame]:
        """The tables of scripts by name."""
        return {path.stem: pandas.read_csv(path) for path in sorted((self.path / "tables").glob("*.csv"))}

    def polars(self, name: str) -> polars.DataFrame:
        """A table as a frame of Polars: "signals", "energies", "table", or one of `tables`."""
        import polars

        own = self.path / f"{name}.csv"
        return polars.read_csv(own if own.is_file() else self.path / "tables" / f"{name}.csv", comment_prefix="#")

    def _read(self, name: str) -> pandas.DataFrame:
        return pandas.read_csv(self.path / name, comment="#")

    def _figures(self) -> list[tuple[str, str]]:
        """Figures as text, for notebooks."""
        plain = ((name, value) for name, value in self.summary.items() if isinstance(value, (bool, int, float)))
        return [(name, str(value) if isinstance(value, (bool, int)) else f"{value:.6g}") for name, value in plain]

    def _repr_html_(self) -> str:
        rows = "".join(f"<tr><th>{html.escape(name)}</th><td>{value}</td></tr>" for name, value in self._figures())
        title = html.escape(str(self.summary.get("title") or self.path))
        return f"<h4>{title}</h4>{self._pictures()}<table>{rows}</table>"

    def _pictures(self) -> str:
        return ""


class Run(Results):
    """The folder of a run."""

    @cached_property
    def signals(self) -> pandas.DataFrame:
        """Signals over time, SI; `time_s` and a column for each channel."""
        return self._read("signals.csv")

    @cached_property
    def energies(self) -> pandas.DataFrame:
        """The energy balance over time, J."""
        return self._read("energies.csv")

    @property
    def scenario(self) -> str:
        """The scenario with everything that it extends, as TOML."""
        return (self.path / "scenario.toml").read_text(encoding="utf-8")

    @cached_property
    def states(self) -> States:
        """The film over time as arrays; of runs with `vtu=True`."""
        return States(self.path)

    def plot(self, *columns: str) -> Any:
        """Signals over time as a figure of matplotlib: those of the names, or what the kind of run is about."""
        from .plots import signals

        return signals(self, columns or self._columns())

    def _columns(self) -> tuple[str, ...]:
        known = ("acceleration_filtered_m_s2", "displacement_m", "stress_Pa", "force_N", "pressure_Pa")
        found = tuple(name for name in known if name in self.signals.columns)
        return found[:2] or tuple(self.signals.columns[1:2])

    def _pictures(self) -> str:
        try:
            from .plots import signals, svg
        except ImportError:
            return ""
        return svg(signals(self, self._columns()))


class Sweep(Results):
    """The folder of a sweep."""

    @cached_property
    def table(self) -> pandas.DataFrame:
        """A row for each run: its inputs, figures, findings, and why it failed."""
        return self._read("table.csv")

    @property
    def statistics(self) -> pandas.DataFrame:
        """Mean, deviation and quantiles of each figure."""
        return pandas.DataFrame(self.summary["statistics"]).T

    @property
    def runs(self) -> dict[int, Run]:
        """The runs that have folders of their own (`keep`), by their number from one."""
        folder = self.path.with_name(f"{self.path.name}.runs")
        found = (path for path in folder.glob("*") if re.fullmatch(r"\d+", path.name))
        return {int(path.name): Run(path) for path in sorted(found, key=lambda path: int(path.name))}


class Study(Results):
    """The results of a script, or of a calibration: `tables["parameters"]` has the estimates with their intervals."""


class Comparison(Results):
    """Runs compared with the first of them."""

    @property
    def outside(self) -> list[dict[str, Any]]:
        """How far each run is outside of the bounds; empty without bounds."""
        outside: list[dict[str, Any]] = self.summary.get("outside", [])
        return outside
