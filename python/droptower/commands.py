"""The commands: each calls the program and gives what it wrote."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import tomli_w

from .errors import Failed
from .program import call
from .results import Comparison, Reduction, Run, Study, Sweep

PathLike = str | os.PathLike[str]


def run(
    scenario: PathLike,
    set: Mapping[str, Any] | None = None,
    *,
    unset: Iterable[str] = (),
    out: PathLike | None = None,
    vtu: bool = False,
    resume: bool = False,
    force: bool = False,
    threads: int | None = None,
    quiet: bool = True,
) -> Run:
    """Runs a scenario.

    `set` changes keys: numbers (SI), texts with units ("12 um"), lists, dictionaries. `unset` leaves keys out. Results
    go to `out`, or to runs/<name of the scenario>; `vtu` also writes the states of the film (`Run.states`). `resume`
    leaves a complete run as it is, and goes on from the checkpoint of an interrupted one.
    """
    arguments = ["run", _path(scenario), *_changes(set, unset), *_options(out, force, threads)]
    if vtu:
        arguments.append("--vtu")
    if resume:
        arguments.append("--resume")
    summary = json.loads(call([*arguments, "--json"], quiet=quiet))
    return Run(_place(out, summary["scenario"]))


def sweep(
    scenario: PathLike,
    samples: int | None = None,
    set: Mapping[str, Any] | None = None,
    *,
    unset: Iterable[str] = (),
    out: PathLike | None = None,
    store: PathLike | None = None,
    keep: str | None = None,
    figure: str | None = None,
    merge: bool = False,
    force: bool = False,
    threads: int | None = None,
    quiet: bool = True,
) -> Sweep:
    """Runs a scenario many times with the values of its table [variation].

    Runs that were computed before are taken from the records in `store`. `keep` ("worst:3", "all", "4,17") also writes
    run folders (`Sweep.runs`); the worst have the largest `figure`. `merge` computes nothing and gathers what other
    processes have done. Runs that failed are rows of the table (`Sweep.table`), and raise NumericalFailure once it is
    written.
    """
    arguments = ["sweep", _path(scenario), *_changes(set, unset), *_options(out, force, threads)]
    given = {
        "-n": samples,
        "--store": store,
        "--keep": keep,
        "--figure": figure,
    }
    for name, value in given.items():
        if value is not None:
            arguments += [name, str(value)]
    if merge:
        arguments.append("--merge")
    summary = json.loads(call([*arguments, "--json"], quiet=quiet))
    return Sweep(_place(out, f"{summary['scenario']}.sweep"))


def script(
    path: PathLike,
    scenario: PathLike | None = None,
    args: Mapping[str, Any] | None = None,
    set: Mapping[str, Any] | None = None,
    *,
    unset: Iterable[str] = (),
    out: PathLike | None = None,
    force: bool = False,
    threads: int | None = None,
    quiet: bool = True,
) -> Study:
    """Runs a Rhai script; `args` are what it finds in `args`: numbers, texts, flags, lists of numbers."""
    arguments = ["script", _path(path), *_changes(set, unset), *_options(out, force, threads)]
    if scenario is not None:
        arguments += ["--scenario", _path(scenario)]
    for name, value in (args or {}).items():
        arguments += ["--arg", f"{name}={_argument(value)}"]
    summary = json.loads(call([*arguments, "--json"], quiet=quiet))
    return Study(_place(out, summary["script"]))


def calibrate(
    study: PathLike,
    set: Mapping[str, Any] | None = None,
    *,
    unset: Iterable[str] = (),
    out: PathLike | None = None,
    store: PathLike | None = None,
    force: bool = False,
    threads: int | None = None,
    quiet: bool = True,
) -> Study:
    """Fits the parameters of a study (a TOML file) to its tests; `set` and `unset` change keys of its scenarios."""
    arguments = ["calibrate", _path(study), *_changes(set, unset), *_options(out, force, threads)]
    if store is not None:
        arguments += ["--store", _path(store)]
    summary = json.loads(call([*arguments, "--json"], quiet=quiet))
    return Study(_place(out, summary["script"]))


def reduce(kind: str, *recordings: PathLike, quiet: bool = True, **options: Any) -> Reduction:
    """Reduces recordings of a `kind` of test: "drop", "coupon", "bulge" or "wide".

    Options have the names of the command's, with `_` for `-`: reduce("drop", "a.csv", mass="10.72 kg", height="1 m",
    out="a-drop.csv"). True is an option without a value, a tuple one with several, a list one that is repeated.
    """
    arguments = ["reduce", kind, *map(_path, recordings)]
    for name, value in options.items():
        option = f"--{name.replace('_', '-')}"
        for one in value if isinstance(value, list) else [value]:
            if one is None or one is False:
                continue
            values = () if one is True else one if isinstance(one, tuple) else (one,)
            arguments += [option, *(str(_plain(own)) for own in values)]
    out = options.get("out")
    return Reduction(json.loads(call([*arguments, "--json"], quiet=quiet)), None if out is None else Path(out))


def compare(
    *runs: PathLike | Run,
    out: PathLike | None = None,
    within: PathLike | None = None,
    force: bool = False,
) -> Comparison:
    """Compares runs with the first of them; `within` names bounds, and a run outside of them raises Failed."""
    places = [str(run.path) if isinstance(run, Run) else _path(run) for run in runs]
    if out is None:
        out = Path("runs", "-".join(_names(*map(Path, places[:2]))) + ".compare")
    arguments = ["compare", *places, *_options(out, force, None), "--json"]
    if within is not None:
        arguments += ["--within", _path(within)]
    try:
        call(arguments)
    except Failed as failed:
        raise _differing(failed, "outside", "run") from None
    return Comparison(Path(out))


def _names(*runs: Path) -> list[str]:
    """The shortest ends of the paths that differ, in one word each."""
    places = [run.resolve() for run in runs]
    parts = [(place if place.is_dir() else place.with_suffix("")).parts[1:] for place in places]
    ends = [["_".join(own[-length:]) for own in parts] for length in range(1, max(map(len, parts), default=0) + 1)]
    return next((names for names in ends if len(set(names)) == len(names)), ends[-1] if ends else [])


def export_card(
    film: PathLike | Run,
    target: str,
    out: PathLike,
    *,
    units: str = "t-mm-s",
    layers: int | None = None,
    face: int | None = None,
    rate: str | None = None,
    force: bool = False,
) -> dict[str, Any]:
    """Writes a film as a card of another solver.

    That is "ls-dyna", "openradioss", "abaqus", "calculix", "febio", "kratos", or "curves". `film` is a material, a
    scenario or a run. What is given back says what was written; its `findings` what the card loses.
    """
    source = str(film.path) if isinstance(film, Run) else _path(film)
    arguments = ["export", "card", source, "--for", target, "--units", units, "-o", _path(out), "--json"]
    given = {"--layers": layers, "--face": face, "--rate": rate}
    for name, value in given.items():
        if value is not None:
            arguments += [name, str(value)]
    if force:
        arguments.append("--force")
    written: dict[str, Any] = json.loads(call(arguments))
    return written


def test(
    *paths: PathLike,
    bless: bool = False,
    filter: str | None = None,
    out: PathLike = "runs/test",
    force: bool = False,
    threads: int | None = None,
) -> dict[str, Any]:
    """Compares runs with what they must give; the verdicts. A test that fails raises Failed with its differences."""
    arguments = ["test", *map(_path, paths), *_options(out, force, threads), "--json"]
    if bless:
        arguments.append("--bless")
    if filter is not None:
        arguments += ["--filter", filter]
    try:
        verdicts: dict[str, Any] = json.loads(call(arguments))
        return verdicts
    except Failed as failed:
        raise _differing(failed, "cases", "name") from None


def check(scenario: PathLike, set: Mapping[str, Any] | None = None, *, unset: Iterable[str] = ()) -> None:
    """Checks a scenario without running it; raises BadInput with all mistakes."""
    call(["check", _path(scenario), *_changes(set, unset)])


def _differing(failed: Failed, rows: str, name: str) -> Failed:
    """The exception with the differences that the program printed, where those are why it failed."""
    if failed.diagnostics or not failed.printed.strip():
        return failed
    messages = [
        f"{row[name]}: {difference['message']}"
        for row in json.loads(failed.printed)[rows]
        for difference in row["differences"]
    ]
    differing = Failed([], "\n".join(messages))
    differing.printed = failed.printed
    return differing


def _argument(value: Any) -> str:
    """A value as `--arg` takes it; lists are separated by commas."""
    plain = _plain(value)
    if isinstance(plain, list):
        return ",".join(map(_argument, plain))
    return str(plain).lower() if isinstance(plain, bool) else str(plain)


def _path(path: PathLike) -> str:
    """A path that is no option, whatever it begins with."""
    text = os.fspath(path)
    return f".{os.sep}{text}" if text.startswith("-") else text


def _place(out: PathLike | None, name: str) -> Path:
    return Path(out) if out is not None else Path("runs") / name


def _changes(set: Mapping[str, Any] | None, unset: Iterable[str]) -> list[str]:
    arguments: list[str] = []
    for key in unset:
        arguments += ["--unset", key]
    for key, value in (set or {}).items():
        arguments += ["--set", f"{key}={_toml(value)}"]
    return arguments


def _options(out: PathLike | None, force: bool, threads: int | None) -> list[str]:
    arguments: list[str] = []
    if out is not None:
        arguments += ["--out", _path(out)]
    if force:
        arguments.append("--force")
    if threads is not None:
        arguments += ["--threads", str(threads)]
    return arguments


def _toml(value: Any) -> str:
    """A value as TOML in one line."""
    plain = _plain(value)
    if isinstance(plain, dict):
        return (
            "{ "
            + ", ".join(f"{tomli_w.dumps({key: 0}).split(' = ')[0]} = {_toml(item)}" for key, item in plain.items())
            + " }"
        )
    if isinstance(plain, list):
        return "[" + ", ".join(map(_toml, plain)) + "]"
    return tomli_w.dumps({"value": plain}).removeprefix("value = ").strip()


def _plain(value: Any) -> Any:
    """A value without numpy's types."""
    if isinstance(value, Mapping):
        return {str(key): item for key, item in value.items()}
    if isinstance(value, (tuple, list)):
        return list(value)
    if hasattr(value, "tolist"):
        return value.tolist()
    return os.fspath(value) if isinstance(value, os.PathLike) else value
