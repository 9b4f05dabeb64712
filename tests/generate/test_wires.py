"""Decoders of several wires in generated source: what C makes of messages that arrive one by one is what the library makes of them."""

from __future__ import annotations

import random
import struct
import subprocess
from pathlib import Path

import pytest

import rosetta_jit as rj
from rosetta_jit.api.options import request_of
from rosetta_jit.cli import main
from rosetta_jit.generate.build import generated
from tests.api.test_across_wires import FILES, WIRES, made, message
from tests.generate.driver import SANITIZED, STRICT, needs_gcc, write

MAIN = Path(__file__).with_name("joined.c")
NAMES = list(WIRES)


def arrivals():
    """Messages of all wires, some of which are refused: cut, or rejected by the mapping."""
    chance = random.Random("arrivals")
    for number in range(300):
        values = {
            "scan": {
                "frame": chance.choice(["map", "odom", "", "a" * 30]),
                "ranges": [chance.uniform(-1, 1) for _ in range(chance.randrange(5))],
                "level": chance.choice([0, 0, 0, 99]),
                "good": chance.random() < 0.5,
            },
            "pose": {"x": chance.uniform(-2, 2), "seq": chance.randrange(-3, 4), "sigma": [1.0 * number, 2.0 + number]},
            "tilt": {"angle": chance.uniform(-1, 1), "step": chance.randrange(-1, 3)},
        }
        wire = chance.choice(NAMES)
        data = message(wire, values[wire])
        yield wire, data[: chance.randrange(len(data))] if chance.random() < 0.1 else data


def shown(programs, wire, data):
    """What the program in C prints of one message; None where a part is not valid, which C leaves to its caller."""
    try:
        text = f"ok {fields(programs[wire](data))}"
    except rj.DecodeError as error:
        text = f"{error.kind} {error.offset} [{error.path}] {error.detail}"
    except rj.InvalidHolder:
        return None
    return f"{text} {' '.join(str(-1 if age is None else age) for age in programs.ages.values())}"


def fields(seen):
    ranges, joined = ("".join(f"{each:.17g} " for each in some) for some in (seen.ranges, seen.joined))
    count = seen.count if seen.HasField("count") else -1000
    numbers = f"{count} {seen.least:.17g} {int(seen.ready)} {seen.tilt:.17g}"
    return f"{seen.frame} {seen.lead:.17g} [{ranges}] {numbers} [{joined}] {seen.steps}"


@needs_gcc
def test_c_joins_what_the_library_joins(tmp_path):
    request = request_of("decode", {"schema": FILES}, mapping="seen.mapping")
    name = write(tmp_path, generated(request, "c", ("decode",), "seen"))
    program = tmp_path / "joined"
    command = ["gcc", *STRICT, *SANITIZED, f"-I{tmp_path}", "-o", program, MAIN, tmp_path / f"{name}.c", "-lm"]
    subprocess.run(command, check=True)
    every = list(arrivals())
    given = b"".join(struct.pack("<BI", NAMES.index(wire), len(data)) + data for wire, data in every)
    printed = subprocess.run([program], input=given, capture_output=True, check=True).stdout.decode().splitlines()
    programs = made()
    programs.reset()
    wanted = [shown(programs, wire, data) for wire, data in every]
    assert {line.split()[0] for line in printed} >= {"ok", "truncated", "rejected"}
    assert [(one, two) for one, two in zip(printed, wanted, strict=True) if two is not None and one != two] == []
    assert sum(each is not None for each in wanted) > 200


@pytest.mark.parametrize("options", [("--language", "cpp"), ("--language", "python"), ("--directions", "borrow"), ("--emit", "object")])
def test_what_cannot_join_is_refused(tmp_path, capsys, options):
    directions = () if "--directions" in options else ("--directions", "decode")
    assert main(["generate", "joined/odometry.mapping", *options, *directions, "-o", str(tmp_path)]) == 1
    assert "--language c --directions decode" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_one_wire_alone_has_an_encoder_beside(tmp_path, capsys):
    assert main(["generate", "joined/odometry.mapping", "--wire", "pose", "-o", str(tmp_path)]) == 0
    header = (tmp_path / "odometry.h").read_text()
    assert "odometry_decode_pose(" in header
    assert "odometry_decode_velocity(" not in header
    assert "odometry_encode(" in header
    capsys.readouterr()
