"""Optional fields and cases of unions: the one block of a `when` sets them, the other does not, so that they tell the two apart.

`when .kind == 1 .a.x <-> .x else .b.y <-> .y end`           a holder is of the first block if it has `.a`
`when has(.a) .kind <-> 1 .x <-> .a.x else .kind <-> 2 end`  the first block packs messages that have `.a`, the second others
`.has_x <-> has(.x)` beside `.x <-> .x`                      the latter is packed where `.has_x` holds
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

from rosetta_jit.language.both_ways.knowledge import Knowledge, Loops, key_of
from rosetta_jit.model.expr import Call, Expr, List, Literal, Member, Path, Side, Unary
from rosetta_jit.model.mapping import Arranged, Default, For, Ignore, Relation, Rule, SameNames, When
from rosetta_jit.model.types import Optional, Struct, Union
from rosetta_jit.model.walk import fields_of, names_of, parts, path_of, rebuilt
from rosetta_jit.startup.dataclass import replace

if TYPE_CHECKING:
    from rosetta_jit.language.both_ways.inverse import TypeOf

Names = tuple[str, ...]
"""The fields on the way to a place."""


def presence_between(then: tuple[Rule, ...], otherwise: tuple[Rule, ...], type_of: TypeOf) -> Expr | None:
    """That a holder has what the first block alone sets, or lacks what the second alone sets; None where neither can be asked."""
    for block, other, is_first in ((then, otherwise, True), (otherwise, then, False)):
        for place in _set_by(block):
            for size in range(1, len(place.steps) + 1):
                optional = replace(place, steps=place.steps[:size])
                if may_be_absent(optional, type_of) and not _touches(other, "holder", names_of(optional)):
                    test = Call("has", (optional,), place.span)
                    return test if is_first else Unary("not", test, place.span)
    return None


def may_be_absent(path: Path, type_of: TypeOf) -> bool:
    """Whether a place is an optional field or a case of a union."""
    last = path.steps[-1] if path.steps else None
    if not isinstance(last, Member):
        return False
    match type_of(replace(path, steps=path.steps[:-1])):
        case Struct(fields=fields):
            own = next((each for each in fields if each.name == last.name), None)
            return type_of(path) is not None if own is None else isinstance(own.type, Optional)
        case Union():
            return True
        case _:
            return False


def asks_presence(condition: Expr, side: Side) -> bool:
    """Whether a condition asks what is there on one side."""
    return any(isinstance(each, Call) and each.function == "has" and fields_of(each, side) for each in parts(condition))


def told_by_setting(condition: Expr, known: Knowledge, block: tuple[Rule, ...], loops: Loops, *, other: tuple[Rule, ...] = ()) -> Expr:
    """A condition with what a block says of the presence of the wire's fields, which it sets or leaves to the ``other`` block."""
    if isinstance(condition, Call) and condition.function == "has" and isinstance(condition.arguments[0], Path):
        field = condition.arguments[0]
        is_there = _is_set(field, known, block, loops, other) if field.side == "wire" else None
        return condition if is_there is None else Literal(is_there, condition.span)
    return rebuilt(condition, lambda part: told_by_setting(part, known, block, loops, other=other))


def _is_set(field: Path, known: Knowledge, block: tuple[Rule, ...], loops: Loops, other: tuple[Rule, ...]) -> bool | None:
    """Whether a block sets a field of the wire, or something in it, in each of its ways; None where that depends."""
    (place, ranges), _ = key_of(field, loops)
    steps, names = path_of(place).steps, names_of(field)
    for setter, its in known.setters:
        below = path_of(setter).steps
        if isinstance(setter, Path) and its == ranges and below[: len(steps)] == steps and all(isinstance(each, Member) for each in below):
            return True
    if any(_meet(names, names_of(path_of(each))) for each, _ in known.values) or _touches(block, "wire", names):
        return None
    return False if _touches(other, "wire", names) else None  # what no block sets may be set by `same names`


# --- flags ---------------------------------------------------------------------------------------------------------------


def flag_of(rule: Rule) -> tuple[Path, Path] | None:
    """The place of the holder that says whether a field of the wire is there, and that field."""
    match rule:
        case Relation(Path() as flag, Call("has", (Path(side="wire") as field,))) if not fields_of(flag, "wire"):
            return flag, field
        case _:
            return None


def is_kept(pair: tuple[Path, Path], rules: tuple[Rule, ...]) -> bool:
    """Whether rules set the field of a flag, and nowhere but in a `when` that asks for it or beside the flag."""
    setting = [rule for rule in rules if _may_set(rule, "wire", names_of(pair[1]))]
    return bool(setting) and all(
        isinstance(rule, Relation) or (isinstance(rule, When) and Call("has", (pair[1],)) in parts(rule.condition)) for rule in setting
    )


def with_flags(rules: tuple[Rule, ...], is_completed: Callable[[Path], bool]) -> tuple[Rule, ...]:
    """Rules of which those that set a field are packed where the flag beside them says that it is there."""
    found = tuple(_within(rule, is_completed) for rule in rules)
    for flag in rules:
        pair = flag_of(flag)
        if pair is not None and not is_completed(pair[1]):
            found = tuple(_where_present(each, pair[1]) for each in found)
    return found


def _within(rule: Rule, is_completed: Callable[[Path], bool]) -> Rule:
    match rule:
        case For(body=body):
            return replace(rule, body=with_flags(body, is_completed))
        case When(then=then, otherwise=otherwise):
            return replace(rule, then=with_flags(then, is_completed), otherwise=with_flags(otherwise, is_completed))
        case _:
            return rule


def _where_present(rule: Rule, optional: Path) -> Rule:
    """A relation whose fields of the wire are all within one that may be absent, where that is there."""
    if not isinstance(rule, Relation) or flag_of(rule) is not None:
        return rule
    paths = [path_of(each) for each in fields_of(rule.value, "wire")]
    if not paths or any(each.steps[: len(optional.steps)] != optional.steps for each in paths):
        return rule
    return When(Call("has", (optional,), rule.span), (rule,), (), rule.span)


# --- places --------------------------------------------------------------------------------------------------------------


def _set_by(block: tuple[Rule, ...]) -> Iterator[Path]:
    """The places of the holder that relations of a block set in each of its ways."""
    for rule in block:
        match rule:
            case Relation(Path() as place) if not fields_of(place, "wire"):
                yield place
            case Relation(List(items)):
                yield from (each for each in items if isinstance(each, Path) and not fields_of(each, "wire"))
            case _:
                pass


def _touches(rules: tuple[Rule, ...], side: Side, names: Names) -> bool:
    """Whether rules may set a place, something in it or around it, in some of their ways."""
    return any(_may_set(rule, side, names) for rule in rules)


def _may_set(rule: Rule, side: Side, names: Names) -> bool:
    match rule:
        case Relation(place, value):
            return (side == "holder" or flag_of(rule) is None) and _names_any((place if side == "holder" else value,), side, names)
        case Arranged(place, flag, cases):
            return _names_any((place, flag) if side == "holder" else tuple(value for _, value in cases), side, names)
        case For(body=body):
            return _touches(body, side, names)
        case When(then=then, otherwise=otherwise):
            return _touches((*then, *otherwise), side, names)
        case Ignore(place) | Default(place):
            return place.side == side and names_of(place) != names and _meet(names_of(place), names)  # it is absent by default
        case SameNames():
            return True
        case _:
            return False


def _names_any(expressions: tuple[Expr, ...], side: Side, names: Names) -> bool:
    return any(_meet(names_of(path_of(field)), names) for each in expressions for field in fields_of(each, side))


def _meet(one: Names, other: Names) -> bool:
    """Whether one place lies in the other, or is it."""
    return all(a == b for a, b in zip(one, other, strict=False))
