"""Arrays, series and tables as signals."""

from __future__ import annotations

import math
from typing import Any, List, Mapping, Optional, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._trendid import Refusal

Array = NDArray[np.float64]

#: Largest difference between the steps of the time stamps, in parts of a step; that of the command line.
_STEP_TOLERANCE = 0.01


def numbers(values: Any, name: str) -> Array:
    """Real numbers as float64; what is none is refused, where NumPy would make a number of it."""
    if np.ma.is_masked(values):
        place = int(np.flatnonzero(np.ma.getmaskarray(values))[0])
        raise Refusal(f"{name} has masked samples, the first of them is number {place}: leave them out")
    try:
        array = np.asarray(values)
        kind = array.dtype.kind
        # Complex numbers lose a part, dates become nanoseconds, texts are read.
        if kind not in "biufO" or kind == "O" and any(isinstance(one, (str, bytes)) for one in array.flat):
            raise Refusal(f"{name} is no array of numbers: its type is {array.dtype}")
        return np.ascontiguousarray(array, dtype=np.float64)
    except (TypeError, ValueError, OverflowError) as error:
        raise error if isinstance(error, Refusal) else Refusal(f"{name} is no array of numbers: {error}") from None


def column(values: Any, name: str) -> Array:
    """One dimension of float64, whatever it was."""
    array = numbers(values, name)
    if array.ndim == 2 and 1 in array.shape:
        array = array.reshape(-1)
    if array.ndim != 1:
        raise Refusal(f"{name} has the shape {array.shape}, expected one dimension")
    return array


def sampling(t: Any) -> Tuple[float, float]:
    """Sampling interval and first time stamp [s]: of time stamps, or of the interval itself."""
    if np.ndim(t) == 0:
        dt = _real(t)
        if dt is None or not (math.isfinite(dt) and dt > 0.0):
            raise Refusal(f"the sampling interval {t} s is not a positive number")
        return dt, 0.0
    if np.ma.is_masked(t):
        raise Refusal("t has masked time stamps: leave them out")
    stamps = np.asarray(t)
    if stamps.size and np.issubdtype(stamps.dtype, np.datetime64) or np.issubdtype(stamps.dtype, np.timedelta64):
        stamps = (stamps - stamps[0]) / np.timedelta64(1, "ns") * 1e-9
    stamps = column(stamps, "t")
    if len(stamps) < 2:
        raise Refusal(f"t has {len(stamps)} time stamps, expected at least 2")
    bad = np.flatnonzero(~np.isfinite(stamps))
    if len(bad):
        raise Refusal(f"t[{bad[0]}] is {stamps[bad[0]]}, expected a finite number of seconds")
    steps = np.diff(stamps)
    median = float(np.sort(steps)[len(steps) // 2])
    back = np.flatnonzero(steps <= 0.0)
    if len(back):
        k = int(back[0])
        raise Refusal(f"t[{k + 1}] is {stamps[k + 1]} after {stamps[k]}: time does not advance")
    wrong = np.abs(steps - median) > _STEP_TOLERANCE * median
    if wrong.any():
        k = int(np.flatnonzero(wrong)[0])
        raise Refusal(
            f"t[{k + 1}] is {stamps[k + 1]}, {steps[k]:.6g} s after the one before it, expected {median:.6g} s: "
            "the samples must be equally spaced"
        )
    return float((stamps[-1] - stamps[0]) / len(steps)), float(stamps[0])


def inputs(u: Any, names: Optional[List[str]]) -> List[Tuple[str, Array]]:
    """The inputs with their names: one array, a table with a column for each, or a mapping."""
    columns: List[Tuple[str, Any]]
    if isinstance(u, Mapping) or hasattr(u, "columns"):
        columns = [(str(name), u[name]) for name in u]
    elif np.ndim(u) == 2 and 1 not in np.shape(u):
        table = np.asarray(u)
        columns = [(f"u{i + 1}", table[:, i]) for i in range(table.shape[1])]
    else:
        columns = [(str(getattr(u, "name", None) or "u"), u)]
    if names is not None:
        if isinstance(names, str):
            raise Refusal(f"names is {names!r}, expected a list of names")
        names = [str(name) for name in names]
        if len(names) != len(columns):
            raise Refusal(f"{len(names)} names for {len(columns)} inputs")
        columns = list(zip(names, (values for _, values in columns)))
    # Results stand under the names: a second one would take the place of the first.
    for k, (name, _) in enumerate(columns):
        if name in (other for other, _ in columns[:k]):
            raise Refusal(f"two inputs have the name {name!r}")
    return [(name, column(values, f"the input {name!r}")) for name, values in columns]


def _labels(values: Any) -> Any:
    """The index of a series or table; None of everything else, a list and its method too."""
    labels = getattr(values, "index", None)
    return None if callable(labels) else labels


def _aligned(y: Any, others: Any) -> None:
    """Series and tables are taken by their places: labels that differ mean another order, or other samples."""
    labels = _labels(y)
    for name, one in others:
        own = _labels(one)
        if labels is not None and own is not None and not labels.equals(own):
            raise Refusal(f"the index of {name} is not that of y: align them first")


Coulomb = Union[bool, ArrayLike]


def signals(
    t: Any,
    u: Any,
    y: Any,
    names: Optional[List[str]],
    hold: str,
    coulomb: Coulomb,
) -> Tuple[dict[str, Any], float]:
    """What the native part takes, and the first time stamp [s]."""
    columns = list(u.items()) if isinstance(u, Mapping) else [("u", u)]
    _aligned(y, [*columns, ("`coulomb`", coulomb)])
    dt, start = sampling(t)
    output = column(y, "y")
    if np.ndim(t) != 0 and len(np.asarray(t)) != len(output):
        raise Refusal(f"t has {len(np.asarray(t))} samples, y {len(output)}")
    measured = not isinstance(coulomb, (bool, np.bool_))
    velocity = column(coulomb, "the velocity `coulomb`") if measured else None
    if velocity is not None and len(velocity) != len(output):
        raise Refusal(f"`coulomb` has {len(velocity)} samples, y {len(output)}")
    return {
        "dt": dt,
        "output": output,
        "inputs": inputs(u, names),
        "hold": hold,
        "coulomb": bool(measured or coulomb),
        "velocity": velocity,
    }, start


def _real(value: Any) -> Optional[float]:
    """A number, whatever its type; None for everything else, a list or an array of one number too."""
    if isinstance(value, (str, bytes, bool, np.bool_)) or np.ndim(value) != 0:
        return None
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError):
        return None


def number_of(value: Any, name: str) -> float:
    """A number; its limits are those of what takes it."""
    number = _real(value)
    if number is None:
        raise Refusal(f"{name} is {value!r}, expected a number")
    return number


def flag_of(value: Any, name: str) -> bool:
    """True or False: every text is true to Python, "no" too."""
    if _whole(value) not in (0, 1):
        raise Refusal(f"{name} is {value!r}, expected True or False")
    return bool(value)


def pole_of(pole: Union[str, float, None]) -> Optional[float]:
    """`auto` is None, no filter 0.0, else rad/s."""
    if pole is None:
        return 0.0
    if isinstance(pole, str) and pole == "auto":
        return None
    number = _real(pole)
    if number is None or not math.isfinite(number) or number == 0.0:
        raise Refusal(f"pole is {pole!r}, expected a number of rad/s other than 0, 'auto' or None")
    return abs(number)


def delay_of(delay: Union[str, int]) -> Optional[int]:
    """`auto` is None, else samples."""
    if isinstance(delay, str):
        if delay == "auto":
            return None
        raise Refusal(f"delay is {delay!r}, expected a number of samples from 0 to 512, or 'auto'")
    whole = _whole(delay)
    if whole is None or not 0 <= whole <= 512:
        raise Refusal(f"delay is {delay}, expected a number of samples from 0 to 512, or 'auto'")
    return whole


def _whole(value: Any) -> Optional[int]:
    """A whole number, whatever its type; None for everything else."""
    try:
        whole = int(value)
        return whole if not isinstance(value, (str, bytes)) and bool(whole == value) else None
    except (TypeError, ValueError, OverflowError):
        return None


def count_of(value: Any, name: str, low: int, high: int) -> int:
    """A whole number within limits."""
    whole = _whole(value)
    if isinstance(value, (bool, np.bool_)) or whole is None or not low <= whole <= high:
        raise Refusal(f"{name} is {value!r}, expected a whole number from {low} to {high}")
    return whole
