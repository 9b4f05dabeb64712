"""What a mapping adds: its decode against that of the same message without one, and what its arithmetic takes in a numba kernel by hand."""

from __future__ import annotations

import math
import struct

import numpy as np
import pytest

import rosetta_jit as rj
from bench import ros_wire
from bench.contest import Contender
from bench.figures import Spread
from bench.messages import joints_mapping, specialised
from bench.subjects import RST_IMAGE

numba = pytest.importorskip("numba")

CHAPTER = "Mappings"
OURS, PLAIN, BY_HAND, CALL, MOVE = "rosetta_jit", "unmapped", "numba by hand", "numba, of nothing", "memmove"
AT_MOST = 1.2
COUNT = 1000
FILES = {
    "wire/msg/Wire.msg": "float64[] numbers\nint32[] kinds\nwire/Point[] points\n",
    "wire/msg/Point.msg": "float64 x\nfloat64 y\nfloat64 z\nint32 id\n",
    "held/msg/Held.msg": "float32[] numbers\nint32[] kinds\nheld/Point[] points\n",
    "held/msg/Point.msg": "float64 z\nfloat64 y\nfloat64 x\nint32 id\n",
}
HEAD = 'import "wire/msg/Wire.msg"\nimport "held/msg/Held.msg"\ndata-holder: held/Held\nwire-schema: wire/Wire\nunpack-rules:\n'
RULES = {
    "numbers": "  .numbers[] = float32(radians(.numbers[]))\n",
    "kinds": "  .kinds[] = table(.kinds[]) { 5 = 0, 6 = 2, 7 = 1, otherwise 3 }\n",
    "points": "".join(f"  .points[].{name} = .points[].{name}{by}\n" for name, by in (("x", ""), ("y", " * 2.0"), ("z", ""), ("id", ""))),
}


def radians(source, target, count):
    for i in range(count):
        target[i] = np.float32(source[i] * (math.pi / 180))


def looked_up(source, target, count):
    for i in range(count):
        kind = source[i]
        target[i] = 0 if kind == 5 else 2 if kind == 6 else 1 if kind == 7 else 3


def doubled(source, target, count):
    for i in range(count):
        target[i] = source[i] * 2.0


NUMBERS = np.arange(COUNT, dtype=np.float64)
KINDS = (np.arange(COUNT) % 4 + 5).astype(np.int32)
WORK = {
    "numbers": (radians, NUMBERS, np.empty(COUNT, np.float32)),
    "kinds": (looked_up, KINDS, np.empty(COUNT, np.int32)),
    "points": (doubled, NUMBERS, np.empty(COUNT)),
}
WHAT = {
    "numbers": f"mapping, {COUNT} degrees to radians",
    "kinds": f"mapping, {COUNT} numbers looked up in a table",
    "points": f"mapping, {COUNT} points renamed and one coordinate doubled",
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    made = tmp_path_factory.mktemp("mapped")
    for name, content in FILES.items():
        (made / name).parent.mkdir(parents=True, exist_ok=True)
        (made / name).write_text(content)
    return made


def message(part):
    """A message in which one of the three arrays has elements."""
    points = np.zeros(COUNT, [("x", "<f8"), ("y", "<f8"), ("z", "<f8"), ("id", "<i4")])
    points["x"], points["y"], points["id"] = NUMBERS, NUMBERS, KINDS
    arrays = {"numbers": NUMBERS, "kinds": KINDS, "points": points}
    return b"".join(struct.pack("<I", COUNT) + each.tobytes() if name == part else bytes(4) for name, each in arrays.items())


def mapped(part, folder):
    rest = "".join(f"  ignore .{name}\n  default .{name}\n" for name in RULES if name != part)
    (folder / f"{part}.mapping").write_text(HEAD + RULES[part] + rest)
    return rj.Decoder(folder / f"{part}.mapping", encoding="ros1", search_path=[folder])


def check(part, found):
    match part:
        case "numbers":
            assert np.allclose(found.numbers, np.radians(NUMBERS), rtol=1e-6)
        case "kinds":
            assert list(found.kinds) == [{5: 0, 6: 2, 7: 1}.get(kind, 3) for kind in KINDS.tolist()]
        case _:
            assert [(point.x, point.y, point.z, point.id) for point in found.points[:3]] == [(i, 2.0 * i, 0.0, 5 + i) for i in range(3)]


@pytest.mark.parametrize("part", RULES)
def test_arrays(part, folder, effort, compare, record):
    decode, data = mapped(part, folder), message(part)
    check(part, decode(data))
    plain = rj.Decoder.of("wire/Wire", encoding="ros1", search_path=[folder], imports=["wire/msg/Wire.msg"])
    outcome = compare(CHAPTER, WHAT[part], [*contenders(decode, plain, data, effort), *by_hand(*WORK[part], COUNT, effort)])
    record(WHAT[part], added(outcome), AT_MOST, "x unmapped and the arithmetic by hand", f"{outcome.took(OURS).median:.0f} ns")
    if part == "points":
        record(f"{WHAT[part]}, against its bytes", outcome.ratio(OURS, MOVE), None, "x memmove", "each byte once")


def test_joints(tmp_path, effort, compare, record):
    data, what = specialised(24), "mapping, an iCub's 24 joints to radians"
    decode = rj.Decoder(joints_mapping(24, tmp_path), encoding="yarp3")
    plain = rj.Decoder.of("bench.joints24", encoding="yarp3", imports=["joints24.bottle-schema"], search_path=[tmp_path])
    assert decode(data).angles == pytest.approx(np.radians([10.0 * index - 7.25 for index in range(24)]), rel=1e-6)
    outcome = compare(CHAPTER, what, [*contenders(decode, plain, data, effort), *by_hand(*WORK["numbers"], 24, effort)])
    record(what, added(outcome), AT_MOST, "x unmapped and the arithmetic by hand", f"{outcome.took(OURS).median:.0f} ns")


def contenders(decode, plain, data, effort):
    plain(data)
    source, target = np.frombuffer(data, np.uint8), np.empty(len(data), np.uint8)
    return [
        Contender(OURS, "ours", "an object of another type, used again", effort.call(decode, data)),
        Contender(PLAIN, "limit", "an object of the wire's type, used again", effort.call(plain, data)),
        Contender(MOVE, "limit", "the message, elsewhere", effort.call(np.copyto, target, source)),
    ]


def by_hand(function, source, target, count, effort):
    """The arithmetic alone, and the call that it takes from Python."""
    compiled = numba.njit(function)
    compiled(source, target, count)
    return [
        Contender(BY_HAND, "limit", "the numbers, from one array to another", effort.call(compiled, source, target, count)),
        Contender(CALL, "limit", "nothing", effort.call(compiled, source, target, 0)),
    ]


def added(outcome):
    """Ours over the unmapped decode and the arithmetic, round by round."""
    rounds = outcome.rounds_ns
    parts = zip(rounds[OURS], rounds[PLAIN], rounds[BY_HAND], rounds[CALL], strict=True)
    return Spread.of([ours / (plain + max(0.0, work - call)) for ours, plain, work, call in parts])


def test_cloud(effort, compare, record):
    """Coordinates among the bytes of a cloud, against numpy's copy of three strided columns, which asks nothing."""
    what, points = "mapping, 100,000 points out of the bytes of a cloud", ros_wire.POINTS
    data = ros_wire.written(ros_wire.Ros1(), ros_wire.point_cloud)
    decode = rj.Decoder("ros1/point_cloud2.mapping", encoding="ros1")
    stride = 16
    body = np.frombuffer(data, np.uint8)[len(data) - 1 - stride * points : -1]
    columns = body.view(np.dtype({"names": ["x", "y", "z"], "formats": ["<f4"] * 3, "offsets": [0, 4, 8], "itemsize": stride}))
    held = np.empty((points, 3), np.float32)
    found = decode(data).points
    assert [(found[number].x, found[number].z) for number in (0, points - 1)] == [
        (columns["x"][number], columns["z"][number]) for number in (0, -1)
    ]

    def by_numpy():
        for number, name in enumerate("xyz"):
            held[:, number] = columns[name]

    outcome = compare(
        CHAPTER,
        what,
        [
            Contender(OURS, "ours", "an RST cloud, used again", effort.call(decode, data)),
            Contender("numpy, unchecked", "peer", "an array, used again", effort.call(by_numpy)),
        ],
    )
    record(what, outcome.ratio(OURS, "numpy, unchecked"), None, "x numpy, unchecked", f"{outcome.took(OURS).median / 1000:.0f} µs")


REDUCED_FILES = {
    "lab/msg/Wire.msg": "float64[] numbers\nuint8[] data\nstring[] names\n",
    "held.proto": 'syntax = "proto3"; message Held { double x = 1; int64 n = 2; }',
}
REDUCED_HEAD = 'import "lab/msg/Wire.msg"\nimport "held.proto"\ndata-holder: Held\nwire-schema: lab/Wire\nunpack-rules:\n'
MANY = 100_000


def norm(numbers):
    total = 0.0
    for number in numbers:
        total += number * number
    return math.sqrt(total)


def least(numbers):
    found = math.inf
    for number in numbers:
        if number < found or number != number:  # noqa: PLR0124 - NaN stays
            found = number
    return found


def positive(numbers):
    count = 0
    for number in numbers:
        count += number > 0
    return count


REDUCTIONS = {
    f"mapping, the norm of {MANY:,} numbers": (".x = sqrt(sum(.numbers[] * .numbers[]))", norm, AT_MOST),
    f"mapping, the least of {MANY:,} numbers": (".x = min(.numbers[])", least, AT_MOST),
    f"mapping, how many of {MANY:,} numbers are positive": (".n = count(.numbers[] > 0)", positive, AT_MOST),
}


@pytest.mark.parametrize("what", REDUCTIONS)
def test_reductions(what, effort, compare, record):
    """Against the same loop by hand: what is summed from the first to the last cannot be summed in vectors."""
    rule, by_hand_, at_most = REDUCTIONS[what]
    rest = "  .n = 0\n" if rule.startswith(".x") else "  .x = 0\n"
    files = {**REDUCED_FILES, "m.mapping": f"{REDUCED_HEAD}  {rule}\n{rest}  ignore .data\n  ignore .names\n"}
    decode, compiled = rj.Decoder("m.mapping", schema=files, encoding="ros1"), numba.njit(by_hand_)
    numbers = np.random.default_rng(1).normal(size=MANY)
    data = struct.pack("<I", MANY) + numbers.tobytes() + bytes(8)
    found = decode(data)
    assert found.x + found.n == compiled(numbers)
    outcome = compare(
        CHAPTER,
        what,
        [
            Contender(OURS, "ours", "an object of another type, used again", effort.call(decode, data)),
            Contender(BY_HAND, "limit", "a number", effort.call(compiled, numbers)),
        ],
    )
    record(what, outcome.ratio(OURS, BY_HAND), at_most, "x numba by hand", f"{outcome.took(OURS).median / 1000:.0f} µs")


def table_of(polynomial):
    table = np.zeros(256, np.uint32)
    for byte in range(256):
        register = byte
        for _ in range(8):
            register = register >> 1 ^ (polynomial if register & 1 else 0)
        table[byte] = register
    return table


def checksum(data, table):
    register = np.uint32(0xFFFFFFFF)
    for byte in data:
        register = table[(register ^ byte) & np.uint32(255)] ^ (register >> np.uint32(8))
    return register ^ np.uint32(0xFFFFFFFF)


def total_of(data):
    total = 0
    for byte in data:
        total += byte
    return total


def test_sum_of_bytes(effort, compare, record):
    """Integers may be added in any order, so that both do it in vectors."""
    what, rules = f"mapping, the sum of {MANY:,} bytes", "  .n = sum(.data[])\n  .x = 0\n  ignore .numbers\n  ignore .names\n"
    decode = rj.Decoder("m.mapping", schema={**REDUCED_FILES, "m.mapping": REDUCED_HEAD + rules}, encoding="ros1")
    data, compiled = np.random.default_rng(1).integers(0, 256, MANY, np.uint8), numba.njit(total_of)
    message_ = struct.pack("<II", 0, MANY) + data.tobytes() + bytes(4)
    assert decode(message_).n == compiled(data)
    outcome = compare(
        CHAPTER,
        what,
        [
            Contender(OURS, "ours", "an object of another type, used again", effort.call(decode, message_)),
            Contender(BY_HAND, "limit", "a number", effort.call(compiled, data)),
        ],
    )
    record(what, outcome.ratio(OURS, BY_HAND), AT_MOST, "x numba by hand", f"{outcome.took(OURS).median / 1000:.0f} µs")


def test_checksum(effort, compare, record):
    """Against a table of 256 entries by hand."""
    what, rules = f"mapping, the CRC-32 of {MANY:,} bytes", '  .n = crc(.data, "CRC-32")\n  .x = 0\n  ignore .numbers\n  ignore .names\n'
    decode = rj.Decoder("m.mapping", schema={**REDUCED_FILES, "m.mapping": REDUCED_HEAD + rules}, encoding="ros1")
    data, table, compiled = np.random.default_rng(1).integers(0, 256, MANY, np.uint8), table_of(0xEDB88320), numba.njit(checksum)
    message_ = struct.pack("<II", 0, MANY) + data.tobytes() + bytes(4)
    assert decode(message_).n == compiled(data, table)
    outcome = compare(
        CHAPTER,
        what,
        [
            Contender(OURS, "ours", "an object of another type, used again", effort.call(decode, message_)),
            Contender(BY_HAND, "limit", "a number", effort.call(compiled, data, table)),
        ],
    )
    record(what, outcome.ratio(OURS, BY_HAND), AT_MOST, "x a table by hand", f"{outcome.took(OURS).median / 1000:.0f} µs")


def test_one_field(effort, compare, record):
    """The width of an image whose pixels no rule reads."""
    files = {
        "held/msg/Held.msg": "uint32 width\n",
        "width.mapping": """import "rst/vision/Image.proto"
import "held/msg/Held.msg"
data-holder: held/Held
wire-schema: rst.vision.Image
unpack-rules:
  .width = .width
""",
    }
    decode, message = rj.Decoder("width.mapping", schema=files), RST_IMAGE.message
    assert decode(message).width == 320
    outcome = compare(
        CHAPTER,
        "the width of an image of 230 KB",
        [
            Contender(OURS, "ours", "a holder, used again", effort.call(decode, message)),
            Contender("len()", "limit", "a number", effort.call(len, message)),
        ],
    )
    what = "mapping, one field of an RST Image 320x240"
    record(what, outcome.ratio(OURS, "len()"), 2.5, "x len()", f"{outcome.took(OURS).median:.0f} ns")
