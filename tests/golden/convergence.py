"""Makes convergence.json: arviz's R-hat and effective sample sizes for src/statistics/convergence.rs."""

import json
from pathlib import Path

import arviz
import numpy as np

rng = np.random.default_rng(1)


def first_order(rho, chains, draws):
    x = rng.standard_normal((chains, draws))
    for t in range(1, draws):
        x[:, t] = rho * x[:, t - 1] + np.sqrt(1 - rho**2) * x[:, t]
    return x


apart = first_order(0.3, 4, 101)
apart[2] += 1.5
cases = {
    "independent": rng.standard_normal((4, 300)),
    "slow": first_order(0.95, 4, 120),
    "alternating": -0.1 + first_order(-0.7, 2, 80),
    "apart": apart,
    "width": rng.standard_normal((4, 100)) * np.array([[1], [1], [1], [4]]),
    "heavy": rng.standard_cauchy((3, 60)),
    "ties": np.round(rng.standard_normal((4, 300)), 1),
    "drift": rng.standard_normal((2, 90)) + np.linspace(0, 3, 90),
}
golden = [
    {
        "name": name,
        "chains": np.round(x, 6).tolist(),
        "r_hat": float(arviz.rhat(np.round(x, 6), method="rank")),
        "ess_bulk": float(arviz.ess(np.round(x, 6), method="bulk")),
        "ess_tail": float(arviz.ess(np.round(x, 6), method="tail")),
    }
    for name, x in cases.items()
]
Path(__file__).with_suffix(".json").write_text(json.dumps(golden))
for case in golden:
    print(case["name"], case["r_hat"], case["ess_bulk"], case["ess_tail"])
