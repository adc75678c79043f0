"""The swarm and separable least squares of benches/identification.rs, vectorised in numpy.

Six joints x 6000 samples, Eq. 1, 60 particles x 1000 iterations. Usage: python identification.py
"""
import time

import numpy as np

SAMPLES, JOINTS = 6000, 6
LOW = np.array([0, 0, 0, -50, -50, .005])
HIGH = np.array([60, 90, 100, 100, 100, .5])
TRUTH = np.array([6, 8.5, 9, -1.5, .8, .05])


def joint(j):
    n = SAMPLES + j
    t = np.arange(n) * 48 / n
    w = .7 * np.sin(1.3 * t) + .3 * np.cos(3.1 * t + 1)
    noise = .3 * 3 ** .5 * np.random.default_rng(j).uniform(-1, 1, n)
    return w, law(TRUTH[None], w)[0] + noise


def law(x, w):
    """Eq. 1 for particles x (rows) at speeds w."""
    s, a = np.sign(w), np.abs(w)
    e = np.exp(-a / x[:, 5:6])
    return (s * (x[:, :1] + (x[:, 1:2] - x[:, :1]) * e)
            + w * (x[:, 2:3] + x[:, 3:4] * a + x[:, 4:5] * (w * w)))


def rms(x, w, y):
    r = law(x, w) - y
    return np.sqrt(np.einsum('ij,ij->i', r, r) / len(y))


def swarm(w, y, rng, particles=60, iterations=1000):
    span = HIGH - LOW
    x = LOW + span * rng.random((particles, 6))
    v = np.zeros_like(x)
    own, own_cost = x.copy(), rms(x, w, y)
    for k in range(iterations):
        best = own[np.argmin(own_cost)]
        v = ((.9 - .5 * k / iterations) * v + 2 * rng.random(x.shape) * (own - x)
             + 2 * rng.random(x.shape) * (best - x))
        v = np.clip(v, -span / 2, span / 2)
        moved = x + v
        x = np.clip(moved, LOW, HIGH)
        v[x != moved] = 0
        cost = rms(x, w, y)
        better = cost < own_cost
        own[better], own_cost[better] = x[better], cost[better]
    return own_cost.min()


def separable(w, y):
    s, a = np.sign(w), np.abs(w)
    fixed = np.stack([w, w * a, w ** 3])

    def sse(ln_ws):
        e = np.exp(-a / np.exp(ln_ws))
        columns = np.vstack([s * (1 - e), s * e, fixed]).T
        gram = columns.T @ columns
        b = np.linalg.solve(gram, columns.T @ y)
        r = y - columns @ b
        return r @ r

    grid = np.linspace(np.log(.005), np.log(.5), 64)
    heights = [sse(g) for g in grid]
    k = int(np.argmin(heights))
    low, high = grid[max(k - 1, 0)], grid[min(k + 1, 63)]
    golden = (5 ** .5 - 1) / 2
    for _ in range(35):
        p, q = high - golden * (high - low), low + golden * (high - low)
        if sse(p) < sse(q):
            high = q
        else:
            low = p
    return sse((low + high) / 2)


joints = [joint(j) for j in range(JOINTS)]
start = time.perf_counter()
costs = [swarm(w, y, np.random.default_rng(1)) for w, y in joints]
print(f'pso   {time.perf_counter() - start:8.3f} s   mean cost {np.mean(costs):.9f} N.m')
start = time.perf_counter()
squares = [separable(w, y) for w, y in joints]
seconds = time.perf_counter() - start
print(f'nlse  {seconds:8.3f} s   mean cost '
      f'{np.mean([np.sqrt(s / len(y)) for s, (w, y) in zip(squares, joints)]):.9f} N.m')
