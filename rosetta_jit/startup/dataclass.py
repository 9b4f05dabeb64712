"""`dataclass` as the standard library's, made in a tenth of the time: processes that start quickly cannot spend theirs on making classes.

The standard one compiles six methods for each class, half a millisecond a class, and takes as long to be imported. Here `__init__` is the
code of a class of the same shape with other names; comparison, hash, repr and the refusal to be changed are the same few functions for all,
over the fields' values; and what the standard library knows of a class it works out when it is asked for. What is asked for beyond the
`OPTIONS`, classes without slots, and those that inherit fields or bring such methods themselves, are left to the standard library.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from operator import attrgetter
from types import CodeType, FunctionType
from typing import TYPE_CHECKING, Any

from rosetta_jit.startup.stores import STORES

if TYPE_CHECKING:
    from dataclasses import dataclass as dataclass  # noqa: PLC0414 - what others import from here
    from dataclasses import field as field  # noqa: PLC0414
    from dataclasses import replace as replace  # noqa: PLC0414

OPTIONS = frozenset(("frozen", "slots", "eq", "repr", "weakref_slot"))
_OWN = frozenset(("__init__", "__eq__", "__hash__", "__repr__", "__setattr__", "__delattr__", "__getstate__", "__setstate__"))
_FIELDS = "__dataclass_fields__"
MISSING: Any = object()


class Field:
    """What a class says of one of its fields; ``options`` are those of `dataclasses.field`."""

    __slots__ = ("compare", "default", "default_factory", "init", "options", "repr")

    def __init__(self, options: dict[str, Any]) -> None:
        self.options = options
        self.default, self.default_factory = options.get("default", MISSING), options.get("default_factory", MISSING)
        self.init, self.repr, self.compare = options.get("init", True), options.get("repr", True), options.get("compare", True)


_PLAIN = Field({})
"""Of which nothing is said."""


if not TYPE_CHECKING:

    def dataclass(cls=None, /, **options):
        """As `dataclasses.dataclass`."""
        if cls is not None or not options.keys() <= OPTIONS or not options.get("slots"):
            return _standard(cls, options) if cls is not None else lambda plain: _standard(plain, options)
        return lambda plain: _made(plain, options)

    def field(**options):
        """As `dataclasses.field`."""
        return Field(options)

    def replace(instance, /, **changes):
        """As `dataclasses.replace`, in a third of the time: what is made here brings its own."""
        own = vars(instance.__class__).get("__replace__")
        if own is not None:
            return own(instance, **changes)
        from dataclasses import replace as replaced

        return replaced(instance, **changes)


def _made(plain: type[Any], options: Mapping[str, bool]) -> type[Any]:
    own, types = vars(plain), " ".join(map(str, plain.__annotations__.values()))
    if "InitVar" in types or _is_special(plain):
        return _standard(plain, options)
    if not plain.__doc__:
        plain.__doc__ = plain.__name__  # else the standard library writes the signature there, for which it imports and asks `inspect`
    are_plain = "ClassVar" not in types and own.keys().isdisjoint(plain.__annotations__)
    fields = dict.fromkeys(plain.__annotations__, _PLAIN) if are_plain else _fields(plain)
    names: dict[str, Any] = {}
    given = {name: each for name, each in own.items() if name not in fields and name not in _OF_EACH_CLASS}
    given["__slots__"] = (*fields, "__weakref__") if options.get("weakref_slot") else (*fields,)
    given["__qualname__"] = plain.__qualname__
    given["__init__"] = _init(fields, names, are_plain=are_plain, has_post_init=hasattr(plain, "__post_init__"))
    given["__declared__"] = Declared(plain, options, fields)
    given |= _DESCRIBED
    _add_methods(given, fields, options, are_plain=are_plain)
    kind: Any = type(plain)
    made: Any = kind(plain.__name__, plain.__bases__, given)
    names |= {f"set{number}": getattr(made, name).__set__ for number, name in enumerate(fields)}
    if not are_plain:
        for number, each in enumerate(fields.values()):
            if each.default_factory is not MISSING:
                names[f"set{number}"] = _made_anew(names[f"set{number}"], each.default_factory)
    return made


def _is_special(plain: type[Any]) -> bool:
    """Whether a class inherits fields, or brings what is to be made."""
    inherits = plain.__bases__ != (object,) and any(hasattr(base, _FIELDS) for base in plain.__bases__)
    return inherits or not _OWN.isdisjoint(vars(plain))


def _fields(plain: type[Any]) -> dict[str, Field]:
    """The fields of a class of which some have more than a type."""
    own = vars(plain)
    said = ((name, own.get(name, _PLAIN)) for name, each in plain.__annotations__.items() if not str(each).startswith("ClassVar"))
    return {name: _field(each) for name, each in said}


def _add_methods(given: dict[str, Any], fields: Mapping[str, Field], options: Mapping[str, bool], *, are_plain: bool) -> None:
    """All that a class gets, given to it at once, because a class that is changed tells all that have looked at it."""
    if are_plain:
        parameters = compared = tuple(fields)
    else:
        parameters = tuple([name for name, each in fields.items() if each.init])
        compared = tuple([name for name, each in fields.items() if each.compare])
    values = _values(parameters)
    given["__match_args__"], given["__replace__"] = parameters, _replace(parameters, values)
    if options.get("repr", True):
        given["__repr__"] = _repr
    if options.get("eq", True):
        values = values if compared == parameters else _values(compared)
        given["__eq__"], given["__hash__"] = _eq(values), _hash(values) if options.get("frozen") else None
    if options.get("frozen"):
        given |= _FROZEN


def _field(default: Any) -> Field:
    """What the declaration of a field with a value says of it."""
    if type(default).__module__ == "dataclasses":
        raise TypeError("`field` is to be imported from where `dataclass` is")
    return default if isinstance(default, Field) else Field({"default": default})


def _standard(plain: type[Any], options: Mapping[str, Any]) -> type[Any]:
    """The class as the standard library makes it."""
    import dataclasses

    for name, each in tuple(vars(plain).items()):
        if isinstance(each, Field):
            setattr(plain, name, dataclasses.field(**each.options))
    return dataclasses.dataclass(**options)(plain)


class Declared:
    """What a class was made of: as it was written, with which options, and its fields by their names."""

    __slots__ = ("fields", "options", "plain")

    def __init__(self, plain: type[Any], options: Mapping[str, bool], fields: Mapping[str, Field]) -> None:
        self.plain, self.options, self.fields = plain, options, fields


class _Described:
    """What the standard library knows of a class, worked out when somebody asks.

    `replace` and `fields` ask of many classes, for the fields alone: no method has to be compiled for that.
    """

    __slots__ = ("_name",)

    def __init__(self, name: str) -> None:
        self._name = name

    def __get__(self, instance: object, owner: type[Any]) -> Any:
        made = next(each for each in owner.__mro__ if "__declared__" in vars(each))
        declared: Declared = vars(made)["__declared__"]
        if self._name == _FIELDS:
            described = _standard(declared.plain, {"init": False, "repr": False, "eq": False, "match_args": False})
        else:
            described = _standard(type(made.__name__, (), {}), declared.options)
        found = getattr(described, self._name)
        setattr(made, self._name, found)
        return found


_DESCRIBED = {name: _Described(name) for name in (_FIELDS, "__dataclass_params__")}
"""Where the standard library keeps what it knows of a class."""

_OF_EACH_CLASS = ("__dict__", "__weakref__")
"""What every class without slots has of its own."""


def _init(fields: Mapping[str, Field], names: dict[str, Any], *, are_plain: bool, has_post_init: bool) -> Callable[..., None]:
    """Objects are made often, and generic code would be slow at it: each class has its own, with ``names`` of its own for what it needs."""
    if are_plain and len(fields) < len(STORES) and not has_post_init:
        return _named(STORES[len(fields)], ("self", *fields), names, ())
    kinds: list[tuple[bool, bool]] = []
    defaults: list[Any] = []
    for number, (name, field) in enumerate(fields.items()):
        is_made = field.default_factory is not MISSING
        is_optional = is_made or field.default is not MISSING
        kinds.append((field.init, is_optional and not field.init))
        if is_optional:
            names[f"default{number}"] = field.default
        if field.init and is_optional:
            defaults.append(field.default)
        elif field.init and defaults:
            raise TypeError(f"non-default argument {name!r} follows default argument")
    code = _stores(tuple(kinds), has_post_init=has_post_init)
    parameters = ("self", *(name for name, each in fields.items() if each.init))
    return _named(code, parameters, names, tuple(defaults))


def _named(code: CodeType, parameters: tuple[str, ...], names: dict[str, Any], defaults: tuple[Any, ...]) -> Callable[..., None]:
    named = code.replace(co_name="__init__", co_qualname="__init__", co_varnames=parameters)
    return FunctionType(named, names, "__init__", defaults)


def _made_anew(store: Callable[[object, object], None], make: Callable[[], object]) -> Callable[[object, object], None]:
    """Stores what is given, or else what a factory makes."""
    return lambda self, value: store(self, make() if value is MISSING else value)


@cache
def _stores(kinds: tuple[tuple[bool, bool], ...], *, has_post_init: bool) -> CodeType:
    """The code of an `__init__`: for each field, whether it is a parameter, and whether it has a value of its own if it is none."""
    if len(kinds) < len(STORES) and not has_post_init and all(is_parameter for is_parameter, _ in kinds):
        return STORES[len(kinds)]
    parameters, body = ["self"], list[str]()
    for number, (is_parameter, has_default) in enumerate(kinds):
        if is_parameter:
            parameters.append(f"a{number}")
            body.append(f" set{number}(self, a{number})")
        elif has_default:
            body.append(f" set{number}(self, default{number})")
    body.append(" self.__post_init__()" if has_post_init else " pass")
    made_by: dict[str, Any] = {}
    exec(f"def __init__({', '.join(parameters)}):\n" + "\n".join(body), made_by)  # noqa: S102 - our own text, without a name from elsewhere
    return made_by["__init__"].__code__


def _replace(names: tuple[str, ...], values: Callable[[Any], tuple[Any, ...]]) -> Callable[..., Any]:
    def __replace__(self: Any, /, **changes: Any) -> Any:  # noqa: N807 - what it becomes
        made = list(values(self))
        for name, each in changes.items():
            if name not in names:
                return self.__class__(*made, **changes)  # which says what is wrong
            made[names.index(name)] = each
        return self.__class__(*made)

    return __replace__


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


def _repr(self: Any) -> str:
    names = [name for name, each in self.__declared__.fields.items() if each.repr]
    return f"{self.__class__.__qualname__}({', '.join([f'{name}={getattr(self, name)!r}' for name in names])})"


def _refuse_to_set(self: Any, name: str, value: object) -> None:  # noqa: ARG001 - whatever they are
    from dataclasses import FrozenInstanceError

    raise FrozenInstanceError(f"cannot assign to field {name!r}")


def _refuse_to_delete(self: Any, name: str) -> None:  # noqa: ARG001 - whichever it is
    from dataclasses import FrozenInstanceError

    raise FrozenInstanceError(f"cannot delete field {name!r}")


def _state(self: Any) -> list[Any]:
    return [getattr(self, name) for name in self.__declared__.fields]


def _set_state(self: Any, state: list[Any]) -> None:
    for name, value in zip(self.__declared__.fields, state, strict=True):
        object.__setattr__(self, name, value)


_FROZEN = {"__setattr__": _refuse_to_set, "__delattr__": _refuse_to_delete, "__getstate__": _state, "__setstate__": _set_state}
"""What frozen classes have in common."""
