"""The program: where it is, and how it is called."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import sysconfig
import threading
from collections.abc import Sequence
from pathlib import Path
from typing import TextIO

from .errors import Diagnostic, ProgramNotFound, error, is_record

VARIABLE = "DROPTOWER"
"""Names another program than the one that belongs to this package."""


def program() -> str:
    """Path of the program: that of `$DROPTOWER`, the one installed with this package, or one on the path.

    Raises ProgramNotFound.
    """
    given = os.environ.get(VARIABLE)
    name = "droptower.exe" if os.name == "nt" else "droptower"
    beside = [Path(sysconfig.get_path("scripts", scheme)) / name for scheme in _schemes()]
    candidates = [given] if given else [*map(str, beside), shutil.which("droptower")]
    for candidate in candidates:
        if candidate and Path(candidate).is_file():
            return candidate
    if given:
        raise ProgramNotFound([Diagnostic(f"there is no program {given}", f"correct ${VARIABLE}")])
    raise ProgramNotFound([Diagnostic("there is no program droptower", "pip install droptower")])


def _schemes() -> list[str]:
    """Where pip puts programs: in this environment, and for this user."""
    return [sysconfig.get_default_scheme(), sysconfig.get_preferred_scheme("user")]


def version() -> str:
    """Version of the program."""
    return call(["--version"]).split()[-1]


def call(arguments: Sequence[str], *, quiet: bool = True, cwd: str | os.PathLike[str] | None = None) -> str:
    """What the program prints on standard output.

    What it tells meanwhile is shown on standard error as it comes, unless `quiet`. Raises DroptowerError if it fails.
    """
    command = [program(), *arguments, "--diagnostics", "json"]
    if quiet and "--version" not in arguments:
        command.append("--quiet")
    process = subprocess.Popen(
        command,
        cwd=cwd,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        encoding="utf-8",
        errors="replace",
    )
    assert process.stdout is not None and process.stderr is not None
    told: list[str] = []
    listener = threading.Thread(target=_listen, args=(process.stderr, told, quiet), daemon=True)
    listener.start()
    try:
        printed = process.stdout.read()
        process.wait()
    except BaseException:
        # An interrupt ends the program too.
        process.terminate()
        process.wait()
        raise
    finally:
        listener.join()
        process.stdout.close()
        process.stderr.close()
    if process.returncode != 0:
        raise error(process.returncode, "".join(told), printed)
    return printed


def _listen(stream: TextIO, told: list[str], quiet: bool) -> None:
    """Keeps what the program tells, and shows it as it comes, but for the mistakes that an exception will hold."""
    for line in stream:
        told.append(line)
        if not quiet and not is_record(line):
            print(line, end="", file=sys.stderr, flush=True)
