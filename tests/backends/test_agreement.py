"""All backends do what the interpreter does, on good, cut, altered and random messages."""

from __future__ import annotations

import struct

import numpy as np
import pytest

from rosetta_jit.kernel.nodes import (
    Binary,
    Compare,
    Const,
    Convert,
    Expect,
    Failure,
    Fits,
    Load,
    Lookup,
    Place,
    Require,
    Return,
    Select,
    SetField,
    Unary,
)
from rosetta_jit.kernel.terms import BEGIN, END, ROW, add, index
from tests.backends import kernels
from tests.backends.engines import ENGINES, outcome
from tests.backends.holders import rows
from tests.backends.kernels import failure, row_fits
from tests.backends.messages import BAD_TEXT, GOOD, SIGNALLING_F32, hostile

BACKENDS = ENGINES[1:]
DECODERS = {kernel.name: kernel for kernel in kernels.DECODERS}


@pytest.mark.parametrize("name", DECODERS)
@pytest.mark.parametrize("backend", BACKENDS)
def test_decodes_like_the_interpreter(backend, name):
    kernel = DECODERS[name]
    for message in hostile(name):
        for begin, row in ((0, 0), (3, 2)):
            expected = outcome("interpreter", kernel, message, rows(kernel), begin, row)
            assert outcome(backend, kernel, message, rows(kernel), begin, row) == expected, (message, begin, row)


@pytest.mark.parametrize("backend", ENGINES)
def test_good_messages_decode(backend):
    for name, kernel in DECODERS.items():
        results = [outcome(backend, kernel, message, rows(kernel))[0] for message in GOOD[name]]
        grown = [result for result in results if result == -1]
        assert len(grown) == {"counted": 1, "varints": 1}.get(name, 0)
        assert all(result >= -1 for result in results)


def usual_length():
    """That the message has the length that most have, which is told only where nothing else fails."""
    return Expect(Compare("eq", add(BEGIN, 2), END), Failure(5, Const("i64", -1)))


@pytest.mark.parametrize("before", [(), (usual_length(),), (Require(BEGIN, index(2), failure(1)),)], ids=["first", "behind", "later"])
@pytest.mark.parametrize("backend", ENGINES)
def test_a_row_that_the_holder_has_not(backend, before):
    """Also of the message after one that has failed farther on, of which the state still tells."""
    second = (
        row_fits(),
        Require(BEGIN, index(2), failure(2)),
        Expect(Compare("eq", Load("u8", add(BEGIN, 1)), Const("u8", 1)), failure(3, END)),
    )
    made = kernels.kernel(
        (*before, row_fits(), Require(BEGIN, index(2), failure(4)), SetField(Place(0, ROW), Load("u8", BEGIN)), Return(add(BEGIN, 2))),
        (*second, SetField(Place(0, ROW), Load("u8", BEGIN)), Return(add(BEGIN, 2))),
        strides=(8,),
    )
    holder = rows(made, 2)
    expected = rows(made, 2)
    for message, row in ((b"ab", 0), (b"a", 0), (b"\x00\x00\x00", 1), (b"ab", 2), (b"a\x01c", 2), (b"", 2), (b"ab", 1)):
        assert outcome(backend, made, message, holder, row=row) == outcome("interpreter", made, message, expected, row=row), (message, row)


@pytest.mark.parametrize("backend", ENGINES)
def test_bad_text_is_refused(backend):
    for message in BAD_TEXT:
        for padded in (message, b"12345678" + message, message + b"12345678"):
            assert outcome(backend, kernels.text(), padded, rows(kernels.text()))[0] == -3, padded


@pytest.mark.parametrize("backend", BACKENDS)
def test_characters_in_texts_of_every_length(backend):
    """Texts are looked at by words and vectors: where a character stands, and what is left behind it, must not matter."""
    kernel, places = kernels.text(), 0
    for size in (*range(41), 63, 64, 65, 96, 97):
        for character in (b"", b"\xc3\xa9", b"\xe2\x82\xac", b"\xf0\x9f\xa4\x96", b"\x80", b"\xe2\x82", b"\xc3\xa9\xff"):
            for place in range(size - len(character) + 1):
                message = bytearray(b"a" * size)
                message[place : place + len(character)] = character
                holder = rows(kernel)
                accepted = outcome(backend, kernel, bytes(message), holder)[0] == size
                assert accepted == is_utf8(message), message
                places += 1
    assert places > 7000


def is_utf8(message):
    try:
        message.decode("utf-8")
    except UnicodeDecodeError:
        return False
    return True


@pytest.mark.parametrize("backend", ENGINES)
def test_decoding_into_row_0_empties_lanes(backend):
    kernel = kernels.counted()
    holder = rows(kernel)
    for message in GOOD["counted"][1:2] * 20:
        assert outcome(backend, kernel, message, holder)[1] == [0, 5]
    assert outcome(backend, kernel, GOOD["counted"][1], holder, row=1)[1] == [0, 10]


@pytest.mark.parametrize("backend", ENGINES)
def test_a_lane_that_must_grow(backend):
    kernel = kernels.counted()
    holder = rows(kernel, capacity=3)
    assert outcome(backend, kernel, GOOD["counted"][1], holder) == (-1, [1, 2])


@pytest.mark.parametrize("backend", ENGINES)
def test_the_farthest_attempt_is_reported(backend):
    result, (offset, site), indices = outcome(backend, kernels.attempts(), bytes([7, 9]), rows(kernels.attempts()))
    assert (result, offset, site, indices[0]) == (-6, 2, 5, 2)


@pytest.mark.parametrize("backend", ENGINES)
def test_a_moved_nan_keeps_its_payload(backend):
    holder = rows(kernels.tagged())
    outcome(backend, kernels.tagged(), b"\x02" + SIGNALLING_F32, holder)
    assert holder.lanes[0][8:12].tobytes() == SIGNALLING_F32[::-1]


@pytest.mark.parametrize("backend", BACKENDS)
def test_encodes_like_the_interpreter(backend):
    encoder, size = kernels.encoder()
    for start, count, used in ((0, 0, 0), (0, 3, 3), (2, 3, 5), (2, 4, 5), (-1, 1, 5), (0, -1, 5), (6, 0, 5), (0, 40, 40)):

        def holder(start=start, count=count, used=used):
            made = rows(encoder)
            made.state[22] = used
            made.lanes[0].view(np.int64)[:2] = start, count
            made.lanes[1].view(np.float64)[:] = np.arange(40) / 3
            return made

        for room in (0, 3, 4, 28, 400):
            assert outcome(backend, encoder, bytes(room), holder()) == outcome("interpreter", encoder, bytes(room), holder())
        assert outcome(backend, size, b"", holder()) == outcome("interpreter", size, b"", holder())


# --- expressions -------------------------------------------------------------------------------------------------------

NUMBERS = {
    "f64": (0.0, -0.0, 0.5, 1.5, 2.5, -2.5, 1e300, -1e300, 3e9, 2.0**63, -(2.0**63), float("inf"), float("-inf"), float("nan")),
    "f32": (0.0, -0.0, 0.1, 2.5, -3.5, 3e38, 1e-45, float("inf"), float("nan")),
    "i64": (0, 1, -1, 7, -7, 2**53 + 1, 2**62 + 2**38 + 1, -(2**63), 2**63 - 1),
    "u64": (0, 1, 7, 2**53 + 1, 2**63 + 2**39 + 1, 2**64 - 1),
    "i16": (0, 1, -1, 300, -32768, 32767),
    "u8": (0, 1, 127, 128, 255),
}
FORMATS = {"f64": "<d", "f32": "<f", "i64": "<q", "u64": "<Q", "i16": "<h", "u8": "<B"}
SCALARS = ("bool", "i8", "u8", "i16", "u16", "i32", "u32", "i64", "u64", "f32", "f64")


def operands(type_):
    """The two numbers that a test message starts with."""
    return Load(type_, BEGIN), Load(type_, add(BEGIN, 8))


def agree(expressions, type_, pairs):
    """One kernel that computes all of the expressions."""
    fields = tuple(SetField(Place(0, ROW, 8 * number), each) for number, each in enumerate(expressions))
    kernel = kernels.kernel(
        (Require(BEGIN, index(16), kernels.failure(1)), *fields, Return(BEGIN)), strides=(8 * len(expressions),), name=f"of_{type_}"
    )
    for left, right in pairs:
        message = struct.pack(FORMATS[type_], left).ljust(8, b"\0") + struct.pack(FORMATS[type_], right).ljust(8, b"\0")
        expected = rows(kernel, 1)
        outcome("interpreter", kernel, message, expected)
        for backend in BACKENDS:
            got = rows(kernel, 1)
            outcome(backend, kernel, message, got)
            different = np.flatnonzero(expected.lanes[0].view("<u8") != got.lanes[0].view("<u8"))
            assert all(is_nan(expected, got, k) for k in different), (backend, left, right, [expressions[k] for k in different])


def is_nan(expected, got, field):
    """Which NaN an operation makes is not said."""
    doubles = [each.lanes[0].view("<f8")[field] for each in (expected, got)]
    singles = [each.lanes[0].view("<f4")[2 * field] for each in (expected, got)]
    return all(map(np.isnan, doubles)) or all(map(np.isnan, singles))


@pytest.mark.parametrize("type_", NUMBERS)
def test_conversions(type_):
    left, _ = operands(type_)
    agree([Convert(target, left) for target in SCALARS], type_, [(value, 0) for value in NUMBERS[type_]])


@pytest.mark.parametrize("type_", NUMBERS)
def test_comparisons_and_selection(type_):
    left, right = operands(type_)
    compared = [Compare(op, left, right) for op in ("eq", "ne", "lt", "le", "gt", "ge")]
    chosen = [Select(compared[2], left, right), *(Binary(op, left, right) for op in ("min", "max"))]
    agree([*compared, *chosen], type_, [(a, b) for a in NUMBERS[type_] for b in NUMBERS[type_]])


@pytest.mark.parametrize("type_", ["f32", "f64"])
def test_float_arithmetic(type_):
    left, right = operands(type_)
    binary = [Binary(op, left, right) for op in ("add", "sub", "mul", "div", "rem")]
    unary = [Unary(function, left) for function in ("neg", "abs", "sqrt", "floor", "ceil", "trunc", "rint")]
    agree([*binary, *unary], type_, [(a, b) for a in NUMBERS[type_] for b in NUMBERS[type_]])


@pytest.mark.parametrize("type_", ["i64", "u64", "i16", "u8"])
def test_integer_arithmetic(type_):
    left, right = operands(type_)
    expressions = [Binary(op, left, right) for op in ("div", "rem", "and", "or", "xor")]
    expressions += [Binary(op, left, Const(type_, 3)) for op in ("shl", "shr")] + [Unary("not", left)]
    least = min(NUMBERS[type_])
    pairs = [(a, b) for a in NUMBERS[type_] for b in NUMBERS[type_] if b and not (a == least < 0 and b == -1)]
    agree(expressions, type_, pairs)


@pytest.mark.parametrize("type_", [each for each in NUMBERS if each[0] == "u"])
def test_sums_that_wrap(type_):
    agree([Binary("wrapping_add", *operands(type_))], type_, [(a, b) for a in NUMBERS[type_] for b in NUMBERS[type_]])


TABLES = {"u8": (0, 1, 128, 255), "i16": (-(2**15), -1, 2**15 - 1), "u64": (0, 2**63, 2**64 - 1), "i64": (-(2**63), -1, 2**63 - 1)}
TABLES |= {"i8": (-128, 127), "u16": tuple(range(0, 65536, 257)), "i32": (-(2**31), 5), "u32": (2**32 - 1,)}


@pytest.mark.parametrize("type_", TABLES)
def test_tables(type_):
    """Whatever the byte, its remainder is a place of the table."""
    values = TABLES[type_]
    number = (
        Convert("i64", Binary("rem", operands("u8")[0], Const("u8", len(values))))
        if len(values) < 256
        else Convert("i64", operands("u8")[0])
    )
    agree(
        [Convert("i64" if type_ != "u64" else "u64", Lookup(type_, values, number))], "u8", [(each, 0) for each in (0, 1, 2, 3, 128, 255)]
    )


def test_fits():
    left, right = operands("i64")
    agree([Fits(op, left, right) for op in ("add", "sub", "mul")], "i64", [(a, b) for a in NUMBERS["i64"] for b in NUMBERS["i64"]])


def test_a_failing_expectation_of_a_later_row_tells_its_index():
    kernel = kernels.counted()
    message = struct.pack("<i", 3) + struct.pack(">3h", 1, -1, 3)
    for backend in ENGINES:
        result, where, indices = outcome(backend, kernel, message, rows(kernel))
        assert (result, where, indices[0]) == (-5, [6, 4], 1)
    assert isinstance(kernel.bodies[0][1], Expect)
