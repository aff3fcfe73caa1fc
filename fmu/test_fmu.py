"""Validates both units with FMPy and simulates them; prints what `cargo xtask fmu` compares with Rust.

usage: test_fmu.py identifier.fmu loop.fmu servo.csv
"""

import contextlib
import ctypes
import io
import math
import shutil
import struct
import sys

from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave
from fmpy.validation import validate_fmu


class Hash:
    """FNV-1a over the bits of numbers."""

    def __init__(self):
        self.value = 0xCBF29CE484222325

    def bits(self, word):
        for byte in struct.pack("<I", word):
            self.value = ((self.value ^ byte) * 0x100000001B3) % 2**64

    def number(self, value):
        (word,) = struct.unpack("<I", struct.pack("<f", value))
        self.bits(word)


class Unit:
    """A running unit with its variables by name."""

    def __init__(self, path, **parameters):
        problems = validate_fmu(path)
        assert not problems, problems
        description = read_model_description(path)
        self.directory = extract(path)
        self.references = {v.name: (v.type, v.valueReference) for v in description.modelVariables}
        self.unit = FMU2Slave(
            guid=description.guid,
            unzipDirectory=self.directory,
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName="one",
        )
        self.unit.instantiate()
        self.unit.setupExperiment(startTime=0.0)
        self.set(**parameters)
        self.unit.enterInitializationMode()
        self.unit.exitInitializationMode()

    def set(self, **values):
        for name, value in values.items():
            kind, reference = self.references[name]
            getattr(self.unit, f"set{kind}")([reference], [value])

    def get(self, name):
        kind, reference = self.references[name]
        return getattr(self.unit, f"get{kind}")([reference])[0]

    def step(self, k, samples=1):
        self.unit.doStep(k * 0.001, samples * 0.001)

    def end(self):
        self.unit.terminate()
        self.unit.freeInstance()
        shutil.rmtree(self.directory)


THETA = ["a1", "a2", "b0", "constant", "initial_state"]


def identify(path, record):
    unit = Unit(path, u_range=0.4, y_range=50.0)
    number = Hash()
    rows = [line.split(",") for line in open(record).read().splitlines()[6:]]
    for k, row in enumerate(rows):
        unit.set(u=float(row[1]), y=float(row[2]))
        unit.step(k)
        for name in THETA + [name + "_std" for name in THETA] + ["prediction", "innovation"]:
            number.number(unit.get(name))
        number.bits(unit.get("kind"))
        if k == len(rows) // 2:
            # Back to a state that was kept: the rest must come out as if nothing had happened.
            state = unit.unit.getFMUState()
            unit.set(u=1.0, y=-3.0)
            unit.step(k + 1, 20)
            unit.unit.setFMUState(state)
            unit.unit.freeFMUState(state)
    assert abs(unit.get("omega0") - 20) < 0.2 and abs(unit.get("damping") - 0.5) < 0.01
    unit.end()
    print(f"identifier {number.value:016x}")


def f32(value):
    return ctypes.c_float(value).value


class Drive:
    """The simulated drive of the examples, in single precision: each operation is rounded."""

    def __init__(self):
        self.position, self.velocity, self.acceleration, self.seed = 200.0, 0.0, 0.0, 1

    def move(self, command):
        time, zone = f32(f32(0.001) / 8), f32(0.03)
        flow = 0.0
        if command > zone:
            flow = f32(command - zone)
        elif command < -zone:
            flow = f32(command + zone)
        for _ in range(8):
            jerk = f32(f32(f32(1e6 * flow) - f32(20 * self.acceleration)) - f32(400 * self.velocity))
            self.acceleration = f32(self.acceleration + f32(time * jerk))
            self.velocity = f32(self.velocity + f32(time * self.acceleration))
            self.position = f32(self.position + f32(time * self.velocity))
        self.seed = (self.seed * 1664525 + 1013904223) % 2**32
        noise = (self.seed >> 24) % 5 - 2
        return 8_000_000 + int(f32(self.position * 200)) + noise


def control(path):
    unit = Unit(path, reference_code=8_000_000, bandwidth=20.0)
    drive, number, command = Drive(), Hash(), 0.0
    for k in range(6000):
        unit.set(code=drive.move(command), commission=k == 0)
        if k == 5000:
            unit.set(target=300.0)
        unit.step(k)
        command = unit.get("command")
        for name in ["command", "position", "reference", "innovation"]:
            number.number(unit.get(name))
        number.bits(unit.get("state"))
        number.bits(unit.get("reason"))
    assert 3 <= unit.get("state") <= 6, unit.get("state")
    assert abs(unit.get("position") - 300) < 1
    unit.end()
    print(f"loop-fmu {number.value:016x}")


def wait(path):
    """A target that comes before control is a move when control begins, and no end of the simulation."""
    unit = Unit(path, reference_code=8_000_000, bandwidth=20.0)
    drive, command = Drive(), 0.0
    for k in range(5000):
        unit.set(code=drive.move(command), commission=k == 10)
        if k < 300:
            unit.set(target=float(k))
        unit.step(k)
        command = unit.get("command")
    assert 3 <= unit.get("state") <= 6, unit.get("state")
    assert abs(unit.get("position") - 299) < 1, unit.get("position")
    unit.end()


def fails(call, *arguments):
    """Whether a unit refuses a call."""
    try:
        call(*arguments)
    except Exception:
        return True
    return False


def refuse(path, loop):
    for wrong in [{"bandwidth": 5000.0}, {"delay": 8}, {"sample_time": 0.0}, {"y_range": float("nan")}]:
        assert fails(lambda: Unit(path, **wrong)), wrong
    unit = Unit(path)
    # Nothing is known before the first sample, which is no zero.
    assert all(math.isnan(unit.get(name)) for name in ["gain", "gain_std", "omega0", "omega0_std", "damping_std"])
    step = unit.unit.doStep
    for now, length in [(0.0, 0.0005), (0.0, -0.001), (0.0, 0.0), (0.0, float("nan")), (0.0, 1e300), (1.0, 0.001), (0.0005, 0.0005)]:
        assert fails(step, now, length), (now, length)
    unit.step(0)
    # A step that begins before the end of the one before, or behind it, is not filled in.
    for now, length in [(0.0, 0.002), (0.002, 0.001), (0.0, 0.001)]:
        assert fails(step, now, length), (now, length)
    # What the object was built with does not change under it, and an output is not written.
    for fixed in [{"sample_time": 0.002}, {"delay": 1}, {"a1": 1.0}, {"kind": 1}]:
        assert fails(lambda: unit.set(**fixed)), fixed
    unit.step(1, 3)
    assert unit.get("sample_time") == 0.001
    unit.end()
    # A sample that is not finite changes nothing; a target that is none ends the run under its name.
    unit = Unit(path, u_range=0.4, y_range=50.0)
    for k in range(200):
        bad = k % 50 == 49
        unit.set(u=float("inf") if bad else 0.4, y=float("nan") if bad else 0.01 * k)
        unit.step(k)
        assert all(math.isfinite(unit.get(name)) for name in THETA + ["prediction"])
    unit.end()
    unit = Unit(loop, reference_code=8_000_000, bandwidth=20.0)
    drive, command = Drive(), 0.0
    for k in range(3000):
        unit.set(code=drive.move(command), commission=k == 0)
        unit.step(k)
        command = unit.get("command")
    unit.set(target=float("nan"))
    assert fails(unit.step, 3000)
    print("refusals ok")


if __name__ == "__main__":
    identify(sys.argv[1], sys.argv[3])
    control(sys.argv[2])
    wait(sys.argv[2])
    # What the units say of it goes to the terminal.
    with contextlib.redirect_stdout(io.StringIO()) as said:
        refuse(sys.argv[1], sys.argv[2])
    for name in ["bandwidth", "a communication step must begin where", "a parameter is fixed", "an output cannot", "target"]:
        assert name in said.getvalue(), (name, said.getvalue())
    print(said.getvalue().splitlines()[-1])
