"""Pictures by matplotlib: curves over time above, one curve below."""

from __future__ import annotations

from typing import Any, Sequence, Tuple

from numpy.typing import ArrayLike

#: Times, values, and the label or the colour of a curve.
Curve = Tuple[ArrayLike, ArrayLike, str]


def figure(axes: Any) -> Tuple[Any, Any]:
    """The two axes that were given, or those of a new figure."""
    if axes is not None:
        upper, lower = axes
        return upper, lower
    try:
        from matplotlib import pyplot
    except ImportError as error:
        raise ImportError("plot() needs matplotlib: pip install matplotlib") from error
    _, (upper, lower) = pyplot.subplots(
        2, 1, sharex=True, figsize=(8, 5), gridspec_kw={"height_ratios": [3, 1]}, layout="constrained"
    )
    return upper, lower


def curves(axes: Any, above: Sequence[Curve], unit: str, below: Sequence[Curve], difference: str) -> Any:
    """Labelled curves above, the first one in grey; coloured ones below. Returns the figure."""
    upper, lower = figure(axes)
    for n, (t, values, label) in enumerate(above):
        color, width = ("0.6", 1.5) if n == 0 else ("C0", 1.0)
        upper.plot(t, values, label=label, color=color, linewidth=width)
    for t, values, color in below:
        lower.plot(t, values, color=color, linewidth=0.7)
    upper.set_ylabel(unit)
    upper.legend(loc="upper left")
    lower.set_ylabel(difference)
    lower.set_xlabel("t [s]")
    return upper.figure
