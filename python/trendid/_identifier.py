"""The identifier of the microcontroller, sample by sample."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Dict, List, Optional, Sequence, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _trendid
from ._record import Quantity, control_of, lti_of
from ._signals import Array, column, count_of, flag_of, number_of, numbers
from ._trendid import Refusal


@dataclass(frozen=True)
class Reading:
    """A model at one moment: noise bias taken out, an insignificant constant withdrawn. Units are those of u and y, and s."""

    #: In the order ``a_i``, ``b_i`` of each input, constant, initial state.
    theta: Array
    #: Standard deviations.
    sigma: Array
    #: n x n.
    covariance: Array
    #: ``a_0 .. a_{m-1}`` of the denominator ``s^m + ..``.
    a: Array
    #: ``b_0 ..`` of each input.
    b: List[Array]
    constant: float
    #: Static gain, or velocity gain C behind an integrator [y/s per u], of the first input.
    gain: Optional[Quantity]
    #: Natural frequency [rad/s].
    omega0: Optional[Quantity]
    damping: Optional[Quantity]
    #: [rad/s]
    poles: NDArray[np.complex128]
    #: Whether the poles behind the integrator are stable.
    stable: bool
    #: Sums of the squared and of the absolute prediction errors so far.
    ise: float
    iae: float

    def lti(self, index: int = 0) -> Any:
        """Transfer function from an input without its delay, a ``scipy.signal.TransferFunction``."""
        return lti_of(self.a, self.b[index])

    def to_control(self, index: int = 0) -> Any:
        """The same for python-control."""
        return control_of(self.a, self.b[index], 0.0, 0)


@dataclass(frozen=True)
class Pass:
    """What a pass over arrays gave, in the f32 of the microcontroller."""

    #: Parameters after every so-many-th sample, one row each.
    theta: NDArray[np.float32]
    #: Error of the prediction of each sample, in the unit of y; NaN where there was none.
    innovation: NDArray[np.float32]
    #: Number of the outcome of each sample in :attr:`Identifier.OUTCOMES`.
    outcome: NDArray[np.uint8]


class Identifier:
    """Recursive least squares on filtered trends, in f32, as it runs on the microcontroller.

    >>> identifier = Identifier(0.001, bandwidth=20.0, input_range=0.4, output_range=50.0)
    >>> for u, y in samples:
    ...     identifier.update(u, y)
    >>> identifier.estimate().theta

    Parameters
    ----------
    sample_time : [s]
    order : 1 to 4, the integrator included
    integrator : the drive integrates, ``a0 = 0``
    zeros : ``b0 .. b_zeros`` of each input are estimated
    constant : an offset, withdrawn from the reading while the data do not show one
    initial_state : the error of the first output is a parameter
    bandwidth : rough natural frequency of the drive [rad/s]
    input_range : usual size of the input, or one for each input
    output_range : usual size of the movement of the output
    filter : ``f_0 .. f_{m-1}`` of the filter polynomial; ``None`` for the default of the bandwidth, ``'raw'`` for raw trends
    delay : of the inputs in samples, 0 to 512
    memory : [s]; without it nothing is forgotten
    output_noise : standard deviation of the noise of y before it is known
    scheme : ``'tustin'`` or ``'goodwin'``
    hold : what the inputs do between samples, ``'zoh'`` or ``'foh'``
    reference : subtracted from y in f64, before f32 rounds a position far from zero

    The defaults are those of ``trendid::Servo``.
    """

    #: What can become of a sample.
    OUTCOMES: List[str] = list(_trendid.Recursion.outcomes)

    def __init__(
        self,
        sample_time: float,
        *,
        bandwidth: float,
        output_range: float,
        input_range: Union[float, Sequence[float]] = 1.0,
        order: int = 3,
        integrator: bool = True,
        zeros: int = 0,
        constant: bool = True,
        initial_state: bool = True,
        filter: Union[Sequence[float], str, None] = None,
        delay: int = 0,
        memory: Optional[float] = None,
        output_noise: Optional[float] = None,
        scheme: str = "tustin",
        hold: str = "zoh",
        reference: float = 0.0,
    ) -> None:
        if isinstance(filter, str) and filter != "raw":
            raise Refusal(f"filter is {filter!r}, expected coefficients, None or 'raw'")
        if not np.isfinite(number_of(reference, "reference")):
            raise Refusal(f"reference is {reference!r}, expected a finite number")
        raw = isinstance(filter, str)
        ranges = np.atleast_1d(column(np.atleast_1d(input_range), "input_range"))
        self._core = _trendid.Recursion(
            {
                "sample_time": number_of(sample_time, "sample_time"),
                "order": count_of(order, "order", 1, 4),
                "integrator": flag_of(integrator, "integrator"),
                "zeros": count_of(zeros, "zeros", 0, 3),
                "constant": flag_of(constant, "constant"),
                "initial_state": flag_of(initial_state, "initial_state"),
                "input_ranges": [float(size) for size in ranges],
                "output_range": number_of(output_range, "output_range"),
                "bandwidth": number_of(bandwidth, "bandwidth"),
                "filter": None if raw or filter is None else column(filter, "filter").tolist(),
                "raw": raw,
                "delay": count_of(delay, "delay", 0, 512),
                "memory": None if memory is None else number_of(memory, "memory"),
                "output_noise": None if output_noise is None else number_of(output_noise, "output_noise"),
                "scheme": scheme,
                "hold": hold,
                "reference": number_of(reference, "reference"),
            }
        )
        self._inputs = len(ranges)

    def update(self, u: Union[float, Sequence[float]], y: float) -> Optional[float]:
        """Takes u (in force until the next sample) and y of one sample; the innovation in the unit of y, None without one.

        A sample that is not finite is refused and leaves no trace: :meth:`run` tells by its outcomes.
        """
        # The scalars of numpy are neither numbers of Python nor sequences.
        single = isinstance(u, (int, float)) or np.ndim(u) == 0
        values = [_sample(u, "u")] if single else [_sample(one, "u") for one in u]  # type: ignore[union-attr]
        return self._core.update(values, _sample(y, "y"))[1]

    def run(self, u: ArrayLike, y: ArrayLike, *, every: int = 1) -> Pass:
        """Takes whole arrays (u: n, or n x inputs), with the parameters after every so-many-th sample, 0 for none.

        Other threads of Python run meanwhile.
        """
        table = numbers(u, "u")
        if table.ndim == 1:
            table = table.reshape(-1, 1)
        if table.ndim != 2:
            raise Refusal(f"u has the shape {table.shape}, expected one or two dimensions")
        return Pass(*self._core.run(table, column(y, "y"), count_of(every, "every", 0, 10**12)))

    @property
    def theta(self) -> NDArray[np.float32]:
        """The parameters, as :meth:`estimate` has them, at about a sixth of its cost."""
        return self._core.theta()

    def estimate(self) -> Reading:
        """The model at this moment."""
        found: Dict[str, Any] = self._core.estimate()
        sigmas = found.pop("reading_sigma") or (float("nan"),) * 3
        for name, sigma in zip(("gain", "omega0", "damping"), sigmas):
            value = found[name]
            found[name] = None if value is None else Quantity(value, sigma)
        found["poles"] = np.array([complex(*pole) for pole in found["poles"] or []])
        return Reading(**found)

    def adapt(self, on: bool) -> None:
        """Lets the estimate move (as constructed) or holds it; predictions go on."""
        self._core.adapt(flag_of(on, "on"))

    def reset(self) -> None:
        """Begins again from nothing."""
        self._core.reset()

    def warm_start(self, theta: Sequence[float], std: Sequence[float]) -> None:
        """Begins again from parameters with their standard deviations, in the order of ``theta``."""
        self._core.warm_start(column(theta, "theta").tolist(), column(std, "std").tolist())


def _sample(value: Any, name: str) -> float:
    """A number of a sample; those of Python pass at once."""
    return float(value) if isinstance(value, (int, float)) else number_of(value, name)
