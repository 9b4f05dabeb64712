"""Decoders of several wires in generated source make of messages that arrive one by one what the library makes of them."""

from __future__ import annotations

import copy
import importlib.util
import random
import re
import struct
import subprocess
import sys
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import pytest

import rosetta_jit as rj
from rosetta_jit.api.options import request_of
from rosetta_jit.cli import main
from rosetta_jit.generate.build import generated
from tests.api.test_across_wires import MAPPING, SCHEMAS, WIRES, message
from tests.generate import cpp, lisp
from tests.generate.cpp import QUICK
from tests.generate.driver import SANITIZED, STRICT, needs_gcc

HERE = Path(__file__).parent
NAMES = list(WIRES)
FILES = {**SCHEMAS, "seen.mapping": MAPPING + '  reject "too steep" when .tilt.step > 1\n'}
"""A message of tilt is refused after it has set an element of an array that pose fills, too."""


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
    is_there = seen.HasField("count") if hasattr(seen, "HasField") else seen.count is not None
    count = seen.count if is_there else -1000
    numbers = f"{count} {seen.least:.17g} {int(seen.ready)} {seen.tilt:.17g}"
    return f"{seen.frame} {seen.lead:.17g} [{ranges}] {numbers} [{joined}] {'|'.join(seen.names)} {seen.steps}"


@cache
def both():
    """The library's programs, twice: decoders of the same wires that have had no message."""
    return [rj.Decoders("seen.mapping", schema=FILES) for _ in range(2)]


@pytest.fixture(scope="module")
def told():
    """Messages of all wires for programs that join them, and what the library says of each."""
    every, programs = list(arrivals()), both()[0]
    return Told(every, [shown(programs, wire, data) for wire, data in every])


@pytest.fixture(scope="module")
def whole(told):
    """What there is in an object that a message which is refused does not change: what the library says where these do not come."""
    programs = both()[1]
    accepted = {number for number, line in enumerate(told.said) if line is None or line.startswith("ok ")}
    good = [shown(programs, wire, data) if number in accepted else None for number, (wire, data) in enumerate(told.arrivals)]
    return [line or refused for line, refused in zip(good, told.said, strict=True)]


@dataclass(frozen=True)
class Told:
    """Messages with their wires, and lines about them."""

    arrivals: list[tuple[str, bytes]]
    said: list[str | None]

    @property
    def stream(self) -> bytes:
        return b"".join(struct.pack("<BI", NAMES.index(wire), len(data)) + data for wire, data in self.arrivals)


def written(folder, language):
    """The files of the mapping in a language."""
    texts = generated(request_of("decode", {"schema": FILES}, mapping="seen.mapping"), language, ("decode",), "seen")
    for name, text in texts.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text)


def printed(told, folder, *command):
    """The lines of a program that was given the messages."""
    lines = subprocess.run(command, input=told.stream, capture_output=True, check=True, cwd=folder).stdout.decode().splitlines()
    assert {line.split()[0] for line in lines} >= {"ok", "truncated", "rejected"}
    return lines


@needs_gcc
def test_c_joins_what_the_library_joins(tmp_path, told):
    written(tmp_path, "c")
    command = ["gcc", *STRICT, *SANITIZED, f"-I{tmp_path}", "-o", tmp_path / "joined", HERE / "joined.c", tmp_path / "seen.c", "-lm"]
    subprocess.run(command, check=True)
    lines = printed(told, tmp_path, tmp_path / "joined")
    assert [(one, two) for one, two in zip(lines, told.said, strict=True) if two is not None and one != two] == []
    assert sum(each is not None for each in told.said) > 200


@cpp.needs_cpp
def test_cpp_joins_what_the_library_joins(tmp_path, told, whole):
    written(tmp_path, "cpp")
    command = ["g++", *cpp.STRICT, *QUICK, f"-I{tmp_path}", "-o", tmp_path / "joined", HERE / "joined.cpp", tmp_path / "seen.cpp"]
    subprocess.run(command, check=True)
    assert printed(told, tmp_path, tmp_path / "joined") == whole


def test_python_joins_what_the_library_joins(tmp_path, told, whole):
    written(tmp_path, "python")
    spec = importlib.util.spec_from_file_location("seen", tmp_path / "seen.py")
    unit = sys.modules["seen"] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(unit)
    for _ in range(2):
        seen, lines = unit.Seen(), list[str]()
        for wire, data in told.arrivals:
            before = copy.deepcopy(seen)
            try:
                assert getattr(unit, f"decode_{wire}")(data, seen) is seen
                text = f"ok {fields(seen)}"
            except unit.DecodeError as error:
                assert seen == before
                text = f"{error.kind} {error.offset} [{error.path}] {error.detail}" + (f" ({error.line})" if error.line else "")
            ages = (getattr(unit, f"age_{each}")() for each in NAMES)
            lines.append(f"{text} {' '.join(str(-1 if age is None else age) for age in ages)}")
        assert lines == whole
        unit.reset()


@lisp.needs_sbcl
def test_lisp_joins_what_the_library_joins(tmp_path, told, whole):
    written(tmp_path, "lisp")
    lines = printed(told, tmp_path, *lisp.COMMAND, "--load", "seen-runtime.lisp", "--load", HERE / "joined.lisp")
    assert [
        re.sub(r"(?<![\w.])-?[\d.]+d[+-]?\d+", lambda found: f"{float(found[0].replace('d', 'e')):.17g}", line) for line in lines
    ] == whole


@pytest.mark.parametrize("options", [("--directions", "borrow"), ("--emit", "object"), ("--language", "cpp", "--holder", "yarp")])
def test_what_cannot_join_is_refused(tmp_path, capsys, options):
    directions = () if "--directions" in options else ("--directions", "decode")
    assert main(["generate", "joined/odometry.mapping", *options, *directions, "-o", str(tmp_path)]) == 1
    said = capsys.readouterr().err
    assert "choose another `--holder`" in said if "yarp" in options else "made as source, by `--directions decode`" in said
    assert not list(tmp_path.iterdir())


def test_one_wire_alone_has_an_encoder_beside(tmp_path, capsys):
    assert main(["generate", "joined/odometry.mapping", "--wire", "pose", "-o", str(tmp_path)]) == 0
    header = (tmp_path / "odometry.h").read_text()
    assert "odometry_decode_pose(" in header
    assert "odometry_decode_velocity(" not in header
    assert "odometry_encode(" in header
    capsys.readouterr()
