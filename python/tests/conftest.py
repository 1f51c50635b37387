"""A short drop on a coarse film in a folder of its own."""

from pathlib import Path

import pytest

BASE = Path(__file__).resolve().parents[2] / "scenarios/drop/1008.toml"

SCENARIO = """
extends = {base!r}
unset = ["reference", "post"]
title = "A <short> drop"
specimen.mesh.size = "80 mm"
loading.impact.duration = "10 ms"
[variation]
"impactor.mass" = ["10 kg", "11 kg", "12 kg"]
"""


@pytest.fixture
def scene(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The scenario `kurzer Fall.toml`; the working folder is its own."""
    path = tmp_path / "kurzer Fäll.toml"
    path.write_text(SCENARIO.format(base=str(BASE)), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return path
