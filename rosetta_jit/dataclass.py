"""`dataclass` as the standard library's, made in a sixth of the time: processes that start quickly cannot spend theirs on making classes.

The standard one compiles six methods for each class, half a millisecond a class. Here `__init__` alone is compiled; comparison, hash,
repr and the refusal to be changed are the same few functions for all, over the fields' values. What is asked for beyond the `OPTIONS`,
classes without slots, and those that inherit fields or bring such methods themselves, are left to the standard library.
"""

from __future__ import annotations

import dataclasses
from operator import attrgetter
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from dataclasses import dataclass as dataclass  # noqa: PLC0414 - what others import from here
    from typing import Any

OPTIONS = frozenset(("frozen", "slots", "eq", "repr", "weakref_slot"))
_OWN = frozenset(("__init__", "__eq__", "__hash__", "__repr__", "__setattr__", "__delattr__", "__getstate__", "__setstate__"))


if not TYPE_CHECKING:

    def dataclass(cls=None, /, **options):
        """As `dataclasses.dataclass`."""
        if cls is not None or not options.keys() <= OPTIONS or not options.get("slots"):
            return dataclasses.dataclass(cls, **options)
        return lambda plain: _made(plain, options)


def _made(plain: type[Any], options: Mapping[str, bool]) -> type[Any]:
    inherits = any(dataclasses.is_dataclass(base) for base in plain.__mro__[1:])
    if inherits or not _OWN.isdisjoint(vars(plain)) or any("InitVar" in str(each) for each in plain.__annotations__.values()):
        return dataclasses.dataclass(**options)(plain)
    if not plain.__doc__:
        plain.__doc__ = plain.__name__  # else the standard library writes the signature there, for which it imports and asks `inspect`
    frozen, eq, weak = options.get("frozen", False), options.get("eq", True), options.get("weakref_slot", False)
    made: Any = dataclasses.dataclass(plain, init=False, repr=False, eq=False, slots=True, weakref_slot=weak)
    fields = dataclasses.fields(made)
    made.__init__ = _init(fields, has_post_init=hasattr(made, "__post_init__"))
    if options.get("repr", True):
        made.__repr__ = _repr(tuple(each.name for each in fields if each.repr))
    if eq:
        values = _values(tuple(each.name for each in fields if each.compare))
        made.__eq__ = _eq(values)
        made.__hash__ = _hash(values) if frozen else None
    if frozen:
        made.__setattr__, made.__delattr__ = _refuse_to_set, _refuse_to_delete
        made.__getstate__, made.__setstate__ = _state, _set_state
    made.__dataclass_params__.frozen, made.__dataclass_params__.eq = frozen, eq
    return made


def _init(fields: Sequence[dataclasses.Field[Any]], *, has_post_init: bool) -> Callable[..., None]:
    """The one method that is compiled: objects are made often, and generic code would be slow at it."""
    names: dict[str, Any] = {"set_": object.__setattr__, "MISSING": dataclasses.MISSING}
    parameters, body = ["self"], [" self.__post_init__()"] if has_post_init else [" pass"]
    for number, field in reversed(tuple(enumerate(fields))):
        default, value = "", field.name
        if field.default_factory is not dataclasses.MISSING:
            names[f"make{number}"] = field.default_factory
            default, value = "=MISSING", f"make{number}() if {field.name} is MISSING else {field.name}" if field.init else f"make{number}()"
        elif field.default is not dataclasses.MISSING:
            names[f"default{number}"] = field.default
            default, value = f"=default{number}", field.name if field.init else f"default{number}"
        if field.init:
            parameters.insert(1, field.name + default)
        if field.init or default:
            body.insert(0, f" set_(self, {field.name!r}, {value})")
    exec(f"def __init__({', '.join(parameters)}):\n" + "\n".join(body), names)  # noqa: S102 - the names of fields of our own classes
    return names["__init__"]


def _values(names: tuple[str, ...]) -> Callable[[Any], tuple[Any, ...]]:
    """The values of some fields, as a tuple however many they are."""
    if len(names) > 1:
        return attrgetter(*names)
    return lambda self: tuple(getattr(self, name) for name in names)


def _eq(values: Callable[[Any], tuple[Any, ...]]) -> Callable[[Any, Any], bool]:
    def __eq__(self: Any, other: Any) -> bool:  # noqa: N807 - what it becomes
        return values(self) == values(other) if other.__class__ is self.__class__ else NotImplemented

    return __eq__


def _hash(values: Callable[[Any], tuple[Any, ...]]) -> Callable[[Any], int]:
    def __hash__(self: Any) -> int:  # noqa: N807 - what it becomes
        return hash(values(self))

    return __hash__


def _repr(names: tuple[str, ...]) -> Callable[[Any], str]:
    def __repr__(self: Any) -> str:  # noqa: N807 - what it becomes
        return f"{self.__class__.__qualname__}({', '.join(f'{name}={getattr(self, name)!r}' for name in names)})"

    return __repr__


def _refuse_to_set(self: Any, name: str, value: object) -> None:  # noqa: ARG001 - whatever they are
    raise dataclasses.FrozenInstanceError(f"cannot assign to field {name!r}")


def _refuse_to_delete(self: Any, name: str) -> None:  # noqa: ARG001 - whichever it is
    raise dataclasses.FrozenInstanceError(f"cannot delete field {name!r}")


def _state(self: Any) -> list[Any]:
    return [getattr(self, field.name) for field in dataclasses.fields(self)]


def _set_state(self: Any, state: list[Any]) -> None:
    for field, value in zip(dataclasses.fields(self), state, strict=True):
        object.__setattr__(self, field.name, value)
