"""The functions of the language, against Python's own."""

from __future__ import annotations

import math

import pytest

import rosetta_jit as rj

FILES = {
    "w.bottle-schema": '"w" (("x" :double) ("y" :double) ("i" :int64) ("j" :int64))',
    "h.proto": 'syntax = "proto2"; message H { required double f = 1; required int64 n = 2; }',
}
HEAD = 'import "w.bottle-schema"\nimport "h.proto"\ndata-holder: H\nwire-schema: w\nunpack-rules:\n'
FLOATS = [(0.5, 2.0), (-0.75, 0.25), (1.0, -0.0), (-1.0, 1e300), (0.0, -0.0)]
OF_FLOATS = {
    "sin(.x)": lambda x, _y: math.sin(x),
    "cos(.x)": lambda x, _y: math.cos(x),
    "tan(.x)": lambda x, _y: math.tan(x),
    "asin(.x)": lambda x, _y: math.asin(x),
    "acos(.x)": lambda x, _y: math.acos(x),
    "atan(.y)": lambda _x, y: math.atan(y),
    "atan2(.x, .y)": math.atan2,
    "sqrt(abs(.x))": lambda x, _y: math.sqrt(abs(x)),
    "round(.x * 10.0) + floor(.x) - ceil(.x)": lambda x, _y: round(x * 10) + math.floor(x) - math.ceil(x),
    "min(.x, .y, 0.1) + max(.x, -0.5)": lambda x, y: min(x, y, 0.1) + max(x, -0.5),
    "1.0 if isfinite(.x / .y) else 0.0": lambda x, y: float(y != 0 and math.isfinite(x / y)),
    "1.0 if isfinite(float32(.y)) and isfinite(3) else 0.0": lambda _x, y: float(abs(y) < 2**127),
    "1.0 if isnan(.x * (0.0 / abs(.y))) else 0.0": lambda _x, y: float(y == 0),
    "2.0 * atan2(sin(.x), cos(.x))": lambda x, _y: 2.0 * math.atan2(math.sin(x), math.cos(x)),
}
INTEGERS = [(7, 2), (-7, 2), (1 << 40, 3), (0, 63)]
OF_INTEGERS = {
    ".i & 12 | .j": lambda i, j: i & 12 | j,
    ".i ^ -1": lambda i, _j: i ^ -1,
    "(.i & 255) << .j % 8": lambda i, j: (i & 255) << j % 8,
    ".i >> .j": lambda i, j: i >> j,
    "divide(.i * 6, 3)": lambda i, _j: i * 2,
    ".i / .j * .j + .i % .j": lambda i, _j: i,
    "int64(float64(.i) / 2.0, round)": lambda i, _j: round(i / 2),
    "1 if .i < .j and not (.i == 0) else -1": lambda i, j: 1 if i < j and i != 0 else -1,
    "floor_divide(.i, .j + 2) * 100 + modulo(.i, .j + 2)": lambda i, j: i // (j + 2) * 100 + i % (j + 2),
    "floor_divide(.i, -3) * 100 + modulo(.i, -3)": lambda i, _j: i // -3 * 100 + i % -3,
    ".i + int64(.x > 2) + int64(.x) + (3 if .y > 0 else 4)": lambda i, _j: i + 4,
}


def program(tmp_path, rules, backend):
    for name, content in {**FILES, "m.mapping": HEAD + rules}.items():
        (tmp_path / name).write_text(content)
    decode = rj.Decoder(tmp_path / "m.mapping", encoding="yarp3", backend=backend)
    write = rj.Encoder.of("w", schema=FILES, imports=["w.bottle-schema"], encoding="yarp3", backend="interpreter")

    def run(**values):
        given = {"x": 0.0, "y": 0.0, "i": 0, "j": 1, **values}
        return decode(write(write.holder_type.from_dict(given)))

    return run


@pytest.mark.parametrize("backend", ["numba", "python", "interpreter"])
@pytest.mark.parametrize("expression", OF_FLOATS)
def test_of_floats(tmp_path, expression, backend):
    run = program(tmp_path, f"  .f = {expression}\n  .n = 0\n", backend)
    for x, y in FLOATS:
        assert repr(run(x=x, y=y).f) == repr(float(OF_FLOATS[expression](x, y)))


@pytest.mark.parametrize("backend", ["numba", "python", "interpreter"])
@pytest.mark.parametrize("expression", OF_INTEGERS)
def test_of_integers(tmp_path, expression, backend):
    run = program(tmp_path, f"  .n = {expression}\n  .f = 0\n", backend)
    for i, j in INTEGERS:
        assert run(i=i, j=j).n == OF_INTEGERS[expression](i, j)


@pytest.mark.parametrize("backend", ["numba", "python", "interpreter"])
@pytest.mark.parametrize(("expression", "values"), [("asin(.x)", {"x": 2.0}), ("sin(.x)", {"x": math.inf}), ("sqrt(.x)", {"x": -1.0})])
def test_where_there_is_no_value(tmp_path, expression, values, backend):
    assert math.isnan(program(tmp_path, f"  .f = {expression}\n  .n = 0\n", backend)(**values).f)


@pytest.mark.parametrize("backend", ["numba", "python", "interpreter"])
@pytest.mark.parametrize("expression", ["1 << .i", ".j >> .i", "divide(.j, .i)"])
def test_out_of_range(tmp_path, expression, backend):
    run = program(tmp_path, f"  .n = {expression}\n  .f = 0\n", backend)
    for i in (0 if "divide" in expression else -1, 64, 1 << 40):
        with pytest.raises(rj.DecodeError) as error:
            run(i=i, j=3)
        assert error.value.kind == "range"


@pytest.mark.parametrize("backend", ["numba", "python", "interpreter"])
def test_conversions_by_rule(tmp_path, backend):
    run = program(tmp_path, "  .f = float64(.i, exact)\n  .n = int64(int8(.x, saturate))\n", backend)
    for number in (0, -1, 1 << 53, 1 << 62, -(1 << 63), (1 << 63) - 1024):
        assert run(i=number).f == number
    for number in ((1 << 53) + 1, (1 << 63) - 1, -(1 << 62) - 1):
        with pytest.raises(rj.DecodeError) as error:
            run(i=number)
        assert error.value.kind == "range"
    for x, wanted in ((0.5, 0), (1.5, 2), (-1.5, -2), (126.6, 127), (1e300, 127), (-math.inf, -128)):
        assert run(x=x).n == wanted
    with pytest.raises(rj.DecodeError, match="does not fit int8"):
        run(x=math.nan)
    run = program(tmp_path, "  .f = float64(float32(.x, exact))\n  .n = 0\n", backend)
    for x in (0.5, -0.0, math.inf, math.ldexp(1, -149)):
        assert run(x=x).f == x
    assert math.isnan(run(x=math.nan).f)
    for x in (0.1, 1e300, 5e-324):
        with pytest.raises(rj.DecodeError, match="does not fit float32"):
            run(x=x)
