"""Bottles of YARP 3 become those of YARP 4, and back: the bytes that the real libraries write for the same values."""

from __future__ import annotations

import json
import random
import struct
from pathlib import Path

import pytest

import rosetta_jit as rj
from rosetta_jit.errors import DecodeError, EncodeError
from rosetta_jit.frameworks.yarp.bottle import read, write
from rosetta_jit.frameworks.yarp.tags import DIALECTS

VECTORS = Path(__file__).resolve().parents[2] / "vectors" / "yarp"
OTHER = {
    "yarp3": {"text_vocab_long": "YARP 4 reads another vocab out of this text", "sound_4x2": "YARP 4 has one list more"},
    "yarp4": {
        "sound_4x2": "YARP 4 has one list more",
        **dict.fromkeys(("oldimg_rgb_4x3", "oldimg_mono_5x3", "oldimg_rgb_1x1", "oldimg_rgb_16x12"), "as YARP 3.4 wrote it: no flag"),
    },
}
REFUSED = {
    "yarp3": {"pointcloud_xyz_2": "a message is a list", "pointcloud_xyzrgba_1": "a message is a list"},
    "yarp4": {
        "pointcloud_xyz_2": "a message is a list",
        "pointcloud_xyzrgba_1": "a message is a list",
        "vocab64_5": "YARP 3 has no vocab64",
        "text_vocab_long": "YARP 3 has no vocab64",
    },
}


def vectors(dialect):
    return {each["name"]: bytes.fromhex(each["hex"]) for each in json.loads((VECTORS / f"{dialect}.json").read_text())}


@pytest.fixture(scope="module", params=["llvm", "python"])
def bridges(request):
    half = {"backend": request.param}
    pairs = ("yarp3", "yarp4"), ("yarp4", "yarp3")
    return {source: rj.Bridge(None, None, decode={"encoding": source, **half}, encode={"encoding": to, **half}) for source, to in pairs}


@pytest.mark.parametrize("source", ["yarp3", "yarp4"])
def test_what_the_other_library_writes(bridges, source):
    there = vectors("yarp4" if source == "yarp3" else "yarp3")
    for name, message in vectors(source).items():
        if name in REFUSED[source]:
            with pytest.raises(DecodeError, match=REFUSED[source][name]):
                bridges[source](message)
        elif name in there:
            assert (bridges[source](message) == there[name]) == (name not in OTHER[source]), name


@pytest.mark.parametrize("source", ["yarp3", "yarp4"])
def test_there_and_back(bridges, source):
    back = bridges["yarp4" if source == "yarp3" else "yarp3"]
    for name, message in vectors(source).items():
        if name not in REFUSED[source] and not name.startswith("oldimg"):
            assert back(bridges[source](message)) == message, name


def test_images_within_lists():
    """The headers of layered images stand among other elements; only these have a number that differs."""
    there = rj.Bridge.between("yarp4", "yarp3")
    image = vectors("yarp4")["img_rgb_4x3_padded"]
    pixels = image[8:]
    layered = struct.pack("<ii", 256, 5) + struct.pack("<ii", 1, 7) + pixels
    expected = there(image)[8:]
    assert there(layered) == layered[:16] + expected
    assert there(image[:-1] + b"\0")[:60] == there(image)[:60]


def test_many_and_into():
    there = rj.Bridge.between("yarp3", "yarp4")
    messages = [each for name, each in vectors("yarp3").items() if name not in REFUSED["yarp3"]] * 3
    found, ends = there.many(messages)
    assert [found[ends[i] : ends[i + 1]].tobytes() for i in range(len(messages))] == [there(each) for each in messages]
    buffer = bytearray(1 << 16)
    for each in messages[:50]:
        assert buffer[: there.into(each, buffer)] == there(each)


def test_as_a_reader_and_a_writer_in_python_do(bridges):
    """Random damage: what is refused is no bottle, and what is not comes out as the reference writes it."""
    choose = random.Random(7)
    messages = [each for name, each in vectors("yarp3").items() if len(each) < 200 and not name.startswith(("img", "oldimg"))]
    taken = 0
    for _ in range(1500):
        message = bytearray(choose.choice(messages))
        for _ in range(choose.randrange(1, 4)):
            message[choose.randrange(len(message))] = choose.choice([0, 1, 2, 3, 4, 10, 12, 255, choose.randrange(256)])
        try:
            found = bridges["yarp3"](bytes(message))
        except DecodeError:
            continue
        taken += 1
        try:
            expected = write(read(bytes(message), DIALECTS["yarp3"]), DIALECTS["yarp4"])
        except (DecodeError, EncodeError):
            continue  # the reference is stricter about texts
        assert len(expected) <= len(found)
        if len(expected) == len(found):
            assert str(read(found, DIALECTS["yarp4"])) == str(read(expected, DIALECTS["yarp4"]))
    assert taken > 100


@pytest.mark.parametrize(
    ("message", "kind", "offset"),
    [
        (b"", "truncated", 0),
        (struct.pack("<ii", 256, -1), "count", 4),
        (struct.pack("<iiii", 256, 1, 4, -1), "length", 12),
        (struct.pack("<iiii", 256, 1, 4, 2**31 - 1), "truncated", 16),
        (struct.pack("<ii", 266, 2**31 - 1), "truncated", 8),
        (struct.pack("<ii2d", 266, 3, 1, 2) + b"abc", "truncated", 27),
        (struct.pack("<iiii", 256, 2, 257, 1), "truncated", 16),
        (struct.pack("<iii", 256, 1, 999), "tag", 8),
        (struct.pack("<ii", 1, 0), "tag", 0),
        (struct.pack("<iiii", 256, 1, 768, 1), "tag", 12),
        (struct.pack("<ii", 256, 0) + b"x", "trailing", 8),
        (struct.pack("<ii", 256, 1) * 100_000, "nesting", 2048),
    ],
)
def test_what_is_no_bottle(bridges, message, kind, offset):
    with pytest.raises(DecodeError) as found:
        bridges["yarp3"](message)
    assert (found.value.kind, found.value.offset) == (kind, offset)


def test_other_encodings():
    with pytest.raises(rj.SchemaError, match="nothing turns any message of `yarp3` into one of `cdr`"):
        rj.Bridge.between("yarp3", "cdr")
    with pytest.raises(rj.SchemaError, match="yarp2012"):
        rj.Bridge.between("yarp3", "yarp2012")
