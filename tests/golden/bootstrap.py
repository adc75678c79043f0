"""Makes bootstrap.json: numbers of the package arch for src/statistics/bootstrap_tests.rs."""

import json
from pathlib import Path

import numpy as np
from arch.bootstrap import CircularBlockBootstrap, optimal_block_length

rng = np.random.default_rng(20)


def first_order(n, rho):
    """AR(1) of variance 1."""
    e = rng.standard_normal(n)
    for t in range(1, n):
        e[t] = rho * e[t - 1] + np.sqrt(1 - rho**2) * e[t]
    return e


def neighbours(x):
    d = x - x.mean()
    return float(d[1:] @ d[:-1] / (d @ d))


def interval(x, block, replications, level):
    found = CircularBlockBootstrap(block, x, seed=rng).conf_int(np.mean, reps=replications, method="percentile", size=level)
    return found.ravel()


def coverage(n, rho, series, replications, level):
    """Share of intervals of the mean that hold it, blocks by Politis and White's rule for an AR(1)."""
    held = 0
    for _ in range(series):
        x = first_order(n, rho)
        r = neighbours(x)
        block = max(1, int(np.ceil((6 * n * (r / (1 - r * r)) ** 2) ** (1 / 3))))
        low, high = interval(x, min(block, n // 3), replications, level)
        held += low <= 0 <= high
    return held / series


one = first_order(400, 0.7)
long = [first_order(20000, rho) for rho in (0.5, 0.8, 0.9)]
SERIES = 1500
golden = {
    "series": one.round(6).tolist(),
    "block": 15,
    "intervals": [[level, *interval(one.round(6), 15, 40000, level)] for level in (0.9, 0.99)],
    "block_lengths": [[neighbours(x), len(x), float(optimal_block_length(x)["circular"].iloc[0])] for x in long],
    "coverage_series": SERIES,
    "coverage": [[rho, n, level, coverage(n, rho, SERIES, 300, level)] for rho, n, level in ((0.0, 300, 0.9), (0.5, 300, 0.9), (0.8, 300, 0.9), (0.8, 1500, 0.9))],
}
Path(__file__).with_suffix(".json").write_text(json.dumps(golden))
