"""An arm falls from a pose under its own weight, with its friction and without a motor: energy only goes.

Usage: python falls.py MODEL.xml [seconds]. Prints energy, J, at the start, at its largest and at the end.
"""
import json
import sys

import mujoco
import numpy as np


def main(path, seconds=5.0):
    model = mujoco.MjModel.from_xml_path(path)
    model.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_ENERGY
    data = mujoco.MjData(model)
    data.qpos[:] = 0.3 * np.sin(1.0 + np.arange(model.nq))
    energies = []
    for _ in range(int(seconds / model.opt.timestep)):
        mujoco.mj_step(model, data)
        energies.append(float(data.energy.sum()))
    assert np.isfinite(data.qpos).all() and np.isfinite(data.qvel).all(), "the arm flew apart"
    masses = [float(m) for m in model.body_mass]
    print(json.dumps({"start": energies[0], "largest": max(energies), "end": energies[-1],
                      "masses": masses}))


if __name__ == "__main__":
    main(sys.argv[1], *map(float, sys.argv[2:]))
