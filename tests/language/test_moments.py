"""Points in time and other values whose parts are fields: taken apart and put together in both directions, against exact integers."""

from __future__ import annotations

import math
import random
from fractions import Fraction

import pytest

import rosetta_jit as rj
from tests.language.texts import HEAD, SCHEMAS, decoder

BACKENDS = ["llvm", "python", "interpreter"]
SECOND = 10**9
LEAST, MOST = -(2**63), 2**63 - 1
HEADER = 'import "w.bottle-schema"\nimport "h.proto"\ndata-holder: H\nwire-schema: w\nrules:\n'


class Pair:
    """Both directions of some relations; fields by name, those of the wire and of the holder with the types that a test gives."""

    def __init__(self, rules, wire, held, backend):
        fields = " ".join(f"required {type_} {name} = {number};" for number, (name, type_) in enumerate(held.items(), 1))
        schemas = {
            "w.bottle-schema": '"w" (' + " ".join(f'("{name}" :{type_})' for name, type_ in wire.items()) + ")",
            "h.proto": f'syntax = "proto2"; message H {{ {fields} }}',
        }
        files = {**schemas, "m.mapping": HEADER + "".join(f"  {rule}\n" for rule in rules)}
        self.read = rj.Decoder("m.mapping", schema=files, encoding="yarp4", backend=backend)
        self.write = rj.Encoder("m.mapping", schema=files, encoding="yarp4", backend=backend)
        self.make = rj.Encoder.of("w", schema=schemas, imports=["w.bottle-schema"], encoding="yarp4", backend="interpreter")
        self.look = rj.Decoder.of("w", schema=schemas, imports=["w.bottle-schema"], encoding="yarp4", backend="interpreter")

    def unpack(self, **fields):
        return self.read(self.make(self.make.holder_type.from_dict(fields))).to_dict()

    def pack(self, **fields):
        return self.look(self.write(self.write.holder_type.from_dict(fields))).to_dict()

    def both(self, wire, held):
        assert self.unpack(**wire) == held
        assert self.pack(**held) == wire


def refused(kind, use, **fields):
    with pytest.raises(rj.MessageError) as error:
        use(**fields)
    assert error.value.kind == kind
    return str(error.value)


def times():
    rng = random.Random(5)
    return [LEAST, MOST, 0, -1, 1, SECOND, -SECOND, SECOND - 1, *(rng.randint(LEAST, MOST) for _ in range(30))]


@pytest.mark.parametrize("backend", BACKENDS)
def test_nanoseconds_of_two_fields(backend):
    pair = Pair([".n <-> nanoseconds(.s, .b)"], {"s": "int64", "b": "int"}, {"n": "int64"}, backend)
    for time in times():
        pair.both(dict(zip("sb", divmod(time, SECOND), strict=True)), {"n": time})
    for second, behind in [(0, SECOND), (0, -1)]:
        refused("range", pair.unpack, s=second, b=behind)
    for beyond in (LEAST - 1, MOST + 1):
        second, behind = divmod(beyond, SECOND)
        refused("range", pair.unpack, s=second, b=behind)


@pytest.mark.parametrize("backend", BACKENDS)
def test_seconds_that_do_not_fit_their_field(backend):
    pair = Pair([".n <-> nanoseconds(.s, .b)"], {"s": "int", "b": "int"}, {"n": "int64"}, backend)
    assert pair.pack(n=(2**31) * SECOND - 1) == {"s": 2**31 - 1, "b": SECOND - 1}
    refused("range", pair.pack, n=(2**31) * SECOND)


@pytest.mark.parametrize("backend", BACKENDS)
def test_microseconds_as_digits(backend):
    pair = Pair([".n <-> .s * 1000000 + .u"], {"s": "int64", "u": "int"}, {"n": "int64"}, backend)
    million = 10**6
    for time in (0, -1, million, -million, 1795255722123456, MOST, -(2**63 // million) * million):
        pair.both(dict(zip("su", divmod(time, million), strict=True)), {"n": time})
    for micros in (-1, million):
        assert "`.u` is not from 0 to 999999" in refused("rejected", pair.unpack, s=5, u=micros)
    refused("range", pair.unpack, s=2**62, u=0)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("value", [".h * 3600 + .m * 60 + .s", "(.h * 60 + .m) * 60 + .s", ".s + 60 * (.m + .h * 60)"])
def test_several_digits(backend, value):
    pair = Pair([f".n <-> int32({value} + 5)"], dict.fromkeys("hms", "int"), {"n": "int32"}, backend)
    for total in (0, 59, 60, 3599, 3600, 86399, -1, -3601):
        hours, rest = divmod(total, 3600)
        pair.both({"h": hours, "m": rest // 60, "s": rest % 60}, {"n": total + 5})
    assert "`.s` is not from 0 to 59" in refused("rejected", pair.unpack, h=0, m=0, s=60)
    refused("rejected", pair.unpack, h=0, m=60, s=0)
    refused("rejected", pair.unpack, h=0, m=-1, s=5)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("value", [".h * 60 + .m - 5", "(.h * 60 - 10) + (.m + 5)"])
def test_digits_less_a_constant(value, backend):
    pair = Pair([f".n <-> {value}"], dict.fromkeys("hm", "int"), {"n": "int64"}, backend)
    for total in (0, 59, 60, -1, -61, 86399):
        pair.both(dict(zip("hm", divmod(total, 60), strict=True)), {"n": total - 5})
    refused("rejected", pair.unpack, h=0, m=60)


@pytest.mark.parametrize("backend", BACKENDS)
def test_one_field_out_of_two(backend):
    rules = [".s <-> floor_divide(.n, 1000000)", ".b <-> int32(modulo(.n, 1000000) * 1000)"]
    pair = Pair(rules, {"n": "int64"}, {"s": "int64", "b": "int32"}, backend)
    for time in (0, -1, 1795255722123456, MOST, -(2**63 // 10**6) * 10**6):
        second, micros = divmod(time, 10**6)
        pair.both({"n": time}, {"s": second, "b": micros * 1000})
    assert "is not from 0 to 999999" in refused("rejected", pair.pack, s=0, b=SECOND)
    refused("rejected", pair.pack, s=0, b=-1000)
    refused("range", pair.pack, s=0, b=1)  # no whole microsecond
    refused("range", pair.pack, s=2**62, b=0)


@pytest.mark.parametrize("backend", BACKENDS)
def test_what_is_rounded_down_packs_as_its_least(backend):
    pair = Pair([".n <-> .s * 1000000 + floor_divide(.b, 1000)"], {"s": "int64", "b": "int"}, {"n": "int64"}, backend)
    assert pair.unpack(s=-2, b=1999) == {"n": -1999999}
    assert pair.pack(n=-1999999) == {"s": -2, "b": 1000}


@pytest.mark.parametrize("backend", BACKENDS)
def test_text_of_two_fields(backend):
    pair = Pair([".t <-> iso8601(.s, .b)"], {"s": "int64", "b": "int"}, {"t": "string"}, backend)
    for second, behind, text in [
        (0, 0, "1970-01-01T00:00:00Z"),
        (-1, 999_999_999, "1969-12-31T23:59:59.999999999Z"),
        (-62167219200, 0, "0000-01-01T00:00:00Z"),
        (253402300799, 5000, "9999-12-31T23:59:59.000005Z"),
    ]:
        pair.both({"s": second, "b": behind}, {"t": text})
    assert pair.pack(t="2026-11-21T11:08:42.5+01:00") == {"s": 1795255722, "b": 500_000_000}
    refused("text", pair.pack, t="today")
    refused("range", pair.unpack, s=0, b=SECOND)
    refused("range", pair.unpack, s=253402300800, b=0)


@pytest.mark.parametrize("backend", BACKENDS)
def test_two_fields_of_a_text(backend):
    pair = Pair([".s <-> seconds(.t)", ".b <-> int32(fraction(.t))"], {"t": "string"}, {"s": "int64", "b": "int32"}, backend)
    pair.both({"t": "2026-11-21T10:08:42.500Z"}, {"s": 1795255722, "b": 500_000_000})
    assert pair.unpack(t="1969-12-31T23:59:59.1-00:01") == {"s": 59, "b": 100_000_000}
    refused("range", pair.pack, s=0, b=-1)
    refused("range", pair.pack, s=2**40, b=0)


def parts_of(value):
    """The seconds and nanoseconds of a float, by exact fractions."""
    return divmod(round(Fraction(value) * SECOND), SECOND) if abs(value) < 2**53 else (int(value), 0)


FLOATS = [0.0, -0.0, 0.5, -0.25, 1.0 - 2**-53, -(2.0**-80), 1795255722.123456, -1795255722.75, 2.0**52 + 1, float(2**62), -float(2**63)]


@pytest.mark.parametrize("backend", BACKENDS)
def test_floats_are_taken_apart(backend):
    rng = random.Random(7)
    pair = Pair([".s <-> seconds(.x)", ".b <-> int32(fraction(.x))"], {"x": "double"}, {"s": "int64", "b": "int32"}, backend)
    for value in [*FLOATS, *(rng.uniform(-4e9, 4e9) for _ in range(30))]:
        second, behind = parts_of(value)
        assert pair.unpack(x=value) == {"s": second, "b": behind}
        back = pair.pack(s=second, b=behind)["x"]
        assert back == float(second) + behind / 1e9
        assert abs(back - value) <= (0 if abs(value) > 1e7 else 6e-10)
    for value in (math.nan, math.inf, -math.inf, float(2**63), -1e19):
        refused("range", pair.unpack, x=value)
    refused("range", pair.pack, s=0, b=SECOND)


@pytest.mark.parametrize("backend", BACKENDS)
def test_floats_of_two_fields_and_of_nanoseconds(backend):
    rules = [".x <-> timestamp(.s, .b)", ".y <-> timestamp(.n)", ".m <-> nanoseconds(.z)"]
    pair = Pair(rules, {"s": "int64", "b": "int", "n": "int64", "z": "double"}, {"x": "double", "y": "double", "m": "int64"}, backend)
    wire = {"s": -3, "b": 250_000_000, "n": -1_500_000_000, "z": 1700000000.125}
    pair.both(wire, {"x": -2.75, "y": -1.5, "m": 1_700_000_000_125_000_000})
    refused("range", pair.unpack, **{**wire, "z": 1e10})
    refused("range", pair.pack, x=0.0, y=1e10, m=0)


@pytest.mark.parametrize("backend", BACKENDS)
def test_times_of_one_direction(backend):
    run = decoder({"n": "nanoseconds(.i, .j)", "x": "timestamp(.i, .j)", "s": "text(seconds(.x)) + text(fraction(.f))"}, backend)
    assert run(i=-1, j=5, x=-0.5, f=0.5) == {**run(), "n": 5 - SECOND, "x": -1.0 + 5e-9, "s": "-1500000000"}


@pytest.mark.parametrize(
    ("rule", "code"),
    [
        (".n <-> .i + .j", "several-fields"),
        (".n <-> .i * 10 + .j * 10", "several-fields"),
        (".n <-> .i * 100 + .j * 10 + .i", "several-fields"),
        (".n <-> .i * -10 + .j", "several-fields"),
        (".n <-> .i * .j", "several-fields"),
        (".x <-> .x * 10 + .f", "operand"),
        (".n <-> .i * 10 + .j if .s == .t else .i", "undetermined-field"),
        (".n <-> modulo(.i, .j)", "several-fields"),
        (".n <-> nanoseconds(.i, .x)", "integer-needed"),
        (".n <-> seconds(.i)", "text-needed"),
    ],
)
def test_what_is_no_part(rule, code):
    text = HEAD + f"rules:\n  {rule}\n"
    with pytest.raises(rj.MappingError) as error:
        rj.Encoder("m.mapping", schema={**SCHEMAS, "m.mapping": text}, encoding="yarp4", backend="interpreter")
    assert code in {problem.code for problem in error.value.diagnostics}


@pytest.mark.parametrize("rule", [".n <-> .i * 10 + .j", ".n <-> floor_divide(.i, 10)", ".n <-> nanoseconds(.i, .j)"])
def test_fields_that_rules_to_pack_set_are_left_to_them(rule):
    unpacking = "  .s = .s\n  .b = .b\n  .x = .x\n  .ok = true\n"
    packing = '  .i = 1\n  .j = 2\n  .s = .s\n  .t = ""\n  .b = .b\n  .x = .x\n  .f = 0\n'
    text = f"{HEAD}rules:\n  {rule}\nunpack-rules:\n{unpacking}pack-rules:\n{packing}"
    encode = rj.Encoder("m.mapping", schema={**SCHEMAS, "m.mapping": text}, encoding="yarp4", backend="interpreter")
    read = rj.Decoder.of("w", schema=SCHEMAS, imports=["w.bottle-schema"], encoding="yarp4", backend="interpreter")
    found = read(encode(encode.holder_type.from_dict({"s": "", "b": b"", "n": 12345, "x": 0.0, "ok": True})))
    assert (found.i, found.j) == (1, 2)


@pytest.mark.parametrize("backend", BACKENDS)
def test_in_loops_and_conditions(backend):
    schemas = {
        "p/msg/W.msg": "int32 kind\nint32[] secs\nuint32[] nsecs\n",
        "h.proto": 'syntax = "proto2"; message H { enum Kind { A = 0; B = 1; } required Kind kind = 1; repeated int64 at = 2; }',
        "m.mapping": """import "p/msg/W.msg"
import "h.proto"
data-holder: H
wire-schema: p/msg/W
rules:
  .kind <-> H.Kind(.kind)
  len(.at) <-> len(.secs)
  for i from 0 to len(.secs)
    .at[i] <-> nanoseconds(.secs[i], .nsecs[i])
  end
unpack-rules:
  reject "as many" when len(.secs) != len(.nsecs)
pack-rules:
  len(.nsecs) = len(.at)
""",
    }
    decode = rj.Decoder("m.mapping", schema=schemas, backend=backend)
    encode = rj.Encoder("m.mapping", schema=schemas, backend=backend)
    values = {"kind": "B", "at": [0, -1, 2**30 * SECOND + 7]}
    assert decode(encode(encode.holder_type.from_dict(values))).to_dict() == values


def test_a_moment_that_disagrees_is_told_as_a_person_reads_it():
    rules = [".a <-> seconds(.t)", ".b <-> fraction(.t)", ".c <-> .t"]
    pair = Pair(rules, {"t": "string"}, {"a": "int64", "b": "int64", "c": "string"}, "interpreter")
    assert pair.pack(a=0, b=0, c="1970-01-01T00:00:00Z") == {"t": "1970-01-01T00:00:00Z"}
    with pytest.raises(rj.EncodeError, match=r"`\.c` is not `iso8601\(\.a, \.b\)`, as the mapping says"):
        pair.pack(a=1, b=0, c="1970-01-01T00:00:00Z")
