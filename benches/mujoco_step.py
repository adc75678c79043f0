#!/usr/bin/env python3
"""Cost of a step of the same arm in MuJoCo (pip install mujoco): beside `cargo bench simulation`.

    armtwin urdf --robot ur5 -o ur5.urdf && python3 benches/mujoco_step.py ur5.urdf

Dry and viscous friction, rotor inertia, torque and step are those of benches/simulation.rs. The loop
over steps runs inside MuJoCo (C), on one core; Python is left out of what is measured.
"""

import sys
import time

import mujoco

ROTORS = [1.1, 1.1, 1.1, 0.14, 0.14, 0.14]
STEPS = 20000


def main():
    model = mujoco.MjModel.from_xml_path(sys.argv[1])
    model.opt.timestep = 5e-4
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_LIMIT
    model.dof_armature[:] = ROTORS
    model.dof_damping[:] = 1.0
    for dry in (0.0, 1.0):
        model.dof_frictionloss[:] = dry
        data = mujoco.MjData(model)
        data.qfrc_applied[:] = 3.0
        best = float("inf")
        for _ in range(10):
            start = time.process_time()
            mujoco.mj_step(model, data, STEPS)
            best = min(best, (time.process_time() - start) / STEPS)
        friction = f"dry friction {dry:.0f} N.m"
        print(f"MuJoCo {mujoco.__version__}, {friction}: {1e6 * best:.2f} us/step, {1e-6 / best:.3f} million/s")


if __name__ == "__main__":
    main()
