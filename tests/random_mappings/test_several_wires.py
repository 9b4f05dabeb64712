"""Random rules over several wires: each message fills of the holder what plain Python fills, in whichever order they come."""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import pytest

import rosetta_jit as rj
from tests.random_mappings.meaning import TEXTS
from tests.random_mappings.values import quoted

WIRES = ("left", "right", "base")
MESSAGES = 40
FIELDS = {"s": "string", "t": "string", "x": "float64", "n": "int32", "v": "float64[]"}
Last = dict[str, dict[str, Any]]


@dataclass
class Filled:
    """A field of the holder: its type, its rules, the wires whose messages set it, those that it waits for, and what it then is."""

    type: str
    rules: str
    at: frozenset[str]
    waits: frozenset[str]
    value: Callable[[Last], Any]
    before: Any
    """What it is until then."""


def number(rng: random.Random, wire: str) -> tuple[str, Callable[[Last], float]]:
    name, factor = rng.choice(["x", "n"]), rng.choice([0.5, -2.0, 3.25])
    return f".{wire}.{name} * {factor}", lambda last: last[wire][name] * factor


def numbers(rng: random.Random, name: str) -> Filled:
    """A number of one wire or several, perhaps one of two that asks whether another wire has sent."""
    wires = rng.sample(WIRES, rng.randrange(1, 4))
    parts = [number(rng, wire) for wire in wires]
    text = " + ".join(shown for shown, _ in parts)

    def value(last: Last) -> float:
        total = parts[0][1](last)
        for _, each in parts[1:]:
            total = total + each(last)
        return total

    if rng.random() < 0.7:
        return Filled("float64", f".{name} = {text}", frozenset(wires), frozenset(wires), value, 0.0)
    asked = rng.choice(WIRES)
    rule = f".{name} = {text} if has(.{asked}) else -1.0"
    waits = frozenset(wires) - {asked}
    return Filled("float64", rule, frozenset(WIRES), waits, lambda last: value(last) if asked in last else -1.0, 0.0)


def arrivals(rng: random.Random, name: str) -> Filled:
    """Whether a wire has sent anything."""
    asked = rng.choice(WIRES)
    return Filled("bool", f".{name} = has(.{asked})", frozenset(WIRES), frozenset(), lambda last: asked in last, before=False)


def text(rng: random.Random, wire: str) -> tuple[str, Callable[[Last], str]]:
    """A text that one wire makes."""
    field, quote = rng.choice(["s", "t"]), rng.choice(TEXTS)
    forms: list[tuple[str, Callable[[Last], str]]] = [
        (f".{wire}.{field}", lambda last: last[wire][field]),
        (f".{wire}.{field} + {quoted(quote)}", lambda last: last[wire][field] + quote),
        (f'text(.{wire}.n) + ":" + .{wire}.{field}', lambda last: f"{last[wire]['n']}:{last[wire][field]}"),
        (f'replace(.{wire}.{field}, "a", "{wire}")', lambda last: last[wire][field].replace("a", wire)),
    ]
    return rng.choice(forms)


def texts(rng: random.Random, name: str) -> Filled:
    wire = rng.choice(WIRES)
    shown, value = text(rng, wire)
    return Filled("string", f".{name} = {shown}", frozenset((wire,)), frozenset((wire,)), value, "")


def arrays(rng: random.Random, name: str) -> Filled:
    """An array of one wire, whose elements other wires may change."""
    wire, other = rng.sample(WIRES, 2)
    shown, more = number(rng, other)
    if rng.random() < 0.4:
        return Filled("float64[]", f".{name} = .{wire}.v", frozenset((wire,)), frozenset((wire,)), lambda last: last[wire]["v"], [])
    rule = f".{name}[] = .{wire}.v[] + {shown}"
    value: Callable[[Last], Any] = lambda last: [each + more(last) for each in last[wire]["v"]]  # noqa: E731 - one line
    return Filled("float64[]", rule, frozenset((wire,)), frozenset((wire, other)), value, [])


FORMS = (numbers, numbers, texts, texts, arrays, arrivals)


def joined(rng: random.Random, name: str) -> tuple[str, list[tuple[str, Callable[[Last], str]]]]:
    """The texts of several wires in one array, and the wire and value of each."""
    wires = [*rng.sample(WIRES, 2), *(rng.choice(WIRES) for _ in range(rng.randrange(4)))]
    made = [text(rng, wire) for wire in wires]
    return f".{name} = [{', '.join(shown for shown, _ in made)}]", [(wire, value) for wire, (_, value) in zip(wires, made, strict=True)]


def some_message(rng: random.Random) -> dict[str, Any]:
    return {
        "s": rng.choice([*TEXTS, "banana"]),
        "t": rng.choice([*TEXTS, "a"]),
        "x": rng.choice([0.0, -1.5, 1e10, rng.uniform(-9, 9)]),
        "n": rng.choice([0, -1, 2**31 - 1, -(2**31), rng.randrange(100)]),
        "v": [rng.uniform(-5, 5) for _ in range(rng.choice([0, 1, 4]))],
    }


def some_mapping(rng: random.Random) -> tuple[dict[str, str], dict[str, Filled], list[tuple[str, Callable[[Last], str]]]]:
    """The files of a mapping, the fields of its holder, and the texts of `.all`."""
    made = {f"o{count}": rng.choice(FORMS)(rng, f"o{count}") for count in range(rng.randrange(3, 9))}
    rule, names = joined(rng, "all")
    files = {f"t/{wire.title()}.msg": "".join(f"{type_} {name}\n" for name, type_ in FIELDS.items()) for wire in WIRES}
    files["t/Out.msg"] = "".join(f"{each.type} {name}\n" for name, each in made.items()) + "string[] all\n"
    head = "".join(f'import "{name}"\n' for name in files) + "data-holder: t/Out\n"
    head += "".join(f"wire-schema {wire}: t/{wire.title()}\n" for wire in WIRES)
    rules = [each.rules for each in made.values()] + [rule]
    rng.shuffle(rules)
    files["m.mapping"] = f"{head}unpack-rules:\n" + "".join(f"  {each}\n" for each in rules) + "  ignore rest\n"
    return files, made, names


def check_several_wires(seed: int, backends: list[str]) -> None:
    rng = random.Random(f"several {seed}")
    files, made, names = some_mapping(rng)
    options: dict[str, Any] = {"schema": files, "encoding": "ros1", "backend": "interpreter"}
    write = {wire: rj.Encoder.of(f"t/{wire.title()}", imports=[f"t/{wire.title()}.msg"], **options) for wire in WIRES}
    programs = [rj.Decoders("m.mapping", schema=files, backend=backend, encodings=dict.fromkeys(WIRES, "ros1")) for backend in backends]
    last: Last = {}
    wanted: dict[str, Any] = {**{name: each.before for name, each in made.items()}, "all": [""] * len(names)}
    for _ in range(MESSAGES):
        wire, fields = rng.choice(WIRES), some_message(rng)
        last[wire] = fields
        for name, each in made.items():
            if wire in each.at:
                wanted[name] = each.value(last) if each.waits <= last.keys() else each.before
        wanted["all"] = [value(last) if at == wire else old for (at, value), old in zip(names, wanted["all"], strict=True)]
        message = write[wire](write[wire].holder_type.from_dict(fields))
        for decode, backend in zip(programs, backends, strict=True):
            assert decode[wire](message).to_dict() == wanted, (seed, backend, files["m.mapping"], wire, last)


@pytest.mark.parametrize("seed", range(3))
def test_several_wires(seed):
    check_several_wires(seed, ["llvm", "python"])


@pytest.mark.campaign
@pytest.mark.parametrize("block", range(20))
def test_campaign(block):
    for seed in range(20 * block + 1000, 20 * block + 1020):
        check_several_wires(seed, ["llvm", "python"] if seed % 10 else ["llvm", "python", "interpreter", "numba"])
