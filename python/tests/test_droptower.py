"""The package against the real program, which $DROPTOWER names."""

import json
import os
import stat
import sys
from pathlib import Path

import numpy
import pandas
import pytest

import droptower
from droptower.commands import _toml
from droptower.program import call


def test_a_run_is_read_back(scene: Path) -> None:
    run = droptower.run(scene, set={"layers.count": 9, "impactor.mass": "11 kg"}, unset=["title"], out="a b")
    assert run.path == Path("a b")
    assert isinstance(run.signals, pandas.DataFrame)
    lowest = run.signals["displacement_m"].min()
    assert run.peak_displacement_m == pytest.approx(lowest, rel=1e-3)
    assert run.summary["peak_displacement_m"] == run.peak_displacement_m
    assert run.ruptured is False and "peak_displacement_m" in dir(run)
    assert "time_s" in run.energies.columns and len(run.energies) > 3
    assert "count" in run.scenario and "9" in run.scenario
    assert isinstance(run.findings, pandas.DataFrame)
    again = droptower.Run("a b")
    pandas.testing.assert_frame_equal(again.signals, run.signals)
    with pytest.raises(AttributeError, match="no figure nothing"):
        _ = run.nothing


def test_results_have_a_default_place(scene: Path) -> None:
    run = droptower.run(scene)
    assert run.path.parts[0] == "runs" and run.report.is_file()


def test_states_are_arrays(scene: Path) -> None:
    run = droptower.run(scene, vtu=True, out="states")
    states = run.states
    assert len(states) == len(states.times) > 3
    last = states[-1]
    assert last.time == pytest.approx(0.01, rel=0.01)
    assert states.at(1.0).time == last.time
    assert last.points.shape == last.point_data["displacement_m"].shape
    flat = states[0].points - states[0].point_data["displacement_m"]
    numpy.testing.assert_allclose(flat + last.point_data["displacement_m"], last.points, atol=1e-6)
    assert last.points[:, 2].min() < -0.03
    assert sum(map(len, last.cells.values())) == len(next(iter(last.cell_data.values())))
    assert numpy.isfinite(last.points).all()
    with pytest.raises(FileNotFoundError, match="vtu=True"):
        _ = droptower.run(scene, out="plain").states


def test_a_state_without_film_has_no_elements(scene: Path) -> None:
    stretch = Path(__file__).resolve().parents[2] / "scenarios/stretch/md-0.2.toml"
    fibres = {"curve": [[0.3, "8 MPa"]]}
    broken = {
        "loading.stretch.direction": "45 deg",
        "loading.stretch.until": 0.6,
        "specimen.material.fabric.md": fibres,
        "specimen.material.fabric.td": fibres,
        "output.frames": 8,
    }
    states = droptower.run(stretch, set=broken, vtu=True, out=scene.parent / "broken").states
    assert states[0].cells and len(states[0].points) >= 4
    assert states[-1].points.shape == (0, 3) and not states[-1].cells


def test_a_sweep_has_a_table(scene: Path) -> None:
    sweep = droptower.sweep(scene, keep="worst:1", out="swept", store="kept")
    assert list(sweep.table["impactor.mass_kg"]) == [10, 11, 12]
    assert sweep.statistics.loc["peak_displacement_m", "p50"] == pytest.approx(
        sweep.table["peak_displacement_m"].median()
    )
    assert sweep.summary["runs"] == 3
    assert len(sweep.runs) == 1
    assert droptower.sweep(scene, out="swept", store="kept", force=True).reused == 3
    assert droptower.sweep(scene, out="gathered", store="kept", merge=True).summary["runs"] == 3
    with pytest.raises(droptower.BadInput, match="the runs have no figure `peak`"):
        droptower.sweep(scene, out="swept", store="kept", figure="peak")


def test_progress_is_shown_while_runs_are_computed(scene: Path, capfd: pytest.CaptureFixture[str]) -> None:
    droptower.sweep(scene, quiet=False)
    events = [json.loads(line) for line in capfd.readouterr().err.splitlines()]
    assert [event["done"] for event in events if event["event"] == "progress"][-1] == 3


def test_failed_runs_are_rows_of_the_table(scene: Path) -> None:
    places = {"impactor.position": [["0 mm", "0 mm"], ["0 mm", "0 mm", "0 mm"]]}
    with pytest.raises(droptower.NumericalFailure, match="3 of 6 runs failed: the impactor starts"):
        droptower.sweep(scene, set={"specimen.symmetry": "none", "variation": places}, out="swept")
    assert list(droptower.Sweep("swept").table["status"]) == 3 * ["finished", "failed"]


def test_a_script_has_tables(scene: Path) -> None:
    Path("study.rhai").write_text(
        'let n = args.number("n", 1); measure("n", n); let list = args.numbers("list", [0, 0]);'
        ' measure("sum", list.reduce(|sum, x| sum + x, 0)); table("t", [#{ a: 1, b: 2.5 }, #{ a: 2, b: n }]);',
        encoding="utf-8",
    )
    study = droptower.script("study.rhai", args={"n": 7, "list": numpy.array([1, 2.5])}, out="study")
    assert study.n == 7 and study.sum == 3.5
    assert list(study.tables["t"]["b"]) == [2.5, 7]


DATA = Path(__file__).resolve().parents[2] / "data/virtual"


def test_recordings_are_reduced(scene: Path) -> None:
    tower = {"mass": "10.72 kg", "height": "1 m"}
    drop = droptower.reduce("drop", DATA / "1008.csv", **tower, out="drop.csv", mask=["10 ms..11 ms", "20 ms..21 ms"])
    assert drop.signals["displacement_m"].min() == pytest.approx(drop.peak_displacement_m)
    [low, high] = drop.energy_absorption_interval
    [row] = drop.table.to_dict("records")
    assert low == row["energy_absorption_interval.low"] < row["energy_absorption"] < high
    assert "virtual-recording" in set(drop.findings["code"])
    drops = droptower.reduce("drop", *sorted(DATA.glob("10*.csv")), **tower)
    assert list(drops.table["impact_velocity_m_s"]) == pytest.approx([4.16, 4.14, 4.18], rel=2e-3)
    with pytest.raises(FileNotFoundError, match=r"drop\.csv"):
        _ = drops.signals
    coupons = droptower.reduce(
        "coupon",
        *DATA.glob("coupons/*d-0.2-*.csv"),
        gauge="5 mm",
        width="10 mm",
        thickness="12 um",
        window=(0.01, 0.03),
    )
    elongations = coupons.table.set_index("direction")["break_elongation.mean"]
    assert (elongations["MD"], elongations["TD"]) == pytest.approx((1.39, 7.01), rel=1e-3)
    with pytest.raises(droptower.BadInput):
        droptower.reduce("drop", DATA / "1008.csv", mass="10.72 mm")


def test_a_study_is_calibrated(scene: Path) -> None:
    strip = Path(__file__).resolve().parents[2] / "scenarios/stretch/single-element.toml"
    Path("strip.toml").write_text(f"extends = {str(strip)!r}\nloading.stretch.until = 0.2\n", encoding="utf-8")
    scale = "specimen.material.fabric.scale.ke"
    droptower.run("strip.toml", set={scale: 1.3}, out="pulled")
    Path("study.toml").write_text(
        'precision = 0.05\n[[test]]\nscenario = "strip.toml"\ncompare = "force"\nrecordings = "pulled/signals.csv"\n'
        f'noise = 0.01\n[parameters]\nke = {{ key = "{scale}", start = 1, within = [0.2, 5], log = true }}\n',
        encoding="utf-8",
    )
    study = droptower.calibrate("study.toml")
    [ke] = study.tables["parameters"].to_dict("records")
    assert study.path == Path("runs/study") and ke["value"] == pytest.approx(1.3, abs=0.01)


def test_a_function_of_runs_is_minimized(scene: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    strip = Path(__file__).resolve().parents[2] / "scenarios/stretch/single-element.toml"
    text = f"extends = {str(strip)!r}\nloading.stretch.until = 0.2\n"
    Path("strip.toml").write_text(text, encoding="utf-8")
    scale = "specimen.material.fabric.scale.ke"
    pulled = droptower.run("strip.toml", set={scale: 1.3}, out="pulled").signals["force_N"].to_numpy()
    bounds = {scale: (0.5, 3.0)}

    def residuals(run: droptower.Run) -> numpy.ndarray:
        return run.signals["force_N"].to_numpy()[1:] / pulled[1:] - 1

    found = droptower.minimize("strip.toml", residuals, bounds)
    assert found.converged and found.values[scale] == pytest.approx(1.3, rel=1e-3)
    assert found.value == found.trials["value"].min() and found.run.path in set(found.trials["path"])
    # Another objective over the same runs: the start is stored. One of another state of the scenario is computed anew.
    times = {path: (path / "summary.json").stat().st_mtime_ns for path in found.trials["path"]}
    number = droptower.minimize("strip.toml", lambda run: float(abs(residuals(run)[-1])), bounds, trials=40)
    assert number.values[scale] == pytest.approx(1.3, rel=3e-3) and len(number.trials) < 40
    assert all((path / "summary.json").stat().st_mtime_ns == time for path, time in times.items())
    Path("strip.toml").write_text(text + "title = 'another'\n", encoding="utf-8")
    limited = droptower.minimize("strip.toml", residuals, bounds, trials=1)
    [only] = limited.trials["path"]
    assert not limited.converged and only == found.trials["path"][0]
    assert (only / "summary.json").stat().st_mtime_ns > times[only]
    with pytest.raises(ValueError, match="as many finite residuals"):
        droptower.minimize("strip.toml", lambda run: float("nan"), bounds)
    with pytest.raises(ValueError, match="within the bounds"):
        droptower.minimize("strip.toml", residuals, bounds, start={scale: 4})
    monkeypatch.setitem(sys.modules, "scipy", None)
    with pytest.raises(ImportError, match="pip install scipy"):
        droptower.minimize("strip.toml", residuals, bounds)


def test_runs_are_compared_and_tested(scene: Path) -> None:
    runs = [droptower.run(scene, {"impactor.mass": mass}, out=name) for name, mass in (("a", "10 kg"), ("b", "12 kg"))]
    Path("bounds.toml").write_text("[signals.displacement_m]\nrelative = 1e-6\n", encoding="utf-8")
    assert droptower.compare(*runs).outside == []
    with pytest.raises(droptower.Failed, match="b: displacement_m is"):
        droptower.compare(*runs, within="bounds.toml")
    case = Path("cases/one")
    case.mkdir(parents=True)
    (case / "scenario.toml").write_text(scene.read_text(encoding="utf-8").split("[variation]")[0], encoding="utf-8")
    (case / "expect.toml").write_text("[figures]\nruptured = true\n", encoding="utf-8")
    with pytest.raises(droptower.Failed, match="ruptured is false, expected true"):
        droptower.test("cases")
    (case / "expect.toml").write_text("[figures]\nruptured = false\n", encoding="utf-8")
    assert droptower.test("cases")["passed"] == 1


def test_mistakes_are_exceptions_with_their_place(scene: Path) -> None:
    with pytest.raises(droptower.BadInput) as raised:
        droptower.check(scene, set={"impactor.mass": "10 mm", "impactor.colour": 3})
    messages = [diagnostic.message for diagnostic in raised.value.diagnostics]
    assert len(messages) == 2 and any('expected a mass, found "10 mm"' in message for message in messages), messages
    text = scene.read_text(encoding="utf-8").replace('"10 ms"', '"10 kg"')
    scene.write_text(text, encoding="utf-8")
    with pytest.raises(droptower.BadInput) as raised:
        droptower.run(scene)
    [mistake] = raised.value.diagnostics
    line = next(number for number, line in enumerate(text.splitlines(), 1) if "10 kg" in line)
    assert (mistake.line, mistake.column) == (line, 27) and mistake.source == scene.name
    assert mistake.hint is not None and "120 ms" in mistake.hint
    assert not Path("runs").exists()


@pytest.mark.skipif(os.name != "posix", reason="the stub is a shell script")
def test_what_is_told_is_shown_but_for_mistakes(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    stub = tmp_path / "stub"
    mistake = '{"message": "wrong", "hint": null, "labels": []}'
    stub.write_text(f"#!/bin/sh\necho working >&2\necho '{mistake}' >&2\necho '{{}}'\nexit 2\n")
    stub.chmod(stub.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setenv("DROPTOWER", str(stub))
    for quiet, shown in ((True, ""), (False, "working\n")):
        with pytest.raises(droptower.BadInput, match="wrong") as raised:
            call(["run"], quiet=quiet)
        assert capfd.readouterr() == ("", shown)
        assert raised.value.text == "working" and raised.value.printed == "{}\n"


def test_results_of_something_else_are_not_replaced(scene: Path) -> None:
    droptower.run(scene, out="mine")
    case = Path("cases/one")
    case.mkdir(parents=True)
    (case / "scenario.toml").write_text(scene.read_text(encoding="utf-8").split("[variation]")[0], encoding="utf-8")
    (case / "expect.toml").write_text("[figures]\nruptured = false\n", encoding="utf-8")
    with pytest.raises(droptower.DroptowerError, match="is not replaced"):
        droptower.test("cases", out="mine")
    assert droptower.Run("mine").ruptured is False


def test_a_missing_program_is_told(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("DROPTOWER", str(tmp_path / "none"))
    with pytest.raises(droptower.ProgramNotFound, match="there is no program"):
        droptower.version()
    if os.name == "posix":
        stub = tmp_path / "stub"
        stub.write_text("#!/bin/sh\necho droptower 9.8.7\n")
        stub.chmod(stub.stat().st_mode | stat.S_IXUSR)
        monkeypatch.setenv("DROPTOWER", str(stub))
        assert droptower.version() == "9.8.7"


def test_a_notebook_shows_a_run(scene: Path) -> None:
    run = droptower.run(scene, out="shown")
    shown = run._repr_html_()
    assert "A &lt;short&gt; drop" in shown and "<short>" not in shown
    assert "<svg" in shown and "peak_displacement_m" in shown
    assert len(run.plot("displacement_m").axes) == 1


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (9, "9"),
        (0.5, "0.5"),
        (True, "true"),
        ('12 "um"', '"12 \\"um\\""'),
        ([1, "2 mm"], '[1, "2 mm"]'),
        (("x-", "x+"), '["x-", "x+"]'),
        ({"rectangle": ["1 m", "2 m"]}, '{ rectangle = ["1 m", "2 m"] }'),
        ({"a b": {"c": 1}}, '{ "a b" = { c = 1 } }'),
        (numpy.float64(0.25), "0.25"),
        (numpy.array([1, 2]), "[1, 2]"),
        (Path("a/b.toml"), '"a/b.toml"'),
    ],
)
def test_values_are_written_as_toml(value: object, text: str) -> None:
    assert _toml(value) == text


def test_polars(scene: Path) -> None:
    polars = pytest.importorskip("polars")
    run = droptower.run(scene, out="frames")
    frame = run.polars("signals")
    assert isinstance(frame, polars.DataFrame) and frame.height == len(run.signals)


def test_a_folder_without_results_is_refused(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match=r"summary\.json is missing"):
        droptower.Run(tmp_path)


def test_a_film_is_written_for_another_solver(scene: Path) -> None:
    written = droptower.export_card(scene, "ls-dyna", "film.k", units="g-mm-ms")
    assert written["units"] == "g-mm-ms" and "*MAT_FABRIC" in Path("film.k").read_text()
    codes = {finding["code"] for finding in written["findings"]}
    assert "card-break-strain" in codes
    with pytest.raises(droptower.BadInput, match="no law for fabric"):
        droptower.export_card(droptower.run(scene), "calculix", "film.inp")
    with pytest.raises(droptower.BadInput, match="already exists"):
        droptower.export_card(scene, "ls-dyna", "film.k")
