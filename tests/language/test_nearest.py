"""Integers that are computed in float64, and packed as the nearest one: every value of 8 and 16 bits comes back, and no other is taken."""

from __future__ import annotations

import random
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import rosetta_jit as rj
from tests.random_mappings.relations import FLOAT_STEPS

if TYPE_CHECKING:
    from collections.abc import Callable

RELATIONS: list[tuple[str, str, Callable[[Any], Any]]] = [
    ("{} * 0.01", "double", lambda v: v * 0.01),
    ("{} / 255.0", "double", lambda v: v / 255.0),
    ("radians({})", "double", lambda v: v * (np.pi / 180)),
    ("degrees({})", "double", lambda v: v * (180 / np.pi)),
    ("{} / 10000000.0", "double", lambda v: v / 1e7),
    ("{} / 1e7", "double", lambda v: v / 1e7),
    ("{} * 1e-7", "double", lambda v: v * 1e-7),
    ("{} / 1000.0", "double", lambda v: v / 1000.0),
    ("{} + 1234567890.0", "double", lambda v: v + 1234567890.0),
    ("{} - 0.1", "double", lambda v: v - 0.1),
    ("273.15 - {}", "double", lambda v: 273.15 - v),
    ("{} * 0.1 + 273.15", "double", lambda v: v * 0.1 + 273.15),
    ("({} - 100.5) / 3.0", "double", lambda v: (v - 100.5) / 3.0),
    ("({} + 40.0) * 9.0 / 5.0 - 32.0", "double", lambda v: (v + 40.0) * 9.0 / 5.0 - 32.0),
    ("radians({} * 0.01)", "double", lambda v: v * 0.01 * (np.pi / 180)),
    ("degrees({} / 1000.0) + 0.5", "double", lambda v: v / 1000.0 * (180 / np.pi) + 0.5),
    ("-({} * 0.3)", "double", lambda v: -(v * 0.3)),
    ("{} * pi / 4096", "double", lambda v: v * np.pi / 4096),
    ("divide({}, 3.0)", "double", lambda v: v / 3.0),
    ("float64({}) / 3", "double", lambda v: v / 3.0),
    ("{} * scale", "double", lambda v: v * 0.007),
    ("{} * scales[1]", "double", lambda v: v * 1e-3),
    ("{} * 0.5", "double", lambda v: v * 0.5),
    ("float32({} * 0.01)", "float", lambda v: np.float32(v * 0.01)),
    ("float32({} / 255.0)", "float", lambda v: np.float32(v / 255.0)),
    ("float32(radians({}))", "float", lambda v: np.float32(v * (np.pi / 180))),
    ("float32(radians({} * 0.1) - 1.5)", "float", lambda v: np.float32(v * 0.1 * (np.pi / 180) - 1.5)),
    ("float32({}) / float32(255.0)", "float", lambda v: np.float32(v) / np.float32(255.0)),
    ("float32({}) * 2.5", "float", lambda v: np.float32(v) * np.float32(2.5)),
    ("float32({} * scale)", "float", lambda v: np.float32(v * 0.007)),
]
"""Relations of a field `{}`, the holder's type, and what they mean in numpy, of float64."""

NARROW = ["uint8", "int8", "uint16", "int16"]
GIVEN = {"parameters": {"scale": 0.007, "scales": [2.0, 1e-3]}}


def files(wire: str, relations: list[tuple[str, str, Any]]) -> dict[str, str]:
    """Messages of one field a relation, which are called `f0`, `f1` and so on in both."""
    names = [f"f{number}" for number in range(len(relations))]
    fields = "".join(
        f"required {kind} {name} = {number + 1}; " for number, (name, (_, kind, _)) in enumerate(zip(names, relations, strict=True))
    )
    rules = "".join(f"  .{name} <-> {text.format(f'.{name}')}\n" for name, (text, _, _) in zip(names, relations, strict=True))
    head = 'import "p/W.msg"\nimport "h.proto"\nparameter scale: float64\nparameter scales: list of float64\n'
    return {
        "p/W.msg": "".join(f"{wire} {name}\n" for name in names),
        "h.proto": f'syntax = "proto2"; message H {{ {fields} }}',
        "m.mapping": f"{head}data-holder: H\nwire-schema: p/W\nrules:\n{rules}",
    }


def programs(wire: str, relations: list[tuple[str, str, Any]] = RELATIONS, backend: str = "llvm") -> tuple[Any, Any]:
    options: dict[str, Any] = {"schema": files(wire, relations), "encoding": "ros1", "backend": backend, **GIVEN}
    return rj.Decoder("m.mapping", **options), rj.Encoder("m.mapping", **options)


def all_of(wire: str) -> np.ndarray:
    """Every value of a type."""
    info = np.iinfo(wire)
    return np.arange(info.min, info.max + 1).astype(np.dtype(wire).newbyteorder("<"))


def assert_all_come_back(wire: str, relations: list[tuple[str, str, Any]], values: np.ndarray) -> None:
    """What is decoded is what numpy computes, nothing of it is refused, and all comes back: as the law says."""
    decode, encode = programs(wire, relations)
    assert str(decode.mapping.laws.messages) == "exact inverse"
    messages = np.repeat(values[:, None], len(relations), axis=1)
    data = messages.tobytes()
    with np.errstate(all="ignore"):
        batch = decode.many(data, np.arange(len(messages) + 1) * messages.itemsize * len(relations))
        for number, (text, _, function) in enumerate(relations):
            found = getattr(batch, f"f{number}")
            assert np.array_equal(found, function(values.astype(np.float64)).astype(found.dtype)), text
    assert encode.many(batch)[0].tobytes() == data


@pytest.mark.parametrize("wire", NARROW)
def test_every_integer_comes_back(wire):
    assert_all_come_back(wire, RELATIONS, all_of(wire))
    assert str(programs(wire)[0].mapping.laws.holders) == "exact inverse"


@pytest.mark.parametrize("backend", ["llvm", "python", "interpreter"])
def test_backends_agree(backend):
    decode, encode = programs("int8", backend=backend)
    for value in all_of("int8")[::17]:
        message = value.tobytes() * len(RELATIONS)
        assert encode(decode(message)) == message


@pytest.mark.parametrize("backend", ["llvm", "python"])
@pytest.mark.parametrize("relation", [0, 1, 2, 23], ids=lambda number: RELATIONS[number][0])
def test_what_no_integer_unpacks_to_is_refused(relation, backend):
    """The floats beside those that are decoded, what lies beyond the integers, infinities and NaN."""
    decode, encode = programs("uint8", [RELATIONS[relation]], backend)
    holder = encode.holder_type()
    kind = np.float32 if RELATIONS[relation][1] == "float" else np.float64
    decoded = [kind(decode(bytes([value])).f0) for value in range(256)]
    step = decoded[1]
    beside = [np.nextafter(value, kind(end)) for value in decoded[1::50] for end in (-np.inf, np.inf)]
    for value in [*beside, step * kind(0.4), step * kind(256), -step, kind(np.nan), kind(np.inf), kind(-np.inf), kind(1e30)]:
        holder.f0 = value
        with pytest.raises(rj.EncodeError) as error:
            encode(holder)
        assert (error.value.kind, error.value.path) == ("range", ".f0")
    holder.f0 = -0.0  # an integer has no sign of zero
    assert encode(holder) == b"\0"


WIDE = [
    ("uint32", "{} / 1e7", "double", "exact"),
    ("int32", "radians({})", "double", "exact"),
    ("int32", "{} * 0.1 + 273.15", "double", "exact"),
    ("int32", "float32({} * 0.01)", "float", "lossy"),
    ("uint32", "float32({})", "float", "lossy"),
    ("int32", "float32({} / 1e7)", "float", "lossy"),
    ("int64", "float64({}) * 0.01", "double", "lossy"),
    ("int64", "float64({}) / 1e9", "double", "lossy"),
    ("uint64", "float64({})", "double", "lossy"),
    ("uint8", "{} + 1e17", "double", "lossy"),
    ("uint8", "float32({} * 1e37)", "float", "lossy"),
    ("int16", "float32({} + 1234567890.0)", "float", "lossy"),
]
"""Integers of more bits, and constants beside which floats do not hold them."""


@pytest.mark.parametrize(("wire", "text", "kind", "law"), WIDE)
def test_laws_say_which_integers_are_too_large(wire, text, kind, law):
    decode, encode = programs(wire, [(text, kind, None)])
    assert (decode.mapping.laws.messages.kind, decode.mapping.laws.holders.kind) == (law, "exact")
    info, rng = np.iinfo(wire), np.random.default_rng(1)
    values = rng.integers(info.min, info.max, 3000, dtype=wire, endpoint=True)
    edges = np.array([info.min, info.min + 1, 0, 1, info.max - 1, info.max], wire)
    for value in [*edges, *values]:
        message = value.tobytes()
        try:
            back = encode(decode(message))
        except rj.EncodeError:
            assert law == "lossy", value
        else:
            assert back == message or law == "lossy", value


def test_elements_and_choices_come_back():
    texts = {
        "p/W.msg": "int16[] raw\nuint8 mode\nint16 level\nint16 other\nfloat64 x\n",
        "h.proto": """syntax = "proto2"; message H { repeated double raw = 1; required uint32 mode = 2; required double level = 3;
required double other = 4; required double x = 5; }""",
        "m.mapping": """import "p/W.msg"
import "h.proto"
data-holder: H
wire-schema: p/W
rules:
  .raw[] <-> .raw[] * 0.01
  .mode <-> .mode
  .level <-> .level * 0.001 if .mode == 1 else radians(.level)
  when .mode > 7
    .other <-> .other / 3.0
  else
    .other <-> .other * 0.7
  end
  .x <-> .x
""",
    }
    decode, encode = (make("m.mapping", schema=texts, encoding="ros1") for make in (rj.Decoder, rj.Encoder))
    write = rj.Encoder.of("p/W", schema=texts, imports=["p/W.msg"], encoding="ros1")
    assert [loss.place for loss in decode.mapping.laws.messages.losses] == [".level"]  # of choices it is not shown
    rng = np.random.default_rng(2)
    for mode in (0, 1, 8):
        for _ in range(50):
            raw = rng.integers(-(2**15), 2**15, 5)
            level, other = (int(each) for each in rng.integers(-(2**15), 2**15, 2))
            message = write(write.holder_type.from_dict({"raw": raw, "mode": mode, "level": level, "other": other, "x": 0.1}))
            assert encode(decode(message)) == message


def test_a_condition_on_what_was_computed_sees_the_nearest_integer():
    """Packing decides by the integer that it writes, not by what its float is off."""
    texts = {
        "p/W.msg": "uint16 raw\nint32 n\n",
        "h.proto": 'syntax = "proto2"; message H { required double raw = 1; required int32 n = 2; }',
        "m.mapping": """import "p/W.msg"
import "h.proto"
data-holder: H
wire-schema: p/W
rules:
  .raw <-> .raw * 0.01
  when .raw % 2 == 0
    .n <-> .n
  else
    .n <-> -.n
  end
""",
    }
    texts["m.mapping"] = texts["m.mapping"].replace("<-> -.n", "<-> int32(-.n)")
    decode, encode = (make("m.mapping", schema=texts, encoding="ros1") for make in (rj.Decoder, rj.Encoder))
    for value in range(0, 2**16, 97):
        message = np.uint16(value).tobytes() + np.int32(-7).tobytes()
        assert encode(decode(message)) == message
    assert decode.mapping.laws.messages.kind == "exact"


# --- random relations ------------------------------------------------------------------------------------------------------

CONSTANTS = [0.01, 255.0, 0.1, 1e7, -2.5, 0.5, 273.15, 1234567890.0, 1e-7, 1 / 3, 7e8, -1e-3, 2.0**-20, 1e12]


def some_relation(rng: random.Random) -> tuple[str, str, Callable[[Any], Any]]:
    """Steps by constants, an angle now and then, into a holder of either type."""
    text, steps, kind = "{}", [], rng.choice(["double", "float"])
    for number in range(rng.randrange(1, 5)):
        constant, (template, step) = rng.choice(CONSTANTS), rng.choice(FLOAT_STEPS if number else FLOAT_STEPS[:-1])
        text = template.format(text, f"({constant!r})")
        steps.append((step, constant))
    if rng.random() < 0.25:
        name, factor = rng.choice([("radians", np.pi / 180), ("degrees", 180 / np.pi)])
        text = f"{name}({text})"
        steps.append((lambda value, constant: value * constant, factor))

    def run(value: Any) -> Any:
        for step, constant in steps:
            value = step(value, constant)
        return value

    return (f"float32({text})" if kind == "float" else text), kind, run


@pytest.mark.campaign
@pytest.mark.parametrize("seed", range(60))
def test_campaign(seed):
    rng = random.Random(f"nearest {seed}")
    wire = rng.choice([*NARROW, "int32", "uint32"])
    relations = [some_relation(rng) for _ in range(40)]
    lossy = {loss.place for loss in programs(wire, relations, "interpreter")[0].mapping.laws.messages.losses}
    kept = [each for number, each in enumerate(relations) if f".f{number}" not in lossy]
    info = np.iinfo(wire)
    some = np.random.default_rng(seed).integers(info.min, info.max, 10_000, wire, endpoint=True)
    values = all_of(wire) if wire in NARROW else np.concatenate([some, np.array([info.min, 0, 1, info.max], wire)])
    assert_all_come_back(wire, kept, values)
