"""Why droptower gives no results."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Diagnostic:
    """A mistake: what, where, and what to write instead."""

    message: str
    hint: str | None = None
    source: str | None = None
    """The file, or the argument."""
    line: int | None = None
    """Counted from one."""
    column: int | None = None
    """Counted from one."""

    def __str__(self) -> str:
        place = f"{self.source}:{self.line}:{self.column}: " if self.source else ""
        hint = f" ({self.hint})" if self.hint else ""
        return f"{place}{self.message}{hint}"


class DroptowerError(Exception):
    """droptower failed; `diagnostics` tell why."""

    def __init__(self, diagnostics: list[Diagnostic], text: str = "") -> None:
        self.diagnostics = diagnostics
        """The mistakes, all that were found."""
        self.text = text
        """What the program told besides."""
        self.printed = ""
        """What the program printed on standard output: figures as JSON, where it came to any."""
        super().__init__("\n".join(str(diagnostic) for diagnostic in diagnostics) or text.strip())


class ProgramNotFound(DroptowerError):
    """There is no program droptower."""


class Failed(DroptowerError):
    """Results could not be written, runs are missing, or a test failed (exit status 1)."""


class BadInput(DroptowerError):
    """A mistake in a scenario, a script or the arguments; nothing was written (exit status 2)."""


class NumericalFailure(DroptowerError):
    """A run failed numerically; what was computed until then is kept (exit status 3)."""


BY_STATUS: dict[int, type[DroptowerError]] = {1: Failed, 2: BadInput, 3: NumericalFailure}


def error(status: int, told: str, printed: str = "") -> DroptowerError:
    """The exception of an exit status, of what was told on standard error and printed on standard output."""
    diagnostics: list[Diagnostic] = []
    others: list[str] = []
    for line in told.splitlines():
        record = _record(line)
        if record is None:
            others.append(line)
        else:
            fields = ("message", "hint", "source", "line", "column")
            diagnostics.append(Diagnostic(**{name: record[name] for name in fields if name in record}))
    raised = BY_STATUS.get(status, DroptowerError)(diagnostics, "\n".join(others))
    raised.printed = printed
    return raised


def is_record(line: str) -> bool:
    """Whether a line tells a mistake as a record."""
    return _record(line) is not None


def _record(line: str) -> dict[str, Any] | None:
    """The record of a mistake, where the line is one."""
    if not line.startswith("{"):
        return None
    try:
        record: dict[str, Any] = json.loads(line)
    except ValueError:
        return None
    return record if "message" in record and "labels" in record else None
