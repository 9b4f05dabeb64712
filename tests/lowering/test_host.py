"""What a mapping asks of its host: users' functions, the time, the number of a message; in both directions and every backend."""

from __future__ import annotations

import functools
import math
import time
from itertools import pairwise

import numba
import numpy as np
import pytest

import rosetta_jit as rj

BACKENDS = ["numba", "llvm", "python", "interpreter"]
FILES = {
    "w.bottle-schema": '"w" (("x" :double) ("i" :int) ("b" :bool))',
    "h.proto": 'syntax = "proto2"; message H { required double f = 1; required int64 n = 2; required bool g = 3; }',
}
HEAD = 'import "w.bottle-schema"\nimport "h.proto"\nfunction f(float64, int32): float64\ndata-holder: H\nwire-schema: w\n'
OFFSET = 0.25


def write(**values):
    encode = rj.Encoder.of("w", schema=FILES, imports=["w.bottle-schema"], encoding="yarp3", backend="interpreter")
    return encode(encode.holder_type.from_dict({"x": 0.0, "i": 0, "b": False, **values}))


def decoder(rules, backend, head=HEAD, **functions):
    return rj.Decoder("m.mapping", schema={**FILES, "m.mapping": head + rules}, encoding="yarp3", backend=backend, functions=functions)


def calibrate(raw, channel):
    if channel < 0:
        raise ValueError("no such channel")
    return math.sin(raw) * 2.0**channel + OFFSET


UNPACK = "unpack-rules:\n  .f = f(.x, .i) * 2.0\n  .n = .i\n  .g = .b\n"


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("given", [calibrate, numba.njit(calibrate), numba.njit("float64(float64, int32)")(calibrate)])
def test_a_function_of_numbers(backend, given):
    decode = decoder(UNPACK, backend, f=given)
    for x, i in ((0.5, 3), (-2.0, 0), (1e300, 31)):
        assert decode(write(x=x, i=i)).f == calibrate(x, i) * 2.0
    with pytest.raises(rj.DecodeError, match="raised an exception") as error:
        decode(write(i=-1))
    assert (error.value.kind, error.value.path) == ("rejected", ".f")
    assert "m.mapping:7:3" in str(error.value)


@pytest.mark.parametrize("backend", BACKENDS)
def test_functions_of_every_type(backend):
    scalars = ["bool", *(f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64)), "float32", "float64"]
    for scalar in scalars:
        head = HEAD.replace("f(float64, int32): float64", f"f({scalar}): {scalar}")
        value = ".b" if scalar == "bool" else "float32(.x)" if scalar == "float32" else ".x" if scalar == "float64" else f"{scalar}(.i)"
        back = {
            "bool": ".g = f({})\n .n = 1\n .f = 1",
            "float32": ".f = f({})\n .n = 1\n .g = true",
            "float64": ".f = f({})\n .n = 1\n .g = true",
        }
        rest = back.get(scalar, ".n = int64(f({}))\n .f = 1\n .g = true")
        decode = decoder(f"unpack-rules:\n {rest.format(value)}\n", backend, head, f=lambda x: x)
        found = decode(write(x=0.1, i=101, b=True))
        wanted = {"bool": True, "float32": float(np.float32(0.1)), "float64": 0.1}.get(scalar, 101)
        assert {"bool": found.g, "float32": found.f, "float64": found.f}.get(scalar, found.n) == wanted


@pytest.mark.parametrize("backend", BACKENDS)
def test_to_pack(backend):
    rules = "pack-rules:\n  .x = f(.f, int32(.n))\n  .i = int32(.n)\n  .b = .g\n"
    files = {**FILES, "m.mapping": HEAD + rules}
    encode = rj.Encoder("m.mapping", schema=files, encoding="yarp3", backend=backend, functions={"f": calibrate})
    read = rj.Decoder.of("w", schema=FILES, imports=["w.bottle-schema"], encoding="yarp3", backend="interpreter")
    assert read(encode(encode.holder_type.from_dict({"f": 0.5, "n": 2, "g": True}))).x == calibrate(0.5, 2)
    with pytest.raises(rj.EncodeError, match="raised an exception"):
        encode(encode.holder_type.from_dict({"f": 0.5, "n": -2, "g": True}))


@pytest.mark.parametrize("backend", BACKENDS)
def test_in_loops_and_batches(backend):
    files = {
        "w.bottle-schema": '"w" (("xs" (:list :double)))',
        "h.proto": 'syntax = "proto2"; message H { repeated double ys = 1; }',
        "m.mapping": 'import "w.bottle-schema"\nimport "h.proto"\nfunction f(float64, int64): float64\ndata-holder: H\nwire-schema: w\n'
        "unpack-rules:\n  len(.ys) = len(.xs)\n  for i from 0 to len(.xs)\n    .ys[i] = f(.xs[i], i) if .xs[i] > 0 else 0\n  end\n",
    }
    decode = rj.Decoder("m.mapping", schema=files, encoding="yarp3", backend=backend, functions={"f": calibrate})
    encode = rj.Encoder.of("w", schema=files, imports=["w.bottle-schema"], encoding="yarp3", backend="interpreter")
    rows = [[0.5, -1.0, 2.0], [], [3.0] * 20]
    messages = [encode(encode.holder_type.from_dict({"xs": row})) for row in rows]
    batch = decode.many(b"".join(messages), np.cumsum([0, *map(len, messages)]))
    wanted = [[calibrate(x, i) if x > 0 else 0.0 for i, x in enumerate(row)] for row in rows]
    assert [list(message.ys) for message in batch] == wanted


@pytest.mark.parametrize("backend", BACKENDS)
def test_the_time_and_the_number(backend):
    rules = "unpack-rules:\n  .n = now()\n  .f = float64(now() - now())\n  .g = counter() % 2 == 1\n"
    decode = decoder(rules, backend)
    for number in range(4):
        before, found, after = time.time_ns(), decode(write()).to_dict(), time.time_ns()
        assert before <= found["n"] <= after
        assert (found["f"], found["g"]) == (0.0, number % 2 == 1)


@pytest.mark.parametrize("backend", BACKENDS)
def test_numbers_count_messages_that_were_made(backend):
    decode = decoder('unpack-rules:\n  .n = counter()\n  .f = 0\n  .g = true\n  reject "odd" when .i % 2 == 1\n', backend)
    other = decoder('unpack-rules:\n  .n = counter()\n  .f = 0\n  .g = true\n  reject "odd" when .i % 2 == 1\n', backend)
    assert [decode(write()).n, decode(write()).n] == [0, 1]
    with pytest.raises(rj.DecodeError, match="odd"):
        decode(write(i=1))
    assert decode(write(), decode.new()).n == 2
    messages = [write()] * 3
    batch = decode.many(b"".join(messages), np.cumsum([0, *map(len, messages)]))
    assert batch.n.tolist() == [3, 4, 5]
    assert decode(write()).n == 6
    assert other(write()).n == 0


@pytest.mark.parametrize("backend", BACKENDS)
def test_size_and_bytes_agree(backend):
    files = {
        **FILES,
        "v.bottle-schema": '"v" (("n" :int64) ("xs" (:list :double)))',
        "m.mapping": 'import "v.bottle-schema"\nimport "h.proto"\ndata-holder: H\nwire-schema: v\npack-rules:\n  .n = counter()\n'
        "  ignore .f\n  ignore .n\n  ignore .g\n  len(.xs) = counter()\n  for i from 0 to counter()\n    .xs[i] = float64(now())\n  end\n",
    }
    encode = rj.Encoder("m.mapping", schema=files, encoding="yarp3", backend=backend)
    read = rj.Decoder.of("v", schema=files, imports=["v.bottle-schema"], encoding="yarp3", backend="interpreter")
    holder = encode.holder_type.from_dict({"f": 0, "n": 0, "g": False})
    for number in range(3):
        found = read(encode(holder)).to_dict()
        assert found["n"] == len(found["xs"]) == number
        assert len(set(found["xs"])) <= 1
    buffer, offsets = encode.many(
        decoder("unpack-rules:\n .f=.x .n=.i .g=.b", backend).many(write() * 2, np.array([0, 1, 2]) * len(write()))
    )
    made = [read(buffer[begin:end]).to_dict() for begin, end in pairwise(offsets)]
    assert [message["n"] for message in made] == [3, 4]
    assert [len(message["xs"]) for message in made] == [3, 4]
    assert encode.size(holder) == 5 * 8 + len(buffer) - offsets[1] - 4 * 8


def test_a_warm_start_compiles_nothing(monkeypatch):
    decode = decoder(UNPACK, "numba", f=calibrate)
    monkeypatch.setattr("rosetta_jit.pipeline.build.Build.image", None)
    assert decoder(UNPACK, "numba", f=calibrate)(write(x=1.0)).f == decode(write(x=1.0)).f


def test_another_function_is_another_program():
    def scaled(factor):
        return lambda x, i: x * factor + i

    assert [decoder(UNPACK, "numba", f=scaled(factor))(write(x=1.0)).f for factor in (1.0, 2.0, 3.0)] == [2.0, 4.0, 6.0]


def failed(head=HEAD, rules=UNPACK, backend="numba", **functions):
    with pytest.raises(rj.MappingError) as error:
        decoder(rules, backend, head, **functions)
    return error.value.diagnostics


@pytest.mark.parametrize(
    ("old", "new", "code", "column"),
    [
        ("f(.x, .i)", "f(.x)", "arguments", 8),
        ("f(.x, .i)", "f(.x, .i, .i)", "arguments", 8),
        ("f(.x, .i)", "f(.i, .x)", "argument-type", 14),
        ("f(.x, .i)", "f(.x, .b)", "argument-type", 14),
        ("f(.x, .i)", "g(.x, .i)", "unknown-function", 8),
        ("f(.x, .i)", "now(.x)", "arguments", 8),
        ("f(.x, .i)", "decompress(.x)", "no-bytes", 19),
        ("f(.x, .i)", "image_width()", "arguments", 8),
        ("f(.x, .i)", 'compress(.x, "png", 1, 1, 1)', "no-bytes", 17),
    ],
)
def test_wrong_calls(old, new, code, column):
    (found,) = (each for each in failed(rules=UNPACK.replace(old, new), f=calibrate) if each.code == code)
    assert found.span.source.line_column(found.span.start) == (7, column)


@pytest.mark.parametrize(
    ("declared", "code"),
    [
        ("function f(float64, int32): text", "no-scalar"),
        ("function f(float): float64", "no-scalar"),
        ("function sqrt(float64): float64", "function-name"),
        ("function a.b(float64): float64", "function-name"),
        ("function decompress(float64): float64", "function-name"),
        ("function f(float64, int32): float64\nfunction f(float64): float64", "repeated-function"),
        (f"function f({', '.join(['float64'] * 40)}): float64", "many-parameters"),
        ("function f(float64", "syntax"),
        ("function (float64): float64", "syntax"),
    ],
)
def test_wrong_declarations(declared, code):
    assert code in {each.code for each in failed(HEAD.replace("function f(float64, int32): float64", declared), f=calibrate)}


def test_functions_and_declarations_belong_together():
    (missing,) = failed()
    assert (missing.code, missing.span.source.line_column(missing.span.start)[0]) == ("function-missing", 3)
    (unknown,) = failed(f=calibrate, ff=calibrate)
    assert (unknown.code, unknown.help) == ("function-unknown", "did you mean `f`?")
    with pytest.raises(TypeError, match="neither"):
        decoder(UNPACK, "numba", f=math.sin)


@pytest.mark.parametrize(
    ("function", "why"),
    [
        (lambda x, i: (x, i), "it gives"),
        (lambda _, i: i + 1, "it gives int64, not float64"),
        (lambda x, i: x if i else None, "it gives"),
        (lambda x, _: open(x), "numba"),  # noqa: SIM115, PTH123 - what numba cannot compile
        (lambda x: x, "numba"),
        (lambda x, i: np.ones(3)[i] * x, "cannot call"),
    ],
)
@pytest.mark.parametrize("backend", ["numba", "llvm"])
def test_what_does_not_compile(function, why, backend):
    (found,) = failed(backend=backend, f=function)
    assert (found.code, found.span.source.line_column(found.span.start)[0]) == ("function-type", 3)
    assert why in found.notes[0]


def many_arguments(x, i):
    both = {"x": x, "i": i}
    return max(**both)


def class_in_it(x, i):
    class A:
        pass

    return x * i


def import_in_it(x, i):
    import math

    return math.sin(x) * i


def star_in_it(x, i):
    first, *_ = x, i, i
    return first


def text_in_it(x, i):
    return float(f"{x}") * i


def varied_in_it(x, i):
    first = lambda *given, **_: given[0]  # noqa: E731 - numba takes it to pieces where it is called
    return first(x) * i


@pytest.mark.parametrize("function", [many_arguments, class_in_it, import_in_it, star_in_it, text_in_it, varied_in_it])
def test_whatever_numba_raises_is_a_report(function):
    """Of bytecode that it does not know it raises what is no error of numba's, and some of its code fails on the way."""
    (found,) = failed(backend="llvm", f=function)
    assert (found.code, found.notes[0].startswith("numba: ")) == ("function-type", True)


def test_attributes_of_a_function_do_not_replace_it():
    """`functools.wraps` gives a function the `py_func` and the options of the one of numba's that it is put around."""
    inner = numba.njit(fastmath=True)(lambda x, i: x + i)

    def marked(x, i):
        return x * i

    marked.py_func, marked.targetoptions, marked.locals = inner.py_func, {"fastmath": True}, {}
    assert (
        decoder(UNPACK, "llvm", f=marked)(write(x=3.0, i=4)).to_dict()
        == decoder(UNPACK, "llvm", f=lambda x, i: x * i)(write(x=3.0, i=4)).to_dict()
    )

    @functools.wraps(inner)
    def around(x, i):
        return inner(x, i) * 2.0

    (found,) = failed(backend="llvm", f=around)
    assert (found.code, "unsupported recursion" in found.notes[0]) == ("function-type", True), "nor does numba's own njit take it"


class Compiled:
    py_func = staticmethod(lambda x, i: x * i)
    targetoptions = locals = 5


@pytest.mark.parametrize("given", [Compiled(), Compiled, functools.partial(max, 1.0), functools.cache(lambda x, i: x * i)])
def test_what_is_no_function_of_python_or_numba_is_refused(given):
    with pytest.raises(TypeError, match="neither"):
        decoder(UNPACK, "llvm", f=given)


@pytest.mark.parametrize("backend", ["numba", "llvm"])
def test_without_numba(monkeypatch, backend):
    monkeypatch.setattr("rosetta_jit.pipeline.user_functions.find_spec", lambda _: None)
    (found,) = failed(backend=backend, f=lambda x, i: x - i)
    assert found.code == "no-numba"


@pytest.mark.parametrize("backend", ["python", "interpreter"])
def test_results_of_another_type_are_refused(backend):
    for wrong in (lambda *_: None, lambda *_: "1", lambda *_: True, lambda x, _: x / 0):
        with pytest.raises(rj.DecodeError, match="raised an exception"):
            decoder(UNPACK, backend, f=wrong)(write(x=1.0))


def test_check_needs_no_functions(tmp_path):
    from rosetta_jit.pipeline.checked_mapping import check_mapping

    for name, text in {**FILES, "m.mapping": HEAD + UNPACK}.items():
        (tmp_path / name).write_text(text)
    assert check_mapping(str(tmp_path / "m.mapping")).warnings == ()


@pytest.mark.parametrize("value", ["now()", "counter()", "now() + .i", "int64(.x) if .b else now()"])
def test_no_relation_to_what_changes(value):
    codes = [
        each.code for each in failed(rules=f"rules:\n  .n <-> {value}\n  .f <-> .x\n  .g <-> .b\nunpack-rules:\n  ignore .i\n", f=calibrate)
    ]
    assert "no-inverse" in codes


def test_a_kernel_of_its_own_has_no_host():
    with pytest.raises(ValueError, match="calls functions"):
        _ = decoder(UNPACK, "numba", f=calibrate).kernel


@pytest.mark.parametrize("backend", BACKENDS)
def test_in_a_mapping_that_another_one_uses(backend):
    files = {
        "a.proto": """syntax = "proto3"; message P { double x = 1; } message Q { double y = 1; }
message Ps { repeated P ps = 1; } message Qs { repeated Q qs = 1; int64 when = 2; }""",
        "one.mapping": 'import "a.proto"\nfunction f(float64): float64\ndata-holder: Q\nwire-schema: P\nunpack-rules:\n  .y = f(.x)\n',
        "m.mapping": 'import "a.proto"\ndata-holder: Qs\nwire-schema: Ps\n'
        'unpack-rules:\n  .qs = .ps via "one.mapping"\n  .when = counter()\n',
    }
    decode = rj.Decoder("m.mapping", schema=files, backend=backend, functions={"f": lambda x: x * 3.0})
    encode = rj.Encoder.of("Ps", schema=files, imports=["a.proto"], backend="interpreter")
    message = encode(encode.holder_type.from_dict({"ps": [{"x": 1.0}, {"x": 2.0}]}))
    assert [each.y for each in decode(message).qs] == [3.0, 6.0]
    other = {**files, "m.mapping": "function f(float32): float32\n" + files["m.mapping"]}
    with pytest.raises(rj.MappingError, match="declared twice"):
        rj.Decoder("m.mapping", schema=other, backend=backend, functions={"f": lambda x: x})
