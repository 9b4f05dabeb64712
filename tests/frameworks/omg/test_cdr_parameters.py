"""Optional members and mutable structs in XCDR1: ids and lengths before members (DDS-XTypes 1.3, 7.4.1.2)."""

from __future__ import annotations

import pytest

import rosetta_jit as rj

IDL = """
@final struct Plain { octet before; @optional double there; octet after; };
@mutable struct Loose { @id(7) octet first; @id(9) @optional double second; };
@final struct Holder { octet before; sequence<Loose> many; octet after; };
"""
PLAIN, LIST = "00010000", "00030000"
END = "027f0000"


def decoder(name, **options):
    return rj.Decoder.of(name, encoding="cdr", framework="ros2", schema={"probe.idl": IDL}, backend="interpreter", **options)


def encoder(name, backend="interpreter", **options):
    return rj.Encoder.of(name, encoding="cdr", framework="ros2", schema={"probe.idl": IDL}, backend=backend, **options)


def long(number, size, *, must=0):
    return "017f0800" + (number | must << 30).to_bytes(4, "little").hex() + size.to_bytes(4, "little").hex()


ONE = "000000000000f03f"

PLAINS = [
    ("long", "05000000" + long(1, 8) + ONE + "06", 1.0),
    ("absent", "05000000" + long(1, 0) + "06", None),
    ("short", "05000000" + "01000800" + ONE + "06", 1.0),
    ("short, absent", "05000000" + "01000000" + "06", None),
    ("short, to be understood", "05000000" + "01400800" + ONE + "06", 1.0),
]


@pytest.mark.parametrize(("data", "value"), [each[1:] for each in PLAINS], ids=[each[0] for each in PLAINS])
def test_optional_members(data, value):
    holder = decoder("Plain")(bytes.fromhex(PLAIN + data))
    assert (holder.before, holder.after) == (5, 6)
    assert holder.to_dict().get("there") == value


@pytest.mark.parametrize("backend", ["interpreter", "python", "llvm"])
def test_long_heads_are_written(backend):
    encode = encoder("Plain", backend)
    for _, data, value in PLAINS[:2]:
        holder = encode.holder_type()
        holder.before, holder.after = 5, 6
        if value is not None:
            holder.there = value
        assert bytes(encode(holder)) == bytes.fromhex(PLAIN + data)


LOOSE = [
    ("long", long(7, 1) + "05000000" + long(9, 8) + ONE, {"first": 5, "second": 1.0}),
    ("lengths with padding", long(7, 4) + "05000000" + long(9, 8) + ONE, {"first": 5, "second": 1.0}),
    ("another order", long(9, 8) + ONE + long(7, 1) + "05000000", {"first": 5, "second": 1.0}),
    ("short", "09000800" + ONE + "07000100" + "05000000", {"first": 5, "second": 1.0}),
    ("one absent", long(7, 1) + "05000000", {"first": 5}),
    ("one with a default absent", long(9, 8) + ONE, {"first": 0, "second": 1.0}),
    ("all absent", "", {"first": 0}),
    ("an unknown one", "08000400" + "ffffffff" + long(7, 1) + "05000000", {"first": 5}),
    ("an implementation's own", "07800400" + "ffffffff" + long(7, 1) + "05000000", {"first": 5}),
    ("one to ignore", "037f0400" + "ffffffff" + long(7, 1) + "05000000", {"first": 5}),
]


@pytest.mark.parametrize(("data", "value"), [each[1:] for each in LOOSE], ids=[each[0] for each in LOOSE])
def test_mutable_structs(data, value):
    assert decoder("Loose")(bytes.fromhex(LIST + data + END)).to_dict() == value


@pytest.mark.parametrize("backend", ["interpreter", "python", "llvm"])
def test_mutable_structs_are_written(backend):
    encode = encoder("Loose", backend)
    for _, data, value in (LOOSE[0], LOOSE[4]):
        assert bytes(encode(encode.holder_type(**value))) == bytes.fromhex(LIST + data + END)


WRONG = [
    ("no end", "Loose", LIST + long(7, 1) + "05000000", "truncated"),
    ("twice", "Loose", LIST + 2 * (long(7, 1) + "05000000") + END, "tag"),
    ("must be understood", "Loose", LIST + "08400400" + "ffffffff" + long(7, 1) + "05000000" + END, "tag"),
    ("must be understood, long", "Loose", LIST + long(8, 4, must=1) + "ffffffff" + long(7, 1) + "05000000" + END, "tag"),
    ("too short", "Loose", LIST + long(7, 0) + "05000000" + END, "length"),
    ("too long", "Loose", LIST + long(7, 8) + "0500000000000000" + END, "length"),
    ("longer than the message", "Loose", LIST + long(7, 0xFFFFFFFF) + "05000000" + END, "truncated"),
    ("an odd escape", "Loose", LIST + "017f0c00" + long(7, 1)[8:] + "05000000" + END, "length"),
    ("another member", "Plain", PLAIN + "05000000" + long(2, 8) + ONE + "06", "tag"),
    ("plain, where there are parameters", "Loose", PLAIN + long(7, 1) + "05000000" + END, "constant"),
]


@pytest.mark.parametrize(("name", "data", "kind"), [each[1:] for each in WRONG], ids=[each[0] for each in WRONG])
def test_refused(name, data, kind):
    with pytest.raises(rj.DecodeError) as error:
        decoder(name)(bytes.fromhex(data))
    assert error.value.kind == kind


def test_every_cut():
    whole = bytes.fromhex(LIST + LOOSE[0][1] + END)
    decode = decoder("Loose")
    for size in range(len(whole)):
        with pytest.raises(rj.DecodeError):
            decode(whole[:size])


@pytest.mark.parametrize("order", ["little", "big"])
def test_many(order):
    decode, encode = decoder("Holder"), encoder("Holder", byte_order=order)
    value = {"before": 1, "many": [{"first": 2}, {"first": 3, "second": 4.0}], "after": 5}
    assert decode(encode(encode.holder_type(**value))).to_dict() == value


def test_corba_has_no_such_bytes():
    for name, word in (("Plain", "optional"), ("Loose", "mutable")):
        with pytest.raises(rj.SchemaError, match=word):
            rj.Decoder.of(name, encoding="cdr-giop", schema={"probe.idl": IDL})
