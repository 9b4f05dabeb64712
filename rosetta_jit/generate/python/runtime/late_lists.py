"""Objects of types with many lists and maps, of which some have not come."""

# pyright: reportUnusedClass=false

from __future__ import annotations

import dataclasses as _dataclasses
import functools as _functools
import threading as _threading
from typing import Any

_set_class = object.__dict__["__class__"].__set__
_lists_lock = _threading.RLock()
_lacking: dict[Any, int] = {}
"""By the classes of objects that lack groups of lists: which these are, a bit each."""


class _LateList:
    """A list or map that an object lacks: its group is made when somebody asks for it, or sets it.

    ``classes`` are those of such objects, ``slot`` is where the list will be, ``group`` a bit, ``made`` what sets each list of the group
    with what makes it.
    """

    def __init__(self, classes: Any, slot: Any, group: int, made: Any) -> None:
        self.classes, self.slot, self.group, self.made = classes, slot, group, made

    def come(self, message: Any) -> Any:
        """An object with the group; where two threads ask at once, one of them makes the lists."""
        with _lists_lock:
            lacks = _lacking.get(type(message), 0)
            if lacks & self.group:
                for put, make in self.made:
                    put(message, make())
                _set_class(message, self.classes[lacks - self.group])
        return message

    def __get__(self, message: Any, _: Any = None) -> Any:
        return self.slot if message is None else self.slot.__get__(self.come(message))

    def __set__(self, message: Any, value: Any) -> None:
        self.slot.__set__(self.come(message), value)

    def __delete__(self, message: Any) -> None:
        self.slot.__delete__(self.come(message))


class _WithoutLists:
    """What an object is while it lacks groups of lists and maps."""

    __slots__ = ()

    @property
    def __class__(self) -> Any:
        return type(self).__mro__[2]

    @__class__.setter
    def __class__(self, other: Any) -> None:
        _set_class(_with_lists(self), other)

    def __reduce_ex__(self, protocol: Any) -> Any:
        return _with_lists(self).__reduce_ex__(protocol)


class _ByLists(dict[int, Any]):
    """The classes of objects of a ``usual`` class by the groups of lists, of a ``size`` each, that they lack; all have the same names."""

    def __init__(self, usual: Any, size: int) -> None:
        super().__init__({0: usual})
        fields = _dataclasses.fields(usual)
        late = [each for each in fields if each.default_factory is not _dataclasses.MISSING]
        self.usual, self.lists = usual, dict[str, _LateList]()
        for number in range(-(-len(late) // size)):
            group = [(each.name, usual.__dict__[each.name], each.default_factory) for each in late[number * size : (number + 1) * size]]
            made = [(slot.__set__, make) for _, slot, make in group]
            self.lists |= {name: _LateList(self, slot, 1 << number, made) for name, slot, _ in group}
        if len(late) >= 36:  # of fewer lists, all are made in less time than a group of them later
            besides = [(each.name, usual.__dict__[each.name].__set__, each.default) for each in fields if each.name not in self.lists]
            usual.__init__ = _made_late(self, besides)

    def __missing__(self, lacks: int) -> Any:
        usual = self.usual
        names = {"__module__": usual.__module__, "__qualname__": usual.__qualname__, "__doc__": usual.__doc__}
        lists = {name: each for name, each in self.lists.items() if each.group & lacks}
        late: Any = type(usual.__name__, (_WithoutLists, usual), {"__slots__": (), **lists, **names})
        late.__slots__ = usual.__slots__
        _lacking[late] = lacks
        return self.setdefault(lacks, late)


def _made_late(classes: _ByLists, besides: Any) -> Any:
    """The `__init__` of a class: an object that gets a few of its lists at most lacks the others; ``besides`` are its other fields."""
    usual, whole, lists, names = classes.usual, classes.usual.__init__, classes.lists, {name for name, *_ in besides}
    every = max(each.group for each in lists.values()) * 2 - 1

    @_functools.wraps(whole)
    def init(message: Any, *values: Any, **given: Any) -> None:
        few = given.keys() - names
        if values or type(message) is not usual or len(few) > 3 or not few <= lists.keys():
            whole(message, *values, **given)
            return
        for name, put, default in besides:
            put(message, given.get(name, default))
        _set_class(message, classes[every])
        for name in few:
            lists[name].__set__(message, given[name])

    return init


def _with_lists(message: Any) -> Any:
    """An object with all of its lists."""
    for each in type(message).__dict__.values():
        if isinstance(each, _LateList):
            each.come(message)
    return message
