"""Members of mutable structs that did not come have their defaults; a mutable union is a discriminator and a case, each with its id."""

from __future__ import annotations

import pytest

import rosetta_jit as rj

BACKENDS = ["interpreter", "python", "llvm"]
PLAIN, LIST = {"cdr": "00010000", "cdr2": "00070000"}, {"cdr": "00030000", "cdr2": "000b0000"}
EMPTY = {"cdr": LIST["cdr"] + "027f0000", "cdr2": LIST["cdr2"] + "00000000"}

IDL = """
enum Color { RED, GREEN };
enum Level { LOW, @default_literal HIGH };
@final struct Inner { double x; string text; Color shade; @default(4) long four; };
@mutable struct Deep { @id(3) long n; @id(4) @default(7) short seven; };
@appendable struct App { long n; sequence<string> words; };
union First switch (long) { case 0: double d; case 1: string s; };
union Second switch (long) { case 5: double d; default: string s; };
union Third switch (long) { case 5: double d; };
typedef long Grid[2][3];
@mutable struct Main {
  @id(1) long a; @id(2) @default(5.5) double b; @id(3) string c; @id(4) @default("hé") string d; @id(5) boolean e;
  @id(6) @default(TRUE) boolean f; @id(7) Color g; @id(8) Level h; @id(9) @default(GREEN) Color i; @id(10) sequence<double> j;
  @id(11) long k[3]; @id(12) octet l[4]; @id(13) Inner m; @id(14) Deep n; @id(15) First o; @id(16) Second p; @id(17) Third q;
  @id(18) @optional long r; @id(19) Inner s[2]; @id(20) @default(L"wide") wstring t; @id(21) Grid u; @id(22) sequence<octet> v;
  @id(23) @default('x') char w; @id(24) map<long, string> x; @id(25) string y[2]; @id(26) App z; @id(27) @default(-3) int8 last;
};
@mutable struct Keyed { @id(1) @key long key; @id(2) long value; };
@mutable struct Must { @id(1) @must_understand long first; @id(2) long value; };
@mutable struct Large { @id(1) octet blob[65537]; };
@mutable struct Small { @id(1) octet blob[65536]; };
@mutable struct Each { @id(1) octet few[64]; };
@mutable struct Many { @id(1) octet more[65]; };
@final struct Lists { sequence<Each> all; };
@final struct Longer { sequence<Many> all; };
@mutable union Choice switch (long) { case 1: double d; case 2: string s; @id(9) case 3: case 4: sequence<short> q; default: octet o; };
@mutable union Few switch (Color) { case RED: long r; };
@final struct Holder { octet b; Choice one; sequence<Choice> many; octet e; };
@mutable struct Around { @id(1) Choice one; @id(2) long last; };
"""
INNER = {"x": 0.0, "text": "", "shade": "RED", "four": 4}
NUMBERS = {"a": 0, "b": 5.5, "e": False, "f": True, "g": "RED", "h": "HIGH", "i": "GREEN", "w": ord("x"), "last": -3}
TEXTS = {"c": "", "d": "hé", "t": "wide", "l": bytes(4), "v": b"", "y": ["", ""]}
ARRAYS = {"j": [], "k": [0, 0, 0], "s": [INNER, INNER], "u": [[0, 0, 0], [0, 0, 0]], "x": {}}
STRUCTS = {"m": INNER, "n": {"n": 0, "seven": 7}, "z": {"n": 0, "words": []}}
UNIONS = {"o": {"_d": 0, "d": 0.0}, "p": {"_d": 0, "s": ""}, "q": {"_d": 0}}
DEFAULTS = NUMBERS | TEXTS | ARRAYS | STRUCTS | UNIONS


def program(kind, name, encoding, **options):
    return kind.of(name, encoding=encoding, framework="ros2", schema={"probe.idl": IDL}, **{"backend": "interpreter", **options})


@pytest.mark.parametrize("encoding", EMPTY)
@pytest.mark.parametrize("backend", BACKENDS)
def test_defaults(encoding, backend):
    decode, encode = program(rj.Decoder, "Main", encoding, backend=backend), program(rj.Encoder, "Main", encoding, backend=backend)
    holder = decode(bytes.fromhex(EMPTY[encoding]))
    assert holder.to_dict() == DEFAULTS
    assert decode(encode(holder)).to_dict() == DEFAULTS


@pytest.mark.parametrize("encoding", EMPTY)
def test_what_was_there_before_is_gone(encoding):
    decode, encode = program(rj.Decoder, "Main", encoding), program(rj.Encoder, "Main", encoding)
    full = {**DEFAULTS, "a": 1, "c": "text", "k": [1, 2, 3], "o": {"_d": 1, "s": "case"}, "r": 5, "e": True, "v": b"abc"}
    assert decode(encode(encode.holder_type.from_dict(full))).to_dict() == full
    assert decode(bytes.fromhex(EMPTY[encoding])).to_dict() == DEFAULTS


@pytest.mark.parametrize("encoding", EMPTY)
@pytest.mark.parametrize(("name", "member"), [("Keyed", ".key"), ("Must", ".first"), ("Large", ".blob")])
def test_what_must_come(name, member, encoding):
    with pytest.raises(rj.DecodeError) as error:
        program(rj.Decoder, name, encoding)(bytes.fromhex(EMPTY[encoding]))
    assert (error.value.kind, error.value.path) == ("missing", member)


@pytest.mark.parametrize("encoding", EMPTY)
def test_little_takes_little(encoding):
    """Each element of an array costs the message some bytes, and must not cost thousands of times as much memory."""
    assert program(rj.Decoder, "Small", encoding)(bytes.fromhex(EMPTY[encoding])).blob == bytes(65536)
    data = bytes.fromhex(PLAIN[encoding] + {"cdr": "01000000027f0000", "cdr2": "080000000100000000000000"}[encoding])
    assert program(rj.Decoder, "Lists", encoding)(data).all[0].few == bytes(64)
    with pytest.raises(rj.DecodeError, match="missing"):
        program(rj.Decoder, "Longer", encoding)(data)


# --- compared with Cyclone DDS ------------------------------------------------------------------------------------------------

PEER = """
enum Color { RED, @default_literal GREEN };
@final struct Inner { double x; string s; Color c; };
@mutable struct Deep { long n; sequence<short> many; };
@appendable struct App { long n; string s; };
@mutable struct Main {
  long a; double b; string c; boolean d; Color e; sequence<double> f; long g[3]; Inner h; Deep i; Inner j[2]; App l;
  octet m[4]; string n[2]; short last;
};
"""


def peer_types():
    idl = pytest.importorskip("cyclonedds.idl")
    from cyclonedds.idl import annotations
    from cyclonedds.idl import types as t

    class Color(idl.IdlEnum, typename="Color", default="GREEN"):
        RED = 0
        GREEN = 1

    def made(name, extensibility, **fields):
        return getattr(annotations, extensibility)(idl.make_idl_struct(name, name, fields))

    inner = made("Inner", "final", x=t.float64, s=str, c=Color)
    deep = made("Deep", "mutable", n=t.int32, many=t.sequence[t.int16])
    app = made("App", "appendable", n=t.int32, s=str)
    fields = {
        "a": t.int32,
        "b": t.float64,
        "c": str,
        "d": bool,
        "e": Color,
        "f": t.sequence[t.float64],
        "g": t.array[t.int32, 3],
        "h": inner,
    }
    more = {"i": deep, "j": t.array[inner, 2], "l": app, "m": t.array[t.uint8, 4], "n": t.array[str, 2], "last": t.int16}
    return made("Main", "mutable", **fields, **more)


def plain(value):
    if isinstance(value, bytearray):
        return bytes(value)
    if isinstance(value, list):
        return [plain(each) for each in value]
    return {name: plain(each) for name, each in vars(value).items()} if hasattr(value, "__idl__") else value


@pytest.mark.parametrize("encoding", EMPTY)
def test_defaults_of_cyclone(encoding):
    data = bytes.fromhex(EMPTY[encoding])
    theirs = plain(peer_types().deserialize(data))
    decode = rj.Decoder.of("Main", encoding=encoding, framework="ros2", schema={"peer.idl": PEER})
    ours = decode(data).to_dict()
    named = {"e": "GREEN", "h": {**theirs["h"], "c": "GREEN"}, "j": [{**each, "c": "GREEN"} for each in theirs["j"]]}
    assert (theirs["e"], theirs["h"]["c"]) == (1, 1)
    assert ours == {**theirs, **named}


# --- mutable unions -------------------------------------------------------------------------------------------------------------


def long(number, size, *, must=False):
    return f"017f0800 {number:02x}0000{'40' if must else '00'} {size:02x}000000 "


CASES = [
    ({"_d": 1, "d": 2.0}, 1, "0000000000000040"),
    ({"_d": 2, "s": "hey"}, 2, "0400000068657900"),
    ({"_d": 4, "q": [5, 6]}, 9, "0200000005000600"),
    ({"_d": -9, "o": 4}, 10, "04"),
]


def union(encoding, value, number, data):
    """As Cyclone DDS 11 in C writes it: ids and lengths have words of their own, and the discriminator must be understood."""
    told = value["_d"].to_bytes(4, "little", signed=True).hex()
    size = len(bytes.fromhex(data))
    if encoding == "cdr":
        return f"{long(0, 4, must=True)} {told} {long(number, size)} {data} {'00' * (-size % 4)} 027f0000"
    body = bytes.fromhex(f"000000c0 04000000 {told} {number:02x}000040 {size:02x}000000 {data}")
    return len(body).to_bytes(4, "little").hex() + body.hex()


def padded(encoding, data):
    found = bytes.fromhex(LIST[encoding] + data)
    size = -len(found) % 4
    return found if encoding == "cdr" else found[:3] + bytes([size]) + found[4:] + bytes(size)


@pytest.mark.parametrize("encoding", EMPTY)
@pytest.mark.parametrize("backend", BACKENDS)
def test_mutable_unions(encoding, backend):
    decode, encode = program(rj.Decoder, "Choice", encoding, backend=backend), program(rj.Encoder, "Choice", encoding, backend=backend)
    for value, number, data in CASES:
        message = padded(encoding, union(encoding, value, number, data))
        assert decode(message).to_dict() == value
        assert bytes(encode(encode.holder_type.from_dict(value))) == message


@pytest.mark.parametrize("encoding", EMPTY)
def test_short_heads(encoding):
    """Other ways to tell ids and lengths, as Fast CDR writes them."""
    data = {"cdr": "00000400 01000000 01000800 0000000000000040 027f0000", "cdr2": "14000000 00000020 01000000 01000030 0000000000000040"}
    assert program(rj.Decoder, "Choice", encoding)(bytes.fromhex(LIST[encoding] + data[encoding])).to_dict() == {"_d": 1, "d": 2.0}


@pytest.mark.parametrize("encoding", EMPTY)
def test_no_case(encoding):
    decode, encode = program(rj.Decoder, "Few", encoding), program(rj.Encoder, "Few", encoding)
    for value in ({"_d": "GREEN"}, {"_d": "RED", "r": 3}):
        assert decode(encode(encode.holder_type.from_dict(value))).to_dict() == value


@pytest.mark.parametrize("order", ["little", "big"])
@pytest.mark.parametrize("encoding", EMPTY)
@pytest.mark.parametrize("backend", ["interpreter", "llvm"])
def test_mutable_unions_within(encoding, order, backend):
    choices = [value for value, _, _ in CASES]
    for name, value in (("Holder", {"b": 1, "one": choices[0], "many": choices, "e": 2}), ("Around", {"one": choices[1], "last": 5})):
        decode = program(rj.Decoder, name, encoding, backend=backend)
        encode = program(rj.Encoder, name, encoding, backend=backend, byte_order=order)
        message = bytes(encode(encode.holder_type.from_dict(value)))
        assert decode(message).to_dict() == value
        for size in range(len(message)):
            with pytest.raises(rj.DecodeError):
                decode(message[:size])


WRONG = [
    ("another member first", "cdr", "017f0800 01000000 04000000 01000000" + "027f0000", "tag"),
    ("another case", "cdr", long(0, 4) + "01000000" + long(2, 8) + "0000000000000040 027f0000", "tag"),
    ("no discriminator", "cdr", long(0, 0) + "027f0000", "length"),
    ("too long", "cdr", long(0, 4) + "01000000" + long(1, 16) + "00" * 16 + "027f0000", "length"),
    ("no end", "cdr", long(0, 4) + "01000000" + long(1, 8) + "00" * 8 + "05000000", "constant"),
    ("another member first", "cdr2", "08000000 01000020 01000000", "tag"),
    ("another case", "cdr2", "14000000 00000020 01000000 02000030 0000000000000040", "tag"),
    ("too long", "cdr2", "10000000 00000030 0100000000000000", "length"),
    ("longer than the message", "cdr2", "14000000 00000020 01000000 010000c0 ffffffff", "tag"),
    ("behind it", "cdr2", "18000000 00000020 01000000 01000030 0000000000000040 00000000", "length"),
]


@pytest.mark.parametrize(("encoding", "data", "kind"), [each[1:] for each in WRONG], ids=[f"{each[0]} {each[1]}" for each in WRONG])
def test_refused(encoding, data, kind):
    with pytest.raises(rj.DecodeError) as error:
        program(rj.Decoder, "Choice", encoding)(bytes.fromhex(LIST[encoding] + data))
    assert error.value.kind in (kind, "truncated")


def test_corba_has_no_mutable_unions():
    with pytest.raises(rj.SchemaError, match="mutable"):
        rj.Decoder.of("Few", encoding="cdr-giop", schema={"probe.idl": "@mutable union Few switch (long) { case 1: long r; };"})
