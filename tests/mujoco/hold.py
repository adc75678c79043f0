"""Holds an MJCF of `armtwin export` against armtwin's own numbers (pip install mujoco).

    python hold.py ARM.xml NUMBERS.json

NUMBERS.json: poses with the current each takes (`inverse`), and a motion with the current that
drives it (`drive`). Prints the largest differences as JSON.
"""

import json
import sys

import mujoco
import numpy as np

model = mujoco.MjModel.from_xml_path(sys.argv[1])
numbers = json.load(open(sys.argv[2]))
gain = model.actuator_gainprm[:, 0]
bias = model.actuator_biasprm[:, 0]


def inverse():
    """N.m per joint between MuJoCo's inverse dynamics and the recorded current's torque."""
    data = mujoco.MjData(model)
    worst = np.zeros(model.nv)
    for pose in numbers["inverse"]:
        data.qpos[:], data.qvel[:], data.qacc[:] = pose["q"], pose["qd"], pose["qdd"]
        mujoco.mj_inverse(model, data)
        torque = gain * np.array(pose["current"]) + bias
        worst = np.maximum(worst, np.abs(data.qfrc_inverse - torque))
    return worst.tolist()


def drive():
    """rad per joint between the motion and MuJoCo's when driven by its current, without feedback."""
    motion = numbers["drive"]
    model.opt.timestep = motion["dt"]
    data = mujoco.MjData(model)
    data.qpos[:], data.qvel[:] = motion["q"][0], motion["qd"]
    worst = np.zeros(model.nv)
    for current, q in zip(motion["current"], motion["q"][1:]):
        data.ctrl[:] = current
        mujoco.mj_step(model, data)
        worst = np.maximum(worst, np.abs(data.qpos - np.array(q)))
    return worst.tolist()


print(json.dumps({"version": mujoco.__version__, "inverse_nm": inverse(), "drive_rad": drive()}))
