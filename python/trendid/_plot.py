"""Pictures by matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from ._axis import Log
    from ._record import Identification


def _axes(given: Any, rows: int, ratios: list[int]) -> Any:
    if given is not None:
        return given
    try:
        from matplotlib import pyplot
    except ImportError as error:
        raise ImportError("plot() needs matplotlib: pip install matplotlib") from error
    _, axes = pyplot.subplots(
        rows, 1, sharex=True, figsize=(8, 5), gridspec_kw={"height_ratios": ratios}, layout="constrained"
    )
    return axes


def identification(found: Identification, axes: Any) -> Any:
    """Record and free simulation above, their difference below."""
    upper, lower = _axes(axes, 2, [3, 1])
    t = found.start + found.dt * np.arange(len(found.y))
    upper.plot(t, found.y, label="record", color="0.6")
    if found.simulated is not None:
        half = len(found.y) - len(found.simulated)
        upper.plot(t[half:], found.simulated, label=f"free simulation, fit {found.fit:.2f} %", linewidth=1)
        lower.plot(t[half:], found.y[half:] - found.simulated, color="C3", linewidth=0.7)
    upper.set_ylabel("y")
    upper.legend(loc="upper left")
    lower.set_ylabel("difference")
    lower.set_xlabel("t [s]")
    return upper.figure


def log(run: Log, axes: Any) -> Any:
    """Position and setpoint above, command below."""
    upper, lower = _axes(axes, 2, [3, 1])
    upper.plot(run.t, run.setpoint, label="setpoint", color="0.6")
    upper.plot(run.t, run.position, label="position", linewidth=1)
    upper.set_ylabel("mm")
    upper.legend(loc="upper left")
    lower.plot(run.t, run.command, color="C2", linewidth=0.7)
    lower.set_ylabel("command")
    lower.set_xlabel("t [s]")
    return upper.figure
