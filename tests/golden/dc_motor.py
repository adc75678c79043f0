"""Golden numbers for src/motor: the hybrid DC motor by scipy's DOP853 with events, rtol 1e-12.

Written apart from the Rust code: sliding left, sliding right and standing are three systems of
equations, and every change between them is a root that solve_ivp locates.
Run: python dc_motor.py > dc_motor.json
"""

import json

import numpy as np
import scipy
from scipy.integrate import solve_ivp

TRUTH = dict(J=0.1, K=0.2, L=0.1, R=1.5, T_s=0.1, T_c=0.2, T_v1=0.05, T_v2=0.05, T_v3=0.02, omega_s=0.01)
STRIBECK = TRUTH | dict(T_s=0.3, T_c=0.15, omega_s=0.1, T_v2=0.0, T_v3=0.0)
HOLD, DT = 0.2, 0.05


def friction(p, w, s):
    v = s * w
    dry = p["T_c"] + (p["T_s"] - p["T_c"]) * np.exp(-v / p["omega_s"])
    return s * (dry + p["T_v1"] * v + p["T_v2"] * v**2 + p["T_v3"] * v**3)


def slide(p, u, s):
    def f(_, y):
        i, w = y
        return [(u - p["R"] * i - p["K"] * w) / p["L"], (p["K"] * i - friction(p, w, s)) / p["J"]]

    def stop(_, y):
        return s * y[1]

    stop.terminal, stop.direction = True, -1
    return f, stop


def stand(p, u):
    def f(_, y):
        return [(u - p["R"] * y[0]) / p["L"], 0.0]

    def slip(_, y):
        return abs(p["K"] * y[0]) - p["T_s"]

    slip.terminal, slip.direction = True, 1
    return f, slip


def simulate(p, levels):
    y, mode, out, events = np.zeros(2), 0, [], []
    for n, u in enumerate(levels):
        t, end = n * HOLD, (n + 1) * HOLD
        grid = [n * HOLD + k * DT for k in range(1, round(HOLD / DT) + 1)]
        values = {}
        while t < end:
            f, event = stand(p, u) if mode == 0 else slide(p, u, mode)
            # A start on the event itself would be found again: nudge past it in closed form.
            r = solve_ivp(f, (t, end), y, method="DOP853", rtol=1e-12, atol=1e-14, events=event,
                          dense_output=True, first_step=1e-9 if end - t > 1e-8 else None)
            for k, g in enumerate(grid):
                if k not in values and g <= r.t[-1] + 1e-12:
                    values[k] = r.sol(min(g, r.t[-1])).tolist()
            t, y = r.t[-1], r.y[:, -1].copy()
            if r.status == 1:
                torque = p["K"] * y[0]
                if mode == 0:
                    mode = int(np.sign(torque))
                    # breakaway: step 1e-7 s by Taylor, w = s K i' t^2 / (2 J)
                    di = (u - p["R"] * y[0]) / p["L"]
                    y = np.array([y[0] + di * 1e-7, p["K"] * di * 0.5e-14 / p["J"]])
                    t += 1e-7
                else:
                    y[1] = 0.0
                    mode = 0 if abs(torque) <= p["T_s"] else int(np.sign(torque))
                    if mode:
                        a = (torque - mode * p["T_s"]) / p["J"]
                        di = (u - p["R"] * y[0]) / p["L"]
                        y = np.array([y[0] + di * 1e-9, a * 1e-9])
                        t += 1e-9
                events.append([t, mode])
        out += [values[k] for k in sorted(values)]
    return out, events


def main():
    rng = np.random.default_rng(5)
    levels = np.round(rng.uniform(-5, 5, 24), 3).tolist()
    levels[6:9] = [0.9, 1.3, 0.4]   # creep: between breakaway and Coulomb
    levels[14:16] = [0.3, -0.9]     # stand, then creep the other way
    cases = []
    for p in (TRUTH, STRIBECK):
        out, events = simulate(p, levels)
        assert len(out) == len(levels) * round(HOLD / DT)
        cases.append(dict(parameters=list(p.values()), events=len(events), current=[y[0] for y in out],
                          omega=[y[1] for y in out]))
    print(json.dumps(dict(scipy=scipy.__version__, hold=HOLD, dt=DT, levels=levels, cases=cases)))


main()
