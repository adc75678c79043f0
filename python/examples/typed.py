"""The package as a type checker sees it (mypy --strict), and a first use of it: runs by itself."""

from __future__ import annotations

import numpy as np

import armtwin as at


def friction(fit: at.Identification) -> dict[str, float]:
    return {f"joint {joint.joint}": joint.coulomb.value for joint in fit}


def main() -> None:
    twin = at.Twin.from_urdf("ur5", rotor_inertia=[1.1, 1.1, 1.1, 0.14, 0.14, 0.14])
    motion = at.motions.random_sines(seconds=15, seed=1)
    hidden = {"coulomb": {"coulomb": 5.0}, "viscous": {"viscous": 8.0}, "payload": {"mass": 2.0}}
    sim = at.simulate(twin, motion, effects=hidden, snr_db=30)
    recording = at.Recording(sim.fit.t, sim.fit.q, qd=sim.fit["qd"], current=sim.fit["current"].astype(np.float32))
    fit: at.Identification = at.identify(twin, recording, check=sim.check, methods=["nlse"])
    values: dict[str, float] = friction(fit)
    dx: at.Diagnosis = at.diagnose(twin, recording, check=sim.check, progress=True)
    names: list[str] = [cause.effect for cause in dx.causes]
    torque = dx.mended.torque(recording.q, recording["qd"], np.zeros_like(recording.q))
    print(values, names, torque.shape, dx.sentence, sep="\n")


if __name__ == "__main__":
    main()
