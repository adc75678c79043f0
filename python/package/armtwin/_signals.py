"""How recordings are taken and conditioned."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any, Literal


@dataclass(frozen=True)
class Signals:
    """Conditioning of a recording; what is None stays as the job usually has it.

    Parameters
    ----------
    rate_hz : float, optional
        Resample onto this rate; the recording's own.
    derivatives : {"position", "tracking_error", "recorded", "paper"}, optional
        Where velocity and acceleration come from.
    motion_cutoff_hz, torque_cutoff_hz : float, optional
        Zero-phase low-passes of the motion, and of torque and regressors alike; 0 for none.
    filter_order : int, optional
        Butterworth order of both.
    standstill_rad_s : float, optional
        Samples at or below this speed do not slide; 0 keeps all.
    guard_s, margin_s : float, optional
        Left out beside standstill, and at both ends.
    decimation : int, optional
        Keep every n-th sample.
    """

    rate_hz: float | None = None
    derivatives: Literal["position", "tracking_error", "recorded", "paper"] | None = None
    motion_cutoff_hz: float | None = None
    torque_cutoff_hz: float | None = None
    filter_order: int | None = None
    standstill_rad_s: float | None = None
    guard_s: float | None = None
    margin_s: float | None = None
    decimation: int | None = None


def taken(signals: Signals | None, every_row: bool, force: bool) -> dict[str, Any]:
    """As the engine takes them."""
    return {"signals": asdict(signals or Signals()), "every_row": every_row, "force": force}
