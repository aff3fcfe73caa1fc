"""`Identifier`: against pure numpy, sample by sample against arrays, and what it refuses."""

from __future__ import annotations

import threading
import time

import numpy as np
import pytest

import reference
import trendid

STRUCTURE = dict(bandwidth=20.0, input_range=0.4, output_range=50.0)


def bare() -> trendid.Identifier:
    return trendid.Identifier(0.001, constant=False, initial_state=False, **STRUCTURE)


def excited(n: int) -> "tuple[np.ndarray, np.ndarray]":
    """A record without noise: 1e6/(s (s^2 + 20 s + 400)) exactly, at random levels."""
    signal = pytest.importorskip("scipy.signal")
    rng = np.random.default_rng(200_001)
    u = np.repeat(rng.uniform(-0.4, 0.4, n // 50 + 1), 50)[:n]
    a, b, c, d, _ = signal.cont2discrete(signal.tf2ss([1e6], [1.0, 20.0, 400.0, 0.0]), 0.001)
    x, y = np.zeros((3, 1)), np.empty(n)
    for k in range(n):
        y[k] = (c @ x).item()
        x = a @ x + b * u[k]
    return u, y


def test_the_same_algorithm_in_numpy_finds_the_same():
    u, y = excited(25_000)
    run = bare().run(u, y)
    settling = int(np.sum(run.outcome == 0))
    theirs = reference.identify(u, y, 0.001, 20.0, 0.4, 50.0, settling)
    # f32 against f64, from a second on.
    assert np.max(np.abs(run.theta[1000:] / theirs[1000:] - 1.0)) < 1e-5
    assert np.allclose(run.theta[-1], [400.0, 20.0, 1e6], rtol=1e-3)


def test_it_is_twenty_times_as_fast_as_numpy():
    u, y = excited(25_000)

    def seconds(work) -> float:
        best = np.inf
        for _ in range(3):
            begin = time.process_time()
            work()
            best = min(best, time.process_time() - begin)
        return best

    ours = seconds(lambda: bare().run(u, y))
    theirs = seconds(lambda: reference.identify(u, y, 0.001, 20.0, 0.4, 50.0, 0))
    print(f"\n25000 samples: trendid {1e3 * ours:.1f} ms, numpy {1e3 * theirs:.0f} ms, {theirs / ours:.0f} times")
    assert theirs > 20.0 * ours


def test_samples_and_arrays_say_the_same(record):
    whole = trendid.Identifier(0.001, **STRUCTURE)
    run = whole.run(record["u"], record["y"], every=10)
    single = trendid.Identifier(0.001, **STRUCTURE)
    for k, (u, y) in enumerate(zip(record["u"], record["y"])):
        innovation = single.update(u, y)
        assert innovation is None and np.isnan(run.innovation[k]) or np.float32(innovation) == run.innovation[k]
        if k % 10 == 9:
            assert np.array_equal(single.theta, run.theta[k // 10])
    assert run.theta.dtype == np.float32 and run.theta.shape == (400, 5)
    assert np.array_equal(single.estimate().theta, whole.estimate().theta)
    parts = trendid.Identifier(0.001, **STRUCTURE)
    for begin in range(0, 4000, 1000):
        parts.run(record["u"][begin : begin + 1000], record["y"][begin : begin + 1000], every=0)
    assert np.array_equal(parts.theta, whole.theta)


def test_numbers_of_any_type_are_numbers(record):
    u, y = np.round(record["u"][:600], 1), record["y"][:600]
    plain = trendid.Identifier(0.001, **STRUCTURE)
    innovations = [plain.update(float(a), float(b)) for a, b in zip(u, y)]
    assert any(innovations)
    for kind in (np.float32, np.float64, np.array, lambda x: [x], lambda x: np.array([x])):
        other = trendid.Identifier(0.001, **STRUCTURE)
        assert [other.update(kind(a), float(b)) for a, b in zip(u, y)] == innovations
    integers = trendid.Identifier(0.001, **STRUCTURE)
    assert integers.update(np.int64(1), np.int32(3)) is None


def test_the_truth_is_within_its_deviations(record):
    identifier = trendid.Identifier(0.001, **STRUCTURE)
    identifier.run(record["u"], record["y"], every=0)
    found = identifier.estimate()
    for value, sigma, truth in zip(found.theta, found.sigma, [400.0, 20.0, 1e6]):
        assert abs(value - truth) < 4.0 * sigma
    assert found.covariance.shape == (5, 5) and found.stable
    assert np.allclose(np.sqrt(np.diag(found.covariance)), found.sigma, rtol=1e-3)
    assert abs(found.omega0.value - 20.0) < 4.0 * found.omega0.sigma
    assert np.allclose(found.lti().den, [1.0, found.theta[1], found.theta[0], 0.0])


def test_what_is_not_finite_leaves_no_trace(record):
    u, y = record["u"].copy(), record["y"].copy()
    clean, disturbed = trendid.Identifier(0.001, **STRUCTURE), trendid.Identifier(0.001, **STRUCTURE)
    clean.run(u[:2000], y[:2000])
    disturbed.run(u[:2000], y[:2000])
    assert disturbed.update(np.nan, 0.0) is None and disturbed.update(0.0, np.inf) is None
    assert np.array_equal(clean.theta, disturbed.theta)
    y[100] = np.nan
    outcome = trendid.Identifier(0.001, **STRUCTURE).run(u, y).outcome
    assert trendid.Identifier.OUTCOMES[outcome[100]] == "refused"
    assert trendid.Identifier.OUTCOMES[outcome[-1]] == "estimated"
    # A spike is bridged by its prediction, and no part of the record.
    y[3000] += 50.0
    run = trendid.Identifier(0.001, **STRUCTURE).run(u, y)
    assert trendid.Identifier.OUTCOMES[run.outcome[3000]] == "replaced" and np.isnan(run.innovation[3000])


def test_a_far_reference_costs_no_digits(record):
    near, far = trendid.Identifier(0.001, **STRUCTURE), trendid.Identifier(0.001, reference=1e6, **STRUCTURE)
    near.run(record["u"], record["y"])
    far.run(record["u"], record["y"] + 1e6)
    assert np.allclose(near.theta, far.theta, rtol=1e-4)


def test_holding_resetting_and_warm_starting(record):
    identifier = trendid.Identifier(0.001, **STRUCTURE)
    identifier.run(record["u"], record["y"])
    found = identifier.estimate()
    identifier.adapt(False)
    before = identifier.theta
    identifier.run(record["u"], -record["y"])
    # The noise level, which corrects the reading, goes on.
    assert np.allclose(identifier.theta[:3], before[:3], rtol=1e-5)
    identifier.adapt(True)
    identifier.run(record["u"], -record["y"])
    assert abs(identifier.theta[2] / before[2] - 1.0) > 0.1
    identifier.reset()
    assert not np.allclose(identifier.theta[:3], before[:3], rtol=0.1)
    identifier.warm_start(found.theta, found.sigma)
    assert np.allclose(identifier.theta[:3], found.theta[:3], rtol=1e-4)
    with pytest.raises(trendid.Refusal):
        identifier.warm_start([1.0], [1.0])


def test_other_threads_run_meanwhile():
    n = 400_000
    u = np.sign(np.sin(0.01 * np.arange(n)))
    y = np.cumsum(u) * 0.01
    done = threading.Event()
    ticks = []

    def count() -> None:
        while not done.is_set():
            ticks.append(time.perf_counter())
            time.sleep(1e-3)

    thread = threading.Thread(target=count)
    thread.start()
    time.sleep(0.01)
    begin = time.perf_counter()
    bare().run(u, y)
    end = time.perf_counter()
    done.set()
    thread.join()
    assert sum(begin < tick < end for tick in ticks) >= 3


REFUSALS = [
    (dict(order=0), "order is 0"),
    (dict(order=None), "order is None"),
    (dict(delay=float("nan")), "delay is nan"),
    (dict(bandwidth=-1.0), "-1"),
    (dict(bandwidth=float("nan")), "NaN"),
    (dict(memory=0.0), "memory"),
    (dict(reference=float("nan")), "reference is nan"),
    (dict(delay=513), "delay is 513"),
    (dict(bandwidth=[20.0]), "bandwidth is [20.0], expected a number"),
    (dict(output_range="50"), "output_range is '50', expected a number"),
    (dict(input_range="wide"), "input_range is no array of numbers"),
    (dict(constant="no"), "constant is 'no', expected True or False"),
    (dict(filter="none"), "filter is 'none'"),
    (dict(filter=[1.0, 1.0]), "2"),
    (dict(input_range=[1.0] * 5), "5 inputs were asked for, at most 4"),
    (dict(zeros=3), "3 zeros need an order of at least 4, not 3"),
]


@pytest.mark.parametrize("options, sentence", REFUSALS)
def test_settings_are_refused_by_value(options, sentence):
    with pytest.raises(trendid.Refusal) as refused:
        trendid.Identifier(0.001, **{**STRUCTURE, **options})
    assert sentence in str(refused.value), str(refused.value)


def test_shapes_are_refused():
    identifier = trendid.Identifier(0.001, **STRUCTURE)
    with pytest.raises(trendid.Refusal, match=r"u has the shape \(3, 2\), expected \(3, 1\)"):
        identifier.run(np.zeros((3, 2)), np.zeros(3))
    with pytest.raises(trendid.Refusal, match="2 inputs in a sample, expected 1"):
        identifier.update([1.0, 2.0], 0.0)
