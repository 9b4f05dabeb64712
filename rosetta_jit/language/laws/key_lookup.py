"""Elements by their keys, on the way back: of an array whose keys the first direction has written, a key has one number.

What rules write are the constants of the text, or the items of a list, none of which stands in it twice. So the number under which a key
was written is the one that it is found under.
"""

from __future__ import annotations

from collections.abc import Callable

from rosetta_jit.language.limits import MAX_LOOKED
from rosetta_jit.language.typed import INT64, Access, Binary, Call, Const, Expr, Given, Listed, Local, Place, Search
from rosetta_jit.language.walk import renamed

WRITTEN = Local("(written)")
"""The number of an element while its key is compared with what was written for it."""


def number_found(search: Search, count: Expr, of: Callable[[Expr], Expr], setters: Callable[[Place], int]) -> Expr | None:
    """The number of the element that is looked for among ``count``; None where that does not follow.

    ``of`` makes an expression one of what the first direction read, and ``setters`` says how many of its rules set a field.
    """
    match search.condition:
        case Listed(conditions, index):
            found = [_only(search, condition, count, of) for condition in conditions]
            return of(index) if found == list(range(len(conditions))) else None
        case Binary("==", Call("<=>", (key, Given(name, (index,)))), Const(0)) | Binary("==", key, Given(name, (index,))):
            written = of(renamed(key, {search.variable.name: WRITTEN})) if _is_set_once(key, setters) else None
            return of(index) if isinstance(written, Given) and (written.name, written.arguments) == (name, (WRITTEN,)) else None
        case condition:
            number = _only(search, condition, count, of)
            return None if number is None else Const(number, INT64)


def _is_set_once(key: Expr, setters: Callable[[Place], int]) -> bool:
    """Whether one rule sets the keys, all of them then."""
    return isinstance(key, Access) and setters(key.place) == 1


def _only(search: Search, condition: Expr, count: Expr, of: Callable[[Expr], Expr]) -> int | None:
    """The number of the one element for which a condition holds, where that is known of each."""
    if not isinstance(count, Const) or int(count.value) > MAX_LOOKED:
        return None
    held = [of(renamed(condition, {search.variable.name: Const(number, INT64)})) for number in range(int(count.value))]
    holds = [each.value if isinstance(each, Const) else None for each in held]
    return holds.index(True) if None not in holds and holds.count(True) == 1 else None
