"""The algorithm of :class:`trendid.Identifier` in pure numpy: filtered trends by trapezoids, recursive least squares in U D U' form.

Structure b0 / (s^3 + a2 s^2 + a1 s), no constant, nothing forgotten. In f64, vectors where there are any; what surrounds the
algorithm (gate, standstill, noise bias) is left out, which makes it faster, not slower.
"""

from __future__ import annotations

import numpy as np


class Trends:
    """States of the chain of three integrators with feedback, for one signal."""

    def __init__(self, dt: float, filter: np.ndarray) -> None:
        self.filter, self.half, self.dt = filter, 0.5 * dt, dt
        self.loop_gain = 1.0 / (1.0 + filter @ self.half ** np.arange(3, 0, -1))
        self.states = np.zeros(3)
        #: known = upper @ states: each state with half a step of those above it.
        self.upper = np.triu(self.half ** np.maximum(np.arange(3)[None, :] - np.arange(3)[:, None], 0))
        self.weights = filter @ self.upper
        self.powers = self.half ** np.arange(3, 0, -1)
        self.above = np.empty(3)

    def step(self, direct: float, held: float) -> "tuple[np.ndarray, float]":
        """Trends of order 0 to 2, and 3."""
        top = (direct - self.weights @ self.states) * self.loop_gain
        lower = self.upper @ self.states + self.powers * top
        self.above[:2], self.above[2] = lower[1:], top
        self.states = lower + self.half * self.above
        self.states[2] += held
        return lower, top


def identify(
    u: np.ndarray, y: np.ndarray, dt: float, bandwidth: float, input_range: float, output_range: float, settling: int
) -> np.ndarray:
    """Parameters a1, a2, b0 after every sample; zero over the first ones, in which the filter settles."""
    w = bandwidth
    filter = np.array([0.11 * 1.21 * w**3, (1.21 + 0.11 * 1.54) * w**2, (0.11 + 1.54) * w])
    output, input = Trends(dt, filter), Trends(dt, filter)
    scale = np.array([-1.0 / (output_range * w), -1.0 / (output_range * w**2), 1.0 / input_range])
    top_scale = 1.0 / (output_range * w**3)
    units = np.abs(scale) / top_scale
    upper, diagonal, theta = np.eye(3), np.full(3, 1e18), np.zeros(3)
    found = np.zeros((len(y), 3))
    first = y[0]
    for k in range(len(y)):
        trends, top = output.step(y[k] - first, 0.0)
        driven, _ = input.step(0.0, dt * u[k])
        if k < settling:
            continue
        phi = scale * np.array([trends[1], trends[2], driven[0]])
        error = top_scale * top - phi @ theta
        f = upper.T @ phi
        gain = np.zeros(3)
        alpha = 1.0
        for j in range(3):
            v = diagonal[j] * f[j]
            before, alpha = alpha, alpha + f[j] * v
            diagonal[j] *= before / alpha
            column = upper[:j, j].copy()
            upper[:j, j] -= f[j] / before * gain[:j]
            gain[:j] += column * v
            gain[j] = v
        theta = theta + gain * (error / alpha)
        raw = units * theta
        # What trapezoids bend of an integrating drive of order 3 (src/trends/trapezoids.rs).
        found[k] = raw / (1.0 + raw[0] * dt**2 / 6.0)
    return found
