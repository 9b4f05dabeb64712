"""Properties that are computed once an object. The standard library's, until Python 3.12, hold a lock of their class meanwhile.

Threads would wait for each other, and the child of a fork for ever: the thread that held the lock in the parent is not there to release it.
Here two threads may compute the value at once, and both get the one that was there first.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Generic, Self, TypeVar, overload

_Value = TypeVar("_Value")


class cached_property(Generic[_Value]):  # noqa: N801  as the standard library names it
    """A method without arguments as an attribute, computed when it is first read."""

    def __init__(self, compute: Callable[[Any], _Value]) -> None:
        self.compute = compute
        self.__doc__ = compute.__doc__

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    @overload
    def __get__(self, instance: None, owner: type) -> Self: ...
    @overload
    def __get__(self, instance: object, owner: type) -> _Value: ...
    def __get__(self, instance: object, owner: type) -> Self | _Value:
        if instance is None:
            return self
        return vars(instance).setdefault(self.name, self.compute(instance))
