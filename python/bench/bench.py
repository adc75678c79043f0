"""What the package costs beside the engine, and beside Pinocchio (pip install pin).

    python bench/bench.py [RECORDING.csv]     # in an environment with the wheel and pin

The engine's own times for the same are printed by

    cargo run --release --example beside_python -- RECORDING.csv

with the recording that this script writes where it is given a name for it.
"""

from __future__ import annotations

import json
import statistics
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import armtwin as at
from armtwin import _engine
from armtwin._listen import Listener

SAMPLES = 100_000


def best(call: Callable[[], Any], repeats: int) -> float:
    """Median of the wall-clock times, s."""
    times = []
    for _ in range(repeats):
        begun = time.perf_counter()
        call()
        times.append(time.perf_counter() - begun)
    return statistics.median(times)


def main() -> None:
    twin = at.Twin.from_urdf("ur5", rotor_inertia=[1.1, 1.1, 1.1, 0.14, 0.14, 0.14])
    rng = np.random.default_rng(1)
    q, qd, qdd = rng.normal(size=(3, SAMPLES, 6))
    print(f"twin.torque, ({SAMPLES}, 6)")
    row = best(lambda: twin.torque(q, qd, qdd), 21)
    fortran = [np.asfortranarray(a) for a in (q, qd, qdd)]
    column = best(lambda: twin.torque(fortran[0], fortran[1], fortran[2]), 21)
    print(f"  armtwin, rows contiguous       {1e3 * row:9.2f} ms")
    print(f"  armtwin, columns contiguous    {1e3 * column:9.2f} ms")
    try:
        import pinocchio as pin
    except ImportError:
        print("  pinocchio is not installed")
    else:
        with tempfile.TemporaryDirectory() as folder:
            urdf = Path(folder) / "arm.urdf"
            urdf.write_text(twin._engine.to_urdf())
            model = pin.buildModelFromUrdf(str(urdf))
        data = model.createData()
        model.armature[:] = twin.rotor_inertia

        def loop() -> Any:
            return np.array([pin.rnea(model, data, *row) for row in zip(q, qd, qdd)])

        theirs = loop()
        assert np.abs(theirs - twin.torque(q, qd, qdd)).max() < 1e-6
        print(f"  pinocchio {pin.__version__}, Python loop  {1e3 * best(loop, 5):9.2f} ms")

    sim = at.simulate(
        twin,
        at.motions.mixed(seconds=48, seed=1),
        effects={"coulomb": {"coulomb": 5.0}, "viscous": {"viscous": 8.0}},
        snr_db=30,
    )
    recording = at.Recording(sim.fit.t, sim.fit.q, qd=sim.fit["qd"], current=sim.fit["current"])
    print(f"at.identify, {recording.joints} x {len(recording)} samples, least squares")
    whole = best(lambda: at.identify(twin, recording, methods=["nlse"]), 41)
    options = json.dumps(
        {
            "terms": [], "with": [], "methods": ["nlse"], "direct_cost": False, "reduce": False, "bounds": {},
            "seed": 1, "total_mass": None, "payload": None, "payload_centre": None,
            "taken": {"signals": {}, "every_row": False, "force": False},
        }
    )  # fmt: skip
    args = (twin._engine, recording._engine, None, None, options, Listener(None))
    inner = best(lambda: _engine.identify(*args), 41)
    print(f"  at.identify                    {1e3 * whole:9.2f} ms")
    print(f"  _engine.identify               {1e3 * inner:9.2f} ms")
    if len(sys.argv) > 1:
        recording.save(sys.argv[1])


if __name__ == "__main__":
    main()
