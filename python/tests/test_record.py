"""`identify` and `select`: the numbers of the command line, to the last bit."""

from __future__ import annotations

import math

import numpy as np
import pytest

import trendid

from conftest import RECORD

OPTIONS = [
    (["--order", "3", "--integrator"], dict(order=3, integrator=True)),
    (["--order", "3", "--integrator", "--constant"], dict(order=3, integrator=True, constant=True)),
    (["--order", "3"], dict(order=3)),
    (["--order", "2", "--integrator", "--zeros", "1"], dict(order=2, integrator=True, zeros=1)),
    (["--order", "3", "--integrator", "--delay", "auto"], dict(order=3, integrator=True, delay="auto")),
    (["--order", "3", "--integrator", "--delay", "2"], dict(order=3, integrator=True, delay=2)),
    (["--order", "3", "--integrator", "--filter", "20"], dict(order=3, integrator=True, pole=20)),
    (["--order", "3", "--integrator", "--memory", "1"], dict(order=3, integrator=True, memory=1.0)),
    (["--order", "3", "--integrator", "--filter", "none"], dict(order=3, integrator=True, pole=None)),
    (["--order", "3", "--integrator", "--scheme", "goodwin"], dict(order=3, integrator=True, scheme="goodwin")),
    (["--order", "3", "--integrator", "--hold", "foh"], dict(order=3, integrator=True, hold="foh")),
]


def same(ours, theirs):
    """The same f32; None stands for what is not finite."""
    theirs = [math.nan if value is None else value for value in np.ravel(np.array(theirs, dtype=object))]
    ours = np.ravel(np.asarray(ours, dtype=float))
    assert len(ours) == len(theirs)
    assert np.array_equal(ours.astype(np.float32), np.array(theirs, dtype=np.float32), equal_nan=True)


def compare(found: trendid.Identification, said: dict) -> None:
    same(found.sigma, said["sigma"])
    same(found.a, said["a"])
    b = list(found.b.values()) + ([[found.constant]] if "constant" in found.parameters else [])
    assert len(b) == len(said["inputs"])
    for ours, theirs in zip(b, said["inputs"]):
        same(ours, theirs["b"])
    assert found.parameters == said["parameters"]
    assert found.method == said["method"]
    assert found.poor_input == said["poor_input"]
    assert found.held_out == said["fit_held_out"]
    same(found.delay_s, said["delay_s"])
    same([found.fit, found.fit_constant], [said["fit_pct"], said["fit_x0c_pct"]])
    same([found.ise, found.iae], [said["ise"], said["iae"]])
    if said["filter_pole"] is None:
        assert found.filter_pole is None
    else:
        same(found.filter_pole, said["filter_pole"])
    if said["least_squares"] is not None:
        same(found.least_squares[0], said["least_squares"]["theta"])
        same(found.least_squares[1], said["least_squares"]["sigma"])
    physical, sigma = said["physical"], said["physical"]["sigma"]
    same(found.gain.value, physical["gain"])
    for name in ("omega0", "damping"):
        ours = getattr(found, name)
        if ours is None:
            assert physical[name] is None
        else:
            same(ours.value, physical[name])
            if sigma[name] is not None:
                same(ours.sigma, sigma[name])
    assert found.stable == physical["stable"]
    same([[p.real, p.imag] for p in found.poles], physical["poles"])
    same([q.value for q in found.time_constants], physical["time_constants_s"])
    for name, q in found.force_balance.items():
        same([q.value, q.sigma], [physical[name], sigma[name]])


@pytest.mark.parametrize("arguments, options", OPTIONS, ids=lambda value: " ".join(value) if isinstance(value, list) else "")
def test_the_numbers_are_those_of_the_command_line(record, trendid_cli, arguments, options):
    said = trendid_cli("identify", str(RECORD), *arguments)
    compare(trendid.identify(record["t"], record["u"], record["y"], **options), said)


@pytest.mark.parametrize("measured", [False, True])
def test_friction_too(friction, trendid_cli, measured):
    t, u, y = np.loadtxt(friction, delimiter=",", skiprows=1, unpack=True)
    structure = ["--order", "2", "--integrator", "--constant", "--coulomb"]
    said = trendid_cli("identify", str(friction), *structure, *(["u"] if measured else []))
    coulomb = u if measured else True
    found = trendid.identify(t, u, y, order=2, integrator=True, constant=True, coulomb=coulomb)
    compare(found, said)
    if not measured:
        assert abs(found.force_balance["coulomb"].value - 30.0 / 400.0) < 0.02


def test_structures_are_compared_as_by_the_command_line(record, trendid_cli):
    said = trendid_cli("select", str(RECORD), "--delay", "0")
    found = trendid.select(record["t"], record["u"], record["y"], delay=0)
    assert len(found.candidates) == len(said["candidates"]) > 0
    for ours, theirs in zip(found.candidates, said["candidates"]):
        assert (ours.order, ours.integrator, ours.zeros) == (theirs["order"], theirs["integrator"], theirs["zeros"])
        same(ours.theta, theirs["theta"])
        same([ours.fit, ours.filter_pole], [theirs["fit_x0c_pct"], theirs["filter_pole"]])
    assert found.poor_input is said["poor_input"] is None
    assert found.recommended is found.candidates[said["recommended"]]
    assert [d.reason for d in found.dropped] == [d["reason"] for d in said["dropped"]]
    assert "<== recommended" in str(found)
    assert (found.recommended.order, found.recommended.integrator) == (3, True)


def test_an_input_that_says_too_little_is_said_as_by_the_command_line(tmp_path, trendid_cli):
    t = 0.01 * np.arange(1000)
    y = 1.0 - np.exp(-np.clip(t - 3.05, 0.0, None)) + 0.01 * np.random.default_rng(1).standard_normal(1000)
    u = (t >= 3.0).astype(float)
    path = tmp_path / "record.csv"
    np.savetxt(path, np.column_stack([t, u, y]), delimiter=",", header="t,u,y", comments="", fmt="%.17g")
    for delay, said_of_it in (("auto", "one step"), (5, None)):
        said = trendid_cli("identify", str(path), "--order", "1", "--delay", str(delay))
        found = trendid.identify(t, u, y, order=1, delay=delay)
        compare(found, said)
        assert found.poor_input == said_of_it
        assert ("rest on one step" in str(found)) == (said_of_it is not None)
    said = trendid_cli("select", str(path), "--max-order", "1")
    found = trendid.select(t, u, y, max_order=1)
    assert found.poor_input == said["poor_input"] == "one step"
    assert "rests on one step" in str(found)
    ours, theirs = found.recommended, said["candidates"][said["recommended"]]
    same(ours.sigma, theirs["sigma"])
    same([0.01 * ours.model_delay, 0.01 * ours.delay_sigma], [theirs["delay_s"], theirs["delay_sigma_s"]])


def test_the_truth_is_within_its_deviations(record):
    found = trendid.identify(record["t"], record["u"], record["y"], order=3, integrator=True)
    for name, truth in [("a1", 400.0), ("a2", 20.0), ("b0", 1e6)]:
        q = found[name]
        assert abs(q.value - truth) < 4.0 * q.sigma, (name, q)
    assert abs(found.omega0.value - 20.0) < 4.0 * found.omega0.sigma
    assert "natural frequency" in str(found)


def test_series_tables_and_an_interval_say_the_same(record):
    pandas = pytest.importorskip("pandas")
    table = pandas.DataFrame({"valve": record["u"], "y": record["y"]}, index=record["t"])
    plain = trendid.identify(record["t"], record["u"], record["y"], order=3, integrator=True, pole=20.0)
    series = trendid.identify(table.index, table["valve"], table["y"], order=3, integrator=True, pole=20.0)
    frame = trendid.identify(table.index, table[["valve"]], table["y"], order=3, integrator=True, pole=20.0)
    mapping = trendid.identify(table.index, {"valve": record["u"]}, table[["y"]], order=3, integrator=True, pole=20.0)
    for other in (series, frame, mapping):
        assert np.array_equal(plain.theta, other.theta)
        assert list(other.b) == ["valve"]
    stamps = pandas.to_datetime(np.round(1e9 * record["t"]).astype("int64"))
    dated = trendid.identify(stamps, record["u"], record["y"], order=3, integrator=True, pole=20.0)
    interval = trendid.identify(0.001, record["u"], record["y"], order=3, integrator=True, pole=20.0)
    assert np.allclose(plain.theta, dated.theta, rtol=1e-6)
    assert np.allclose(plain.theta, interval.theta, rtol=1e-6)
    rows = trendid.identify(0.001, record["u"].astype(np.float32), list(record["y"]), order=3, integrator=True, pole=20.0)
    assert np.allclose(plain.theta, rows.theta, rtol=1e-3)


def test_two_inputs_have_their_names(record):
    u2 = np.roll(record["u"], 777)
    found = trendid.identify(record["t"], np.column_stack([record["u"], u2]), record["y"], order=3, integrator=True, pole=20.0)
    assert found.parameters == ["a1", "a2", "b0[u1]", "b0[u2]"]
    named = trendid.identify(
        record["t"], np.column_stack([record["u"], u2]), record["y"], order=3, integrator=True, pole=20.0, names=["a", "b"]
    )
    assert list(named.gains) == ["a", "b"] and abs(named.gains["b"].value) < 0.01 * named.gains["a"].value


def test_transfer_functions_for_scipy_and_control(record):
    signal, control = pytest.importorskip("scipy.signal"), pytest.importorskip("control")
    found = trendid.identify(record["t"], record["u"], record["y"], order=3, integrator=True, pole=20.0, delay=2)
    lti = found.lti()
    assert isinstance(lti, signal.TransferFunction)
    assert np.allclose(lti.den, [1.0, found["a2"].value, found["a1"].value, 0.0])
    _, simulated, _ = signal.lsim(lti, record["u"], record["t"], interp=False)
    assert np.max(np.abs(simulated - record["x"])) < 5.0
    model = found.to_control()
    assert isinstance(model, control.TransferFunction)
    at = 7.0j
    exact = found["b0"].value / np.polyval(lti.den, at) * np.exp(-found.delay_s * at)
    assert abs(model(at) - exact) < 1e-6 * abs(exact)
    assert np.allclose(found.to_control(pade=0).den[0][0], lti.den)


def test_pictures(record, tmp_path):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    found = trendid.identify(record["t"], record["u"], record["y"], order=3, integrator=True, trace=100)
    # Every 40th sample from where the filter has settled.
    assert np.all(np.diff(found.trace_samples.astype(int)) == 40) and found.trace_samples[-1] == 3960
    assert len(found.trace_samples) > 50 and found.trace_theta.shape == (len(found.trace_samples), 3)
    found.plot().savefig(tmp_path / "record.png")
    assert (tmp_path / "record.png").stat().st_size > 10_000


REFUSALS = [
    (dict(order=5), "order is 5, expected a whole number from 1 to 4"),
    (dict(order=2, zeros=2), "2 zeros need an order of at least 3, not 2"),
    (dict(order=2, delay=700), "delay is 700, expected a number of samples from 0 to 512"),
    (dict(order=2, pole=0.0), "pole is 0.0, expected a number of rad/s"),
    (dict(order=2, pole="best"), "pole is 'best'"),
    (dict(order=2, pole=[1]), "pole is [1], expected a number of rad/s"),
    (dict(order=2, pole=np.array([1.0])), "expected a number of rad/s"),
    (dict(order=2, memory=[1.0]), "memory is [1.0], expected a number"),
    (dict(order=2, memory="1"), "memory is '1', expected a number"),
    (dict(order=2, integrator="no"), "integrator is 'no', expected True or False"),
    (dict(order=2, constant=[]), "constant is [], expected True or False"),
    (dict(order=2, hold="linear"), "hold is 'linear', expected 'zoh' or 'foh'"),
    (dict(order=2, scheme="euler"), "scheme is 'euler', expected 'tustin' or 'goodwin'"),
    (dict(order=2, memory=1e-4), "a memory of 0.0001 s is not longer than two samples"),
    (dict(order=2, names=["a", "b"]), "2 names for 1 inputs"),
    (dict(order=float("nan")), "order is nan, expected a whole number from 1 to 4"),
    (dict(order="3"), "order is '3', expected a whole number"),
    (dict(order=2, zeros=[0, 1]), "zeros is [0, 1], expected a whole number"),
    (dict(order=2, delay=float("inf")), "delay is inf, expected a number of samples from 0 to 512"),
    (dict(order=2, delay=None), "delay is None, expected a number of samples from 0 to 512"),
    (dict(order=2, coulomb=[1.0]), "`coulomb` has 1 samples, y 4000"),
]


@pytest.mark.parametrize("options, sentence", REFUSALS)
def test_settings_are_refused_by_name_and_value(record, options, sentence):
    with pytest.raises(trendid.Refusal) as refused:
        trendid.identify(record["t"], record["u"], record["y"], **options)
    assert sentence in str(refused.value)
    assert isinstance(refused.value, ValueError)


def broken(values: np.ndarray, k: int, value: float) -> np.ndarray:
    values = values.copy()
    values[k] = value
    return values


def test_samples_are_refused_by_place_and_value(record):
    t, u, y = record["t"], record["u"], record["y"]
    cases = [
        ((t, broken(u, 7, np.nan), y), "sample 7 of `u` is NaN, not a finite number"),
        ((t, u, broken(y, 9, np.inf)), "sample 9 of the output is inf, not a finite number"),
        ((broken(t, 5, 0.0055), u, y), "t[5] is 0.0055"),
        ((broken(t, 5, np.nan), u, y), "t[5] is nan, expected a finite number of seconds"),
        ((t[::-1], u, y), "time does not advance"),
        ((-1.0, u, y), "the sampling interval -1.0 s is not a positive number"),
        ((t, u[:-1], y), "`u` has 3999 samples, the output 4000"),
        ((t[:-1], u, y), "t has 3999 samples, y 4000"),
        ((t, np.zeros_like(u), y), "the input `u` never changes over the 4000 samples"),
        ((t[:20], u[:20], y[:20]), "too few samples: 20"),
        ((t, u, np.zeros((4000, 2))), "y has the shape (4000, 2), expected one dimension"),
        ((t, ["a"] * 4000, y), "the input 'u' is no array of numbers"),
        ((t, {1: u, "1": np.roll(u, 9)}, y), "two inputs have the name '1'"),
    ]
    for arguments, sentence in cases:
        with pytest.raises(trendid.Refusal) as refused:
            trendid.identify(*arguments, order=3, integrator=True)
        assert sentence in str(refused.value), str(refused.value)
    with pytest.raises(trendid.Refusal):
        trendid.select(t, u, y, pole=None)
