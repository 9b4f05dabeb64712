"""Mappings that are right: the types that their rules get, and the coverage that is proven."""

from __future__ import annotations

from contextlib import suppress

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rosetta_jit.errors import MappingError
from rosetta_jit.frameworks.installed import Readers, installed
from rosetta_jit.language import typed
from rosetta_jit.language.check.mapping import Checked, check
from rosetta_jit.language.parse.mapping import parse
from rosetta_jit.model.types import Float, Int
from rosetta_jit.parsing.search import Reading, SearchPath
from rosetta_jit.source import Source
from tests.golden import GOLDEN

NAMES = ("types.proto", "wires.bottle-schema")
FILES = tuple((name, (GOLDEN / "mapping" / name).read_text()) for name in NAMES)
HEAD = "".join(f'import "{name}"\n' for name in NAMES)
FRONT_ENDS = Readers({name: installed()[name] for name in ("yarp", "protobuf")})


def checked(holder: str, wire: str, *rules: str, pack: tuple[str, ...] | None = None, reading: Reading | None = None) -> Checked:
    text = f"{HEAD}data-holder: {holder}\nwire-schema: {wire}\n"
    text += "unpack-rules:\n" + "\n".join(rules) if pack is None else "pack-rules:\n" + "\n".join(pack)
    return check(parse(Source("test.mapping", text)), FRONT_ENDS, SearchPath(files=FILES), reading)


def value(holder: str, wire: str, text: str) -> typed.Expr:
    (rule,) = checked(holder, wire, f".x = {text}").unpack or ()
    assert isinstance(rule, typed.Assign)
    return rule.value


def test_direct_copy_is_an_access() -> None:
    copied = value("t.Number", "w.int", ".x")
    assert isinstance(copied, typed.Access)
    assert copied.type == Int(32, spelling="int32")


@pytest.mark.parametrize(
    ("text", "rule"),
    [
        ("int32(.x)", "exact"),
        ("int32(.x, saturate)", "saturate"),
        ("int32(.x, wrap)", "wrap"),
    ],
)
def test_integer_conversions(text: str, rule: str) -> None:
    converted = value("t.Number", "w.long", text)
    assert isinstance(converted, typed.Convert)
    assert (converted.type, converted.rule) == (Int(32), rule)


@pytest.mark.parametrize(("text", "rule"), [("int32(.x)", "exact"), ("int32(.x, round)", "round"), ("int32(.x, truncate)", "truncate")])
def test_float_to_integer(text: str, rule: str) -> None:
    converted = value("t.Number", "w.double", text)
    assert isinstance(converted, typed.Convert)
    assert converted.rule == rule


def test_radians_are_computed_in_float64() -> None:
    converted = value("t.Real", "w.double", "float32(radians(.x))")
    assert isinstance(converted, typed.Convert)
    assert (converted.type, converted.rule) == (Float(32), "nearest")
    assert converted.operand.type == Float(64)


@pytest.mark.parametrize(
    ("text", "number"),
    [
        ("2 * 3 + 4", 10),
        ("8 / -2", -4),
        ("7 * -2 / 7", -2),
        ("floor_divide(7, -2)", -4),
        ("-7 % 3", -1),
        ("align(10, 8)", 16),
        ("align(10, 0)", 10),
        ("min(3, 1, 2)", 1),
        ("int8(300, saturate)", 127),
        ("int8(200, wrap)", -56),
        ("abs(-5)", 5),
        ("-2147483648", -2147483648),
    ],
)
def test_constants_fold(text: str, number: int) -> None:
    constant = value("t.Number", "w.int", text)
    assert isinstance(constant, typed.Const)
    assert constant.value == number


def test_operands_are_made_one_type() -> None:
    total = value("t.Real", "w.int", "float32(.x * 0.5)")
    assert isinstance(total, typed.Convert)
    product = total.operand
    assert isinstance(product, typed.Binary)
    assert product.left.type == product.right.type == Float(64)


def test_enum_constants_by_both_names() -> None:
    for name in ("t.Mode.Kind.BUSY", "t.Mode.BUSY"):
        (rule,) = checked("t.Mode", "w.int", f".kind = {name}").unpack or ()
        assert isinstance(rule, typed.Assign)
        assert isinstance(rule.value, typed.Const)
        assert rule.value.value == 1
    checked("t.Mode", "w.int", ".kind = t.Mode.Kind(.x)")
    checked("t.Mode", "w.int", pack=(".x = int32(.kind)",))


WHOLE = [
    ("t.Text", "w.text", (".x = .x",), None),
    ("t.Doubles", "w.list", (".a = .a",), None),
    ("t.Doubles", "w.fixed", (".a = .a",), None),
    ("t.Pose", "t.Pose", (".left = .left", ".right = .right"), None),
    ("t.Goal", "w.int", (".x = .x",), None),
    ("t.Goal", "w.int", (".x = .x", ".place = .x"), None),
    ("t.Goal", "w.int", (".x = .x", ".target.place = .x"), None),
    ("t.Pose", "w.pair", (".left.x = .left.x", ".right.x = .right.x"), None),
    ("t.Number", "w.order", (), (".x = .x", ".depth = 3")),
    ("t.Blob", "w.int", ("len(.data) = 2", ".data[0] = 1", ".data[1] = uint8(.x)"), None),
    ("t.Reals", "w.list", ("len(.a) = 0",), None),
]


@pytest.mark.parametrize(("holder", "wire", "rules", "pack"), WHOLE)
def test_accepted(holder: str, wire: str, rules: tuple[str, ...], pack: tuple[str, ...] | None) -> None:
    checked(holder, wire, *rules, pack=pack)


COVERED = {
    "constant indices": "len(.data) = 3 .data[2] = 0 .data[0] = 0 .data[1] = 0",
    "one loop": "len(.data) = .width for i from 0 to .width .data[i] = 0 end",
    "shifted loop": "len(.data) = .width for i from 1 to .width + 1 .data[i - 1] = 0 end",
    "reversed loop": "len(.data) = .width for i from 0 to .width .data[.width - 1 - i] = 0 end",
    "first element apart": "len(.data) = .width .data[0] = 0 for i from 1 to .width .data[i] = 0 end",
    "mixed radix": "len(.data) = .height * .width * 3 for y from 0 to .height for x from 0 to .width for c from 0 to 3"
    " .data[(y * .width + x) * 3 + c] = 0 end end end",
    "channels one by one": "len(.data) = .width * 3 for x from 0 to .width .data[x * 3 + 2] = 0 .data[x * 3] = 0 .data[x * 3 + 1] = 0 end",
    "planes": "len(.data) = 3 * .height * .width for c from 0 to 3 for y from 0 to .height for x from 0 to .width"
    " .data[(c * .height + y) * .width + x] = 0 end end end",
    "padded rows": "len(.data) = .height * align(.width * 3, .quantum) for y from 0 to .height"
    " for x from 0 to .width * 3 .data[y * align(.width * 3, .quantum) + x] = 0 end"
    " for x from .width * 3 to align(.width * 3, .quantum) .data[y * align(.width * 3, .quantum) + x] = 0 end end",
    "halves": "len(.data) = len(.pixels) / 2 * 2 for i from 0 to len(.pixels) / 2 .data[2 * i] = 0 .data[2 * i + 1] = 0 end",
    "window": "len(.data) = .height * .width for y from 0 to .height for i from y * .width to (y + 1) * .width .data[i] = 0 end end",
}


@pytest.mark.parametrize("rules", COVERED.values(), ids=COVERED.keys())
def test_covered(rules: str) -> None:
    checked("t.Blob", "w.image", rules)


UNCOVERED = {
    "one short": "len(.data) = .width for i from 0 to .width - 1 .data[i] = 0 end",
    "transposed stride": "len(.data) = .width * .height for y from 0 to .height for x from 0 to .width .data[y + x] = 0 end end",
    "triangle": "len(.data) = .width * .width for y from 0 to .width for x from 0 to y .data[y * .width + x] = 0 end end",
    "through a table": "len(.data) = .width for i from 0 to .width .data[.pixels[i]] = 0 end",
    "same diagonal twice": "len(.data) = .width * .width for i from 0 to .width for k from 0 to .width .data[i + i * .width] = 0 end end",
    "other blob": "len(.data) = .width for i from 0 to .height .data[i] = 0 end",
}


@pytest.mark.parametrize("rules", UNCOVERED.values(), ids=UNCOVERED.keys())
def test_not_covered(rules: str) -> None:
    with pytest.raises(MappingError):
        checked("t.Blob", "w.image", rules)


def test_arrays_of_structs_field_by_field() -> None:
    checked(
        "t.Arm",
        "w.arm",
        "len(.joints) = len(.joints)",
        "for i from 0 to len(.joints) .joints[i].name = .joints[i].name end",
        "for k from 1 to len(.joints) + 1 .joints[k - 1].value = .joints[k - 1].value end",
    )


def test_warnings_and_reading() -> None:
    reading = Reading()
    result = checked("t.Number", "t.Number", ".x = .x", reading=reading)
    assert [warning.code for warning in result.warnings] == ["import-unused"]
    assert [lookup.name for lookup in reading.lookups] == list(NAMES)


def test_exponential_loops_end_in_a_report() -> None:
    loops = [f"for i{n} from (i{n - 1} / 2) * (i{n - 1} / 3) to i{n - 1}" for n in range(1, 60)]
    with pytest.raises(MappingError):
        checked("t.Blob", "w.image", "len(.data) = 9 for i0 from 0 to 3", *loops, ".data[i59] = 0", "end " * 60)


def test_deep_loops_end_in_a_report() -> None:
    loops = [f"for i{n} from i{n - 1}{' / 2' * 50} to 3" for n in range(1, 60)]
    with pytest.raises(MappingError):
        checked("t.Blob", "w.image", "len(.data) = 9 for i0 from 0 to 3", *loops, ".data[i59] = 0", "end " * 60)


def test_deepest_expression() -> None:
    index = ".pixels[" * 30 + ".width" + "]" * 30
    checked("t.Number", "w.image", f".x = int32({index})")
    with pytest.raises(MappingError):
        checked("t.Blob", "w.image", f"len(.data) = {index} for i from 0 to {index} .data[{index} + i] = {index} end")


def test_many_constant_indices() -> None:
    rules = " ".join(f".data[{i}] = 0" for i in range(2000))
    checked("t.Blob", "w.image", f"len(.data) = 2000 {rules}")


PIECES = [".x", ".data", "len(.data)", ".data[0]", "=", "=", "1", "2.5", "i", ".width", ".pixels[i]", "+", "*", "(", ")", "int32("]
PIECES += ["for i from 0 to 3", "end", "t.Mode.BUSY", '"s"', "float32(", "/", "-", "align(", ","]


@settings(max_examples=150, deadline=None)
@given(st.lists(st.sampled_from(PIECES), max_size=12))
def test_soup(pieces: list[str]) -> None:
    with suppress(MappingError):
        checked("t.Blob", "w.image", " ".join(pieces))


EXPRESSIONS = st.recursive(
    st.sampled_from(["1", "0", "3.5", "i", ".width", ".pixels[i]", "len(.pixels)", "true", '"s"', "pi", "t.Mode.BUSY", ".pixels"]),
    lambda inner: st.one_of(
        st.tuples(inner, st.sampled_from("+-*/%"), inner).map(lambda parts: f"({' '.join(parts)})"),
        st.tuples(st.sampled_from(["int8", "uint64", "float32", "align", "min", "floor", "abs", "bool", "nil"]), inner, inner).map(
            lambda parts: f"{parts[0]}({parts[1]}, {parts[2]})"
        ),
        inner.map("-{}".format),
    ),
    max_leaves=12,
)


@settings(max_examples=150, deadline=None)
@given(EXPRESSIONS, EXPRESSIONS, EXPRESSIONS)
def test_any_expression(length: str, index: str, value: str) -> None:
    with suppress(MappingError):
        checked("t.Blob", "w.image", f"len(.data) = {length} for i from 0 to 3 .data[{index}] = {value} end")
