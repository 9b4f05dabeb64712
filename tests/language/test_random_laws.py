"""Random types, rules and values: each law that a mapping has is what comes back."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import rosetta_jit as rj
from tests.language.test_laws import files

if TYPE_CHECKING:
    from collections.abc import Callable

    from rosetta_jit.language.laws.chain import Rounding

COLOURS = {"mono8": "GRAY", "rgb8": "RGB", "bgr8": "BGR", "8UC1": "GRAY"}


@dataclass
class Part:
    """A field of each side, the relation between them, and what it means in numpy."""

    wire: str
    holder: str
    rule: str
    unpack: Callable[[Any], Any]
    wires: st.SearchStrategy[Any]
    holders: st.SearchStrategy[Any]


DOUBLES = st.floats(-1e6, 1e6) | st.sampled_from([0.0, -0.0, 1e-9, 273.15, 1e30, -1e30])
SINGLES = DOUBLES.map(lambda value: float(np.float32(value)))
CONSTANTS = st.sampled_from([0.1, 3.0, 273.15, -2.5, 1000.0, 1e-3])
STEPS: list[tuple[str, Callable[[Any, float], Any]]] = [
    ("({0} + {1})", lambda x, c: x + c),
    ("({0} - {1})", lambda x, c: x - c),
    ("({1} - {0})", lambda x, c: c - x),
    ("({0} * {1})", lambda x, c: x * c),
    ("({0} / {1})", lambda x, c: x / c),
    ("radians({0})", lambda x, _: np.float64(x) * (np.pi / 180)),
    ("degrees({0})", lambda x, _: np.float64(x) * (180 / np.pi)),
    ("(-{0})", lambda x, _: -x),
    ("divide({0}, {1})", lambda x, c: x / c),
]


def is_measured(steps: list[Any]) -> bool:
    """Angles are converted once: what is in radians is no argument of `radians`."""
    return sum(template.endswith("s({0})") for template, _ in steps) < 2


@st.composite
def floats(draw: st.DrawFn) -> Part:
    wire_single, holder_single = draw(st.booleans()), draw(st.booleans())
    text, functions = ".NAME", []
    for template, function in draw(st.lists(st.sampled_from(STEPS), max_size=3).filter(is_measured)):
        constant = draw(CONSTANTS)
        text = template.format(text, repr(constant))
        functions.append((function, constant if "{1}" in template else 0.0))

    def unpack(value: Any) -> Any:
        number: Any = np.float32(value) if wire_single else np.float64(value)
        with np.errstate(all="ignore"):
            for function, constant in functions:
                is_single = isinstance(number, np.float32) and np.float32(constant) == np.float64(constant)
                kind = np.float32 if is_single else np.float64
                number = function(kind(number), kind(constant))
            return float(np.float32(number)) if holder_single else float(number)

    rule = f".NAME <-> float32({text})" if holder_single else f".NAME <-> {text}"
    kinds = ":float32" if wire_single else ":double", "float" if holder_single else "double"
    return Part(kinds[0], f"required {kinds[1]}", rule, unpack, SINGLES if wire_single else DOUBLES, SINGLES if holder_single else DOUBLES)


@st.composite
def integers(draw: st.DrawFn) -> Part:
    number = draw(st.integers(-1000, 1000).filter(bool))
    shown = str(number) if number > 0 else f"({number})"
    rules: list[tuple[str, Callable[[int], int]]] = [
        (".NAME", lambda x: x),
        (f".NAME + {shown}", lambda x: x + number),
        (f"{shown} - .NAME", lambda x: number - x),
        (f".NAME * {shown}", lambda x: x * number),
        (f"(.NAME ^ {shown}) + 1", lambda x: (x ^ number) + 1),
        (f"-(.NAME * {shown}) - 3", lambda x: -(x * number) - 3),
    ]
    text, unpack = draw(st.sampled_from(rules))
    values = st.integers(-(2**31), 2**31 - 1)
    return Part(":int", "required int64", f".NAME <-> {text}", unpack, values, values)


@st.composite
def tables(draw: st.DrawFn) -> Part:
    keys = draw(st.lists(st.sampled_from(sorted(COLOURS)), min_size=1, unique=True))
    rest = draw(st.booleans())
    entries = [f'"{key}" = h.Mode.{COLOURS[key]}' for key in keys] + (["otherwise h.Mode.GRAY"] if rest else [])
    names = sorted({COLOURS[key] for key in keys})
    wires = st.sampled_from([*keys, "jpeg"] if rest else keys)
    rule = f".NAME <-> table(.NAME) {{ {', '.join(entries)} }}"
    return Part(
        ":string", "required h.Mode", rule, lambda key: COLOURS.get(key, "GRAY") if key in keys else "GRAY", wires, st.sampled_from(names)
    )


@st.composite
def permutations(draw: st.DrawFn) -> Part:
    order = draw(st.permutations(range(draw(st.integers(1, 5)))))
    size = len(order)
    rules = [f"len(.NAME) <-> {size}", *(f".NAME[{to}] <-> .NAME[{origin}]" for to, origin in enumerate(order))]
    values = st.lists(DOUBLES, min_size=size, max_size=size)
    kind = f"(:list :double (:length {size}))"
    return Part(kind, "repeated double", "\n  ".join(rules), lambda value: [value[origin] for origin in order], values, values)


@st.composite
def orders(draw: st.DrawFn) -> Part:
    size = draw(st.integers(1, 4))
    order = draw(st.permutations(range(size)))
    groups = st.lists(st.lists(DOUBLES, min_size=size, max_size=size), max_size=3).map(
        lambda found: [each for some in found for each in some]
    )

    def permuted(value: Any) -> Any:
        return [value[at + origin] for at in range(0, len(value), size) for origin in order]

    def moved(shape: tuple[int, ...], axes: tuple[int, ...]) -> Callable[[Any], Any]:
        return lambda value: np.array(value).reshape(shape).transpose(axes).ravel().tolist()

    rows, columns, part = (draw(st.integers(1, 4)) for _ in range(3))
    fixed = st.lists(DOUBLES, min_size=rows * columns * part, max_size=rows * columns * part)
    shape = draw(st.sampled_from(["", "transposed", "planar", "interleaved", "turned"]))
    pixels, planes = moved((-1, columns, part), (1, 0, 2)), moved((columns, -1, part), (1, 0, 2))
    shaped: dict[str, tuple[str, Any]] = {
        "transposed": (f"transposed(.NAME, {rows}, {columns}, {part})", moved((rows, columns, part), (1, 0, 2))),
        "planar": (f"planar(.NAME, {columns}, {part})", lambda value: pixels(value) if value else []),
        "interleaved": (f"interleaved(.NAME, {columns}, {part})", lambda value: planes(value) if value else []),
        "turned": (f"reversed(planar(.NAME, {columns}, {part}))", lambda value: pixels(value)[::-1] if value else []),
    }
    if shape:
        text, function = shaped[shape]
        values = fixed if shape == "transposed" else fixed | st.just([])
        return Part("(:list :double)", "repeated double", f".NAME <-> {text}", function, values, values)

    rule, unpack = draw(
        st.sampled_from(
            [
                ("reversed(.NAME)", lambda value: value[::-1]),
                (
                    f"reversed(.NAME, {size})",
                    lambda value: [each for at in range(0, len(value), size) for each in value[at : at + size][::-1]],
                ),
                (f"permuted(.NAME, {list(order)})", permuted),
            ]
        )
    )
    return Part("(:list :double)", "repeated double", f".NAME <-> {rule}", unpack, groups, groups)


SHORT = st.text("ab,é", max_size=6)
NUMBERS = st.integers(-(2**63), 2**63 - 1)
SPELT = NUMBERS.map(str) | st.sampled_from(["007", "-0", "+5"])
TEXTS: list[tuple[str, str, str, Callable[[Any], Any], Any, Any]] = [
    (":int64", "int64", "text(.NAME)", str, NUMBERS, SPELT),
    (":int64", "int64", "text(.NAME - 1)", lambda x: str(x - 1), NUMBERS.filter(lambda x: x > -(2**63)), SPELT),
    (":double", "double", "text(.NAME)", repr, DOUBLES, DOUBLES.map(repr) | SPELT),
    (":string", "int64", "integer(.NAME)", int, SPELT, NUMBERS),
    (":string", "double", "number(.NAME)", float, SPELT | DOUBLES.map(repr), DOUBLES),
    (":string", "string", '"ab" + .NAME', lambda x: f"ab{x}", SHORT, SHORT | SHORT.map(lambda x: f"ab{x}")),
    (":string", "string", '"a" + .NAME + ","', lambda x: f"a{x},", SHORT, SHORT.map(lambda x: f"a{x},")),
    (":string", "string", 'behind(.NAME, "é")', lambda x: x[1:], SHORT.map(lambda x: f"é{x}"), SHORT),
    (":blob", "string", 'text(.NAME, "latin-1")', lambda x: bytes(x).decode("latin-1"), st.binary(max_size=6), SHORT),
    (":string", "bytes", 'bytes(.NAME, "utf-16be")', lambda x: x.encode("utf-16be"), SHORT, st.binary(max_size=6)),
    ("(:list :string)", "string", 'join(.NAME, ",")', ",".join, st.lists(st.text("abé", max_size=3), min_size=2), SHORT),
    (":string", "strings", 'split(.NAME, "ab")', lambda x: x.split("ab") if x else [], SHORT, st.lists(SHORT, max_size=4)),
]
"""What the wire has, what the holder has, the value, what it means in Python, and values of both."""


@st.composite
def wordings(draw: st.DrawFn) -> Part:
    wire, kind, value, unpack, wires, holders = draw(st.sampled_from(TEXTS))
    is_written = value.startswith("text(") and "latin" not in value
    holder = "repeated string" if kind == "strings" else "required string" if is_written else f"required {kind}"
    return Part(wire, holder, f".NAME <-> {value}", unpack, wires, holders)


UNITS = {("mm", "m"): 0.001, ("degree", "radian"): np.pi / 180, ("km", "m"): 1000.0}


def is_near(back: float, value: float, rounding: Rounding) -> bool:
    """What a law promises of one number."""
    if abs(value) > rounding.limit:
        return True
    kind = np.float32 if rounding.bits == 32 else np.float64
    spacing = float(np.spacing(kind(max(abs(value), rounding.floor))))
    return abs(back - value) <= rounding.ulp * spacing


def assert_law(law: Any, values: dict[str, Any], back: dict[str, Any]) -> None:
    lost = {loss.place.split("[")[0] for loss in law.losses}
    rounded = dict(law.rounded)
    for name, value in values.items():
        place = f".{name}"
        if place in lost or "" in lost:
            continue
        if place in rounded:
            assert is_near(back[name], value, rounded[place]), (name, value, back[name], rounded[place])
        else:
            assert back[name] == value, (name, value, back[name])


def meant(part: Part, value: Any) -> Any:
    """What a field is to become; numbers are compared without their types."""
    found = part.unpack(value)
    return pytest.approx(found, rel=0, abs=0) if part.wire in {":double", ":float32", ":int"} and not isinstance(found, str) else found


@settings(max_examples=25, deadline=None)
@given(data=st.data())
def test_laws_hold(data):
    made = data.draw(
        st.lists(
            st.one_of(floats(), floats(), integers(), tables(), permutations(), orders(), wordings(), wordings()), min_size=1, max_size=5
        )
    )
    parts = {f"f{number}": part for number, part in enumerate(made)}
    texts = files(
        " ".join(f'("{name}" {part.wire})' for name, part in parts.items()),
        " ".join(f"{part.holder} {name} = {number + 1};" for number, (name, part) in enumerate(parts.items())),
        "rules:\n" + "".join(f"  {part.rule.replace('NAME', name)}\n" for name, part in parts.items()),
    )
    options: dict[str, Any] = {"schema": texts, "encoding": "yarp3", "backend": "python"}
    decode, encode = rj.Decoder("m.mapping", **options), rj.Encoder("m.mapping", **options)
    own: dict[str, Any] = {**options, "imports": ["wire.bottle-schema"]}
    read, write = rj.Decoder.of("wire", **own), rj.Encoder.of("wire", **own)
    found = decode.mapping.laws

    for _ in range(5):
        values = {name: data.draw(part.wires) for name, part in parts.items()}
        message = write(write.holder_type.from_dict(values))
        held = decode(message).to_dict()
        assert held == {name: meant(part, values[name]) for name, part in parts.items()}
        try:
            back = read(encode(encode.holder_type.from_dict(held))).to_dict()
        except rj.EncodeError:
            continue
        assert_law(found.messages, values, back)
    for _ in range(5):
        held = {name: data.draw(part.holders) for name, part in parts.items()}
        try:
            message = encode(encode.holder_type.from_dict(held))
            back = decode(message).to_dict()
        except (rj.EncodeError, rj.DecodeError):
            continue
        assert_law(found.holders, held, back)


@pytest.mark.parametrize("units", UNITS)
@settings(max_examples=10, deadline=None)
@given(values=st.lists(DOUBLES, min_size=1, max_size=10))
def test_units_come_back_as_their_law_says(units, values):
    texts = {
        "w.bottle-schema": f'"w" (("x" :double (:unit :{units[0]})))',
        "h.bottle-schema": f'"h" (("x" :double (:unit :{units[1]})))',
        "m.mapping": 'import "w.bottle-schema"\nimport "h.bottle-schema"\ndata-holder: h\nwire-schema: w\nrules:\n  .x <-> .x\n',
    }
    options: dict[str, Any] = {"schema": texts, "encoding": "yarp3", "backend": "python"}
    decode, encode = rj.Decoder("m.mapping", **options), rj.Encoder("m.mapping", **options)
    read = rj.Decoder.of("w", **{**options, "imports": ["w.bottle-schema"]})
    write = rj.Encoder.of("w", **{**options, "imports": ["w.bottle-schema"]})
    found = decode.mapping.laws
    assert (found.messages.kind, found.holders.kind) == ("rounded", "rounded")
    for value in values:
        held = decode(write(write.holder_type.from_dict({"x": value}))).x
        assert held == pytest.approx(value * UNITS[units], rel=1e-15)
        assert_law(found.messages, {"x": value}, read(encode(encode.holder_type.from_dict({"x": held}))).to_dict())
