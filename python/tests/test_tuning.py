"""`tune`: the numbers of the command line."""

from __future__ import annotations

import numpy as np
import pytest

import trendid

from conftest import RECORD
from test_record import same


def compare(ours: trendid.Tuned, said: dict) -> None:
    assert [loop.kind for loop in ours.loops] == [loop["kind"] for loop in said["loops"]]
    assert len(ours.loops) > 0
    for loop, theirs in zip(ours.loops, said["loops"]):
        same(loop.bandwidth, theirs["bandwidth"])
        assert set(loop.gains) == set(theirs["gains"])
        for name, value in loop.gains.items():
            same(value, theirs["gains"][name])
        for margins, name in ((loop.margins, "margins"), (loop.worst, "within_2_sigma")):
            assert (margins is None) == (theirs[name] is None)
            if margins is not None:
                finite = {key: value for key, value in theirs[name].items() if value is not None}
                for key, value in finite.items():
                    same(getattr(margins, key), value)
    same(ours.feedforward, said["feedforward"])
    assert [list(one) for one in ours.refused] == [[one["kind"], one["reason"]] for one in said["refused"]]


@pytest.mark.parametrize("bandwidth", [None, 15.0])
def test_the_gains_are_those_of_the_command_line(record, trendid_cli, bandwidth):
    structure = ["--order", "3", "--integrator", "--delay", "0"]
    wish = ["--bandwidth", "auto" if bandwidth is None else str(bandwidth)]
    said = trendid_cli("tune", "record", str(RECORD), *structure, *wish)
    model = trendid.identify(record["t"], record["u"], record["y"], order=3, integrator=True)
    compare(trendid.tune(model, bandwidth=bandwidth), said)


def test_a_step_reaches_its_end_and_a_kind_has_its_name():
    tuned = trendid.tune(([0.0, 400.0, 20.0], [1e6]), sample_time=1e-3, delay=0.5e-3)
    for loop in tuned.loops:
        assert loop.margins.stable and loop.margins.max_sensitivity <= 1.7 and loop.worst is None
        assert tuned[loop.kind] is loop
        assert len({len(one) for one in loop.step}) == 1 and np.all(np.isfinite(loop.step[1]))
    with pytest.raises(KeyError, match="fuzzy"):
        tuned["fuzzy"]


def test_what_has_no_controller_is_refused():
    for model, options, sentence in [
        (([0.0] * 5, [1.0]), dict(sample_time=1e-3), "5"),
        (([0.0, 1.0], [0.0]), dict(sample_time=1e-3), "moves nothing"),
        (([0.0, 1.0], [1.0]), dict(sample_time=-1.0), "-1"),
        (([0.0, 1.0], [1.0]), dict(sample_time=[1e-3]), "sample_time is [0.001], expected a number"),
        (([0.0, 1.0], [1.0]), dict(), "sample_time is missing"),
        (([0.0, 1.0], [1.0]), dict(sample_time=1e-3, bandwidth=1e6), "1000000"),
    ]:
        with pytest.raises(trendid.Refusal) as refused:
            trendid.tune(model, **options)
        assert sentence in str(refused.value), str(refused.value)
