"""Makes signals.json: zero-phase Butterworth and Savitzky-Golay by scipy, for src/signals/tests.rs."""

import json
from pathlib import Path

import numpy as np
from scipy import signal

k = np.arange(120)
x = 0.3 + 0.01 * k + np.sin(0.21 * k) + 0.4 * np.cos(1.7 * k + 0.3) + 0.05 * (k % 7)

low_pass = [
    {
        "cutoff_hz": cutoff,
        "rate_hz": rate,
        "order": order,
        "y": signal.sosfiltfilt(signal.butter(order, cutoff, fs=rate, output="sos"), x).tolist(),
    }
    for order, cutoff, rate in [(1, 8, 125), (2, 8, 125), (3, 20, 125), (4, 8, 125), (5, 2, 100), (8, 30, 500)]
]
savitzky_golay = [
    {"half": half, "degree": degree, "order": order,
     "y": signal.savgol_filter(x, 2 * half + 1, degree, deriv=order, delta=0.008).tolist()}
    for half, degree in [(5, 2), (11, 4)]
    for order in [0, 1, 2]
]
golden = {"x": x.tolist(), "low_pass": low_pass, "savitzky_golay": savitzky_golay}
Path(__file__).with_suffix(".json").write_text(json.dumps(golden))
