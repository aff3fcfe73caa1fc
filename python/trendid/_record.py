"""A model from a record."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Dict, List, Optional, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _trendid
from ._signals import Array, Coulomb, count_of, delay_of, flag_of, number_of, pole_of, signals


@dataclass(frozen=True)
class Quantity:
    """A value with its standard deviation."""

    #: In the units of the signals and s.
    value: float
    #: NaN where it is not known.
    sigma: float

    def __str__(self) -> str:
        return f"{self.value:.6g} +- {self.sigma:.2g}"


def transfer_polynomials(a: Array, b: Array) -> Tuple[Array, Array]:
    """Numerator and denominator, highest power first, as SciPy and python-control take them."""
    return np.array(b[::-1], dtype=float), np.concatenate(([1.0], a[::-1]))


def lti_of(a: Array, b: Array) -> Any:
    """The transfer function without its delay, for SciPy."""
    try:
        from scipy.signal import TransferFunction
    except ImportError as error:
        raise ImportError("lti() needs SciPy: pip install scipy") from error
    return TransferFunction(*transfer_polynomials(a, b))


def control_of(a: Array, b: Array, delay_s: float, pade: int) -> Any:
    """The transfer function for python-control; its delay as a Pade approximation."""
    try:
        import control
    except ImportError as error:
        raise ImportError("to_control() needs python-control: pip install control") from error
    model = control.tf(*transfer_polynomials(a, b))
    if delay_s > 0.0 and pade > 0:
        model = model * control.tf(*control.pade(delay_s, pade))
    return model


@dataclass(frozen=True)
class Identification:
    """A model of a record, with what speaks for it. Units are those of u and y, and s."""

    #: Names of the parameters in the order of ``theta``: ``a0`` .. , ``b0`` .. of each input, ``constant``.
    parameters: List[str]
    #: The parameters.
    theta: Array
    #: Their standard deviations.
    sigma: Array
    #: Their covariance, n x n.
    covariance: Array
    #: ``a_0 .. a_{m-1}`` of the denominator ``s^m + a_{m-1} s^{m-1} + .. + a_0``.
    a: Array
    #: ``b_0 ..`` of each input, by its name.
    b: Dict[str, Array]
    #: The constant on the right-hand side of the differential equation.
    constant: float
    #: Sampling interval [s].
    dt: float
    #: Delay of the inputs in samples; with ``delay='auto'`` also between samples.
    delay: float
    #: Whether the longest delay that is tried was taken: give a longer one.
    delay_at_end: bool
    #: With ``delay='auto'``: ``one step`` or ``one sine``, an input that says too little for delay and parameters; else None.
    poor_input: Optional[str]
    #: Filter pole [rad/s], None for raw trends.
    filter_pole: Optional[float]
    #: ``f_0 .. f_{m-1}`` of the filter with the poles of the model itself, where that was taken.
    filter: Optional[Array]
    #: ``instruments``, ``least squares`` (instruments are weak on this record) or ``recursion`` (see :func:`identify`).
    method: str
    #: Blocks of the record that the standard deviations rest on; None for those of the recursion, which take noise for white.
    effective_blocks: Optional[float]
    #: Parameters and standard deviations by least squares behind the same filter, for comparison.
    least_squares: Optional[Tuple[Array, Array]]
    #: Fit [%] of a free simulation of the second half, ``100 (1 - |y - y_sim| / |y - mean(y)|)``, initial state refitted; NaN
    #: where the model runs away.
    fit: float
    #: The same with the constant refitted too: the fair figure behind an integrator.
    fit_constant: float
    #: Whether the simulated model, its filter and its delay come from the first half alone.
    held_out: bool
    #: Simulated output of the second half, from sample ``len(y) // 2`` on.
    simulated: Optional[Array]
    #: Sums of the squared and of the absolute one-step prediction errors of the recursion, over ``predicted`` samples.
    ise: float
    iae: float
    predicted: int
    #: Static gain, or behind an integrator velocity gain C [y/s per u], of each input by its name.
    gains: Dict[str, Quantity]
    #: Natural frequency [rad/s] and damping, where the model has them.
    omega0: Optional[Quantity]
    damping: Optional[Quantity]
    #: Poles [rad/s], the integrator included.
    poles: NDArray[np.complex128]
    #: Poles behind the integrator as (real part, imaginary part), with standard deviations.
    pole_sigmas: List[Tuple[Quantity, Quantity]]
    #: Time constants of the real poles [s].
    time_constants: List[Quantity]
    #: ``inertia``, ``viscous``, ``coulomb``, ``offset`` of ``1/(s (s + a1))`` in units of the first input; else empty.
    force_balance: Dict[str, Quantity]
    #: Whether the poles behind the integrator are stable.
    stable: bool
    #: Seconds of standstill that were left out.
    standstill_s: float
    #: With ``trace``: sample numbers, parameters and standard deviations in the course of the recursion.
    trace_samples: NDArray[np.uint64]
    trace_theta: Array
    trace_sigma: Array
    #: Coefficients ``a``, ``b`` two standard deviations away along each axis of the covariance, for :func:`tune`.
    around: List[Tuple[List[float], List[float]]] = field(repr=False)
    #: The record: first time stamp [s], output.
    start: float = field(repr=False)
    y: Array = field(repr=False)

    @property
    def delay_s(self) -> float:
        """Delay of the inputs [s]."""
        return self.delay * self.dt

    @property
    def gain(self) -> Quantity:
        """Gain of the first input: static, or velocity gain C behind an integrator."""
        return next(iter(self.gains.values()))

    def __getitem__(self, name: str) -> Quantity:
        """A parameter by its name: ``model['a1']``."""
        if name not in self.parameters:
            raise KeyError(f"{name!r} is none of {', '.join(self.parameters)}")
        k = self.parameters.index(name)
        return Quantity(float(self.theta[k]), float(self.sigma[k]))

    def _b(self, name: Optional[str]) -> Array:
        if name is None:
            return next(iter(self.b.values()))
        if name not in self.b:
            raise KeyError(f"{name!r} is none of the inputs {', '.join(self.b)}")
        return self.b[name]

    def lti(self, name: Optional[str] = None) -> Any:
        """Transfer function from the input ``name`` (the first) without its delay, a ``scipy.signal.TransferFunction``."""
        return lti_of(self.a, self._b(name))

    def to_control(self, name: Optional[str] = None, pade: int = 2) -> Any:
        """The same for python-control; the delay as a Pade approximation of this order, 0 leaves it out."""
        return control_of(self.a, self._b(name), self.delay_s, pade)

    def plot(self, axes: Any = None) -> Any:
        """Record and free simulation of the second half, and their difference; needs matplotlib. Returns the figure."""
        from ._plot import curves

        t = self.start + self.dt * np.arange(len(self.y))
        above = [(t, self.y, "record")]
        below = []
        if self.simulated is not None:
            half = len(self.y) - len(self.simulated)
            above.append((t[half:], self.simulated, f"free simulation, fit {self.fit:.2f} %"))
            below.append((t[half:], self.y[half:] - self.simulated, "C3"))
        return curves(axes, above, "y", below, "difference")

    def __str__(self) -> str:
        lines = [f"{name} = {self[name]}" for name in self.parameters]
        gain = "velocity gain C" if self.a[0] == 0.0 else "static gain"
        lines += [f"{gain} of {name} = {value}" for name, value in self.gains.items()]
        if self.omega0 is not None:
            lines.append(f"natural frequency = {self.omega0} rad/s")
        if self.damping is not None:
            lines.append(f"damping = {self.damping}")
        lines.append(f"delay = {self.delay:g} samples")
        if self.poor_input is not None:
            lines.append(f"doubtful: delay and parameters rest on {self.poor_input}")
        lines.append(f"fit = {self.fit:.2f} % (x0), {self.fit_constant:.2f} % (x0+c), by {self.method}")
        return "\n".join(lines)


def identify(
    t: ArrayLike,
    u: Any,
    y: Any,
    *,
    order: int,
    integrator: bool = False,
    zeros: int = 0,
    constant: bool = False,
    coulomb: Coulomb = False,
    delay: Union[int, str] = 0,
    pole: Union[float, str, None] = "auto",
    memory: Optional[float] = None,
    scheme: str = "tustin",
    hold: str = "zoh",
    names: Optional[List[str]] = None,
    trace: int = 0,
) -> Identification:
    """The model of a record, ``A(s) y = B(s) u(t - d dt) + c sgn(v) + constant``, in SI units with standard deviations.

    Parameters
    ----------
    t : time stamps [s], equally spaced (also ``datetime64``), or the sampling interval [s]
    u : input, or inputs as a table with a column for each (2-D array, DataFrame) or a mapping of names to arrays
    y : output, as many samples
    order : 1 to 4, the integrator included
    integrator : the drive integrates, ``a0 = 0``
    zeros : ``b0 .. b_zeros`` of each input are estimated
    constant : an offset; its standard deviation says whether the record shows one
    coulomb : adds sgn(v); True takes v from the filtered output, an array is the measured velocity
    delay : of the inputs in samples, or ``'auto'``: the best of 0 to 200
    pole : filter poles [rad/s], ``'auto'`` (by folds of the record that the model has not seen), or None for raw trends
    memory : of the estimator [s]; without it nothing is forgotten
    scheme : ``'tustin'`` or ``'goodwin'``, the trends of the recursion
    hold : what the inputs do between samples, ``'zoh'`` or ``'foh'``
    names : of the inputs
    trace : about so many rows of the course of the parameters, those before the filter has settled left out

    Returns
    -------
    Identification
        By instrumental variables over the whole record, which no noise of the output biases; with ``memory``, ``scheme='goodwin'``
        or ``pole=None`` by the recursion of the microcontroller.

    Raises
    ------
    Refusal
        (a ValueError) for what cannot be used, with the value and what was expected; for data that cannot carry the structure.
    """
    taken, start = signals(t, u, y, names, hold, coulomb)
    question = {
        "order": count_of(order, "order", 1, 4),
        "integrator": flag_of(integrator, "integrator"),
        "zeros": count_of(zeros, "zeros", 0, 3),
        "constant": flag_of(constant, "constant"),
        "delay": delay_of(delay),
        "pole": pole_of(pole),
        "memory": None if memory is None else number_of(memory, "memory"),
        "scheme": scheme,
        "trace": count_of(trace, "trace", 0, 10**9),
    }
    return _identification(_trendid.identify(taken, question), taken, start)


def _identification(found: Dict[str, Any], taken: Dict[str, Any], start: float) -> Identification:
    """The values of the native part in their places."""
    names = [name for name, _ in taken["inputs"]] + (["sgn(v)"] if taken["coulomb"] else [])
    fit = found["fit"] or (float("nan"), float("nan"))
    sigmas = found["reading_sigma"] or (None, None, None)

    def reading(value: Optional[float], sigma: Optional[float]) -> Optional[Quantity]:
        return None if value is None else Quantity(value, float("nan") if sigma is None else sigma)

    same = (
        "parameters theta sigma covariance a constant delay delay_at_end poor_input filter_pole filter method effective_blocks "
        "least_squares held_out simulated ise iae predicted stable standstill_s trace_samples trace_theta trace_sigma around"
    ).split()
    return Identification(
        **{name: found[name] for name in same},
        b=dict(zip(names, found["b"])),
        dt=taken["dt"],
        fit=fit[0],
        fit_constant=fit[1],
        gains={name: Quantity(*pair) for name, pair in zip(names, found["gains"])},
        omega0=reading(found["omega0"], sigmas[1]),
        damping=reading(found["damping"], sigmas[2]),
        poles=np.array([complex(*pole) for pole in found["poles"] or []]),
        pole_sigmas=[(Quantity(*re), Quantity(*im)) for re, im in found["pole_sigmas"]],
        time_constants=[Quantity(*pair) for pair in found["time_constants"]],
        force_balance={name: Quantity(*pair) for name, pair in found["force_balance"]},
        start=start,
        y=taken["output"],
    )
