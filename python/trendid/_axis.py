"""The simulated pneumatic axis, alone and under the adaptive position loop."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any, List, Optional, Tuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _trendid
from ._signals import Array, column, count_of, flag_of, number_of


#: The first words of the states.
_STATES = ("idle", "exciting", "identifying", "verified", "adapting", "frozen", "rejected", "failed")


def _begins(state: str, until: Any) -> bool:
    """Whether a state of this first word may begin so."""
    return isinstance(until, str) and until != "" and (state.startswith(until) or until.startswith(state))


@dataclass(frozen=True)
class Axis:
    """What differs from the axis of the project's figures: rodless, 32 mm bore, 400 mm stroke, 5 kg, 6 bar, dead zone 3 %."""

    #: Of the noise of the sensor.
    seed: int = 1
    #: Moving mass [kg], 0.1 to 1000.
    mass: Optional[float] = None
    #: Constant force toward larger positions [N], -1000 to 1000.
    load: Optional[float] = None
    #: Supply pressure above ambient [bar], 1 to 16.
    supply: Optional[float] = None
    #: Factor on the opening of the valve, 0.05 to 2.
    valve_gain: Optional[float] = None
    #: Factor on the friction, 0 to 10.
    friction: Optional[float] = None
    #: Half width of the dead zone of the valve, 0 to 0.5.
    dead_zone: Optional[float] = None
    #: Offset of the spool, -0.5 to 0.5.
    offset: Optional[float] = None
    #: Position at the start [mm], 0 to 400.
    start: Optional[float] = None

    def _values(self) -> dict[str, Any]:
        values = asdict(self)
        values["seed"] = count_of(self.seed, "seed", 0, 2**64 - 1)
        return values


def simulate_axis(u: ArrayLike, axis: Optional[Axis] = None) -> Tuple[Array, Array]:
    """The axis under the commands ``u`` (-1 to 1), one per millisecond: measured positions and true positions [mm]."""
    return _trendid.simulate_axis(column(u, "u"), (axis or Axis())._values())


@dataclass(frozen=True)
class Log:
    """A run of the loop, one entry per millisecond."""

    #: [s]
    t: Array
    #: True position [mm].
    position: Array
    #: Measured position [mm].
    measured: NDArray[np.float32]
    #: Where it should be [mm]; the position outside of control.
    setpoint: NDArray[np.float32]
    #: Of the valve, -1 to 1.
    command: NDArray[np.float32]
    #: Whether the loop controls.
    controlling: NDArray[np.bool_]
    #: Times [s] at which the state changed, and to what.
    states: List[Tuple[float, str]]

    def plot(self, axes: Any = None) -> Any:
        """Position, setpoint and command; needs matplotlib. Returns the figure."""
        from ._plot import Curve, curves

        above: List[Curve] = [(self.t, self.setpoint, "setpoint"), (self.t, self.position, "position")]
        return curves(axes, above, "mm", [(self.t, self.command, "C2")], "command")


@dataclass(frozen=True)
class Model:
    """``b0 flow / (s (s^2 + a2 s + a1))`` behind a valve with dead zone and offset, and a friction."""

    #: [rad^2/s^2]
    a1: float
    #: [rad/s]
    a2: float
    #: [mm/s^3 per unit of flow]
    b0: float
    #: Half width in units of the command.
    dead_zone: float
    #: In units of the command.
    offset: float
    #: In units of flow.
    friction: float


class ServoLoop:
    """The adaptive position loop of the firmware on the simulated pneumatic axis, 1 kHz.

    >>> loop = ServoLoop()
    >>> loop.commission()
    >>> _ = loop.run(6.0, until="verified")
    >>> loop.move_to(300.0)
    >>> log = loop.run(1.0)

    Parameters
    ----------
    axis : the machine
    bandwidth : rough natural frequency of the drive [rad/s], where it is known: the commissioning looks there first
    adaptive : whether the model follows the drive after the commissioning
    wanted_bandwidth : of the closed loop [rad/s]; 2.5 times that of the drive without it
    """

    def __init__(
        self,
        axis: Optional[Axis] = None,
        *,
        bandwidth: Optional[float] = None,
        adaptive: bool = True,
        wanted_bandwidth: Optional[float] = None,
    ) -> None:
        values = (axis or Axis())._values()
        known = None if bandwidth is None else number_of(bandwidth, "bandwidth")
        wanted = None if wanted_bandwidth is None else number_of(wanted_bandwidth, "wanted_bandwidth")
        self._loop = _trendid.AxisLoop(values, known, flag_of(adaptive, "adaptive"), wanted)

    def commission(self) -> None:
        """Commissions the axis with the next sample, around the position that it then has; one in motion first comes to rest."""
        self._loop.commission()

    def abort(self) -> None:
        """Stops commissioning or control; the verified model is kept."""
        self._loop.abort()

    def move_to(self, target: float) -> None:
        """Moves to ``target`` [mm], limited to the travel, as fast as the limits of motion allow."""
        self._loop.move_to(number_of(target, "target"))

    def oscillate(self, amplitude: float, frequency: float) -> None:
        """Oscillates about the present reference with ``amplitude`` [mm] and ``frequency`` [Hz]; refused without room for it."""
        self._loop.oscillate(number_of(amplitude, "amplitude"), number_of(frequency, "frequency"))

    def run(self, seconds: float, *, until: Optional[str] = None) -> Log:
        """Runs for a time [s], or until the state begins with ``until``; other threads of Python run meanwhile."""
        if not 0.0 <= number_of(seconds, "seconds") <= 1e6:
            raise _trendid.Refusal(f"seconds = {seconds} is not within 0..=1000000")
        if until is not None and not any(_begins(state, until) for state in _STATES):
            raise _trendid.Refusal(f"until is {until!r}, expected the begin of a state: {', '.join(_STATES)}")
        return Log(**self._loop.run(round(1000.0 * seconds), until))

    @property
    def time(self) -> float:
        """Of the next sample [s]."""
        return self._loop.time

    @property
    def state(self) -> str:
        """Of the supervisor, such as ``idle``, ``verified``, ``adapting``, ``frozen`` or ``failed: ..``."""
        return self._loop.state

    @property
    def is_controlling(self) -> bool:
        """Whether the loop controls the position."""
        return self._loop.is_controlling

    @property
    def position(self) -> float:
        """True position [mm]."""
        return self._loop.position

    @property
    def model(self) -> Optional[Model]:
        """The verified model, None before there is one."""
        found = self._loop.model
        return None if found is None else Model(*found)

    def set_mass(self, mass: float) -> None:
        """Changes the moving mass [kg]."""
        self._loop.set_mass(number_of(mass, "mass"))

    def set_load(self, load: float) -> None:
        """Changes the constant force toward larger positions [N]."""
        self._loop.set_load(number_of(load, "load"))

    def set_supply(self, bar: float) -> None:
        """Changes the supply pressure above ambient [bar]."""
        self._loop.set_supply(number_of(bar, "bar"))

    def set_valve_gain(self, gain: float) -> None:
        """Changes the factor on the opening of the valve."""
        self._loop.set_valve_gain(number_of(gain, "gain"))

    def set_friction(self, factor: float) -> None:
        """Changes the factor on the friction."""
        self._loop.set_friction(number_of(factor, "factor"))
