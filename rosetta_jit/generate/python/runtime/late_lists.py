"""Objects of types with many lists and maps, of which some have not come."""

# pyright: reportUnusedClass=false

from __future__ import annotations

import dataclasses as _dataclasses
import threading as _threading
from typing import Any

_set_class = object.__dict__["__class__"].__set__
_lists_lock = _threading.RLock()
_lacking: dict[Any, int] = {}
"""By the classes of objects that lack groups of lists: which these are, a bit each."""
_without_lists: dict[Any, Any] = {}
"""By usual classes: those of their objects that lack groups of lists."""


class _WithoutLists:
    """What an object is while it lacks groups of lists and maps: it gets a group when somebody asks for one of its lists, or sets it."""

    __slots__ = ()

    @property
    def __class__(self) -> Any:
        return type(self).__mro__[2]

    @__class__.setter
    def __class__(self, other: Any) -> None:
        _set_class(_with_lists(self), other)

    def __getattr__(self, name: str) -> Any:
        return object.__getattribute__(_with_list(self, name), name)

    def __setattr__(self, name: str, value: Any) -> None:
        object.__setattr__(_with_list(self, name), name, value)

    def __delattr__(self, name: str) -> None:
        object.__delattr__(_with_list(self, name), name)

    def __reduce_ex__(self, protocol: Any) -> Any:
        return _with_lists(self).__reduce_ex__(protocol)


class _ByLists(dict[int, Any]):
    """The classes of objects of a ``usual`` class by the groups of lists, of a ``size`` each, that they lack; all have the same names.

    ``groups`` are these, by the names of their lists: a bit, and what sets each list with what makes it.
    """

    def __init__(self, usual: Any, size: int) -> None:
        super().__init__({0: usual})
        made = [each for each in _dataclasses.fields(usual) if each.default_factory is not _dataclasses.MISSING]
        self.usual, self.groups = usual, dict[str, Any]()
        for number in range(-(-len(made) // size)):
            group = made[number * size : (number + 1) * size]
            what = 1 << number, [(usual.__dict__[each.name].__set__, each.default_factory) for each in group]
            self.groups |= dict.fromkeys((each.name for each in group), what)
        _without_lists[usual] = self

    def __missing__(self, lacks: int) -> Any:
        usual = self.usual
        names = {"__module__": usual.__module__, "__qualname__": usual.__qualname__, "__doc__": usual.__doc__}
        late: Any = type(usual.__name__, (_WithoutLists, usual), {"__slots__": (), **names})
        late.__slots__ = usual.__slots__
        _lacking[late] = lacks
        return self.setdefault(lacks, late)


def _with_list(message: Any, name: str) -> Any:
    """An object with the group of a list, if the name is one's; where two threads ask at once, one of them makes these lists."""
    with _lists_lock:
        if lacks := _lacking.get(type(message), 0):
            classes = _without_lists[type(message).__mro__[2]]
            group, lists = classes.groups.get(name, (0, ()))
            if lacks & group:
                for put, make in lists:
                    put(message, make())
                _set_class(message, classes[lacks - group])
    return message


def _with_lists(message: Any) -> Any:
    """An object with all of its lists."""
    for name in _without_lists[message.__class__].groups:
        _with_list(message, name)
    return message
