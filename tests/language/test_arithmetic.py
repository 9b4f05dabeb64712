"""Integers at their limits, conditions that decide what is computed, and choices among integers, in every backend."""

from __future__ import annotations

import pytest

import rosetta_jit as rj
from tests.language.pairs import pair
from tests.language.texts import BACKENDS, decoder

HEAD = 'import "t/In.msg"\nimport "t/Out.msg"\ndata-holder: t/Out\nwire-schema: t/In\nunpack-rules:\n'
LEAST = -(2**63)
DIVISIONS = {
    "{} / {}": lambda x, y: abs(x) // abs(y) * (1 if (x < 0) == (y < 0) else -1),
    "{} % {}": lambda x, y: abs(x) % abs(y) * (-1 if x < 0 else 1),
    "divide({}, {})": lambda x, y: x // y,
    "floor_divide({}, {})": lambda x, y: x // y,
    "modulo({}, {})": lambda x, y: x % y,
}


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("template", DIVISIONS)
def test_divisors_of_minus_one(template, backend):
    for divisor in (".j", "-1"):
        run = decoder({"n": template.format(".i", divisor)}, backend)
        for number in (0, 1, -1, 7, 2**63 - 1, LEAST + 1):
            assert run(i=number, j=-1)["n"] == DIVISIONS[template](number, -1)
        if template != "{} % {}" or divisor == ".j":
            with pytest.raises(rj.DecodeError, match="beyond 64 bits") as error:
                run(i=LEAST, j=-1)
            assert (error.value.kind, error.value.path) == ("range", ".n")


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("template", DIVISIONS)
def test_divisors_of_zero(template, backend):
    run = decoder({"n": template.format(".i", ".j")}, backend)
    with pytest.raises(rj.DecodeError, match="division by 0 ") as error:
        run(i=1, j=0)
    assert (error.value.kind, error.value.path) == ("range", ".n")
    assert run(i=LEAST, j=1)["n"] == DIVISIONS[template](LEAST, 1)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_side_that_decides_spares_the_other(backend):
    """The right side of `and` and `or` is not computed where the left one says the answer."""
    both = decoder({"ok": ".i != 0 and 10 / .i > 1"}, backend)
    either = decoder({"ok": ".i == 0 or 10 / .i > 1"}, backend)
    for i in (0, 1, 5, 9, -3):
        assert both(i=i)["ok"] == (i != 0 and 10 / i >= 2)
        assert either(i=i)["ok"] == (i == 0 or 10 / i >= 2)
    text = decoder({"ok": 'parts(.s, "/") > 1 and (part(.s, "/", 1) == "a" or integer(part(.s, "/", 1)) == .i)'}, backend)
    for s, i, found in [("x", 1, False), ("x/a", 1, True), ("x/12", 12, True), ("x/13", 12, False)]:
        assert text(s=s, i=i)["ok"] is found
    with pytest.raises(rj.DecodeError) as error:
        text(s="x/b", i=1)
    assert (error.value.kind, error.value.path) == ("text", ".ok")


@pytest.mark.parametrize("backend", BACKENDS)
def test_an_index_rests_on_what_is_computed_once(backend):
    files = {
        "t/In.msg": "float64[] xs\nint64 i\nfloat64 x\nbool b\n",
        "t/Out.msg": "float64 y\nfloat64 z\n",
        "m.mapping": """import "t/In.msg"
import "t/Out.msg"
data-holder: t/Out
wire-schema: t/In
unpack-rules:
  .y = .xs[uint8(.x) % (.i if .b else 63)]
  .z = .xs[int64(.b) ^ len(.xs) - 2]
""",
    }
    decode = rj.Decoder("m.mapping", schema=files, encoding="ros1", backend=backend)
    write = rj.Encoder.of("t/In", schema=files, imports=["t/In.msg"], encoding="ros1", backend="interpreter")
    message = write(write.holder_type.from_dict({"xs": [0.5, 1.5, 2.5, 3.5], "i": 3, "x": 8.0, "b": True}))
    assert decode(message).to_dict() == {"y": 2.5, "z": 3.5}


@pytest.mark.parametrize("backend", BACKENDS)
def test_choices_among_integers_are_integers(backend):
    files = {
        "t/In.msg": "int32 i\nuint32 u\nbool b\nint16[4] k\n",
        "t/Out.msg": "int64 n\nfloat64 x\nint64 m\nint16 k\n",
        "m.mapping": """import "t/In.msg"
import "t/Out.msg"
data-holder: t/Out
wire-schema: t/In
unpack-rules:
  .n = .i if .b else .u
  .x = .i if .b else .u
  .m = .i << 1 if .b else 4294967296
  .k = .k[.u & 3 if .b else .i]
""",
    }
    decode = rj.Decoder("m.mapping", schema=files, encoding="ros1", backend=backend)
    write = rj.Encoder.of("t/In", schema=files, imports=["t/In.msg"], encoding="ros1", backend="interpreter")
    for b, found in ((True, (-3, -3.0, -6, 10)), (False, (7, 7.0, 2**32, 8))):
        values = {"i": -3 if b else 1, "u": 7, "b": b, "k": [7, 8, 9, 10]}
        assert tuple(decode(write(write.holder_type.from_dict(values))).to_dict().values()) == found


@pytest.mark.parametrize(("rule", "bits"), [(".i >> 64", "64"), ("1 << -1", "-1"), (".i << 2147483648", "2147483648")])
def test_shifts_that_can_never_be(rule, bits):
    with pytest.raises(rj.MappingError, match=f"a shift by {bits} bits"):
        decoder({"n": rule}, "interpreter")


def test_a_shift_by_what_is_known_late_costs_nothing():
    run = decoder({"n": ".i >> (1 << 40)"}, "interpreter")
    with pytest.raises(rj.DecodeError, match="a shift by less than 0 or more than 63 bits"):
        run(i=1)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(("scalar", "aim"), [("int32", "float32"), ("uint32", "float32"), ("int64", "float64"), ("uint64", "float64")])
def test_the_greatest_integers_are_no_floats(scalar, aim, backend):
    """They round up to what no integer of their type is, and converting back gives them again."""
    files = {
        "t/In.msg": f"{scalar} n\n",
        "t/Out.msg": f"{aim} x\n",
        "m.mapping": HEAD + f"  .x = {aim}(.n, exact)\n",
    }
    decode = rj.Decoder("m.mapping", schema=files, encoding="ros1", backend=backend)
    write = rj.Encoder.of("t/In", schema=files, imports=["t/In.msg"], encoding="ros1", backend="interpreter")
    bits = int(scalar.removeprefix("u").removeprefix("int")) - (scalar[0] != "u")
    assert decode(write(write.holder_type.from_dict({"n": 2 ** (bits - 1)}))).x == 2.0 ** (bits - 1)
    with pytest.raises(rj.DecodeError) as error:
        decode(write(write.holder_type.from_dict({"n": 2**bits - 1})))
    assert (error.value.kind, error.value.path) == ("range", ".x")


@pytest.mark.parametrize("backend", BACKENDS)
def test_two_conditions_that_nothing_is_known_of(backend):
    """That one of them holds does not say that the other does."""
    files = {
        "t/In.msg": "float64 x\nbool b\nbool c\n",
        "t/Out.msg": "float32 x\nint32 n\n",
        "m.mapping": HEAD + "  .x = float32(.x, exact)\n  .n = 1 if .b or .c else 2\n",
    }
    decode = rj.Decoder("m.mapping", schema=files, encoding="ros1", backend=backend)
    write = rj.Encoder.of("t/In", schema=files, imports=["t/In.msg"], encoding="ros1", backend="interpreter")
    for b, c in ((False, False), (True, False), (False, True)):
        assert decode(write(write.holder_type.from_dict({"x": 0.5, "b": b, "c": c}))).to_dict() == {"x": 0.5, "n": 1 if b or c else 2}


def test_a_constant_below_0_is_aligned_no_more_than_a_field():
    for number in ("-1", ".a"):
        numbers = pair('("a" :int64)', "required int64 y = 1;", f"unpack-rules:\n  .y = align({number}, 4)\npack-rules:\n  .a = .y\n")
        with pytest.raises(rj.DecodeError) as error:
            numbers.unpack(a=-1)
        assert error.value.kind == "range"
