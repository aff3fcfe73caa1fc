"""Records and the command line that the package is held against."""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path
from typing import Any, Callable, Dict

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
RECORD = ROOT / "examples" / "data" / "servo.csv"


@pytest.fixture(scope="session")
def record() -> Dict[str, np.ndarray]:
    """The synthetic record of the repository: G = 1e6/(s (s^2 + 20 s + 400)), 0.5 mm of noise, 0.2 mm of drift."""
    t, u, y, x = np.loadtxt(RECORD, delimiter=",", comments="#", skiprows=6, unpack=True)
    return {"t": t, "u": u, "y": y, "x": x}


@pytest.fixture(scope="session")
def friction(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A drive of second order with Coulomb friction and an offset, as a file for both sides."""
    rng = np.random.default_rng(200_001)
    n, dt, a, b, c, offset = 6000, 0.001, 12.0, 400.0, 30.0, 4.0
    u = np.repeat(rng.uniform(-1.0, 1.0, n // 100), 100)
    y, v, lines = 0.0, 0.0, ["t,u,y"]
    for k in range(n):
        lines.append(f"{k * dt:.3f},{u[k]:.6f},{y + 1e-3 * rng.standard_normal():.6f}")
        for _ in range(10):
            force = b * u[k] + offset
            if v == 0.0 and abs(force) <= c:
                continue
            sign = np.sign(v) if v != 0.0 else np.sign(force)
            step = v + 0.1 * dt * (force - a * v - c * sign)
            v = 0.0 if v * step < 0.0 else step
            y += 0.1 * dt * v
    path = tmp_path_factory.mktemp("records") / "friction.csv"
    path.write_text("\n".join(lines) + "\n")
    return path


@pytest.fixture(scope="session")
def trendid_cli() -> Callable[..., Dict[str, Any]]:
    """The command line, by its JSON; `TRENDID` names the program."""
    program = os.environ["TRENDID"]

    def run(*arguments: str) -> Dict[str, Any]:
        done = subprocess.run([program, *arguments, "--json"], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        return json.loads(done.stdout)

    return run
