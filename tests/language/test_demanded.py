"""Fields that a rejection for both directions compares with a constant: packing writes the one value that unpacking lets through."""

from __future__ import annotations

import pytest

import rosetta_jit as rj
from tests.language.pairs import BACKENDS, files, pair

HOLDER = "required double a = 1;"


@pytest.mark.parametrize("backend", BACKENDS)
def test_constants_are_packed(backend):
    wire = '("id" :int) ("big" :bool) ("on" :bool) ("unit" :string) ("a" :double)'
    rules = 'rules:\n.a <-> .a\nreject "id" when .id != 0x201 or .big\nreject "off" when not .on\nreject "{.unit}" when "mm" != .unit\n'
    both = pair(wire, HOLDER, rules, backend)
    assert str(both.decode.mapping.laws) == "messages: exact inverse\nholders: exact inverse"
    good = {"id": 0x201, "big": False, "on": True, "unit": "mm", "a": 1.5}
    assert both.unpack(**good) == {"a": 1.5}
    assert both.pack(a=1.5) == good
    for wrong in ({"id": 1}, {"big": True}, {"on": False}, {"unit": "m"}):
        with pytest.raises(rj.DecodeError) as error:
            both.unpack(**{**good, **wrong})
        assert error.value.kind == "rejected"


@pytest.mark.parametrize("backend", BACKENDS)
def test_what_the_block_to_pack_says_counts(backend):
    rules = 'rules:\n.a <-> .a\nreject "no" when .id != 3\npack-rules:\n.id = 3 if .a > 0.0 else 4\n'
    assert pair('("id" :int) ("a" :double)', HOLDER, rules, backend).pack(a=-1.0) == {"id": 4, "a": -1.0}


@pytest.mark.parametrize(
    "rules",
    [
        'reject "no" when .id > 3',
        'reject "no" when .id != 3 and .a > 0.0',
        'reject "no" when .id == 3',
        'reject "no" when .id % 4 != 3',
        'reject "no" when .x != 0.0',
        'same names except .a reject "no" when .id != 3',
    ],
)
def test_what_says_no_single_value_is_refused(rules):
    holder = HOLDER + (" required int32 id = 2;" if "same" in rules else "")
    with pytest.raises(rj.MappingError) as error:
        rj.Decoder(
            "m.mapping",
            schema=files('("id" :int) ("x" :double) ("a" :double)', holder, f"rules:\n  .a <-> .a\n  {rules}\n"),
            encoding="yarp3",
        )
    assert "unknown-condition" in [problem.code for problem in error.value.diagnostics]


def test_the_sign_of_a_zero_that_is_not_packed():
    """A condition does not tell -0 from 0, so that a message with -0 may come back with 0."""
    rules = 'rules:\n.a <-> .a\nreject "no" when .zero != 0.0\npack-rules:\n.zero = 0.0\n'
    both = pair('("zero" :double) ("a" :double)', HOLDER, rules)
    assert [loss.place for loss in both.decode.mapping.laws.messages.losses] == [".zero"]
    both = pair('("zero" :double) ("a" :double)', HOLDER, rules.replace("0.0", "1.5"))
    assert both.decode.mapping.laws.messages.kind == "exact"


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_checksum_is_checked_and_written(backend):
    made = pair(
        '("data" :blob) ("check" :int) ("size" :int)',
        "required bytes data = 1;",
        """rules:
  .data <-> .data
  reject "damaged" when .check != crc(.data, "CRC-16/MODBUS")
  reject "another size" when len(.data) + 2 != .size
""",
        backend,
    )
    message = {"data": b"123456789", "check": 0x4B37, "size": 11}
    assert made.unpack(**message) == {"data": b"123456789"}
    assert made.pack(data=b"123456789") == message
    assert [loss.place for loss in made.decode.mapping.laws.messages.losses] == [".size"]  # for a length need not fit an int32
    for wrong in ({"check": 0}, {"size": 9}):
        with pytest.raises(rj.DecodeError, match=r"damaged|another size"):
            made.unpack(**{**message, **wrong})


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_length_that_a_rejection_asks_for(backend):
    made = pair(
        '("values" (:list :double))',
        "required double a = 1; required double b = 2;",
        'rules:\n  .a <-> .values[0]\n  .b <-> .values[1] * 2.0\n  reject "two values" when len(.values) != 2\n',
        backend,
    )
    assert made.unpack(values=[1.0, 2.0]) == {"a": 1.0, "b": 4.0}
    assert made.pack(a=1.0, b=4.0) == {"values": [1.0, 2.0]}
    with pytest.raises(rj.DecodeError, match="two values"):
        made.unpack(values=[1.0, 2.0, 3.0])


def test_what_is_related_or_does_not_fit_is_not_taken_from_a_rejection():
    wire, holder = '("n" :int) ("size" :uint8)', "required int32 n = 1;"
    made = pair(wire, holder, 'rules:\n  .n <-> .n\n  reject "no" when .size != .n + 1\n')
    assert made.pack(n=254) == {"n": 254, "size": 255}
    assert made.refused(n=255).path == ".size"
    with pytest.raises(rj.MappingError, match=r"nothing says what `\.other` is"):
        pair('("n" :int) ("size" :int) ("other" :int)', holder, 'rules:\n  .n <-> .n\n  reject "no" when .size != .other + 1\n')


FRAMES = {
    "lab/msg/Frame.msg": "uint8[] data\nuint8 id\nuint8 number\nuint8 check\n",
    "lab/msg/Log.msg": "Frame[] frames\n",
    "h.proto": 'syntax = "proto2"; message Part { required bytes data = 1; } message Held { repeated Part frames = 1; }',
}
FRAMES_HEAD = 'import "lab/msg/Log.msg"\nimport "h.proto"\ndata-holder: Held\nwire-schema: lab/msg/Log\nrules:\n'
BY_ELEMENT = """  .frames[].data <-> .frames[].data
  reject "id" when .frames[].id != 7
  reject "number" when .frames[].number != index()
  reject "damaged" when .frames[].check != crc(.frames[].data, "CRC-8")
"""
IN_LOOP = """  len(.frames) <-> len(.frames)
  for i from 0 to len(.frames)
    .frames[i].data <-> .frames[i].data
    reject "id" when .frames[i].id != 7
    reject "number" when .frames[i].number != i
    reject "damaged" when .frames[i].check != sum(.frames[i].data[]) & 255
  end
"""


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(("rules", "checks"), [(BY_ELEMENT, (27, 217, 0)), (IN_LOOP, (3, 1, 0))], ids=["elements", "loop"])
def test_a_rejection_of_each_element_says_what_is_packed(rules, checks, backend):
    files = {**FRAMES, "m.mapping": FRAMES_HEAD + rules}
    decode, encode = (each("m.mapping", schema=files, encoding="ros1", backend=backend) for each in (rj.Decoder, rj.Encoder))
    of = {"schema": files, "imports": ["lab/msg/Log.msg"], "encoding": "ros1"}
    write, read = rj.Encoder.of("lab/msg/Log", **of), rj.Decoder.of("lab/msg/Log", **of)
    octets = (b"\1\2", b"\xff\2", b"")
    held = {"frames": [{"data": each} for each in octets]}
    frames = [
        {"data": data, "id": 7, "number": number, "check": check} for number, (data, check) in enumerate(zip(octets, checks, strict=True))
    ]
    assert read(encode(encode.holder_type.from_dict(held))).to_dict() == {"frames": frames}
    assert decode(write(write.holder_type.from_dict({"frames": frames}))).to_dict() == held
    assert str(decode.mapping.laws.holders) == "exact inverse"
    for wrong in ({"id": 8}, {"number": 0}, {"check": 5}):
        message = write(write.holder_type.from_dict({"frames": [frames[0], {**frames[1], **wrong}]}))
        with pytest.raises(rj.DecodeError, match=r"id|number|damaged") as error:
            decode(message)
        assert error.value.kind == "rejected"


@pytest.mark.parametrize(
    ("rule", "field"),
    [
        ('reject "no" when .frames[].id != 7', r"\.frames\[\]\.id"),
        ('for i from 1 to len(.other) reject "no" when .other[i].id != 7 end', r"\.other\[i\]\.id"),
    ],
)
def test_elements_of_which_nothing_says_how_many_there_are_are_not_packed(rule, field):
    wire = {**FRAMES, "lab/msg/Log.msg": "Frame[] frames\nFrame[] other\nuint8 n\n"}
    holder = {"h.proto": 'syntax = "proto2"; message Held { required int32 n = 1; }'}
    with pytest.raises(rj.MappingError, match=rf"nothing says what `{field}` is|unknown-bound"):
        rj.Encoder("m.mapping", schema={**wire, **holder, "m.mapping": f"{FRAMES_HEAD}  .n <-> .n\n  {rule}\n"}, encoding="ros1")


def test_a_float_that_nothing_says_has_a_note():
    rules = 'rules:\n  .a <-> .a\n  reject "no" when .x != .a\n'
    with pytest.raises(rj.MappingError, match=r"-0 equals 0[^$]*say in `pack-rules:` what it is"):
        pair('("x" :double) ("a" :double)', HOLDER, rules)
