"""Texts that are put together of all parts of one: `part(s, "/", 0) + "/" + part(s, "/", 1)` is `s`, where that has two parts."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from rosetta_jit.language.typed import INT64, Call, Choice, Const, Expr, Unary


def whole_text(expr: Call, equal_to: Callable[[Expr], list[Expr]]) -> Expr | None:
    """The text whose parts stand in a sum, if they do; ``equal_to`` gives what expressions are known to be equal to."""
    pieces = list(_pieces(expr))
    found, separators = pieces[::2], pieces[1::2]
    match found[0]:
        case Call("part", (text, Const() as separator, _)):
            is_each = all(_is_part(piece, text, separator, number) for number, piece in enumerate(found))
            count = [each.value for each in equal_to(Call("parts", (text, separator), INT64)) if isinstance(each, Const)]
            are_alike = len(separators) == len(found) - 1 and all(each == separator for each in separators)
            return text if is_each and are_alike and count == [len(found)] else None
        case _:
            return None


def _pieces(expr: Expr) -> Iterator[Expr]:
    """The terms of a sum, from the left; a text that is refused where it holds the separator is one, for no part does."""
    match expr:
        case Call("+", (left, right)):
            yield from _pieces(left)
            yield from _pieces(right)
        case Choice(((Unary("not", Call("contains", (Call("part", (_, known, _)) as text, separator))), value),), None):
            yield text if text == value and known == separator and _is_single(separator) else expr
        case _:
            yield expr


def _is_single(separator: Expr) -> bool:
    return isinstance(separator, Const) and len(str(separator.value).encode()) == 1


def _is_part(piece: Expr, text: Expr, separator: Const, number: int) -> bool:
    match piece:
        case Call("part", (other, between, Const(place))):
            return (other, between, place) == (text, separator, number)
        case _:
            return False
