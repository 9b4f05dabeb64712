"""What a typed rule does to values besides moving them: conversions, units, and what may be lost of them."""

from __future__ import annotations

from collections.abc import Iterator

from rosetta_jit.explain.walk import nodes, places
from rosetta_jit.language import typed
from rosetta_jit.language.conversions import describe, rounded_constant
from rosetta_jit.language.installed import functions
from rosetta_jit.language.typed import Change, ConversionRule, Rule
from rosetta_jit.language.units.conversion import shown, unit_of
from rosetta_jit.language.units.unit_at import Unit, unit_at
from rosetta_jit.model.types import Float, Int
from rosetta_jit.startup.dataclass import dataclass

HOW: dict[ConversionRule, str] = {
    "widen": "without loss",
    "exact": "refused where it does not fit",
    "saturate": "the nearest that fits",
    "wrap": "without its high bits",
    "round": "rounded",
    "truncate": "without its fraction",
    "nearest": "rounded to the nearest",
}

LOSSY: frozenset[str] = frozenset(("saturate", "wrap", "round", "truncate", "nearest"))


@dataclass(frozen=True, slots=True)
class Note:
    """One thing that is done to a value, and whether a value may be changed by it."""

    text: str
    lossy: bool = False


def notes(rules: list[Rule]) -> tuple[Note, ...]:
    """What is done by the rules that one text became; blocks within them speak for themselves."""
    found = [note for rule in rules for note in _notes(rule)]
    return tuple(dict.fromkeys(found))


def _notes(rule: Rule) -> Iterator[Note]:
    match rule:
        case typed.Assign(place, value, by=change):
            yield from _units(rule) if change is None else _changes(change)
            yield from _conversions((place, value))
        case typed.SetLength(place, value):
            yield from _conversions((place, value))
        case typed.For(_, start, stop, kept=kept):
            if kept is not None:
                yield Note("elements for which the condition does not hold are dropped", lossy=True)
                yield from _conversions(kept.condition)
            yield from _conversions((start, stop))
        case typed.SetState(_, value):
            yield from _conversions(value)
        case typed.When(condition):
            yield from _conversions(condition)
        case _:
            return


def _conversions(root: object) -> Iterator[Note]:
    checked = {id(part) for node in nodes(root) if isinstance(node, typed.Nearest) for part in nodes(node.check)}
    for node in nodes(root):
        if id(node) not in checked:
            yield from _conversion(node)


def _conversion(node: object) -> Iterator[Note]:
    match node:
        case typed.Convert(operand, target, rule) if rule != "widen":
            yield Note(f"{describe(operand.type)} → {describe(target)}, {HOW[rule]}", rule in LOSSY)
        case typed.Nearest(operand, type=target):
            yield Note(f"{describe(operand.type)} → {describe(target)}, the nearest, refused where that does not unpack to the value")
        case typed.Const() if (single := rounded_constant(node)) is not None:
            yield Note(f"{node.value!r} → float32, rounded to {single!r}", lossy=True)
        case typed.Binary("/", _, _, Int()):
            yield Note("a quotient of integers, without its fraction", lossy=True)
        case typed.Binary("%" | ">>" | "&" | "|" as operator):
            yield Note(f"`{operator}` keeps a part of a value", lossy=True)
        case typed.Binary("+" | "-" | "*" | "/", _, _, Float(32)) | typed.Call("divide", _, Float(32)):
            yield Note("computed in float32, rounded", lossy=True)
        case typed.Call(function) if remark := functions()[function].remark:
            yield Note(f"`{function}` {remark}", lossy=True)
        case _:
            pass


def _changes(change: Change) -> Iterator[Note]:
    """The units of the numbers within a whole value."""
    yield from (Note(f"{node.source} → {node.target}") for node in nodes(change) if isinstance(node, typed.Rescale))


def _units(rule: typed.Assignment) -> Iterator[Note]:
    """From which unit to which; one that only one side declares is said to be so."""
    wanted = _unit_text(unit_at(rule.place) or unit_of(rule.value))
    read = dict.fromkeys(_unit_text(unit_at(place)) for place in places(rule.value, "wire" if rule.place.side == "holder" else "holder"))
    known = [unit for unit in read if unit is not None] or _taken(rule.value)
    for unit in known:
        if wanted is None:
            yield Note(f"in {unit}, no unit declared for its place")
        else:
            yield Note(f"in {unit}" if unit == wanted else f"{unit} → {wanted}")
    if wanted is not None and not known:
        yield Note(f"in {wanted}, no unit declared for the value")


def _unit_text(unit: Unit) -> str | None:
    return None if unit is None else shown(unit)


def _taken(value: typed.Expr) -> list[str]:
    """The units that functions within a value take."""
    calls = (functions()[node.function].units for node in nodes(value) if isinstance(node, typed.Call))
    return [units.takes for units in calls if units.takes is not None]
