#!/usr/bin/env python3
"""Golden numbers of rigid-body dynamics, from pinocchio, for the URDFs in urdf/.

    python tests/golden/dynamics.py        # writes tests/golden/dynamics.json

Needs numpy and pin. The regressor is kept as its product with a fixed vector and its
Frobenius norm, so that the file stays small and every column still counts.
"""

import json
import pathlib

import numpy as np
import pinocchio as pin

HERE = pathlib.Path(__file__).parent
ROBOTS = ["ur5", "ur5-as-printed", "ur3", "ur10e"]
STATES = 3


def case(model, data, rng):
    n = model.nv
    q, v, a, tau = (rng.uniform(-2, 2, n).round(3) for _ in range(4))
    # Continuous joints are (cos, sin) in pinocchio's configuration.
    full = pin.neutral(model)
    for j in range(1, model.njoints):
        angle = q[model.idx_vs[j]]
        full[model.idx_qs[j]:model.idx_qs[j] + model.nqs[j]] = (
            [angle] if model.nqs[j] == 1 else [np.cos(angle), np.sin(angle)])
    torque = pin.rnea(model, data, full, v, a).copy()
    gravity = pin.computeGeneralizedGravity(model, data, full).copy()
    accel = pin.aba(model, data, full, v, tau).copy()
    mass = pin.crba(model, data, full)
    mass = np.triu(mass) + np.triu(mass, 1).T
    kinetic = pin.computeKineticEnergy(model, data, full, v)
    potential = pin.computePotentialEnergy(model, data, full)
    y = pin.computeJointTorqueRegressor(model, data, full, v, a).copy()
    pin.framesForwardKinematics(model, data, full)
    flange = data.oMf[model.getFrameId("tool0")].copy()
    jacobian = pin.computeFrameJacobian(
        model, data, full, model.getFrameId("tool0"), pin.LOCAL_WORLD_ALIGNED).copy()
    weights = np.cos(np.arange(y.shape[1]))
    return {
        "q": q, "qd": v, "qdd": a, "tau": tau,
        "inverse": torque, "gravity": gravity, "forward": accel,
        "mass_matrix": mass[np.triu_indices(n)],
        "kinetic": kinetic, "potential": potential,
        "regressor_weighted": y @ weights, "regressor_norm": np.linalg.norm(y),
        "flange_translation": flange.translation, "flange_rotation": flange.rotation.ravel(),
        "jacobian": jacobian.ravel(),
    }


def main():
    rng = np.random.default_rng(2026)
    cases = []
    for name in ROBOTS:
        model = pin.buildModelFromUrdf(str(HERE / f"../../urdf/{name}.urdf"))
        data = model.createData()
        for _ in range(STATES):
            cases.append({"robot": name} | case(model, data, rng))
    plain = lambda x: x.tolist() if isinstance(x, np.ndarray) else float(x)
    rows = ",\n".join(
        json.dumps({k: v if k == "robot" else plain(v) for k, v in c.items()}) for c in cases)
    text = f'{{"pinocchio": "{pin.__version__}", "cases": [\n{rows}\n]}}\n'
    (HERE / "dynamics.json").write_text(text)


if __name__ == "__main__":
    main()
