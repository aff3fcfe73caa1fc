"""Gains for the loop that a user already has, from a model and what is not known of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Dict, List, Optional, Sequence, Tuple, Union

from . import _trendid
from ._record import Identification
from ._signals import Array, column, number_of
from ._trendid import Refusal


@dataclass(frozen=True)
class Margins:
    """Of a sampled loop, broken at the input of the plant."""

    #: Factor on the gain that the loop bears.
    gain: float
    #: [degrees]
    phase_deg: float
    #: Further delay that the loop bears [s].
    delay_s: float
    #: Largest of ``|1/(1+L)|``.
    max_sensitivity: float
    #: [rad/s]
    crossover: float
    stable: bool


@dataclass(frozen=True)
class Loop:
    """One controller with its margins."""

    #: ``cascade`` (position P around velocity PI), ``pid`` (derivative of the output, filtered) or ``state feedback``.
    kind: str
    #: Bandwidth that the gains are for [rad/s].
    bandwidth: float
    #: Gains by their names, as ``trendid tune`` prints them.
    gains: Dict[str, Any]
    #: With the model.
    margins: Margins
    #: The worst within two standard deviations; None without standard deviations.
    worst: Optional[Margins]
    #: Answer to a step of the reference by 1: times [s], outputs, commands.
    step: Tuple[Array, Array, Array]


@dataclass(frozen=True)
class Tuned:
    """Gains for a model."""

    #: One loop of each kind that the plant allows.
    loops: List[Loop]
    #: Kinds without a loop, with the reason.
    refused: List[Tuple[str, str]]
    #: Commands for r, r', r'' ..: the model inverted, its delay left out.
    feedforward: Array

    def __getitem__(self, kind: str) -> Loop:
        """The loop of a kind: ``tuned['pid']``."""
        for loop in self.loops:
            if loop.kind == kind:
                return loop
        reasons = dict(self.refused)
        raise KeyError(f"no loop of the kind {kind!r}: {reasons.get(kind, 'there is no such kind')}")


def tune(
    model: Union[Identification, Tuple[Sequence[float], Sequence[float]]],
    *,
    sample_time: Optional[float] = None,
    delay: Optional[float] = None,
    bandwidth: Optional[float] = None,
) -> Tuned:
    """Gains of a cascade, a PID and a state feedback for a model.

    Parameters
    ----------
    model : what :func:`identify` found (its first input counts; the margins hold for two standard deviations around it too), or the
        coefficients ``(a_0 .. a_{m-1}), (b_0 ..)`` of a transfer function
    sample_time : of the controller [s]; that of the record without it
    delay : [s]; that of the identified model without it, else 0
    bandwidth : [rad/s]; without it the largest whose sensitivity stays at or below 1.7

    Raises
    ------
    Refusal
        (a ValueError) for a model without a controller, or a setting that cannot be used.
    """
    around: List[Tuple[List[float], List[float]]] = []
    if isinstance(model, Identification):
        a, b = list(model.a), list(next(iter(model.b.values())))
        around = model.around
        sample_time = model.dt if sample_time is None else sample_time
        delay = model.delay_s if delay is None else delay
    else:
        if not isinstance(model, (tuple, list)) or len(model) != 2:
            raise Refusal("the model is neither what identify() found nor a pair of coefficients (a, b)")
        a, b = list(column(model[0], "a")), list(column(model[1], "b"))
        if sample_time is None:
            raise Refusal("sample_time is missing: a transfer function has none of its own")
    wanted = None if bandwidth is None else number_of(bandwidth, "bandwidth")
    found = _trendid.tune((a, b), around, number_of(0.0 if delay is None else delay, "delay"), number_of(sample_time, "sample_time"), wanted)
    loops = []
    for one in found["loops"]:
        one["margins"] = Margins(**one["margins"])
        one["worst"] = None if one["worst"] is None else Margins(**one["worst"])
        loops.append(Loop(**one))
    return Tuned(loops=loops, refused=found["refused"], feedforward=found["feedforward"])
