"""Laws of relations of several fields: orders whose sizes are fields, dates of two fields, digits; shown, and held by random values."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import rosetta_jit as rj
from tests.language.test_laws import files
from tests.language.test_random_laws import assert_law

if TYPE_CHECKING:
    from collections.abc import Callable

    from rosetta_jit.language.laws.guarantees import Laws


@dataclass
class Both:
    """A mapping in both directions, run on values."""

    wire: str
    holder: str
    rules: str
    backend: str = "python"

    def __post_init__(self) -> None:
        texts = files(self.wire, self.holder, f"rules:\n{self.rules}\n")
        options: dict[str, Any] = {"schema": texts, "encoding": "yarp3", "backend": self.backend}
        own: dict[str, Any] = {**options, "imports": ["wire.bottle-schema"], "backend": "interpreter"}
        self.decode, self.encode = rj.Decoder("m.mapping", **options), rj.Encoder("m.mapping", **options)
        self.read, self.write = rj.Decoder.of("wire", **own), rj.Encoder.of("wire", **own)
        mapping = self.decode.mapping
        assert mapping is not None
        assert mapping.laws is not None
        self.laws: Laws = mapping.laws

    def unpacked(self, values: dict[str, Any]) -> dict[str, Any]:
        return self.decode(self.write(self.write.holder_type.from_dict(values))).to_dict()

    def packed(self, held: dict[str, Any]) -> dict[str, Any]:
        return self.read(self.encode(self.encode.holder_type.from_dict(held))).to_dict()

    def assert_message(self, values: dict[str, Any], held: dict[str, Any] | None) -> None:
        """What a message means, None where it is refused; and that it comes back as the law says."""
        if held is None:
            with pytest.raises(rj.DecodeError):
                self.unpacked(values)
            return
        assert self.unpacked(values) == held
        try:
            back = self.packed(held)
        except rj.EncodeError:
            return
        assert_law(self.laws.messages, values, back)

    def assert_holder(self, held: dict[str, Any], values: dict[str, Any] | None = None) -> None:
        """That a holder comes back as the law says; what it packs as, where that is given."""
        try:
            packed = self.packed(held)
            back = self.unpacked(packed)
        except (rj.EncodeError, rj.DecodeError):
            assert values is None
            return
        assert values is None or packed == values
        assert_law(self.laws.holders, held, back)


# --- orders --------------------------------------------------------------------------------------------------------------

SIZED = (
    '("l" (:list :double)) ("r" :int) ("c" :int)',
    "repeated double l = 1; required int32 r = 2; required int32 c = 3;",
    ".r <-> .r\n.c <-> .c\n",
)


def axes(shape: tuple[int, ...], order: tuple[int, ...]) -> Callable[[np.ndarray], np.ndarray]:
    return lambda array: array.reshape(shape).transpose(order).ravel()


ORDERS: list[tuple[str, Callable[[int, int], Callable[[np.ndarray], np.ndarray]]]] = [
    ("transposed(.l, .r, .c)", lambda r, c: axes((r, c), (1, 0))),
    ("transposed(.l, .r, .c, 1)", lambda r, c: axes((r, c), (1, 0))),
    ("transposed(reversed(.l), .r, .c)", lambda r, c: lambda array: axes((r, c), (1, 0))(array[::-1])),
    ("reversed(transposed(.l, .r, .c))", lambda r, c: lambda array: axes((r, c), (1, 0))(array)[::-1]),
    ("planar(.l, .c)", lambda r, c: axes((r, c), (1, 0))),
    ("interleaved(.l, .r)", lambda r, c: axes((r, c), (1, 0))),
    ("planar(.l, 1, .c)", lambda _r, _c: lambda array: array),
    ("reversed(planar(.l, .c))", lambda r, c: lambda array: axes((r, c), (1, 0))(array)[::-1]),
    ("reversed(.l, .c)", lambda r, c: lambda array: array.reshape(r, c)[:, ::-1].ravel()),
]


@pytest.mark.parametrize(("rule", "meaning"), ORDERS, ids=[rule for rule, _ in ORDERS])
@settings(max_examples=6, deadline=None)
@given(r=st.integers(0, 5), c=st.integers(0, 5))
def test_orders_whose_sizes_are_fields(rule, meaning, r, c):
    both = made(*SIZED[:2], f"{SIZED[2]}.l <-> {rule}")
    assert str(both.laws) == "messages: exact inverse\nholders: exact inverse"
    array = np.arange(float(r * c))
    values = {"l": array.tolist(), "r": r, "c": c}
    if 0 in (r, c):  # groups of nothing are refused, arrays of none come back
        both.assert_holder(values)
        return
    held = {**values, "l": meaning(r, c)(array).tolist()}
    both.assert_message(values, held)
    both.assert_holder(values)


@cache
def made(wire: str, holder: str, rules: str) -> Both:
    """One mapping, compiled once."""
    return Both(wire, holder, rules)


@pytest.mark.parametrize(
    ("rules", "lost"),
    [
        ("when .r > 0 .l <-> planar(.l, .c) else .l <-> .l end", ()),
        (".l[] <-> .l[] * 2.0", ()),
        (".l <-> planar(rows(.l, 2, 6, 8), 3)", (".l[]",)),
    ],
)
def test_other_laws_are_as_they_were(rules, lost):
    both = made(*SIZED[:2], f"{SIZED[2]}{rules}")
    assert tuple(dict.fromkeys(loss.place for loss in both.laws.messages.losses if loss.place != "len(.l)")) == lost


def test_rounds_that_set_other_elements_are_no_inverse():
    """A transposition by sizes that are not those of the way back."""
    texts = files(
        *SIZED[:2],
        "unpack-rules:\n.r = .r\n.c = .c\n.l = transposed(.l, .r, .c)\npack-rules:\n.r = .r\n.c = .c\n.l = transposed(.l, .r, .c)\n",
    )
    mapping = rj.Decoder("m.mapping", schema=texts, encoding="yarp3", backend="interpreter").mapping
    assert mapping is not None
    assert mapping.laws is not None
    assert [loss.place for loss in mapping.laws.messages.losses] == [".l[]"]


# --- moments -------------------------------------------------------------------------------------------------------------

FLOATING = '("x" :double)', "required int64 n = 1; required int32 i = 2;", ".n <-> seconds(.x)\n.i <-> int32(fraction(.x))"
PARTED = '("n" :int64) ("i" :int)', "required double x = 1;", ".x <-> timestamp(.n, .i)"
SPELT = '("s" :string)', "required int64 n = 1; required int32 i = 2;", ".n <-> seconds(.s)\n.i <-> int32(fraction(.s))"
WRITTEN = '("n" :int64) ("i" :int)', "required string s = 1;", ".s <-> iso8601(.n, .i)"
SECONDS = (
    st.floats(-1e10, 1e10)
    | st.floats(-10, 10)
    | st.floats(-5e6, 5e6)
    | st.sampled_from([0.0, -0.0, 2.0**23, 2.0**-60, -(2.0**-60), 0.9999999996])
)


def test_laws_of_moments():
    kinds = {
        rules: tuple(law.kind for law in (found.messages, found.holders))
        for *rest, rules in (FLOATING, PARTED, SPELT, WRITTEN)
        for found in [made(*rest, rules).laws]
    }
    assert list(kinds.values()) == [("rounded", "lossy"), ("lossy", "rounded"), ("lossy", "exact"), ("exact", "lossy")]
    (rounding,) = dict(made(*FLOATING).laws.messages.rounded).values()
    assert (rounding.ulp, rounding.bits, rounding.floor) == (3, 64, 4.6e6)
    assert [loss.why for loss in made(*SPELT).laws.messages.losses] == ["a date is written in one way, in UTC, however it was spelt"]
    assert {loss.why for loss in made(*PARTED).laws.messages.losses} == {
        "it is rounded to a float64, which tells moments of today to about 240 ns"
    }


@settings(max_examples=150, deadline=None)
@given(x=SECONDS)
def test_floating_seconds_come_back_as_their_law_says(x):
    nanos = round((x % 1.0) * 1e9) if x % 1.0 != 1.0 else 10**9
    whole = int(np.floor(x)) + (nanos == 10**9)
    held = {"n": whole, "i": nanos % 10**9}
    made(*FLOATING).assert_message({"x": x}, held)
    made(*PARTED).assert_holder({"x": x}, held)


@settings(max_examples=50, deadline=None)
@given(n=st.integers(-62135596800, 253402300799), i=st.integers(0, 10**9 - 1))
def test_dates_come_back_as_their_law_says(n, i):
    micros = i // 1000 * 1000
    moment = datetime(1970, 1, 1, tzinfo=UTC) + timedelta(seconds=n, microseconds=micros // 1000)
    digits = 0 if not micros else 3 if micros % 10**6 == 0 else 6
    spelt = f"{moment:%Y-%m-%dT%H:%M:%S}".zfill(19) + (f".{micros:09d}"[: digits + 1] if digits else "") + "Z"
    made(*WRITTEN).assert_message({"n": n, "i": micros}, {"s": spelt})
    made(*WRITTEN).assert_message({"n": n, "i": i}, made(*WRITTEN).unpacked({"n": n, "i": i}))
    made(*SPELT).assert_message({"s": spelt}, {"n": n, "i": micros})
    made(*SPELT).assert_holder({"n": n, "i": i})
    made(*WRITTEN).assert_holder({"s": spelt.replace("Z", "+00:00")}, {"n": n, "i": micros})


# --- digits --------------------------------------------------------------------------------------------------------------

INT64 = st.integers(-(2**63), 2**63 - 1)


@st.composite
def radices(draw: st.DrawFn) -> list[int]:
    return draw(st.lists(st.integers(2, 70), min_size=1, max_size=3))


def weights(bases: list[int]) -> list[int]:
    """What each digit counts, the highest first."""
    return [int(np.prod(bases[number:], dtype=object)) for number in range(len(bases) + 1)]


def digits_of(total: int, bases: list[int]) -> list[int]:
    """The digits of a number, the highest without an end."""
    found: list[int] = []
    for base in reversed(bases):
        total, digit = divmod(total, base)
        found.insert(0, digit)
    return [total, *found]


@settings(max_examples=25, deadline=None)
@given(data=st.data(), bases=radices(), shape=st.sampled_from(["sum", "turned", "nested"]))
def test_digits_become_one_number(data, bases, shape):
    """`.t <-> .f0 * 3600 + .f1 * 60 + .f2`: exact both ways, and a digit that is none is refused."""
    names = [f"f{number}" for number in range(len(bases) + 1)]
    terms = [f".{name} * {weight}" if weight > 1 else f".{name}" for name, weight in zip(names, weights(bases), strict=True)]
    value = " + ".join(reversed(terms) if shape == "turned" else terms)
    if shape == "nested":
        value = f".{names[0]}"
        for name, base in zip(names[1:], bases, strict=True):
            value = f"({value}) * {base} + .{name}"
    both = made(" ".join(f'("{name}" :int64)' for name in names), "required int64 t = 1;", f".t <-> {value}")
    assert str(both.laws) == "messages: exact inverse\nholders: exact inverse"
    for _ in range(4):
        total = data.draw(INT64 | st.integers(-5000, 5000))
        found = dict(zip(names, digits_of(total, bases), strict=True))
        both.assert_holder({"t": total})
        if abs(total) < 2**62:  # what is computed on the way may be larger than the number
            both.assert_holder({"t": total}, found)
            both.assert_message(found, {"t": total})
        wrong, digit = data.draw(st.sampled_from([*zip(names[1:], bases, strict=True)]))
        both.assert_message({**found, wrong: data.draw(st.sampled_from([-1, digit, digit + 1]))}, None)


@settings(max_examples=25, deadline=None)
@given(data=st.data(), base=st.integers(2, 10**9), scale=st.sampled_from([1, 3, 1000]), turned=st.booleans())
def test_one_number_becomes_digits(data, base, scale, turned):
    """`.a <-> floor_divide(.t, 1000000)` and `.b <-> int32(modulo(.t, 1000000) * 1000)`."""
    part = f"modulo(.t, {base})" if scale == 1 else f"modulo(.t, {base}) * {scale}"
    rules = [f".a <-> floor_divide(.t, {base})", f".b <-> {part}"]
    both = made('("t" :int64)', "required int64 a = 1; required int64 b = 2;", "\n".join(rules[::-1] if turned else rules))
    assert str(both.laws) == "messages: exact inverse\nholders: exact inverse"
    for _ in range(4):
        total = data.draw(INT64 | st.integers(-5000, 5000))
        both.assert_message({"t": total}, {"a": total // base, "b": total % base * scale})
        both.assert_holder({"a": data.draw(st.integers(-(2**33), 2**33)), "b": data.draw(st.integers(0, base - 1)) * scale})
        with pytest.raises(rj.EncodeError):
            both.packed({"a": 0, "b": base * scale})


def test_what_is_known_of_some_elements_is_not_known_of_all():
    """The loop that checks ends before the one that sets."""
    texts = files(
        '("a" (:list :int64)) ("b" (:list :int))',
        "repeated int64 t = 1;",
        """unpack-rules:
  for i from 0 to CHECKED
    reject "no digit" when .b[i] < 0 or .b[i] >= 60
  end
  len(.t) = len(.b)
  for i from 0 to len(.b)
    .t[i] = .a[i] * 60 + .b[i]
  end
pack-rules:
  len(.a) = len(.t)
  len(.b) = len(.t)
  for i from 0 to len(.t)
    .a[i] = floor_divide(.t[i], 60)
    .b[i] = int32(modulo(.t[i], 60))
  end
""",
    )
    for checked, lost in (("2", {".a[]", ".b[]", "len(.a)"}), ("len(.b)", {"len(.a)"})):
        mapping = rj.Decoder(
            "m.mapping",
            schema={**texts, "m.mapping": texts["m.mapping"].replace("CHECKED", checked)},
            encoding="yarp3",
            backend="interpreter",
        ).mapping
        assert mapping is not None
        assert mapping.laws is not None
        assert {loss.place for loss in mapping.laws.messages.losses} == lost


TIMES = '("hours" (:list :int64)) ("minutes" (:list :int))', "repeated int64 t = 1;", ".t[] <-> .hours[] * 60 + .minutes[]"
CLOCKS = '("p" (:list (:bottle ("h" :int64) ("m" :int))))', "repeated int64 t = 1;", ".t[] <-> .p[].h * 60 + .p[].m"
BACK = (
    '("t" (:list :int64))',
    "message M { required int64 h = 1; required int32 m = 2; } repeated M p = 1;",
    ".p[].h <-> floor_divide(.t[], 60)\n.p[].m <-> int32(modulo(.t[], 60))",
)
CHOSEN = (
    '("k" :int) ("a" :int64) ("b" :int)',
    "required int64 t = 1; required int32 k = 2;",
    ".k <-> .k\n.t <-> .a * 60 + .b if .k > 0 else .a * 100 + .b if .k > -5 else .a * 7 + .b",
)


@pytest.mark.parametrize("backend", ["llvm", "python", "interpreter"])
def test_digits_of_each_element(backend):
    totals = [0, -1, 59, 60, -61, 10**12]
    pairs = [divmod(total, 60) for total in totals]
    found = {"hours": [hours for hours, _ in pairs], "minutes": [minutes for _, minutes in pairs]}
    points = {"p": [{"h": hours, "m": minutes} for hours, minutes in pairs]}
    for form, values in ((TIMES, found), (CLOCKS, points)):
        both = Both(*form, backend)
        assert str(both.laws) == "messages: exact inverse\nholders: exact inverse"
        both.assert_message(values, {"t": totals})
        both.assert_holder({"t": totals}, values)
        both.assert_message({name: [] for name in values}, {"t": []})
    wrong = Both(*TIMES, backend)
    with pytest.raises(rj.DecodeError, match=r"`\.minutes\[\]` is not from 0 to 59"):
        wrong.unpacked({"hours": [0, 1], "minutes": [59, 60]})
    with pytest.raises(rj.DecodeError, match="the arrays have different lengths"):
        wrong.unpacked({"hours": [0, 1], "minutes": [59]})
    back = Both(*BACK, backend)
    assert str(back.laws) == "messages: exact inverse\nholders: exact inverse"
    back.assert_message({"t": totals}, points)
    back.assert_holder(points, {"t": totals})
    with pytest.raises(rj.EncodeError, match=r"`\.p\[\]\.m` is not from 0 to 59"):
        back.packed({"p": [{"h": 0, "m": -1}]})


@pytest.mark.parametrize("backend", ["llvm", "python", "interpreter"])
def test_digits_that_are_chosen(backend):
    both = Both(*CHOSEN, backend)
    assert str(both.laws) == "messages: exact inverse\nholders: exact inverse"
    for kind, base in ((1, 60), (0, 100), (-5, 7)):
        both.assert_message({"k": kind, "a": -3, "b": base - 1}, {"t": -3 * base + base - 1, "k": kind})
        both.assert_holder({"t": -1, "k": kind}, {"k": kind, "a": -1, "b": base - 1})
        both.assert_message({"k": kind, "a": 0, "b": base}, None)


@pytest.mark.parametrize("backend", ["llvm", "python", "interpreter"])
def test_a_rejection_that_asks_each_element(backend):
    """In both directions, with the value of the first element that is refused."""
    both = Both(
        '("b" (:list :int64)) ("c" (:list :int64))',
        "repeated int64 b = 1; repeated int64 c = 2;",
        """.b[] <-> .b[] + 1
.c <-> .c
reject "{.b[]} is above {.c[]}" when .b[] > .c[]""",
        backend,
    )
    assert str(both.laws) == "messages: exact inverse\nholders: exact inverse"
    both.assert_message({"b": [1, 5], "c": [1, 5]}, {"b": [2, 6], "c": [1, 5]})
    with pytest.raises(rj.DecodeError, match="7 is above 5") as error:
        both.unpacked({"b": [1, 7, 9], "c": [1, 5, 0]})
    assert error.value.kind == "rejected"
    with pytest.raises(rj.EncodeError, match="7 is above 5"):
        both.packed({"b": [2, 8, 10], "c": [1, 5, 0]})
    with pytest.raises(rj.DecodeError, match="different lengths"):
        both.unpacked({"b": [1], "c": [1, 5]})


@pytest.mark.parametrize("backend", ["llvm", "python", "interpreter"])
def test_what_is_known_of_elements_is_used_for_others(backend):
    """`.f[]` is known when `.a[]` is packed."""
    wire = '("a" (:list :double)) ("f" (:list :double))'
    both = Both(wire, "repeated double t = 1; repeated double f = 2;", ".f[] <-> .f[] * 2.0\n.t[] <-> .a[] * .f[]", backend)
    both.assert_message({"a": [1.5, 3.0], "f": [2.0, 4.0]}, {"t": [3.0, 12.0], "f": [4.0, 8.0]})
    assert both.packed({"t": [3.0, 12.0], "f": [4.0, 8.0]}) == {"a": [1.5, 3.0], "f": [2.0, 4.0]}
