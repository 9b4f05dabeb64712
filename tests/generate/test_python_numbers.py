"""Bools and numbers that generated Python reads and writes together, as lists and as arrays of numpy."""

from __future__ import annotations

import numpy as np
import pytest

import rosetta_jit as rj
from rosetta_jit.api.options import type_request
from rosetta_jit.generate.build import NO_WISHES, Wishes
from tests.generate.driver import harmed
from tests.generate.python import BOTH, answers_as_the_library, module, protobuf, source_of

BOOLS = {
    "ros1": "bool a\nbool[] some\nbool[3] few\nint16 n\nbool[36] many\nbool b\nbool c\n",
    "cdr": "bool a\nbool[] some\nbool[3] few\nint16 n\nbool[36] many\nbool b\nbool c\n",
    "lcm": {
        "t.lcm": "package t; struct T { boolean a; int32_t n; boolean some[n]; boolean few[3]; boolean many[36]; boolean b; boolean c; }"
    },
}


@pytest.mark.parametrize("arrays", ["", "numpy"])
@pytest.mark.parametrize("encoding", BOOLS)
def test_bools_are_read_and_written_together(encoding, arrays):
    """A byte that is neither 0 nor 1 is an error at its place, the first of them, wherever it is."""
    type_ = {"ros1": "t/T", "cdr": "t/msg/T", "lcm": "t.T"}[encoding]
    given = {"encoding": encoding, "schema": BOOLS[encoding]}
    request, programs = type_request("decode", type_, given), (rj.Decoder.of(type_, **given), rj.Encoder.of(type_, **given))
    text = source_of(request, BOTH, Wishes(numpy=bool(arrays)))
    assert "for i in range" not in text
    unit = module(request, BOTH, Wishes(numpy=bool(arrays)))
    good = []
    for count in (0, 1, 5, 150):
        some = [number % 3 == 0 for number in range(count)]
        values = {"a": True, "n": count, "some": some, "few": [False, True, True], "many": [*some, *[True] * 36][:36], "c": True}
        good.append(bytes(programs[1](programs[1].holder_type.from_dict(values))))
        assert unit.encode(unit.T(**values)) == good[-1]
        found = unit.decode(good[-1])
        assert [*found.some] == some
        assert {type(each) for each in [found.a, found.b, *found.some]} <= {bool, np.bool_}
    bad = [good[-1][:at] + bytes([byte]) + good[-1][at + 1 :] for at in range(len(good[-1])) for byte in (2, 255)]
    answers_as_the_library(unit, programs, [*harmed(good, 12, encoding), *bad])
    assert unit.decode(unit.encode(unit.T(a="yes", b=[], few=[0, 1, 5], many=[7] * 36))).a
    if arrays:
        seen, own = (unit.decode(good[-1], copy=copy).some for copy in (False, True))
        assert (seen.dtype, seen.tolist(), seen.flags.writeable, own.flags.writeable) == (np.bool_, own.tolist(), False, True)


def _side_by_side(encoding: str) -> str | dict[str, str]:
    """A message with bools before a number, behind it, and in a list of structs."""
    names = [f"{place}{number}" for place in "ab" for number in range(9)]
    if encoding == "lcm":
        first, last = ("".join(f"boolean {name}; " for name in each) for each in (names[:9], names[9:]))
        both = f"{first} int16_t number; {last}"
        return {"t.lcm": f"package t; struct T {{ {both} int32_t n; Row rows[n]; }} struct Row {{ {both} }}"}
    first, last = ("".join(f"bool {name}\n" for name in each) for each in (names[:9], names[9:]))
    separator = f"\n{'=' * 80}\nMSG: t/Row\n"
    return f"{first}int16 number\n{last}Row[] rows{separator}{first}int16 number\n{last}"


@pytest.mark.parametrize("encoding", ["ros1", "cdr", "lcm"])
def test_bools_side_by_side_are_read_by_one_call(encoding):
    type_ = {"ros1": "t/T", "cdr": "t/msg/T", "lcm": "t.T"}[encoding]
    given = {"encoding": encoding, "schema": _side_by_side(encoding)}
    request, programs = type_request("decode", type_, given), (rj.Decoder.of(type_, **given), rj.Encoder.of(type_, **given))
    assert "a8 = _load_9T(data, " in source_of(request, BOTH)
    flags = {f"{place}{number}": number % 2 == (place == "a") for place in "ab" for number in range(9)}
    row = {**flags, "number": 258}
    values = ({**row, "rows": [row] * count, **({"n": count} if encoding == "lcm" else {})} for count in (0, 2))
    good = [bytes(programs[1](programs[1].holder_type.from_dict(each))) for each in values]
    bad = [good[-1][:at] + bytes([byte]) + good[-1][at + 1 :] for at in range(len(good[-1])) for byte in (2, 255)]
    answers_as_the_library(module(request), programs, [*harmed(good, 12, encoding), *bad])


@pytest.mark.parametrize("arrays", ["", "numpy"])
@pytest.mark.parametrize(("type_", "value"), [("boolean", True), ("double", 0.5), ("int8_t", -1)])
def test_structs_of_one_number_are_structs(type_, value, arrays):
    given = {"encoding": "lcm", "schema": {"t.lcm": f"package t; struct T {{ int32_t n; Row rows[n]; }} struct Row {{ {type_} one; }}"}}
    programs = rj.Decoder.of("t.T", **given), rj.Encoder.of("t.T", **given)
    good = bytes(programs[1](programs[1].holder_type.from_dict({"n": 2, "rows": [{"one": value}, {}]})))
    unit = module(type_request("decode", "t.T", given), BOTH, Wishes(numpy=bool(arrays)))
    assert unit.encode(unit.T(2, [unit.Row(value), unit.Row()])) == good
    answers_as_the_library(unit, programs, harmed([good], 24, type_))


def test_few_numbers_of_numpy_are_pythons_where_they_are_packed():
    """Together with the numbers around them; what is no number of their type is refused, times too."""
    given = {
        "encoding": "lcm",
        "schema": {"t.lcm": "package t; struct T { int64_t t; double p[3]; int32_t n; int16_t v[n]; int32_t q[2]; }"},
    }
    request = type_request("decode", "t.T", given)
    unit, encode = module(request, BOTH, Wishes(numpy=True)), rj.Encoder.of("t.T", **given)
    text = source_of(request, BOTH, Wishes(numpy=True))
    assert "*_few(p_" in text
    values = {"t": 1, "p": [1.5, -2.0, 3.0], "n": 4, "v": [1, -2, 300, 4], "q": [7, -8]}
    message = bytes(encode(encode.holder_type.from_dict(values)))
    for change in (np.array, list, tuple):
        made = {name: change(value) if isinstance(value, list) else value for name, value in values.items()}
        assert unit.encode(unit.T(**made)) == message
    found = unit.decode(message, copy=False)
    assert (found.p.dtype, found.v.dtype, found.q.dtype) == (np.float64, np.int16, np.int32)
    assert found.v.flags.writeable
    assert unit.decode(unit.encode(unit.T(p=np.zeros(3), q=np.zeros(2, np.int64)))).v.dtype == np.int16
    for wrong in ({"p": np.zeros((3, 2))}, {"q": np.zeros(2)}, {"q": np.zeros(2, "datetime64[s]")}, {"p": np.zeros(3, complex)}):
        with pytest.raises(unit.EncodeError, match="range"):
            unit.encode(unit.T(**{"p": np.zeros(3), "q": np.zeros(2, int), **wrong}))


def test_lists_of_numbers_together_may_be_empty():
    """Of times, whose two numbers are read by one call for all."""
    given = {"encoding": "ros1", "schema": "time[] v\nduration[2] w\n"}
    request, programs = type_request("decode", "t/T", given), (rj.Decoder.of("t/T", **given), rj.Encoder.of("t/T", **given))
    unit = module(request)
    assert "if count else []" in source_of(request)
    good = [bytes([count, 0, 0, 0]) + bytes(range(8 * count + 16)) for count in (0, 1, 3)]
    assert [len(unit.decode(each).v) for each in good] == [0, 1, 3]
    answers_as_the_library(unit, programs, harmed(good, 12, "times"))


def test_arrays_of_fixed_dimensions_are_written_from_the_objects():
    """Of bytes, of numbers of a byte and of more, and of structs: each row is taken apart where it is written."""
    schema = {
        "t.lcm": "package t; struct sub { byte raw[2]; int8_t few[2][2]; string name; } "
        "struct T { byte b[2][3]; int8_t v[2][3]; int16_t w[3][2]; int8_t x[2][2][2]; sub s[2]; string names[2]; }"
    }
    given = {"encoding": "lcm", "schema": schema}
    request, programs = type_request("decode", "t.T", given), (rj.Decoder.of("t.T", **given), rj.Encoder.of("t.T", **given))
    values = {
        "b": [b"abc", b"def"],
        "v": [[1, -2, 3], [4, 5, -6]],
        "w": [[1, 2], [-300, 4], [5, 6]],
        "x": [[[1, 2], [3, 4]], [[5, 6], [7, 8]]],
        "s": [{"raw": b"\1\2", "few": [[1, 2], [3, 4]], "name": "one"}, {"raw": b"\3\4", "few": [[5, 6], [7, 8]], "name": ""}],
        "names": ["x", "é"],
    }
    message = bytes(programs[1](programs[1].holder_type.from_dict(values)))
    for arrays in ("", "numpy"):
        unit = module(request, BOTH, Wishes(numpy=bool(arrays)))
        assert unit.encode(unit.decode(message)) == message
        made = {**values, "s": [unit.sub(**each) for each in values["s"]]}
        assert unit.encode(unit.T(**made)) == message
        for wrong in ({"b": [b"abc"]}, {"b": [b"abc", b"de"]}, {"v": [[1, 2, 3], [1, 2]]}, {"x": [[[1, 2], [3, 4]], [[5, 6], [7]]]}):
            with pytest.raises(unit.EncodeError):
                unit.encode(unit.T(**{**made, **wrong}))
        answers_as_the_library(unit, programs, harmed([message], 12, f"dimensions {arrays}"))
    for fields in ("byte b[2][3]; byte c[3];", "int8_t v[2][3]; byte b[2][3];"):
        few = {"encoding": "lcm", "schema": {"t.lcm": f"package t; struct T {{ {fields} }}"}}
        assert "_size_1" not in source_of(type_request("decode", "t.T", few))


@pytest.mark.parametrize("arrays", ["", "numpy"])
def test_rows_of_several_dimensions_are_read_at_once(arrays):
    """Few rows each as a whole, many of them by one call; of bytes and of numbers, with the order of their bytes; none at all."""
    fields = (
        "byte b[2][3]; int8_t v[3][30]; int8_t x[2][2][2]; byte r[n][3]; double d[n][3]; int16_t w[n][2]; int8_t s[5][2]; byte y[2][n][2];"
    )
    given = {"encoding": "lcm", "schema": {"t.lcm": f"package t; struct T {{ int32_t n; {fields} float f[4][3]; }}"}}
    request, programs = type_request("decode", "t.T", given), (rj.Decoder.of("t.T", **given), rj.Encoder.of("t.T", **given))
    text = source_of(request, BOTH, Wishes(numpy=bool(arrays)))
    borrow = text[text.index("def _borrow_1(") : text.index("def decode(")]
    assert "bytearray" not in borrow
    values = {
        "b": [b"abc", b"def"],
        "v": [[*range(-15, 15)]] * 3,
        "x": [[[1, 2], [3, 4]], [[5, 6], [7, 8]]],
        "s": [[number, -number] for number in range(5)],
        "f": [[0.5, -1.0, number] for number in range(4)],
    }
    for count in (0, 1, 5):
        some = {
            "n": count,
            "r": [b"\0\1\2"] * count,
            "d": [[0.5, float(number), -1.5] for number in range(count)],
            "w": [[-300, number] for number in range(count)],
            "y": [[b"ab"] * count] * 2,
        }
        message = bytes(programs[1](programs[1].holder_type.from_dict({**values, **some})))
        unit = module(request, BOTH, Wishes(numpy=bool(arrays)))
        found = unit.decode(message)
        assert [[*row] for row in found.d] == some["d"]
        assert all(isinstance(row, np.ndarray if arrays else list) for row in (*found.v, *found.d, *found.w, *found.s))
        for row in found.d:
            row[0] = 7.0  # rows are their object's own
        answers_as_the_library(unit, programs, harmed([message], 30, f"rows {arrays} {count}"))


@pytest.mark.parametrize("wishes", [NO_WISHES, Wishes(numpy=True)])
def test_integers_of_lists_are_those_of_their_fields(wishes):
    """What is written one by one is looked at as what is written by one call: too large, negative, no integer at all."""
    schema = """
        enum E { ZERO = 0; } message S { repeated uint32 numbers = 1; }
        message M {
            repeated int32 a = 1; repeated sint64 b = 2 [packed = false]; repeated uint64 c = 3 [packed = false]; repeated E d = 4;
            repeated uint32 e = 5; repeated S f = 6; repeated int64 g = 7; repeated fixed32 h = 8 [packed = false];
        }
    """
    unit = module(type_request("decode", "t.M", protobuf(schema)), BOTH, wishes)
    bounds = {"a": (-(1 << 31), 1 << 31), "b": (-(1 << 63), 1 << 63), "c": (0, 1 << 64), "d": (-(1 << 31), 1 << 31)}
    bounds |= {"e": (0, 1 << 32), "f": (0, 1 << 32), "g": (-(1 << 63), 1 << 63), "h": (0, 1 << 32)}
    for name, (least, end) in bounds.items():
        for numbers in ([least, 1, end - 1], [True]):
            given = [unit.S(numbers)] if name == "f" else numbers
            found = getattr(unit.decode(unit.encode(unit.M(**{name: given}))), name)
            assert [*(found[0].numbers if name == "f" else found)] == numbers
        for wrong in ([least - 1], [0, end], [1.5], ["1"], [None], 7, None):
            with pytest.raises(unit.EncodeError) as caught:
                unit.encode(unit.M(**{name: [unit.S(wrong)] if name == "f" else wrong}))
            assert caught.value.kind == "range"


def test_arrays_of_numpy_in_arrays_are_joined_by_numpy():
    """Where all have one length and one type; else a loop finds the one that has not, or takes it as the numbers that it is."""
    schema = {
        "t.lcm": "package t; struct s { double x; } struct T { int32_t n; int32_t k; double m[n][3]; int16_t v[n][k]; boolean b[4][k]; "
        "byte raw[2][n][2]; float x[2][2][3]; s structs[4][2]; }"
    }
    given = {"encoding": "lcm", "schema": schema}
    request, programs = type_request("decode", "t.T", given), (rj.Decoder.of("t.T", **given), rj.Encoder.of("t.T", **given))
    text = source_of(request, BOTH, Wishes(numpy=True))
    assert [text.count(each) for each in (" = _table(", ", 3)) if count", "is_bool=True)\n")] == [4, 1, 1]
    unit = module(request, BOTH, Wishes(numpy=True))
    values = {
        "n": 5,
        "k": 2,
        "m": np.arange(15.0).reshape(5, 3),
        "v": np.arange(10, dtype=np.int16).reshape(5, 2) - 4,
        "b": np.array([[True, False]] * 4),
        "raw": [[bytes([each, 255]) for each in range(5)]] * 2,
        "x": np.arange(12, dtype=np.float32).reshape(2, 2, 3),
    }
    plain = {name: value.tolist() if isinstance(value, np.ndarray) else value for name, value in values.items()}
    plain["structs"] = [[{"x": 1.5}, {"x": 2.5}]] * 4
    message = bytes(programs[1](programs[1].holder_type.from_dict(plain)))
    plain["structs"] = values["structs"] = [[unit.s(x=1.5), unit.s(x=2.5)]] * 4
    rows = {name: [*value] if isinstance(value, np.ndarray) else value for name, value in values.items()}
    others = {
        "m": [np.array([0, 1, 2]), *rows["m"][1:]],
        "v": [[-4, -3], *rows["v"][1:]],
        "b": [[1, 0]] * 4,
        "x": [rows["x"][0].astype(float), rows["x"][1]],
    }
    for given_ in (values, plain, rows, {**rows, **others}, vars_of(unit.decode(message), values)):
        assert unit.encode(unit.T(**given_)) == message
    wrong = {"m": [rows["m"][0][:2], *rows["m"][1:]], "v": np.full((5, 2), 70000), "b": rows["b"][:3], "x": np.zeros((2, 3, 2))}
    for name, value in {**wrong, "m ": rows["m"][:4], "v ": [*rows["v"][:4], np.zeros((2, 1), np.int16)], "b ": "abcd"}.items():
        with pytest.raises(unit.EncodeError):
            unit.encode(unit.T(**{**rows, name.strip(): value}))
    with pytest.raises(unit.EncodeError, match=r"count at \.m\[3\]"):
        unit.encode(unit.T(**{**rows, "m": [*rows["m"][:3], np.zeros(2), rows["m"][4]]}))
    answers_as_the_library(unit, programs, harmed([message, bytes(programs[1](programs[1].holder_type()))], 12, "tables"))


def vars_of(message, names):
    """Attributes by their names."""
    return {name: getattr(message, name) for name in names}


@pytest.mark.parametrize("encoding", ["ros1", "lcm"])
def test_arrays_of_more_lengths_than_are_kept(encoding):
    """What reads and writes so many numbers is kept for some counts: nothing says so."""
    schema = {"ros1": "int64[] v\nuint16[] w\n", "lcm": {"t.lcm": "package t; struct T { int32_t n; int64_t v[n]; int16_t w[n]; }"}}
    type_, given = {"ros1": "t/T", "lcm": "t.T"}[encoding], {"encoding": encoding, "schema": schema[encoding]}
    request, programs = type_request("decode", type_, given), (rj.Decoder.of(type_, **given), rj.Encoder.of(type_, **given))
    unit, named = module(request), programs[1].holder_type.from_dict
    assert "_writes_q" in source_of(request)
    for count in (*range(300), 128, 1000, 0, 3):
        values = {"v": [-(3**30)] * count, "w": [7 * each for each in range(count)], **({"n": count} if encoding == "lcm" else {})}
        message = bytes(programs[1](named(values)))
        assert unit.encode(unit.T(**values)) == message
        assert unit.decode(message) == unit.T(**values)
    kept = unit._writes_q if encoding == "ros1" else unit._writes_q_be
    assert len(kept) <= unit._KEPT
    for wrong in ([0.5], [1 << 63], ["1"], [None], 7):
        with pytest.raises(unit.EncodeError, match="range"):
            unit.encode(unit.T(**{"v": wrong, **({"n": 1, "w": [1]} if encoding == "lcm" else {})}))
