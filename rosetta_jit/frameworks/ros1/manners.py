"""Holders that behave as the Python classes that genpy writes do, so that code written against those keeps working.

What differs, and why: arrays of numbers are numpy arrays, not tuples; a bool or an integer out of range is refused when it is assigned, not
when it is serialised; what cannot be decoded raises `rosetta_jit.errors.DecodeError`, which says where; and ``serialize_numpy`` and
``deserialize_numpy`` are the plain ones, since arrays are numpy's anyway.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, ClassVar, Protocol, Self, cast

import numpy as np

from rosetta_jit.frameworks.ros1.times import DURATION, TIME
from rosetta_jit.model.types import Array, Bytes, Ref, Schema, Struct, Type
from rosetta_jit.runtime.holder import PLAIN, Family, Holder, Manners
from rosetta_jit.runtime.holder.serialising import Programs, encoded, programs_of

SEPARATOR = "=" * 80


class Buffer(Protocol):
    """A file that bytes are written to."""

    def write(self, data: bytes, /) -> object:
        """Append them."""
        ...


class RosMessage(Holder):
    """A message of ROS 1. Its constants are attributes of the class.

    Parameters
    ----------
    *values, **fields
        Either every field in order, or some by name.

    Attributes
    ----------
    _type, _md5sum, _full_text : str
        Name, sum, and definition with those of all that it contains.
    _has_header : bool
        Whether it begins with a header.
    __slots__, _slot_types : list of str
        Names and types of its fields.
    """

    __slots__ = ()

    begins_alike_ = True

    programs_: ClassVar[Programs | None] = None

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        cls.__slots__ = tuple(each.name for each in cls.family_.struct.fields)  # read by people's code only, once a class is made

    def __init__(self, *values: Any, **fields: Any) -> None:
        super().__init__()
        if not values and not fields:
            return
        names = [each.name for each in self.family_.struct.fields]
        if values and (fields or len(values) != len(names)):
            raise TypeError(f"Invalid number of arguments, args should be {names}")
        for name, value in (*zip(names, values, strict=False), *fields.items()):
            if name not in names:
                raise AttributeError(f"{type(self).__name__} has no field {name!r}")
            setattr(self, name, value)

    def serialize(self, buff: Buffer) -> None:
        """Write the message's bytes.

        Raises
        ------
        EncodeError
            If a fixed array has another length, or a string is no UTF-8.
        """
        buff.write(encoded(self))

    def deserialize(self, data: Any) -> Self:
        """Become the message of some bytes; returns itself.

        Raises
        ------
        DecodeError
            If they are no message of the type.
        """
        programs_of(self).decode(data, self)
        return self

    def serialize_numpy(self, buff: Buffer, numpy: object) -> None:
        """Do the same as `serialize`."""
        del numpy
        self.serialize(buff)

    def deserialize_numpy(self, data: Any, numpy: object) -> Self:
        """Do the same as `deserialize`."""
        del numpy
        return self.deserialize(data)

    def picture_(self) -> Any:
        from rosetta_jit.frameworks.ros.pictures import picture

        return picture(self)

    def __str__(self) -> str:
        return "\n".join(_yaml(self.to_dict()))


def members(family: Family) -> dict[str, Any]:
    """What a class has besides its fields."""
    struct = family.struct
    if struct.name in ("time", "duration"):
        return {"_type": struct.name, **(TIME if struct.name == "time" else DURATION)}
    return {
        **{each.name: each.value for each in struct.constants if not hasattr(RosMessage, each.name)},
        "_type": struct.name,
        "_md5sum": struct.option("md5sum"),
        "_full_text": full_text(struct, family.schema),
        "_has_header": bool(struct.fields) and struct.fields[0].type == Ref("std_msgs/Header"),
        "_slot_types": [spelled(each.type) for each in struct.fields],
    }


def full_text(struct: Struct, schema: Schema) -> str:
    """The definition of a message, and those of the messages in it, each once."""
    text = [str(struct.option("definition") or "")]
    for name in dict.fromkeys(_depends(struct, schema)):
        inner = schema.types[name]
        if isinstance(inner, Struct) and inner.option("definition") is not None:
            text += [SEPARATOR, f"MSG: {name}", str(inner.option("definition"))]
    return "\n".join(text)


def _depends(struct: Struct, schema: Schema) -> Iterator[str]:
    """The names of all messages in one, depth first."""
    for each in struct.fields:
        type_ = each.type.element if isinstance(each.type, Array) else each.type
        if isinstance(type_, Ref):
            yield type_.name
            inner = schema.types[type_.name]
            if isinstance(inner, Struct):
                yield from _depends(inner, schema)


def spelled(type_: Type) -> str:
    """A type as a `.msg` file has it."""
    match type_:
        case Ref(name):
            return name
        case Array(element, length):
            return f"{spelled(element)}[{length or ''}]"
        case Bytes(word, length):
            return f"{word}[{length or ''}]"
        case _:
            return getattr(type_, "spelling", "")


def _yaml(values: dict[str, Any], indent: str = "") -> Iterator[str]:
    """Lines of YAML, as `rostopic echo` prints them."""
    for name, value in values.items():
        match value:
            case dict():
                yield f"{indent}{name}: "
                yield from _yaml(cast("dict[str, Any]", value), indent + "  ")
            case [dict(), *_]:
                yield f"{indent}{name}: "
                for each in cast("list[dict[str, Any]]", value):
                    first, *others = _yaml(each, indent + "    ")
                    yield f"{indent}  - {first.lstrip()}"
                    yield from others
            case str():
                yield f'{indent}{name}: "{value}"'
            case _:
                yield f"{indent}{name}: {value!r}"


GENPY = Manners(
    RosMessage,
    np.ndarray,
    PLAIN.sequence,
    PLAIN.mapping,
    assigns_whole=True,
    members=members,
    serialising=("ros1", "ros1"),
    foreign="rosetta_jit.frameworks.ros1.objects:OBJECTS",
    place="rosetta_jit.frameworks.ros1.manners:GENPY",
    methods=lambda _: {"serialize": "write", "deserialize": "decode"},
)
"""The manners of genpy's classes."""
