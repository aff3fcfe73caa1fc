"""The simulated axis, alone and in the loop."""

from __future__ import annotations

import numpy as np
import pytest

import trendid


def commissioned(**options) -> trendid.ServoLoop:
    loop = trendid.ServoLoop(bandwidth=25.0, **options)
    loop.commission()
    loop.run(7.0, until="verified")
    assert loop.state == "verified", loop.state
    return loop


def test_an_axis_commissions_itself_and_moves():
    loop = commissioned()
    assert loop.model is not None and loop.model.b0 > 0.0
    loop.move_to(230.0)
    log = loop.run(2.0)
    assert loop.is_controlling and abs(loop.position - 230.0) < 0.5
    assert len(log.t) == 2000 and log.controlling[-1]
    assert np.all(np.abs(log.command) <= 1.0)
    assert abs(log.t[-1] - log.t[0] - 1.999) < 1e-9


def test_the_same_seed_is_the_same_run():
    logs = []
    for seed in (1, 1, 2):
        loop = trendid.ServoLoop(trendid.Axis(seed=seed), bandwidth=25.0)
        loop.commission()
        logs.append(loop.run(1.0))
    assert np.array_equal(logs[0].position, logs[1].position)
    assert not np.array_equal(logs[0].position, logs[2].position)


def test_a_heavier_axis_is_slower():
    light, heavy = (commissioned(axis=trendid.Axis(mass=mass)).model for mass in (3.0, 12.0))
    assert heavy.a1 < light.a1


def test_the_open_axis_gives_a_record():
    rng = np.random.default_rng(1)
    u = np.repeat(rng.uniform(-0.3, 0.3, 40), 50)
    measured, position = trendid.simulate_axis(u, trendid.Axis(dead_zone=0.0))
    assert len(measured) == len(u) and np.max(np.abs(measured - position)) < 0.05
    assert position[0] == 200.0 and np.ptp(position) > 5.0


def test_values_out_of_range_are_refused():
    for axis, sentence in [
        (trendid.Axis(mass=0.0), "mass = 0 is not within 0.1..=1000"),
        (trendid.Axis(start=500.0), "start = 500 is not within 0..=400"),
        (trendid.Axis(seed=-1), "seed is -1"),
    ]:
        with pytest.raises(trendid.Refusal) as refused:
            trendid.ServoLoop(axis)
        assert sentence in str(refused.value), str(refused.value)
    with pytest.raises(trendid.Refusal, match=r"u\[1\] = 1.5 is not within -1..=1"):
        trendid.simulate_axis([0.0, 1.5])
    with pytest.raises(trendid.Refusal, match=r"bandwidth is \[20\], expected a number"):
        trendid.ServoLoop(bandwidth=[20])
    loop = trendid.ServoLoop()
    with pytest.raises(trendid.Refusal, match=r"target is \[300\], expected a number"):
        loop.move_to([300])
    with pytest.raises(trendid.Refusal, match="-3"):
        loop.set_mass(-3.0)
    with pytest.raises(trendid.Refusal):
        loop.move_to(float("nan"))
    with pytest.raises(trendid.Refusal, match="seconds = -1"):
        loop.run(-1.0)
