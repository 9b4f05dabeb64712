"""Wide strings on DDS: UTF-16 whose bytes are counted (DDS-XTypes 1.3, 7.4.1.1.2), and what ROS 2 writes instead."""

from __future__ import annotations

import pytest

import rosetta_jit as rj

SCHEMA = {"probe/msg/Wide.msg": "uint8 before\nwstring text\nwstring<=2 short\nuint8 after\n"}
TEXT = "h€😀"
VALUE = {"before": 1, "text": TEXT, "short": "", "after": 2}
ORDERS = {"little": ("utf-16-le", "utf-32-le", 1), "big": ("utf-16-be", "utf-32-be", 0)}


def specified(order):
    word, _, low = ORDERS[order]
    data = TEXT.encode(word)
    return bytes((0, low, 0, 0, 1, 0, 0, 0)) + len(data).to_bytes(4, order) + data + bytes(4) + b"\x02"


def ros2(order):
    """As rmw_fastrtps and rmw_cyclonedds: a surrogate is a unit, too."""
    data = TEXT.encode("utf-16-le")
    units = [int.from_bytes(data[at : at + 2], "little").to_bytes(4, order) for at in range(0, len(data), 2)]
    return bytes((0, ORDERS[order][2], 0, 0, 1, 0, 0, 0)) + len(units).to_bytes(4, order) + b"".join(units) + bytes(4) + b"\x02"


@pytest.mark.parametrize("backend", ["interpreter", "python", "llvm"])
@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize(("lenient", "expected"), [((), specified), (("wstring",), ros2)])
def test_both_ways(lenient, expected, order, backend):
    given = {"encoding": "cdr", "schema": SCHEMA, "backend": backend, "lenient": lenient}
    decode, encode = rj.Decoder.of("probe/msg/Wide", **given), rj.Encoder.of("probe/msg/Wide", byte_order=order, **given)
    data = expected(order)
    holder = decode(data)
    assert holder.to_dict() == VALUE
    assert bytes(encode(holder)) == data


def test_second_version():
    given = {"encoding": "cdr2", "schema": {"probe/msg/Wide.msg": "wstring text"}, "backend": "interpreter"}
    decode, encode = rj.Decoder.of("probe/msg/Wide", **given), rj.Encoder.of("probe/msg/Wide", **given)
    data = bytes.fromhex("0007000202000000ac200000")
    assert decode(data).text == "€"
    assert bytes(encode(decode(data))) == data


WRONG = [
    ("an odd number of bytes", (), "03000000" + "680000", "length"),
    ("beyond the end", (), "08000000" + "6800", "truncated"),
    ("beyond any end", (), "feffffff" + "6800", "truncated"),
    ("no unit of UTF-16", ("wstring",), "01000000" + "68000100", "constant"),
    ("bytes counted, not units", ("wstring",), "02000000" + "6800", "truncated"),
]


@pytest.mark.parametrize(("lenient", "data", "kind"), [each[1:] for each in WRONG], ids=[each[0] for each in WRONG])
def test_refused(lenient, data, kind):
    schema = {"probe/msg/Wide.msg": "wstring text"}
    decode = rj.Decoder.of("probe/msg/Wide", encoding="cdr", schema=schema, backend="interpreter", lenient=lenient)
    with pytest.raises(rj.DecodeError) as error:
        decode(bytes.fromhex("00010000" + data))
    assert error.value.kind == kind


@pytest.mark.parametrize("lenient", [(), ("wstring",)])
def test_bounds_are_of_units(lenient):
    given = {"encoding": "cdr", "schema": {"probe/msg/Wide.msg": "wstring<=2 text"}, "backend": "interpreter"}
    decode, encode = rj.Decoder.of("probe/msg/Wide", lenient=lenient, **given), rj.Encoder.of("probe/msg/Wide", lenient=lenient, **given)
    longer = rj.Encoder.of("probe/msg/Wide", lenient=lenient, **given | {"schema": {"probe/msg/Wide.msg": "wstring text"}})
    assert decode(encode(encode.holder_type(text="ab"))).text == "ab"
    with pytest.raises(rj.DecodeError, match="at most 2"):
        decode(longer(longer.holder_type(text="abc")))
