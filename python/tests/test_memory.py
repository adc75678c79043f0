"""A million samples: at most three times the memory of the input."""

from __future__ import annotations

import subprocess
import sys

import pytest

SCRIPT = """
import resource, sys
import numpy as np
import armtwin as at

ROWS = 1_000_000

def peak():
    return 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss

twin = at.Twin.from_urdf("ur5", rotor_inertia=[1.1, 1.1, 1.1, 0.14, 0.14, 0.14])
t = np.arange(ROWS) * 0.002
rng = np.random.default_rng(1)
phase = np.linspace(0.3, 1.1, 6)
q, qd, qdd = (np.empty((ROWS, 6)) for _ in range(3))
for j in range(6):
    w = 0.7 + 0.2 * j
    q[:, j], qd[:, j], qdd[:, j] = np.sin(w * t) - 1.0, w * np.cos(w * t), -w * w * np.sin(w * t)
current = np.empty_like(q)
for k in range(0, ROWS, 10_000):
    part = slice(k, k + 10_000)
    tau = twin.torque(q[part], qd[part], qdd[part]) + 5.0 * np.tanh(100 * qd[part]) + 8.0 * qd[part]
    current[part] = tau / twin.gains + 0.01 * rng.normal(size=tau.shape)
del qdd
size = t.nbytes + q.nbytes + qd.nbytes + current.nbytes
before = peak()
if sys.argv[1] == "torque":
    twin.torque(q, qd, current)
elif sys.argv[1] == "recording":
    recording = at.Recording(t, q, qd=qd, current=current)
    assert len(recording) == ROWS
else:
    at.identify(twin, at.Recording(t, q, qd=qd, current=current), methods=["nlse"])
print((peak() - before) / size)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="memory is measured as Linux tells it")
@pytest.mark.parametrize("what", ["torque", "recording", "identify"])
def test_a_million_samples_take_little_more_than_themselves(what: str) -> None:
    run = subprocess.run([sys.executable, "-c", SCRIPT, what], capture_output=True, text=True, check=True)
    times = float(run.stdout)
    print(f"{what}: {times:.2f} times the input besides it")
    assert times <= 3.0
