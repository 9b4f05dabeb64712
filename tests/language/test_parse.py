"""The mapping language: what its texts mean, and that no text does harm."""

from __future__ import annotations

import time
from contextlib import suppress

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rosetta_jit.errors import MappingError
from rosetta_jit.language.parse.mapping import parse
from rosetta_jit.model.expr import Binary, Call, Index, Len, Literal, Member, Name, Path, Unary
from rosetta_jit.model.mapping import Assign, For, Import, SetLength
from rosetta_jit.source import Source

HEAD = "data-holder: a.B\nwire-schema: c.d\n"

LISTING = """\
import "rst/kinematics/JointAngles.proto"
import "bottle-structure-icub-torso-command.bottle-schema"
data-holder: rst.kinematics.JointAngles
wire-schema: yarp.icub.torso.command
unpack-rules:
  len(.angles) = 3
  .angles[0] = .angles.a0
  .angles[1] = .angles.a1
"""


def unpack(*rules: str) -> tuple[object, ...]:
    return parse(Source("test", f"{HEAD}unpack-rules:\n" + "\n".join(rules))).unpack_rules or ()


def value(text: str) -> object:
    (rule,) = unpack(f".x = {text}")
    assert isinstance(rule, Assign)
    return rule.value


def wire(*steps: Member | Index) -> Path:
    return Path("wire", steps)


def test_listing_of_the_paper() -> None:
    mapping = parse(Source("torso.mapping", LISTING))
    assert mapping.imports[0].path == "rst/kinematics/JointAngles.proto"
    assert (mapping.holder_type, mapping.wire_type) == ("rst.kinematics.JointAngles", "yarp.icub.torso.command")
    assert mapping.pack_rules is None
    length, first, second = mapping.unpack_rules or ()
    assert length == SetLength(Path("holder", (Member("angles"),)), Literal(3))
    assert first == Assign(Path("holder", (Member("angles"), Index(Literal(0)))), wire(Member("angles"), Member("a0")))
    assert isinstance(second, Assign)
    assert second.value == wire(Member("angles"), Member("a1"))


def test_blocks_in_any_order_and_empty() -> None:
    mapping = parse(Source("test", 'pack-rules:\n wire-schema: "odd name" data-holder: a import "x.proto" # end'))
    assert mapping.pack_rules == ()
    assert mapping.unpack_rules is None
    assert mapping.wire_type == "odd name"
    assert mapping.imports == (Import("x.proto"),)


def test_sides_follow_position() -> None:
    text = f"{HEAD}pack-rules: .a[.n] = .b[len(.c)]"
    (rule,) = parse(Source("test", text)).pack_rules or ()
    read = Path("holder", (Member("b"), Index(Len(Path("holder", (Member("c"),))))))
    assert rule == Assign(Path("wire", (Member("a"), Index(Path("holder", (Member("n"),))))), read)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("0x1F", Literal(31)),
        ("1.5e3", Literal(1500.0)),
        ("2e-1", Literal(0.2)),
        ("true", Literal(value=True)),
        (r'"a\"\n"', Literal('a"\n')),
        ("rst.Enum.X", Name("rst.Enum.X")),
        ("-i", Unary("-", Name("i"))),
        ("1 - 2 - 3", Binary("-", Binary("-", Literal(1), Literal(2)), Literal(3))),
        ("1 + 2 % 3", Binary("+", Literal(1), Binary("%", Literal(2), Literal(3)))),
        ("(1 + 2) / 3", Binary("/", Binary("+", Literal(1), Literal(2)), Literal(3))),
        ("align(.w, 8)", Call("align", (wire(Member("w")), Literal(8)))),
        ('."odd name".end', wire(Member("odd name"), Member("end"))),
        ("f()", Call("f", ())),
    ],
)
def test_expressions(text: str, expected: object) -> None:
    assert value(text) == expected


def test_rules_need_no_separator() -> None:
    rules = unpack(".a = .b .c = .d[0] for i from 0 to n .e[i] = 1 end len(.f) = 2")
    assert [type(rule) for rule in rules] == [Assign, Assign, For, SetLength]


def test_spans_cover_what_was_written() -> None:
    source = Source("test", f"{HEAD}unpack-rules:\n  .x = (.a + 1) * 2\n")
    (rule,) = parse(source).unpack_rules or ()
    assert rule.span is not None
    assert source.text[rule.span.start : rule.span.end] == ".x = (.a + 1) * 2"


@pytest.mark.parametrize(
    "rule",
    [
        ".x = " + "(" * 100_000,
        ".x = " + "(" * 50_000 + "1" + ")" * 50_000,
        ".x = " + "-" * 100_000 + "1",
        ".x = " + "1+" * 50_000 + "1",
        ".x = " + "f(" * 50_000,
        "for i from 0 to 1 " * 10_000,
        ".a" * 50_000 + " = 1",
        ".x = 9" + "9" * 100_000,
        '.x = "' + "a" * 100_000,
        ".x = .y\n $" * 20_000,
        "end " * 20_000,
    ],
    ids=lambda rule: rule[:20],
)
def test_bombs_end_in_a_report(rule: str) -> None:
    start = time.process_time()
    with pytest.raises(MappingError):
        unpack(rule)
    assert time.process_time() - start < 30


WORDS = ["import", "data-holder:", "wire-schema:", "unpack-rules:", "pack-rules:", "for", "from", "to", "end", "len", "true"]
WORDS += [".a", ".b.c", "[", "]", "(", ")", "=", "+", "-", "*", "/", "%", ",", "1", "0x", "1.5", '"s"', '"', "i", "x.y", "$", "\n", ":"]


@settings(max_examples=300, deadline=None)
@given(st.lists(st.sampled_from(WORDS), max_size=40), st.booleans())
def test_token_soup(words: list[str], headed: bool) -> None:
    text = (f"{HEAD}unpack-rules:\n" if headed else "") + " ".join(words)
    with suppress(MappingError):
        parse(Source("soup", text))


@settings(max_examples=200, deadline=None)
@given(st.text(max_size=60))
def test_any_text(text: str) -> None:
    with suppress(MappingError):
        parse(Source("text", f"{HEAD}unpack-rules:\n{text}"))


@pytest.mark.parametrize("name", ["rst.vision.Image", "sensor_msgs/Image", "sensor_msgs/msg/Image", "RTC::TimedDouble"])
def test_names_of_types(name):
    text = f"data-holder: {name}\nwire-schema: {name}\nunpack-rules:\n  .a = .b / 2\n"
    mapping = parse(Source("test", text))
    assert (mapping.holder_type, mapping.wire_type) == (name, name)
    assert mapping.wire_span is not None
    assert text[mapping.wire_span.start : mapping.wire_span.end] == name
