"""What the package costs beside the engine, and beside Pinocchio.

    pip install ./python pin
    cargo build --release --example beside_python
    python python/bench/bench.py target/release/examples/beside_python > docs/python-cost.md

The example is the engine without Python: the same calls on the same samples, written in Rust.
"""

from __future__ import annotations

import json
import platform
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import armtwin as at

SAMPLES = 100_000


def median_ms(call: Callable[[], Any], repeats: int) -> float:
    """Wall-clock."""
    times = []
    for _ in range(repeats):
        begun = time.perf_counter()
        call()
        times.append(1e3 * (time.perf_counter() - begun))
    return statistics.median(times)


def waves(rate: float) -> Any:
    """What the example moves along, (T, 6)."""
    return np.sin(rate * np.arange(SAMPLES)[:, None] + np.arange(6.0))


def pinocchio_ms(twin: at.Twin, motion: list[Any], expected: Any) -> tuple[str, float]:
    import pinocchio as pin

    with tempfile.TemporaryDirectory() as folder:
        urdf = Path(folder) / "arm.urdf"
        twin.export(urdf)
        model = pin.buildModelFromUrdf(str(urdf))
    data = model.createData()
    model.armature[:] = twin.rotor_inertia

    def loop() -> Any:
        return np.array([pin.rnea(model, data, *row) for row in zip(*motion)])

    assert np.abs(loop() - expected).max() < 1e-6
    return pin.__version__, median_ms(loop, 5)


def recorded(twin: at.Twin) -> at.Recording:
    """Six joints, 6000 samples."""
    sim = at.simulate(
        twin,
        at.motions.mixed(seconds=48, seed=1),
        effects={"coulomb": {"coulomb": 5.0}, "viscous": {"viscous": 8.0}},
        snr_db=30,
    )
    return at.Recording(sim.fit.t[:6000], sim.fit.q[:6000], qd=sim.fit["qd"][:6000], current=sim.fit["current"][:6000])


def main() -> None:
    example = sys.argv[1]
    twin = at.Twin.from_urdf("ur5", rotor_inertia=[1.1, 1.1, 1.1, 0.14, 0.14, 0.14])
    recording = recorded(twin)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "run.csv"
        recording.save(path)
        # As the engine reads it: the same numbers on both sides.
        recording = at.read(path)
        engine = json.loads(subprocess.run([example, path], capture_output=True, text=True, check=True).stdout)
    motion = [waves(rate) for rate in (0.7, 1.3, 2.9)]
    rows = median_ms(lambda: twin.torque(*motion), 21)
    columns = [np.asfortranarray(a) for a in motion]
    turned = median_ms(lambda: twin.torque(*columns), 21)
    version, theirs = pinocchio_ms(twin, motion, twin.torque(*motion))
    identify = median_ms(lambda: at.identify(twin, recording, methods=["nlse"]), 41)
    beside = engine["torque"]
    print("# What Python costs\n")
    print(f"Printed by `python/bench/bench.py`, armtwin {at.__version__}, Python {platform.python_version()}, numpy {np.__version__};")
    print("medians of wall-clock times.\n")
    print(f"| torque along {SAMPLES} samples of six joints | ms | beside the engine |")
    print("| --- | ---: | ---: |")
    print(f"| Rust, `Twin::torque` | {beside:.1f} | 1.00 |")
    print(f"| Rust, a loop over `inverse_dynamics` on one thread | {engine['loop']:.1f} | {engine['loop'] / beside:.2f} |")
    print(f"| Python, `twin.torque`, rows contiguous | {rows:.1f} | {rows / beside:.2f} |")
    print(f"| Python, `twin.torque`, columns contiguous | {turned:.1f} | {turned / beside:.2f} |")
    print(f"| Python, a loop over Pinocchio {version}'s `rnea` | {theirs:.1f} | {theirs / beside:.2f} |")
    print(f"\n| identification of 6 x {len(recording)} samples, least squares | ms |")
    print("| --- | ---: |")
    print(f"| Rust, `Identify::run` | {engine['identify']:.2f} |")
    print(f"| Python, `at.identify` | {identify:.2f} |")
    print(f"| what Python adds | {identify - engine['identify']:.2f} |")
    print("\nBoth run in processes of their own: from run to run their difference varies by some 2 ms.")


if __name__ == "__main__":
    main()
