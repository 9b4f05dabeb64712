"""Structs of the model that YARP does not write as a list of their fields, and the options by which an encoding knows them.

form = packed     the values of the fields, one behind the other, without code or count
     | bare       the code and the count of a list, then such values
union             a struct of two fields: `_d`, the number of the case, and `_u`, the model's union
dict              a struct all of whose fields have the option ``key``
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from rosetta_jit.model.types import Enum, Field, Struct, Type, Union

if TYPE_CHECKING:
    from rosetta_jit.source import Span


def make_union(name: str, cases: Sequence[Field], span: Span) -> Struct:
    """A union of these cases; the first is that of a new message."""
    case = Enum(f"{name}.case", tuple((each.name, number) for number, each in enumerate(cases)), span=span)
    labels = tuple((number,) for number in range(len(cases)))
    union = Union(name, tuple(cases), span, "_d", labels)
    return Struct(name, (Field("_d", case, span=span), Field("_u", union, span=span)), span=span, options=(("union", True),))


def union_of(type_: Type) -> Union | None:
    """The model's union in a struct that is one."""
    if not isinstance(type_, Struct) or not type_.option("union"):
        return None
    union = type_.fields[1].type
    return union if isinstance(union, Union) else None


def is_packed(struct: Struct) -> bool:
    """Whether a struct is the values of its fields alone."""
    return struct.option("form") == "packed"


def is_dict(struct: Struct) -> bool:
    """Whether a struct is a dict with a field for each key."""
    return bool(struct.fields) and struct.fields[0].option("key") is not None
