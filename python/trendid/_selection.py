"""Many structures compared on a record."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, List, Optional, Union

from numpy.typing import ArrayLike

from . import _trendid
from ._signals import Array, Coulomb, count_of, delay_of, flag_of, pole_of, signals


@dataclass(frozen=True, eq=False)
class Candidate:
    """One structure at its best filter and delay."""

    order: int
    integrator: bool
    zeros: int
    constant: bool
    #: That it is compared at, in samples.
    delay: int
    #: That of its parameters in samples, between two of them where it was searched.
    model_delay: float
    #: Standard deviation of that in samples, contained in ``sigma``; None where the delay was given.
    delay_sigma: Optional[float]
    #: Whether the longest delay that was tried is the best.
    delay_at_end: bool
    #: [rad/s]
    filter_pole: float
    #: Names of the parameters.
    parameters: List[str]
    theta: Array
    #: Standard deviations.
    sigma: Array
    #: Fit [%] of free simulations of eighths of the record, each by a model that has not seen it, initial state and constant
    #: refitted.
    fit: float


@dataclass(frozen=True)
class Dropped:
    """A structure that is no candidate, and why."""

    order: int
    integrator: bool
    zeros: int
    constant: bool
    reason: str


@dataclass(frozen=True)
class Selection:
    """All structures, and the one with the fewest parameters among those that simulate about as well as the best."""

    candidates: List[Candidate]
    dropped: List[Dropped]
    #: The recommended candidate.
    recommended: Candidate
    #: The candidates that simulate about as well as the best, the recommended one among them.
    alike: List[Candidate]
    #: ``one step`` or ``one sine``: an input that says too little for a structure; else None.
    poor_input: Optional[str]

    def __str__(self) -> str:
        lines = ["order integrator zeros delay parameters    fit"]
        for c in self.candidates:
            mark = " <== recommended" if c is self.recommended else " about as good" if c in self.alike else ""
            integrator = "yes" if c.integrator else "no"
            lines.append(
                f"{c.order:5} {integrator:>10} {c.zeros:5} {c.delay:5} {len(c.parameters):10} {c.fit:6.2f} %{mark}"
            )
        if self.poor_input is not None:
            lines.append(f"in doubt: the structure rests on {self.poor_input}, which no other signal confirms")
        return "\n".join(lines)


def select(
    t: ArrayLike,
    u: Any,
    y: Any,
    *,
    max_order: int = 3,
    integrator: bool = False,
    constant: bool = False,
    coulomb: Coulomb = False,
    delay: Union[int, str] = "auto",
    pole: Union[float, str] = "auto",
    scheme: str = "tustin",
    hold: str = "zoh",
    names: Optional[List[str]] = None,
) -> Selection:
    """Compares all orders up to ``max_order`` (1 to 4), with and without integrator (``integrator=True``: only with), and zeros.

    The other parameters are those of :func:`identify`.

    Raises
    ------
    Refusal
        (a ValueError) for what cannot be used, or when no structure fits.
    """
    taken, _ = signals(t, u, y, names, hold, coulomb)
    found = _trendid.select(
        taken,
        {
            "max_order": count_of(max_order, "max_order", 1, 4),
            "integrator": flag_of(integrator, "integrator"),
            "constant": flag_of(constant, "constant"),
            "delay": delay_of(delay),
            "pole": _pole(pole),
            "scheme": scheme,
        },
    )
    candidates = [Candidate(**one) for one in found["candidates"]]
    return Selection(
        candidates=candidates,
        dropped=[Dropped(**one) for one in found["dropped"]],
        recommended=candidates[found["recommended"]],
        alike=[candidates[k] for k in found["alike"]],
        poor_input=found["poor_input"],
    )


def _pole(pole: Union[float, str]) -> Optional[float]:
    if pole is None:
        raise _trendid.Refusal("pole is None, expected a number of rad/s or 'auto': structures are compared behind a filter")
    return pole_of(pole)
