"""Reductions: one value of an array, in every backend as Python computes it from the first element to the last."""

from __future__ import annotations

import math
import random
import re
import struct

import numpy as np
import pytest

import rosetta_jit as rj
from rosetta_jit.explain.operations import operations

BACKENDS = ["llvm", "python", "interpreter"]
ALL = [*BACKENDS, "numba"]
SCHEMAS = {
    "lab/msg/Row.msg": "string name\nfloat64[] cells\n",
    "lab/msg/In.msg": "float64[] a\nfloat64[] b\nfloat32[] f\nint64[] n\nint32[] i\nuint8[] d\nbool[] ok\nRow[] rows\n",
    "h.proto": """syntax = "proto3"; package lab;
message Out { double x = 1; float f = 2; int64 n = 3; bool t = 4; repeated double a = 5; repeated int64 m = 6; }""",
}
HEAD = 'import "lab/msg/In.msg"\nimport "h.proto"\ndata-holder: lab.Out\nwire-schema: lab/msg/In\n'
DEFAULTS = {".x": ".x = 0", ".f": ".f = 0", ".n": ".n = 0", ".t": ".t = false", ".a": "len(.a) = 0", ".m": "len(.m) = 0"}
"""What a holder has that a test is not about."""

EMPTY = {"a": [], "b": [], "f": [], "n": [], "i": [], "d": b"", "ok": [], "rows": []}


def decoder(rules, backend):
    """``run(a=…)``: what rules to unpack make of a message."""
    others = [rule for name, rule in DEFAULTS.items() if not any(re.match(rf"(len\()?\{name}\b", line.strip()) for line in rules)]
    files = {**SCHEMAS, "m.mapping": HEAD + "unpack-rules:\n" + "".join(f"  {rule}\n" for rule in (*rules, *others))}
    decode = rj.Decoder("m.mapping", schema=files, backend=backend)
    write = rj.Encoder.of("lab/msg/In", schema=SCHEMAS, imports=["lab/msg/In.msg"], backend="interpreter")
    return lambda **fields: decode(write(write.holder_type.from_dict({**EMPTY, **fields}))).to_dict()


def refused(kind, path, words, run, **fields):
    with pytest.raises(rj.DecodeError) as error:
        run(**fields)
    assert (error.value.kind, error.value.path) == (kind, path)
    assert words in str(error.value)


def added(numbers):
    """The sum from the first to the last: Python's `sum` compensates floats."""
    total = 0.0
    for number in numbers:
        total = total + number
    return total


def extreme(choose, numbers):
    """NaN if one is, else the first of those that are the least or the largest."""
    return next((number for number in numbers if math.isnan(number)), choose(numbers))


def bits(number):
    return struct.pack("<d", number) if not math.isnan(number) else b"nan"


FLOATS = {
    "sum(.a[])": added,
    "sum(.a[] * .a[] - 1)": lambda a: added([each * each - 1 for each in a]),
    "sqrt(sum(.a[] * .a[]))": lambda a: np.sqrt(added([each * each for each in a])),
    "mean(.a[])": lambda a: added(a) / len(a),
    "mean(.a[] - mean(.a[]))": lambda a: added([each - added(a) / len(a) for each in a]) / len(a),
    "min(.a[])": lambda a: extreme(min, a),
    "max(.a[])": lambda a: extreme(max, a),
    "max(.a[]) - min(abs(.a[]))": lambda a: extreme(max, a) - extreme(min, [abs(each) for each in a]),
    "sum(.a[1 to])": lambda a: added(a[1:]),
    "sum(reversed(.a))": lambda a: added(a[::-1]),
}
ARRAYS = [[1.5], [0.0, -0.0], [0.1, 0.2, 0.3, -0.7, 1e300], [math.inf, 1.0, -math.inf], [2.0, math.nan, -1.0], [math.nan, 3.0, 7.0]]


def set_to(array, expressions):
    """Rules that set the elements of an array, so that one program computes them all."""
    return [f"len({array}) = {len(expressions)}", *(f"{array}[{number}] = {each}" for number, each in enumerate(expressions))]


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.filterwarnings("ignore:invalid value")
def test_of_floats(backend):
    run = decoder(set_to(".a", FLOATS), backend)
    rng = random.Random(7)
    for array in (*ARRAYS, [rng.gauss(0, 1e3) for _ in range(99)]):
        for expression, found in zip(FLOATS, run(a=array)["a"], strict=True):
            assert bits(found) == bits(FLOATS[expression](array)), (expression, array)


CHOSEN = {
    "sum(.a[] where .ok[])": added,
    "mean(.a[] * 2 where .ok[])": lambda a: added([each * 2 for each in a]) / len(a),
    "min(.a[] where .ok[])": lambda a: extreme(min, a),
    "max(-.a[] where .ok[])": lambda a: extreme(max, [-each for each in a]),
    "mean(.a[] - mean(.a[] where .ok[]) where .ok[])": lambda a: added([each - added(a) / len(a) for each in a]) / len(a),
}


@pytest.mark.parametrize("backend", ALL)
@pytest.mark.filterwarnings("ignore:invalid value")
def test_of_the_elements_for_which_a_condition_holds(backend):
    run = decoder(set_to(".a", CHOSEN), backend)
    rng = random.Random(11)
    for array in (*ARRAYS, [rng.gauss(0, 1e3) for _ in range(99)]):
        taken = [rng.random() < 0.6 for _ in array]
        taken[rng.randrange(len(array))] = True
        chosen = [each for each, is_taken in zip(array, taken, strict=True) if is_taken]
        for expression, found in zip(CHOSEN, run(a=array, ok=taken)["a"], strict=True):
            assert bits(found) == bits(CHOSEN[expression](chosen)), (expression, array, taken)


COUNTED = {
    "count(.i[] > 2 where .n[] != 0)": lambda i, n: sum(1 for each, by in zip(i, n, strict=True) if by and each > 2),
    "sum(.i[] % .n[] where .n[] != 0)": lambda i, n: sum(math.fmod(each, by) for each, by in zip(i, n, strict=True) if by),
    "xor(.i[] where index() % 2 == 1)": lambda i, _: np.bitwise_xor.reduce(i[1::2]) if len(i) > 1 else 0,
    "int64(any(.i[] / .n[] > 2 where .n[] != 0))": lambda i, n: any(int(each / by) > 2 for each, by in zip(i, n, strict=True) if by),
    "int64(all(.i[] / .n[] > 2 where .n[] != 0))": lambda i, n: all(int(each / by) > 2 for each, by in zip(i, n, strict=True) if by),
    "min(.i[] where .i[] > -100)": lambda i, _: min(each for each in i if each > -100),
    "max(.n[] + .i[] where .i[] > -100)": lambda i, n: max(each + by for each, by in zip(i, n, strict=True) if each > -100),
}


@pytest.mark.parametrize("backend", ALL)
def test_elements_that_are_left_out_are_not_computed(backend):
    """A division by 0 of one that the condition leaves out is no error."""
    run = decoder(set_to(".m", COUNTED), backend)
    rng = random.Random(5)
    for size in (1, 2, 7, 50):
        i, n = ([rng.randrange(-9, 9) for _ in range(size)] for _ in range(2))
        assert run(i=i, n=n)["m"] == [int(each(i, n)) for each in COUNTED.values()]


@pytest.mark.parametrize("backend", ALL)
def test_of_no_element_for_which_a_condition_holds(backend):
    run = decoder([".x = mean(.a[] where .a[] > 0)", ".n = count(.a[] > 1 where .a[] > 0)"], backend)
    assert run(a=[-1.0, 3.0, 5.0]) == {**run(a=[3.0, 5.0]), "x": 4.0, "n": 2}
    for array in ([], [-1.0, 0.0]):
        refused("range", ".x", "there is no value", run, a=array)
    refused("rejected", ".x", "different lengths", decoder([".x = mean(.a[] where .ok[])"], backend), a=[1.0], ok=[])


@pytest.mark.parametrize("backend", ALL)
def test_elements_of_each_round_by_a_condition(backend):
    rules = ["len(.a) = len(.rows)", "for i from 0 to len(.rows)", "  .a[i] = sum(.rows[i].cells[] where .rows[i].cells[] > .b[i])", "end"]
    found = decoder(rules, backend)(rows=[{"name": "", "cells": [1.0, 2.0, 4.0]}, {"name": "", "cells": [8.0]}], b=[1.5, 9.0])
    assert found["a"] == [6.0, 0.0]


@pytest.mark.parametrize("backend", BACKENDS)
def test_of_elements_that_may_not_be_there(backend):
    run = decoder([".x = sum(.a[0 to 3 by 2])"], backend)
    assert run(a=[0.1, 9.0, 0.2, 9.0])["x"] == added([0.1, 0.2])
    refused("index", ".a[2]", "no such element", run, a=[0.1, 9.0])


@pytest.mark.parametrize("backend", BACKENDS)
def test_float32_is_added_in_float32(backend):
    run = decoder([".f = sum(.f[])", ".x = mean(.f[])"], backend)
    numbers = np.random.default_rng(3).normal(0, 100, 50).astype(np.float32)
    total = np.float32(0)
    for number in numbers:
        total = np.float32(total + number)
    found = run(f=numbers)
    assert (found["f"], found["x"]) == (total, added(map(float, numbers)) / 50)


INTEGERS = {
    "sum(.n[])": sum,
    "max(.n[])": max,
    "min(.n[])": min,
    "xor(.n[])": lambda n: int(np.bitwise_xor.reduce(np.array(n, np.int64))),
    "count(.n[] > 0)": lambda n: sum(each > 0 for each in n),
    "count(.n[] != 0 and 10 / .n[] == 2)": lambda n: sum(each in (4, 5) for each in n),
    "1 if any(.n[] == 5) else 0": lambda n: int(5 in n),
    "1 if all(.n[] < 9) else 0": lambda n: int(all(each < 9 for each in n)),
}


@pytest.mark.parametrize("backend", BACKENDS)
def test_of_integers(backend):
    run = decoder(set_to(".m", INTEGERS), backend)
    for array in ([5], [-3, 4, 0, 7], [1 << 62, -(1 << 63), 9], list(range(-20, 30))):
        for expression, found in zip(INTEGERS, run(n=array)["m"], strict=True):
            assert found == INTEGERS[expression](array), (expression, array)


@pytest.mark.parametrize("backend", BACKENDS)
def test_of_nothing(backend):
    run = decoder([".n = count(.ok[]) + sum(.n[]) + xor(.d[])", ".x = sum(.a[])", ".t = any(.ok[]) or not all(.ok[])"], backend)
    assert run() == {"x": 0.0, "f": 0.0, "n": 0, "t": False, "a": [], "m": []}
    for expression, words in (
        ("min(.a[])", "none is the least"),
        ("max(.a[])", "none is the largest"),
        ("mean(.a[])", "there is no value"),
    ):
        refused("range", ".x", words, decoder([f".x = {expression}"], backend))


@pytest.mark.parametrize("backend", BACKENDS)
def test_integers_never_wrap(backend):
    run = decoder([".n = sum(.n[])"], backend)
    assert run(n=[(1 << 63) - 1, -5, 5])["n"] == (1 << 63) - 1
    refused("range", ".n", "beyond 64 bits", run, n=[(1 << 62), (1 << 62), -5])
    assert decoder([".n = sum(.i[])"], backend)(i=[-(1 << 31)] * 1000)["n"] == -1000 << 31


@pytest.mark.parametrize("backend", BACKENDS)
def test_several_arrays_have_one_length(backend):
    run = decoder([".x = sum(.a[] * .b[])"], backend)
    assert run(a=[1, 2], b=[3, 4])["x"] == 11
    refused("rejected", ".x", "different lengths", run, a=[1, 2], b=[3])


@pytest.mark.parametrize("backend", BACKENDS)
def test_of_fields_and_lengths_of_elements(backend):
    run = decoder(['.n = count(.rows[].name == "x")', ".x = float64(sum(len(.rows[].cells)))", ".t = all(len(.rows[].name) == 1)"], backend)
    found = run(rows=[{"name": "x", "cells": [1, 2]}, {"name": "y", "cells": []}, {"name": "x", "cells": [5]}])
    assert (found["n"], found["x"], found["t"]) == (2, 3, True)


@pytest.mark.parametrize("backend", BACKENDS)
def test_within_loops_and_as_bounds_of_them(backend):
    rules = ["len(.a) = len(.rows)", "for i from 0 to len(.rows) .a[i] = sum(.rows[i].cells[]) end"]
    assert decoder(rules, backend)(rows=[{"cells": [1, 2]}, {"cells": []}, {"cells": [5]}])["a"] == [3, 0, 5]
    rules = ["len(.a) = count(.ok[])", "for i from 0 to count(.ok[]) .a[i] = .b[i] end"]
    assert decoder(rules, backend)(ok=[True, False, True], b=[1, 2, 3])["a"] == [1, 2]


@pytest.mark.parametrize("backend", BACKENDS)
def test_beside_elements(backend):
    """A reduction has the elements within it; rules for each element have the others."""
    run = decoder([".a[] = .a[] / sum(.a[]) + .b[]"], backend)
    assert run(a=[1, 3], b=[5, 6])["a"] == [5.25, 6.75]
    run = decoder(['reject "{max(.a[])}" when .a[] > 2 * mean(.a[])'], backend)
    assert run(a=[1, 2])["x"] == 0
    refused("rejected", "", "9", run, a=[1, 9, 1])


@pytest.mark.parametrize("backend", BACKENDS)
def test_what_no_round_asks_for_does_not_fail(backend):
    """A value that is the same in each round is computed once, in the first that asks for it."""
    run = decoder([".a[] = .a[] / mean(.b[])"], backend)
    assert run()["a"] == []
    assert run(a=[6], b=[3])["a"] == [2]
    refused("range", ".a[0]", "there is no value", run, a=[1])
    run = decoder([".a[] = .a[] / float64(sum(.n[])) if .a[] > 0 else 0.5"], backend)
    assert run(a=[-1, 0], n=[1 << 62] * 2)["a"] == [0.5, 0.5]
    assert run(a=[-1, 4, 6], n=[1, 1])["a"] == [0.5, 2, 3]
    refused("range", ".a[1]", "beyond 64 bits", run, a=[-1, 4], n=[1 << 62] * 2)


def test_is_computed_once_for_all_elements():
    """Else a message of this size would take minutes."""
    run = decoder([".a[] = .a[] / float64(sum(.n[])) + mean(.b[])"], "llvm")
    size = 300_000
    assert run(a=[1.0] * size, n=[1] * size, b=[2.0] * size)["a"][-1] == 1 / size + 2


@pytest.mark.parametrize("backend", ["llvm", "python"])
def test_many_integers_are_added_in_blocks(backend):
    """At the ends of blocks, and where sums need more than 32 bits."""
    run = decoder([".n = sum(.i[]) - sum(.d[])"], backend)
    for count in (1, 65535, 65536, 65537, 140_001):
        numbers, octets = np.full(count, -(2**31), np.int32), np.full(count, 255, np.uint8)
        numbers[::3] = 2**31 - 1
        assert run(i=numbers, d=octets.tobytes())["n"] == int(numbers.sum(dtype=np.int64)) - 255 * count


def test_small_integers_are_added_without_a_check():
    """So that LLVM computes a checksum in as many bits as it has."""
    files = {**SCHEMAS, "m.mapping": HEAD + "unpack-rules:\n  ignore rest\n  default rest\n  .n = sum(.d[]) & 255\n"}
    assert "fits(sum" not in rj.Decoder("m.mapping", schema=files, encoding="ros1").stage("kernel")


BOTH = """rules:
  .a[] <-> .a[] * 2
  .n <-> count(.a[] > 3)
  .x <-> max(.a[])
  ignore .b ignore .f ignore .n ignore .i ignore .d ignore .ok ignore .rows
  default .f default .t default .m
"""


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_relation_is_a_check_when_packing(backend):
    files = {**SCHEMAS, "m.mapping": HEAD + BOTH}
    decode, encode = (each("m.mapping", schema=files, backend=backend) for each in (rj.Decoder, rj.Encoder))
    held = {"x": 7.0, "f": 0.0, "n": 2, "t": False, "a": [2.0, 14.0, 8.0], "m": []}
    assert decode(encode(encode.holder_type.from_dict(held))).to_dict() == held
    for wrong in ({"n": 3}, {"x": 7.5}, {"a": [2.0, 14.0, 6.0]}):
        with pytest.raises(rj.EncodeError) as error:
            encode(encode.holder_type.from_dict({**held, **wrong}))
        assert error.value.kind == "rejected"


def test_counts_as_an_operation(tmp_path):
    for name, text in SCHEMAS.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    rules = "unpack-rules:\n  .x = sum(.a[])\n  .f = 0\n  .n = 0\n  .t = any(.ok[])\n  len(.a) = 0\n  len(.m) = 0\n"
    (tmp_path / "m.mapping").write_text(HEAD + rules)
    assert {"arithmetic", "predicate assignment"} <= set(operations(tmp_path / "m.mapping", folders=[tmp_path]))


def test_a_misspelt_reduction_and_a_forgotten_bracket_are_told_as_such():
    for value, words in (("cuont(.a[] > 3.0)", "did you mean `count`"), ("count(.a > 3.0)", "write `\\[\\]` behind the array")):
        files = {
            "lab/msg/A.msg": "float64[] a\n",
            "n.proto": 'syntax = "proto2"; message N { required int64 n = 1; }',
            "n.mapping": 'import "lab/msg/A.msg"\nimport "n.proto"\ndata-holder: N\nwire-schema: lab/msg/A\n'
            f"unpack-rules:\n  .n = {value}\n",
        }
        with pytest.raises(rj.MappingError, match=words) as raised:
            rj.Decoder("n.mapping", schema=files)
        assert len(raised.value.diagnostics) == 1
