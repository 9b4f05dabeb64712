"""Objects of types with many lists and maps, of which none has come: part of generated modules that have such types."""

import dataclasses as _dataclasses
import threading as _threading
from typing import Any

_set_class = object.__dict__["__class__"].__set__
_lists_lock = _threading.RLock()
_lists_of: dict[Any, Any] = {}
"""By the classes of objects that have none yet: the usual class, what sets each list, and what sets each map or array and what makes it."""


class _WithoutLists:
    """What an object is until somebody asks for one of its lists and maps, or sets anything: it gets them all then, and is a usual one."""

    __slots__ = ()

    @property
    def __class__(self) -> Any:
        return type(self).__mro__[2]

    @__class__.setter
    def __class__(self, other: Any) -> None:
        _set_class(_with_lists(self), other)

    def __getattr__(self, name: str) -> Any:
        return getattr(_with_lists(self), name)

    def __setattr__(self, name: str, value: Any) -> None:
        setattr(_with_lists(self), name, value)

    def __delattr__(self, name: str) -> None:
        delattr(_with_lists(self), name)

    def __reduce_ex__(self, protocol: Any) -> Any:
        return _with_lists(self).__reduce_ex__(protocol)


def _without_lists(usual: Any) -> Any:  # pyright: ignore[reportUnusedFunction]
    """The class of such objects of a ``usual`` class, which to all who ask has the same names."""
    names = {"__module__": usual.__module__, "__qualname__": usual.__qualname__, "__doc__": usual.__doc__}
    late: Any = type(usual.__name__, (_WithoutLists, usual), {"__slots__": (), **names})
    late.__slots__ = usual.__slots__
    made = [(usual.__dict__[each.name].__set__, each.default_factory) for each in _dataclasses.fields(usual)]
    lists = [put for put, make in made if make is list]
    _lists_of[late] = usual, lists, [(put, make) for put, make in made if make not in (list, _dataclasses.MISSING)]
    return late


def _with_lists(message: Any) -> Any:
    """An object with its lists and maps; where two threads ask at once, one of them makes these."""
    with _lists_lock:
        if (late := _lists_of.get(type(message))) is not None:
            usual, lists, others = late
            for put in lists:
                put(message, [])
            for put, make in others:
                put(message, make())
            _set_class(message, usual)
    return message
