"""The program in the wheel, and the same numbers from it and from Python, to the last bit."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import armtwin as at

SCENARIO = """
seed = 5
[drive]
rotor_inertia = [1.1, 1.1, 1.1, 0.14, 0.14, 0.14]
[motion]
duration_s = 12
seed = 3
[noise]
snr_db = 35
position_rad = 2e-5
[effects.coulomb]
coulomb = [6, 7, 5, 1.5, 1.2, 1.0]
[effects.viscous]
viscous = [9, 11, 7, 1.9, 1.4, 1.1]
[effects.payload]
payload_mass = 2
payload_moment_x = 0
payload_moment_y = 0
payload_moment_z = 0
"""

TWIN = """
robot = "ur5"
[drive]
rotor_inertia = [1.1, 1.1, 1.1, 0.14, 0.14, 0.14]
"""


def program(*words: str, at_folder: Path) -> subprocess.CompletedProcess[str]:
    name = shutil.which("armtwin", path=str(Path(sys.executable).parent))
    assert name, "the wheel installs the program"
    return subprocess.run([name, *words], cwd=at_folder, capture_output=True, text=True)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("program")
    (place / "scenario.toml").write_text(SCENARIO)
    (place / "twin.toml").write_text(TWIN)
    for words in (
        ["simulate", "scenario.toml", "--out", "run"],
        ["identify", "run/fit.csv", "--check", "run/check.csv", "--twin", "twin.toml", "--json", "fit.json"],
        ["diagnose", "--fit", "run/fit.csv", "--check", "run/check.csv", "--twin", "twin.toml", "--json", "dx.json"],
    ):
        run = program(*words, at_folder=place)
        assert run.returncode == 0, run.stderr
    return place


def without_time(document: Any) -> Any:
    """Seconds differ from run to run, and so does what a command is called with."""
    if isinstance(document, dict):
        kept = {k: v for k, v in document.items() if k not in ("seconds", "source", "next_experiment")}
        return {key: without_time(value) for key, value in kept.items()}
    return [without_time(entry) for entry in document] if isinstance(document, list) else document


def loaded(file: Path) -> Any:
    return without_time(json.loads(file.read_text()))


def test_the_program_is_there() -> None:
    run = program("--version", at_folder=Path.cwd())
    assert run.returncode == 0 and run.stdout.strip() == f"armtwin {at.__version__}"
    assert program("robots", at_folder=Path.cwd()).stdout.count("ur5") >= 2
    assert program("nothing", at_folder=Path.cwd()).returncode == 2
    missing = program("inspect", "nowhere.csv", at_folder=Path.cwd())
    assert missing.returncode == 1 and "nowhere.csv" in missing.stderr


def test_simulations_are_the_same(folder: Path) -> None:
    hidden = {
        "coulomb": {"coulomb": [6, 7, 5, 1.5, 1.2, 1.0]},
        "viscous": {"viscous": [9, 11, 7, 1.9, 1.4, 1.1]},
        "payload": {"mass": 2},
    }
    motion = at.motions.mixed(seconds=12, seed=3)
    twin = at.Twin.load(folder / "twin.toml")
    sim = at.simulate(twin, motion, effects=hidden, seed=5, snr_db=35, position_noise=2e-5)
    sim.save(folder / "python")
    for name in ("fit.csv", "check.csv"):
        assert (folder / "python" / name).read_bytes() == (folder / "run" / name).read_bytes()
    written = at.simulate(folder / "scenario.toml")
    np.testing.assert_array_equal(written.check["current"], sim.check["current"])


def test_identifications_are_the_same(folder: Path) -> None:
    fit, check = (at.read(folder / "run" / f"{name}.csv") for name in ("fit", "check"))
    found = at.identify(at.Twin.load(folder / "twin.toml"), fit, check=check)
    assert without_time(found.to_dict()) == loaded(folder / "fit.json")


def test_diagnoses_are_the_same(folder: Path) -> None:
    fit, check = (at.read(folder / "run" / f"{name}.csv") for name in ("fit", "check"))
    found = at.diagnose(at.Twin.load(folder / "twin.toml"), fit, check=check)
    assert without_time(found.to_dict()) == loaded(folder / "dx.json")
