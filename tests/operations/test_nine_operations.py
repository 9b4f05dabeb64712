"""Each of the paper's nine operations in two mappings, both ways, in every backend, against plain Python and numpy."""

from __future__ import annotations

import io
import math
import time
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("PIL")

from PIL import Image

import rosetta_jit as rj
from rosetta_jit.explain import operations as table
from tests.operations.cases import CASES, OPERATIONS, Refused

FOLDER = Path(__file__).parent / "mappings"
BACKENDS = ["numba", "python", "interpreter"]
MESSAGES = 16
ONE_WAY = {"generators"}
"""What a mapping generates the other side does not have, so that there is nothing of it to pack."""


def alike(found: object, wanted: object) -> bool:
    """Whether two values are the same, floats but for the last digits, images but for what their format loses."""
    match found, wanted:
        case dict(), dict():
            return found.keys() == wanted.keys() and all(alike(found[name], each) for name, each in wanted.items())
        case list(), list():
            return len(found) == len(wanted) and all(map(alike, found, wanted))
        case float(), float() | int():
            return math.isclose(found, wanted, rel_tol=1e-12, abs_tol=1e-12)
        case bytes(), bytes() if wanted[:4] in {b"\x89PNG", b"\xff\xd8\xff\xe0"}:
            images = [np.asarray(Image.open(io.BytesIO(each)), np.int32) for each in (found, wanted)]
            return images[0].shape == images[1].shape and np.abs(images[0] - images[1]).max() <= 2 * (wanted[0] == 0xFF)
        case _:
            return found == wanted and type(found) is type(wanted)


def plain(value: object) -> object:
    """A holder's values, without what is not there to compare: the time that it was made."""
    return {name: each for name, each in value.items() if name != "made"} if isinstance(value, dict) else value


def told(oracle, *arguments):
    """What should come out, or the kind of the error that should."""
    try:
        return oracle(*arguments), None
    except Refused as refused:
        return None, str(refused)


class Programs:
    """The programs of a case, and those of its wire's own type."""

    def __init__(self, case, backend):
        options = {"encoding": case.encoding, "backend": backend, **case.options}
        self.decode, self.encode = (kind(str(FOLDER / f"{case.name}.mapping"), **options) for kind in (rj.Decoder, rj.Encoder))
        schema = {each.name: each.read_text() for each in FOLDER.iterdir() if each.suffix != ".mapping"}
        own = {"schema": schema, "imports": list(schema), "encoding": case.encoding, "backend": "python"}
        self.read, self.write = (kind.of(case.wire, **own) for kind in (rj.Decoder, rj.Encoder))

    def message(self, values):
        return self.write(self.write.holder_type.from_dict(values))

    def decodes(self, message, expected, kind):
        """Whether a message is unpacked, and to what."""
        if kind is None:
            assert alike(plain(self.decode(message).to_dict()), expected)
            return True
        with pytest.raises(rj.DecodeError) as error:
            self.decode(message)
        assert error.value.kind == kind
        return False

    def encodes(self, holder, expected, kind):
        if kind is None:
            assert alike(self.read(self.encode(holder)).to_dict(), expected)
            return
        with pytest.raises(rj.EncodeError) as error:
            self.encode(self.encode.holder_type.from_dict(holder.to_dict()))
        assert error.value.kind == kind


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_values(case, backend):
    programs, rng = Programs(case, backend), np.random.default_rng(20261121)
    good, wanted = [], []
    for _ in range(MESSAGES):
        values = case.make(rng)
        message, (expected, kind) = programs.message(values), told(case.unpack, values, len(good))
        if programs.decodes(message, expected, kind):
            good.append(message)
            wanted.append(expected)
            holder = programs.decode.holder_type.from_dict({**expected, **({"made": 0} if case.name == "generators_reading" else {})})
            programs.encodes(holder, *told(case.pack, expected))
    assert len(good) >= 3
    batch = programs.decode.many(b"".join(good), np.cumsum([0, *map(len, good)]))
    for number, expected in enumerate(wanted):
        again = {**expected, "number": expected["number"] + len(good)} if case.name == "generators_reading" else expected
        assert alike(plain(batch[number].to_dict()), again)


@pytest.mark.parametrize("backend", BACKENDS)
def test_the_time(backend):
    programs = Programs(next(case for case in CASES if case.name == "generators_reading"), backend)
    before = time.time_ns()
    made = programs.decode(programs.message({"raw": 1.0, "channel": 0})).made
    assert before <= made <= time.time_ns()


@pytest.mark.parametrize("backend", BACKENDS)
def test_holders_that_no_message_becomes(backend):
    by_name = {case.name: Programs(case, backend).encode for case in CASES if case.operation in {"rejection", "reorder"}}
    refused = {
        "rejection_grip": {"hand": "third", "fingers": [0.0] * 5},
        "rejection_order": {"mode": "SLOW", "amount": 1, "grams": 5, "format": 8},
        "reorder_scan": {"x": [1.0], "y": [], "columns": [0.0] * 6, "colors": b"", "first": []},
    }
    for name, values in refused.items():
        with pytest.raises(rj.EncodeError) as error:
            by_name[name](by_name[name].holder_type.from_dict(values))
        assert error.value.kind == "rejected"
    mixed = {"width": 1, "height": 2, "order": "INTERLEAVED", "data": b"abcdef"}
    planes = {**mixed, "order": "SEPARATE", "data": b"adbecf"}
    sent = [by_name["reorder_frame"](by_name["reorder_frame"].holder_type.from_dict(each)) for each in (mixed, planes)]
    assert sent[0] == sent[1]


def test_each_operation_is_used_by_two_mappings_both_ways():
    """What `rosetta-jit operations` derives from the compiled rules."""
    uses = {case.name: table.operations(str(FOLDER / f"{case.name}.mapping")) for case in CASES}
    counts: Counter[str] = Counter()
    for case in CASES:
        operation = OPERATIONS[case.operation]
        wanted = {"unpack"} if case.operation in ONE_WAY else {"unpack", "pack"}
        assert wanted <= set(uses[case.name][operation]), case.name
        counts[operation] += 1
    assert set(counts) == set(table.OPERATIONS)
    assert min(counts.values()) >= 2


def test_every_mapping_here_is_tried():
    helpers = {"subtype_joint"}
    assert {path.stem for path in FOLDER.glob("*.mapping")} - helpers == {case.name for case in CASES}
