"""What a relation of whole arrays says besides: which lengths are equal, and what its layout depends on."""

from __future__ import annotations

from collections.abc import Mapping

from rosetta_jit.language.arrays.array_functions import ARGUMENTS, KEEP_LENGTH
from rosetta_jit.language.both_ways.inverse import fields_in
from rosetta_jit.model.expr import Call, Coerced, Each, Expr, Index, Len, List, Member, Path
from rosetta_jit.model.walk import Field, path_of, rebuilt
from rosetta_jit.startup.dataclass import replace


def equal_lengths(place: Field | List, value: Expr) -> tuple[Len, Len] | None:
    """The length of the array in a value, and that of the place, if both have as many elements."""
    array = value
    while isinstance(array, Call) and array.function in KEEP_LENGTH and array.arguments:
        array = array.arguments[0]
    if not isinstance(place, Path):
        return None
    if not has_each(place):
        return (Len(array), Len(place, place.span)) if isinstance(array, Path) and _is_plain(array) and _is_plain(place) else None
    found = [_array(path) for path in fields_in(value) if isinstance(path, Path) and has_each(path)]
    wanted = _array(place)
    return (Len(found[0]), Len(wanted, place.span)) if len(found) == 1 and all(map(_is_plain, (found[0], wanted))) else None


def with_layouts(value: Expr, written: Mapping[Field, Expr]) -> Expr:
    """A value whose layout depends on what `pack-rules:` write, with that in place of the fields of the wire."""
    match value:
        case Call(function, (array, *arguments)) if function in ARGUMENTS:
            known = tuple(_with_written(argument, written) for argument in arguments)
            return replace(value, arguments=(with_layouts(array, written), *known))
        case _:
            return value


def _with_written(expr: Expr, written: Mapping[Field, Expr]) -> Expr:
    if isinstance(expr, Path) and expr in written:
        return Coerced(expr, written[expr], expr.span)
    return rebuilt(expr, lambda part: _with_written(part, written))


def has_each(place: Field) -> bool:
    """Whether a field, or its length, is meant of each element."""
    return any(isinstance(step, Each) for step in path_of(place).steps)


def _array(path: Path) -> Path:
    """What the first `[]` of a path goes through."""
    number = next(number for number, step in enumerate(path.steps) if isinstance(step, Each))
    return Path(path.side, path.steps[:number], path.span)


def _is_plain(path: Path) -> bool:
    return all(isinstance(step, Member | Index) for step in path.steps)
