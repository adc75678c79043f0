"""A digital twin of robot arms that says why it is wrong.

>>> import armtwin as at
>>> twin = at.Twin.load("my_arm.toml")              # or from_urdf, from_mjcf, builtin("ur5")
>>> rec = at.Recording(t, q, current=i)             # or at.read("run.mcap")
>>> fit = at.identify(twin, rec, check=other)       # parameters with tests and intervals
>>> dx = at.diagnose(twin, rec, check=other)        # where the twin is wrong, and why
>>> sim = at.simulate(twin, at.motions.random_sines(seconds=60, seed=1), effects={"payload": dict(mass=2.0)})

SI units throughout; arrays are ``(T, n)``, joints base to wrist.
"""

from __future__ import annotations

from . import motions
from ._engine import __version__
from ._errors import DoubtfulRecording, EngineFault, Error, InputError, WorkError
from ._signals import Signals
from ._table import Table
from .diagnosis import Diagnosis, diagnose
from .identification import Identification, Prediction, identify, predict
from .recording import Recording, read
from .simulation import Simulation, effects, simulate
from .twin import Robot, Twin

__all__ = [
    "Diagnosis",
    "DoubtfulRecording",
    "EngineFault",
    "Error",
    "Identification",
    "InputError",
    "Prediction",
    "Recording",
    "Robot",
    "Signals",
    "Simulation",
    "Table",
    "Twin",
    "WorkError",
    "__version__",
    "diagnose",
    "effects",
    "identify",
    "motions",
    "predict",
    "read",
    "simulate",
]
