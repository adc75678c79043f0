#!/usr/bin/env python3
"""Golden numbers for arms inside a larger robot, from pinocchio, of
scenarios/robots/cart_with_two_arms.urdf.

    python tests/golden/chain.py        # writes tests/golden/chain.json

Needs numpy and pin. The whole robot is computed; joints off the chain stand at zero, in the
neutral configuration. The tip is seen from the base.
"""

import json
import pathlib

import numpy as np
import pinocchio as pin

HERE = pathlib.Path(__file__).parent
ROBOT = HERE / "../../scenarios/robots/cart_with_two_arms.urdf"
# Base, tip, and the joints between them.
CHAINS = [
    ("left_mount", "left_hand", ["left_pan", "left_lift", "left_roll"]),
    ("mast", "left_2", ["left_pan", "left_lift"]),
    ("mast", "right_3", ["right_pan", "right_lift", "right_elbow"]),
    ("right_1", "right_3", ["right_lift", "right_elbow"]),
]
STATES = 3


def main():
    model = pin.buildModelFromUrdf(str(ROBOT))
    data = model.createData()
    rng = np.random.default_rng(2026)
    cases = []
    for base, tip, joints in CHAINS:
        ids = [model.getJointId(name) for name in joints]
        at = [model.idx_vs[j] for j in ids]
        for _ in range(STATES):
            q, qd, qdd = (rng.uniform(-1.5, 1.5, len(joints)).round(3) for _ in range(3))
            full, v, a = pin.neutral(model), np.zeros(model.nv), np.zeros(model.nv)
            v[at], a[at] = qd, qdd
            for j, angle in zip(ids, q):
                i, n = model.idx_qs[j], model.nqs[j]
                full[i:i + n] = [angle] if n == 1 else [np.cos(angle), np.sin(angle)]
            torque = pin.rnea(model, data, full, v, a)[at]
            pin.framesForwardKinematics(model, data, full)
            seen = data.oMf[model.getFrameId(base)].actInv(data.oMf[model.getFrameId(tip)])
            cases.append({
                "base": base, "tip": tip, "q": q.tolist(), "qd": qd.tolist(),
                "qdd": qdd.tolist(), "inverse": torque.tolist(),
                "tip_translation": seen.translation.tolist(),
                "tip_rotation": seen.rotation.ravel().tolist(),
            })
    rows = ",\n".join(json.dumps(c) for c in cases)
    text = f'{{"pinocchio": "{pin.__version__}", "cases": [\n{rows}\n]}}\n'
    (HERE / "chain.json").write_text(text)


if __name__ == "__main__":
    main()
