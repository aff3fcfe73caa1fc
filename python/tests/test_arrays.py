"""What is taken as numbers, and what is refused where NumPy would make a number of it."""

from __future__ import annotations

import numpy as np
import pytest

import trendid

STRUCTURE = dict(order=3, integrator=True, pole=20.0)


def refused(call, sentence: str) -> None:
    with pytest.raises(trendid.Refusal) as said:
        call()
    assert sentence in str(said.value), str(said.value)


def masked(values: np.ndarray) -> np.ma.MaskedArray:
    return np.ma.masked_array(values, mask=np.arange(len(values)) == 5)


def test_what_is_no_real_number_is_no_sample(record):
    t, u, y = record["t"], record["u"], record["y"]
    dates = np.arange(len(y)).astype("datetime64[ns]")
    others = [
        u + 0j,
        dates,
        dates - dates[0],
        u.astype(str),
        u.astype(bytes),
        [str(x) for x in u],
        np.array([*u[:-1], "1"], dtype=object),
    ]
    for other in others:
        refused(lambda: trendid.identify(t, other, y, **STRUCTURE), "the input 'u' is no array of numbers")
        refused(lambda: trendid.identify(t, u, other, **STRUCTURE), "y is no array of numbers")
        refused(lambda: trendid.select(t, u, other, pole=20.0), "y is no array of numbers")
    refused(lambda: trendid.identify(t, masked(u), y, **STRUCTURE), "the input 'u' has masked samples, the first of them is number 5")
    refused(lambda: trendid.identify(t, u, masked(y), **STRUCTURE), "y has masked samples")
    refused(lambda: trendid.identify(masked(t), u, y, **STRUCTURE), "t has masked time stamps")
    plain = trendid.identify(t, u, y, **STRUCTURE)
    whole = trendid.identify(t, np.ma.masked_array(u), y.astype(object), **STRUCTURE)
    assert np.array_equal(plain.theta, whole.theta)


def test_the_layout_of_an_array_changes_no_number(record):
    u, y = record["u"], record["y"]
    plain = trendid.identify(0.001, u, y, **STRUCTURE)
    for change in (
        lambda x: np.repeat(x, 3)[::3],
        lambda x: x[::-1].copy()[::-1],
        lambda x: np.stack([x, x], 1)[:, 1],
        lambda x: np.asfortranarray(x.reshape(-1, 1)),
        lambda x: x.astype(">f8"),
        list,
    ):
        assert np.array_equal(trendid.identify(0.001, change(u), change(y), **STRUCTURE).theta, plain.theta)
    counts = trendid.identify(0.001, u, np.round(1e3 * y).astype(np.int64), **STRUCTURE)
    assert abs(counts["b0"].value / plain["b0"].value / 1e3 - 1.0) < 1e-3


def test_an_interval_is_a_number(record):
    u, y = record["u"], record["y"]
    for other in ("0.001", "x", None, 0.001 + 0j, np.timedelta64(1, "ms"), float("nan")):
        refused(lambda: trendid.identify(other, u, y, **STRUCTURE), "is not a positive number")
    refused(lambda: trendid.identify(np.array([], dtype="datetime64[ns]"), u, y, **STRUCTURE), "t ")


def test_series_have_the_same_labels(record):
    pandas = pytest.importorskip("pandas")
    table = pandas.DataFrame({"u": record["u"], "y": record["y"]}, index=record["t"])
    u, y = table["u"], table["y"]
    shuffled = y.sample(frac=1.0, random_state=1)
    refused(lambda: trendid.identify(0.001, u, shuffled, **STRUCTURE), "the index of u is not that of y")
    refused(lambda: trendid.identify(0.001, u.iloc[1:], y.iloc[:-1], **STRUCTURE), "the index of u is not that of y")
    refused(lambda: trendid.identify(0.001, table[["u"]], shuffled, **STRUCTURE), "the index of u is not that of y")
    refused(lambda: trendid.identify(0.001, {"valve": u}, shuffled, **STRUCTURE), "the index of valve is not that of y")
    refused(lambda: trendid.identify(0.001, u, y, coulomb=shuffled, **STRUCTURE), "the index of `coulomb` is not that of y")
    plain = trendid.identify(0.001, u.to_numpy(), list(y), **STRUCTURE)
    for one, other in ((u, list(y)), (list(u), y), (u, y.to_numpy()), (u, y), (table[["u"]], table[["y"]])):
        assert np.array_equal(trendid.identify(0.001, one, other, **STRUCTURE).theta, plain.theta)


def test_names_are_a_list(record):
    u, y = record["u"], record["y"]
    refused(lambda: trendid.identify(0.001, u, y, names="u", **STRUCTURE), "names is 'u', expected a list of names")
    assert list(trendid.identify(0.001, u, y, names=[3], **STRUCTURE).b) == ["3"]


def identifier() -> trendid.Identifier:
    return trendid.Identifier(0.001, bandwidth=20.0, input_range=0.4, output_range=50.0)


def test_samples_of_the_identifier_are_numbers(record):
    u, y = record["u"], record["y"]
    for other in ("0.1", b"1", None, 1j, [[1.0]], np.array([1.0])):
        refused(lambda: identifier().update(0.1, other), f"y is {other!r}, expected a number")
    for other in ("0.1", None, 1j, [[1.0]], ["1"]):
        refused(lambda: identifier().update(other, 0.1), "expected a number")
    assert identifier().update(np.float32(0.1), np.int32(1)) is None
    for other in (u + 0j, masked(u), [str(x) for x in u], ["x"] * len(u)):
        refused(lambda: identifier().run(other, y), "u ")
    refused(lambda: identifier().adapt("no"), "on is 'no', expected True or False")
    refused(lambda: identifier().warm_start(["1"] * 5, [1.0] * 5), "theta is no array of numbers")


def test_a_run_ends_with_a_state_that_there_is():
    for other in ("verifed", "", "Verified", 5):
        refused(lambda: trendid.ServoLoop().run(0.01, until=other), f"until is {other!r}, expected the begin of a state")
    for known in ("idle", "failed: the", "rej"):
        assert len(trendid.ServoLoop().run(0.002, until=known).t) == (1 if known == "idle" else 2)


def test_a_transfer_function_is_a_pair():
    for other in (None, ([0.0, 1.0], [1.0], [2.0]), [1.0]):
        refused(lambda: trendid.tune(other, sample_time=0.001), "a pair of coefficients (a, b)")
    refused(lambda: trendid.tune((np.array([0.0, 1j]), [1.0]), sample_time=0.001), "a is no array of numbers")
