"""Makes statistics.json: statsmodels and scipy numbers for src/statistics/tests.rs."""

import json
from pathlib import Path

import numpy as np
import statsmodels.api as sm
from scipy import special, stats
from statsmodels.stats.diagnostic import acorr_ljungbox
from statsmodels.tsa.stattools import acf

n = 60
k = np.arange(n)
X = np.column_stack([np.sign(np.sin(0.31 * k + 0.1)), 2.0 * np.sin(0.31 * k + 0.1), np.cos(0.12 * k)])
e = 0.3 * np.sin(1.1 * k * k % 7) + 0.2 * np.cos(0.4 * k)
y = X @ [3.0, 0.8, -0.4] + e
fit = sm.OLS(y, X).fit()



def quadratic_spectral(scores, slots, bandwidth):
    """Andrews (1991), Eq. 2.7: sum over all pairs of rows."""
    x = 6 * np.pi / 5 * np.subtract.outer(slots, slots) / bandwidth
    with np.errstate(invalid="ignore", divide="ignore"):
        w = np.where(x == 0, 1.0, 3 / x**2 * (np.sin(x) / x - np.cos(x)))
    return scores.T @ w @ scores


gapped = np.concatenate([k[:25], k[25:] + 7])
golden = {
    "gapped": gapped.tolist(),
    "quadratic_spectral": quadratic_spectral(X * e[:, None], gapped, 4.5).tolist(),
    "errors": e.tolist(),
    "x": X.T.tolist(),
    "y": y.tolist(),
    "beta": fit.params.tolist(),
    "covariance": fit.cov_params().tolist(),
    "p": fit.pvalues.tolist(),
    "interval": fit.conf_int(0.01).tolist(),
    "newey_west": {
        str(lags): sm.OLS(y, X).fit(cov_type="HAC", cov_kwds={"maxlags": lags, "use_correction": False}).cov_params().tolist()
        for lags in [0, 4, 12]
    },
    "normal_tail": [[z, 2 * stats.norm.sf(z), (np.log(2) + special.log_ndtr(-z)) / np.log(10)] for z in [0.0, 0.5, 2.5758293035489, 9.0, 30.0, 37.0, 60.0]],
    "student_tail": [
        [t, nu, 2 * stats.t.sf(t, nu), np.log10(2 * stats.t.sf(t, nu))]
        for t, nu in [(0.3, 1), (2.0, 3.5), (2.6, 12), (1.0, 5000), (8.0, 250), (40.0, 900), (3.0, 250.5), (30.0, 100000)]
    ],
    "student_quantile": [[a, nu, float(stats.t.isf(a / 2, nu))] for a, nu in [(0.01, 1.0), (0.01, 3.7), (0.05, 30), (0.01, 995), (1e-6, 8)]],
    "acf": acf(y, nlags=6, fft=False).tolist(),
    "ljung_box": [[int(l), *map(float, acorr_ljungbox(y, lags=[l]).iloc[0])] for l in [1, 8]],
}
Path(__file__).with_suffix(".json").write_text(json.dumps(golden))
