"""An arm whose truth is known, moved for a few seconds."""

from __future__ import annotations

import pytest

import armtwin as at

ROTORS = [1.1, 1.1, 1.1, 0.14, 0.14, 0.14]
FRICTION = {"coulomb": {"coulomb": [6, 7, 5, 1.5, 1.2, 1.0]}, "viscous": {"viscous": [9, 11, 7, 1.9, 1.4, 1.1]}}


@pytest.fixture(scope="session")
def twin() -> at.Twin:
    return at.Twin.from_urdf("ur5", rotor_inertia=ROTORS)


@pytest.fixture(scope="session")
def sim(twin: at.Twin) -> at.Simulation:
    hidden = {**FRICTION, "payload": {"mass": 2.0}}
    return at.simulate(twin, at.motions.mixed(seconds=12, seed=3), effects=hidden, snr_db=35, position_noise=2e-5)


@pytest.fixture(scope="session")
def dx(twin: at.Twin, sim: at.Simulation) -> at.Diagnosis:
    return at.diagnose(twin, sim.fit, check=sim.check)
