"""Numbers in texts, against Python's own `repr`, `format`, `int` and `float`."""

from __future__ import annotations

import math
import random
import re
import struct

import pytest

import rosetta_jit as rj
from tests.language.texts import BACKENDS, decoder, encoder

EDGES = [0.0, -0.0, 1.0, 0.1, 100.0, 123.456, -7e100, 1e15, 1e16, 9999999999999998.0, 1e-4, 1e-5, 1.5e-5, 2.5e-10, 5e-324]
EDGES += [2.2250738585072014e-308, 1.7976931348623157e308, 1e22, 1e23, math.inf, -math.inf, math.nan]
INTEGERS = [0, 1, -1, 9, 10, -10, 123456789, 2**63 - 1, -(2**63), 10**18, -(10**18)]


def some_floats(count):
    rng = random.Random(7)
    found = [struct.unpack("<d", rng.randbytes(8))[0] for _ in range(count)]
    return found + [round(rng.uniform(-1000, 1000), rng.randrange(6)) for _ in range(count)]


@pytest.mark.parametrize("backend", BACKENDS)
def test_floats_are_written_as_python_does(backend):
    run = decoder({"s": "text(.x)"}, backend)
    for x in [*EDGES, *some_floats(200 if backend == "llvm" else 20)]:
        assert run(x=x)["s"] == repr(x)


@pytest.mark.parametrize("backend", BACKENDS)
def test_floats_of_32_bits(backend):
    """As few digits as read back as a float32."""
    run = decoder({"s": "text(.f)"}, backend)
    for value, expected in [(0.1, "0.1"), (16777216.0, "16777216.0"), (3.4028234663852886e38, "3.4028235e+38"), (1e-45, "1e-45")]:
        assert run(f=value)["s"] == expected


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("decimals", [0, 1, 3, 9])
def test_decimals(decimals, backend):
    run = decoder({"s": f"text(.x, {decimals})"}, backend)
    ties = [0.5, 1.5, 2.5, 0.125, 0.0005, 0.00049, 0.05, 9.9999, 99.95, -9.5, 1e-9]
    for x in [
        *ties,
        *(x for x in [*EDGES, *some_floats(100 if backend == "llvm" else 10)] if not abs(x) >= 10 ** (18 - decimals) or math.isinf(x)),
    ]:
        assert run(x=x)["s"] == f"{x:.{decimals}f}"
    with pytest.raises(rj.DecodeError, match="more than 18 digits") as error:
        run(x=10.0 ** (18 - decimals))
    assert error.value.kind == "range"


@pytest.mark.parametrize("backend", BACKENDS)
def test_integers(backend):
    write, read = decoder({"s": "text(.i)"}, backend), decoder({"n": "integer(.s)"}, backend)
    for number in INTEGERS:
        assert write(i=number)["s"] == str(number)
        for text in (str(number), f"{number:+}", f"{number:030}"):
            assert read(s=text)["n"] == number


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("text", ["", "-", "+", " 1", "1 ", "1.0", "0x10", "1_000", "--1", "\uff11", "nan", "9" * 30 + "x"])
def test_texts_that_are_no_integer(text, backend):
    with pytest.raises(rj.DecodeError, match="not an integer") as error:
        decoder({"n": "integer(.s)"}, backend)(s=text)
    assert (error.value.kind, error.value.path) == ("text", ".n")
    assert "m.mapping:" in error.value.detail


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("text", ["9223372036854775808", "-9223372036854775809", "1" + "0" * 40])
def test_integers_that_do_not_fit(text, backend):
    with pytest.raises(rj.DecodeError, match="does not fit int64") as error:
        decoder({"n": "integer(.s)"}, backend)(s=text)
    assert error.value.kind == "range"


@pytest.mark.parametrize("backend", BACKENDS)
def test_floats_are_read_exactly(backend):
    run = decoder({"x": "number(.s)"}, backend)
    texts = ["1", "-1.5", "+.5", "5.", "1e3", "1E-3", "-0.0", "0e99999999999999", "nan", "inf", "-inf", "1e-400", "0." + "0" * 400 + "1"]
    texts += ["9007199254740993", "9007199254740992.99999999999999999999", "2.2250738585072011e-308", "1" * 400 + "e-400", "4.9e-324"]
    texts += [repr(x) for x in some_floats(100)] + [f"{x:.40e}" for x in some_floats(50) if math.isfinite(x)]
    for text in texts:
        assert repr(run(s=text)["x"]) == repr(float(text)), text


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("text", ["", ".", "-", "e5", "1e", "1e+", "1.2.3", "1,5", " 1", "NaN", "infinity", "0x1p3", "1e5.0", "--1", "1_0"])
def test_texts_that_are_no_number(text, backend):
    with pytest.raises(rj.DecodeError, match="not a number") as error:
        decoder({"x": "number(.s)"}, backend)(s=text)
    assert error.value.kind == "text"


@pytest.mark.parametrize("backend", BACKENDS)
def test_numbers_beyond_float64(backend):
    for text in ("1e309", "-1" + "0" * 400):
        with pytest.raises(rj.DecodeError, match="does not fit float64") as error:
            decoder({"x": "number(.s)"}, backend)(s=text)
        assert error.value.kind == "range"


@pytest.mark.parametrize("backend", BACKENDS)
def test_packing_numbers(backend):
    run = encoder({"s": 'text(.n) + "/" + text(.x, 2)', "i": 'integer(part(.s, "/", 0))', "x": 'number(part(.s, "/", 1))'}, backend)
    found = run(s="-12/2.50", n=7, x=1.005)
    assert (found["s"], found["i"], found["x"]) == ("7/1.00", -12, 2.5)
    with pytest.raises(rj.EncodeError, match=re.escape("no such part")):
        run(s="12")


@pytest.mark.parametrize("encoding", ["yarp3", "yarp4"])
def test_an_element_that_a_text_tells(encoding):
    """The distance of a bottle's elements is known when they are read: it is multiplied with a number that was read."""
    files = {
        "a.bottle-schema": '"a" (("xs" (:list :double)) ("t" :string))',
        "lab/B.msg": "float64 o",
        "m.mapping": 'import "a.bottle-schema" import "lab/B.msg" data-holder: lab/B wire-schema: a unpack-rules: .o = .xs[integer(.t)]',
    }
    decode = rj.Decoder("m.mapping", schema=files, encoding=encoding, backend="python")
    write = rj.Encoder.of("a", schema=files, imports=["a.bottle-schema"], encoding=encoding, backend="interpreter")
    for text, kind in (("1", None), ("-1", "index"), ("2", "index"), ("x", "text"), (str(2**62), "index")):
        message = write(write.holder_type.from_dict({"xs": [1.5, 2.5], "t": text}))
        if kind is None:
            assert decode(message).o == 2.5
            continue
        with pytest.raises(rj.DecodeError) as error:
            decode(message)
        assert error.value.kind == kind
