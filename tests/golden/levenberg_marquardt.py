"""Golden numbers for src/identification/levenberg_marquardt.rs from MINPACK and scipy's trf.

Problems of More, Garbow, Hillstrom, *Testing Unconstrained Optimization Software*, 1981.
Usage: python levenberg_marquardt.py > levenberg_marquardt.json
"""
import json
import numpy as np
from scipy.optimize import least_squares

BARD_Y = np.array([.14, .18, .22, .25, .29, .32, .35, .39, .37, .58, .73, .96, 1.34, 2.10, 4.39])
KOWALIK_Y = np.array([.1957, .1947, .1735, .1600, .0844, .0627, .0456, .0342, .0323, .0235, .0246])
KOWALIK_U = np.array([4, 2, 1, .5, .25, .167, .125, .1, .0833, .0714, .0625])
MEYER_Y = np.array([34780, 28610, 23650, 19630, 16370, 13720, 11540, 9744, 8261, 7030, 6005, 5147,
                    4427, 3820, 3307, 2872])


def rosenbrock(x):
    return np.array([10 * (x[1] - x[0] ** 2), 1 - x[0]])


def powell_singular(x):
    return np.array([x[0] + 10 * x[1], 5 ** .5 * (x[2] - x[3]), (x[1] - 2 * x[2]) ** 2,
                     10 ** .5 * (x[0] - x[3]) ** 2])


def freudenstein_roth(x):
    return np.array([-13 + x[0] + ((5 - x[1]) * x[1] - 2) * x[1],
                     -29 + x[0] + ((x[1] + 1) * x[1] - 14) * x[1]])


def bard(x):
    u = np.arange(1, 16.)
    v = 16 - u
    return BARD_Y - (x[0] + u / (v * x[1] + np.minimum(u, v) * x[2]))


def kowalik_osborne(x):
    u = KOWALIK_U
    return KOWALIK_Y - x[0] * (u ** 2 + u * x[1]) / (u ** 2 + u * x[2] + x[3])


def meyer(x):
    t = 45 + 5 * np.arange(1, 17.)
    return x[0] * np.exp(x[1] / (t + x[2])) - MEYER_Y


def jennrich_sampson(x):
    i = np.arange(1, 11.)
    return 2 + 2 * i - (np.exp(i * x[0]) + np.exp(i * x[1]))


CASES = [
    (rosenbrock, [-1.2, 1], None), (powell_singular, [3, -1, 0, 1], None),
    (freudenstein_roth, [.5, -2], None), (bard, [1, 1, 1], None),
    (kowalik_osborne, [.25, .39, .415, .39], None), (meyer, [.02, 4000, 250], None),
    (jennrich_sampson, [.3, .4], None),
    (rosenbrock, [-1.2, 1], ([-2, 1.5], [.5, 3])), (bard, [1, 1, 1], ([0, 1.2, 0], [1, 3, 2])),
    (kowalik_osborne, [.25, .39, .415, .39], ([0, 0, 0, .15], [1, 1, .1, 1])),
    (jennrich_sampson, [.1, .2], ([0, 0], [.2, .25])),
]

out = []
for f, start, box in CASES:
    options = dict(xtol=1e-15, ftol=1e-15, gtol=1e-15, max_nfev=20000)
    if box is None:
        s = least_squares(f, start, method='lm', **options)
    else:
        s = least_squares(f, np.clip(start, *box), bounds=box, method='trf', x_scale='jac', **options)
    out.append(dict(problem=f.__name__, start=start, bounds=box, x=s.x.tolist(),
                    sum_of_squares=2 * s.cost))
print(json.dumps(out, indent=1))
