"""Holders that behave as the Python classes that rosidl_generator_py writes do, so that code written against those keeps working.

What differs, and why: sequences of numbers are numpy arrays, not ``array.array``; values of a wrong kind raise TypeError, those out of
range or beyond a bound ValueError, also where Python runs with ``-O`` and rosidl's assertions are off; and what cannot be decoded raises
`rosetta_jit.errors.DecodeError`, which says where.
"""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np

from rosetta_jit.frameworks.ros2.empty import DUMMY
from rosetta_jit.model.types import Array, Bytes, Field, Optional, Ref, String, Type, name_parts
from rosetta_jit.runtime.holder import PLAIN, Family, Holder, Manners
from rosetta_jit.runtime.holder.serialising import Programs, encoded, programs_of

SPELLED = {"float32": "float", "float64": "double", "bool": "boolean", "byte": "octet", "char": "uint8"}
"""Words of `.msg` files that IDL has other words for."""


class Ros2Message(Holder):
    """A message of ROS 2. Its constants are attributes of the class; a new one has the defaults of its definition.

    Parameters
    ----------
    **fields
        Values by name.
    """

    __slots__ = ()

    begins_alike_ = True

    programs_: ClassVar[Programs | None] = None
    defaults_: ClassVar[dict[str, Any]] = {}
    fields_: ClassVar[dict[str, str]] = {}

    def __init__(self, **fields: Any) -> None:
        super().__init__()
        for name, value in self.defaults_.items():
            setattr(self, name, value)
        if not fields:
            return
        unknown = fields.keys() - self.fields_.keys()
        if unknown:
            raise TypeError(f"Invalid arguments passed to constructor: {', '.join(sorted(unknown))}")
        for name, value in fields.items():
            setattr(self, name, value)

    @classmethod
    def get_fields_and_field_types(cls) -> dict[str, str]:
        """The types of all fields, as IDL has them, by name."""
        return dict(cls.fields_)

    def picture_(self) -> Any:
        from rosetta_jit.frameworks.ros.pictures import picture

        return picture(self)

    def __repr__(self) -> str:
        values = ", ".join(f"{name}={getattr(self, name)!r}" for name in self.fields_)
        return f"{type(self).__module__}.{type(self).__name__}({values})"


def serialize_message(message: Any) -> bytes:
    """A message's bytes, as `rclpy.serialization` makes them.

    Raises
    ------
    EncodeError
        If the message cannot be written.
    """
    return encoded(message)


def deserialize_message(data: Any, message_type: type[Ros2Message]) -> Any:
    """The message of some bytes.

    Raises
    ------
    DecodeError
        If they are no message of the type.
    """
    programs = programs_of(message_type)
    message = programs.new()
    programs.decode(data, message)
    return message


def members(family: Family) -> dict[str, Any]:
    """What a class has besides its fields: constants, the types of the fields, their defaults."""
    struct = family.struct
    fields = [each for each in struct.fields if each.name != DUMMY]
    return {
        **{each.name: each.value for each in struct.constants if not hasattr(Ros2Message, each.name)},
        "fields_": {each.name: spelled(each.type) for each in fields},
        "defaults_": {each.name: _default(each) for each in fields if not _is_initial(each)},
    }


def _is_initial(field: Field) -> bool:
    """Whether a new message has the default of a field without being given it: there is none, or it is zero or empty."""
    default = _default(field)
    return default is None or (not default and not isinstance(field.type, Optional))


def _default(field: Field) -> Any:
    several = field.option("default")
    if not isinstance(several, str):
        return field.default
    import json  # few fields have defaults of several values

    return json.loads(several)


def spelled(type_: Type) -> str:
    """A type as rosidl names it."""
    match type_:
        case Ref(name):
            return "/".join(name_parts(name))
        case String(encoding, _, maximum):
            return ("wstring" if encoding == "utf-16" else "string") + (f"<{maximum}>" if maximum is not None else "")
        case Array(element, length, maximum) | Bytes(element, length, maximum):
            inner = SPELLED.get(element, element) if isinstance(element, str) else spelled(element)
            if length is not None:
                return f"{inner}[{length}]"
            return f"sequence<{inner}>" if maximum is None else f"sequence<{inner}, {maximum}>"
        case Optional(value):
            return spelled(value)
        case _:
            word = getattr(type_, "spelling", "")
            return SPELLED.get(word, word)


RCLPY = Manners(
    Ros2Message,
    np.ndarray,
    PLAIN.sequence,
    PLAIN.mapping,
    assigns_whole=True,
    members=members,
    serialising=("ros2", "cdr"),
    foreign="rosetta_jit.frameworks.ros2.objects:OBJECTS",
    place="rosetta_jit.frameworks.ros2.manners:RCLPY",
)
"""The manners of rosidl's classes."""
