"""Rules by what they mean: which place becomes what of which places. Two texts that do the same give the same meanings."""

from __future__ import annotations

from dataclasses import dataclass, fields, is_dataclass

from rosetta_jit.language import typed
from rosetta_jit.language.conversions import describe
from rosetta_jit.model.types import Array


@dataclass(frozen=True)
class Meaning:
    """One direction's rule for one place. ``reads`` is whether its value is of the other side, and no constant."""

    direction: str
    place: str
    value: str
    reads: bool


def meanings(checked) -> set[Meaning]:
    """All rules that set a value, of both directions; lengths, rejections and what is left out are none."""
    found = set()
    for direction, rules in (("unpack", checked.unpack), ("pack", checked.pack)):
        for rule in rules or ():
            found |= set(_meanings(direction, rule))
    return found


def _meanings(direction, rule):
    match rule:
        case typed.Assign(place, value):
            behind = "[]" if _is_whole(place.type) and _is_whole(value.type) else ""
            text = _text(value)
            yield Meaning(direction, _path(place) + behind, text + behind, "@" in text)
        case typed.For(body=body):
            for each in body:
                yield from _meanings(direction, each)
        case typed.When(then=then, otherwise=otherwise):
            for each in (*then, *otherwise):
                yield from _meanings(direction, each)
        case _:
            pass


def _is_whole(type_):
    return isinstance(type_, Array)


def _path(place):
    """Fields, and elements: by their number, or as any one."""
    text = ""
    for step in place.steps:
        match step:
            case typed.FieldStep(field):
                text += f".{field.name}"
            case typed.IndexStep(typed.Const(value)):
                text += f"[{value}]"
            case typed.IndexStep():
                text += "[]"
    return text


def _text(node) -> str:
    match node:
        case typed.Access(place):
            return f"@{_path(place)}"
        case typed.Convert(operand, type_, rule):
            return _text(operand) if rule == "widen" else f"{describe(type_)} {rule}({_text(operand)})"
        case typed.Const(value):
            return repr(float(value)) if isinstance(value, int | float) and not isinstance(value, bool) else repr(value)
        case typed.Nearest(operand):
            return f"nearest({_text(operand)})"
        case tuple():
            return f"({', '.join(map(_text, node))})"
        case _ if is_dataclass(node):
            parts = [_text(getattr(node, each.name)) for each in fields(node) if each.name not in {"span", "type", "reason", "pieces"}]
            return f"{type(node).__name__}({', '.join(parts)})"
        case _:
            return str(node)
