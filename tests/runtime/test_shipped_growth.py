"""No message, whole or damaged, makes a holder of a shipped mapping larger than docs/security.md says."""

from __future__ import annotations

import random
import re
import struct
from contextlib import suppress
from typing import TYPE_CHECKING, Any

import pytest

import rosetta_jit as rj
from rosetta_jit.model.types import Array, Bool, Bytes, Enum, Float, Int, Optional, String, Struct, Type, Union
from rosetta_jit.runtime.run import ELEMENTS_A_BYTE, GRACE_BYTES
from tests.language.test_shipped_laws import ENCODINGS, ROOT, SHIPPED, is_of_wire

if TYPE_CHECKING:
    from rosetta_jit.model.types import Schema

ROUNDS, CAMPAIGN = 60, 10_000
ROOM = 2
"""How many times what was asked for a lane may be: it grows by doubling."""
COUNTS = [0, 1, 2, 64, 0xFF, 0xFFFF, 1 << 16, 1 << 20, 1 << 24, 0x7FFFFFFF, 1 << 31, 0xFFFFFFFF]
SAMPLE = [
    "packed/binary_grid.mapping",
    "packed/occupancy_grid.mapping",
    "ros1/disparity_image.mapping",
    "ros1/grid_cells.mapping",
    "ros1/image_rgb.mapping",
    "ros1/point_cloud2.mapping",
    "yarp/icub/camera_image.mapping",
    "yarp/sig/matrix.mapping",
]


def likely(type_: Type, schema: Schema, texts: list[str], rng: random.Random, depth: int = 5) -> Any:
    """A value of a type, of small numbers and a mapping's own texts, so that lengths and sizes often agree."""
    match schema.resolve(type_):
        case Bool():
            return rng.random() < 0.5
        case Int():
            return rng.choice([0, 1, 1, 2, 3, 4, 7, 8, 12, 16])
        case Float():
            return rng.choice([0.0, 1.0, -0.5])
        case String():
            return rng.choice(texts)
        case Bytes(length=length):
            return bytes(length if isinstance(length, int) else rng.choice([0, 1, 3, 12, 48]))
        case Enum(values=names):
            return rng.choice([name for name, _ in names])
        case Array(element, length):
            size = rng.choice([0, 1, 2, 3, 3, 12]) if depth > 0 else 0
            return [likely(element, schema, texts, rng, depth - 1) for _ in range(length if isinstance(length, int) else size)]
        case Struct(fields=fields):
            own = [each for each in fields if each.constant is None and not (isinstance(each.type, Optional) and depth <= 0)]
            own = [rng.choice(found.cases) if isinstance(found := schema.resolve(each.type), Union) else each for each in own]
            return {each.name: likely(each.type, schema, texts, rng, depth - 1) for each in own}
        case Optional(value):
            return likely(value, schema, texts, rng, depth)
        case other:
            raise AssertionError(other)


def damaged(message: bytes, rng: random.Random) -> bytes:
    """A message some of whose words are counts and sizes that it does not have."""
    changed = bytearray(message)
    for _ in range(rng.choice([0, 1, 1, 2, 3, 5])):
        if len(changed) >= 4:
            at = rng.randrange(len(changed) - 3) & rng.choice([-1, -4])
            changed[at : at + 4] = struct.pack("<I", rng.choice(COUNTS))
    return bytes(changed)


def messages(name: str, rounds: int, rng: random.Random) -> list[bytes]:
    """Messages of a mapping's wire, each of them damaged or whole."""
    checked = rj.check(name).checked
    text = (ROOT / name).read_text("utf-8")
    texts = ["x", "", *re.findall(r'"([^"\n]*)"', text)]
    imports = [each.path for each in checked.mapping.imports if not each.path.endswith(".units") and is_of_wire(each.path, name)]
    write = rj.Encoder.of(checked.wire.root.name, imports=imports, encoding=encoding(name), backend="python")
    found: list[bytes] = []
    for _ in range(10 * rounds):
        try:
            found.append(bytes(write(write.holder_type.from_dict(likely(checked.wire.root, checked.wire.schema, texts, rng)))))
        except rj.EncodeError:  # a length that other fields determine
            continue
        if len(found) == rounds:
            break
    return [damaged(each, rng) for each in found or [bytes(200)] * rounds]


def encoding(name: str) -> str:
    return ENCODINGS[name.partition("/")[0]]


def largest(holder: Any, message: bytes, most: int) -> int:
    """The bytes that the lanes of a holder may have after a message, as docs/security.md says it."""
    plan = holder.lanes_.plan
    within = [each.within for each in plan.layout.lanes]
    return sum(ROOM * count * (ELEMENTS_A_BYTE * len(message) * stride + most) for stride, count in zip(plan.strides, within, strict=False))


def grow(name: str, rounds: int) -> None:
    said = re.search(r"^limit: (\d+)", (ROOT / name).read_text("utf-8"), re.MULTILINE)
    most = int(said[1]) if said else GRACE_BYTES
    decode, rng = rj.Decoder(name, encoding=encoding(name)), random.Random(name)
    for message in messages(name, rounds, rng):
        holder = decode.new()
        before = sum(each.size for each in holder.lanes_.buffers)
        with suppress(rj.DecodeError):
            decode(message, holder)
        after = sum(each.size for each in holder.lanes_.buffers)
        assert after <= before + largest(holder, message, most), message.hex()


@pytest.mark.parametrize("name", SAMPLE)
def test_growth(name):
    grow(name, ROUNDS)


@pytest.mark.campaign
@pytest.mark.parametrize("name", SHIPPED)
def test_growth_of_all(name):
    grow(name, CAMPAIGN)


def test_a_mapping_that_says_more_makes_more():
    """The bound is no larger than it must be: a few runs that are a large grid exceed it where the mapping's own limit is not counted."""
    name = "packed/occupancy_grid.mapping"
    write = rj.Encoder.of("rosetta_jit/GridRuns", imports=["rosetta_jit/GridRuns.msg"], encoding="ros1")
    sizes = {"width": 4096, "height": 4096}
    message = bytes(write(write.holder_type.from_dict({"info": sizes, "values": [1], "counts": [1 << 24]})))
    holder = rj.Decoder(name, encoding="ros1")(message)
    size = sum(each.size for each in holder.lanes_.buffers)
    assert largest(holder, message, GRACE_BYTES) < size <= largest(holder, message, 1 << 26)
