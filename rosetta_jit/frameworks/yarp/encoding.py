"""How YARP writes a type: bottles in one of three dialects, or in whichever a message is.

A bottle of fields is a list with a place for each. Where all its elements have one scalar type, YARP specialises it: the type is told
once, in the list's code. Thrift's writer never does, so a reader takes both forms. (os/impl/BottleImpl.cpp, os/idl/WireWriter.cpp)

What is written always has the form that YARP's own writer chooses, so the common case of reading is a message of known shape: it is the
first attempt, and the general one comes after it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.catalogue.thrift import endless
from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.yarp.bottle_codec import Bottles
from rosetta_jit.frameworks.yarp.tags import DIALECTS, YARP3, YARP4, YARP2012, Dialect
from rosetta_jit.frameworks.yarp.thrift_encoding import Thrift
from rosetta_jit.model.layout import recursive_structs
from rosetta_jit.model.types import Array, Map, Ref, Schema, String, Struct
from rosetta_jit.wire.codec import Codec, Encoding

if TYPE_CHECKING:
    from rosetta_jit.frameworks.base import Choices
    from rosetta_jit.model.types import Type


def encode_type(struct: Struct, schema: Schema, dialect: str, choices: Choices) -> Encoding:
    """The encoding of a bottle schema's type: of one dialect by name, or ``yarp`` for any.

    Raises
    ------
    SchemaError
        If the dialect has no tag for a type of the schema.
    """
    if dialect != "yarp":
        return Encoding(dialect, _forms(struct, schema, DIALECTS[dialect]), _message(struct, schema, DIALECTS[dialect]))
    usable = [each for each in (YARP2012, YARP3, YARP4) if not _missing(struct, schema, each)]
    if not usable:
        return encode_type(struct, schema, "yarp4", choices)
    if not _has_text(struct, schema) and len(usable) > 1:
        usable = [each for each in usable if each is not YARP2012]
    forms = [_forms(struct, schema, each) for each in usable]
    ordered = [form[0] for form in forms] + [each for form in forms for each in form[1:]]
    return Encoding("yarp", tuple(dict.fromkeys(ordered)), None)


def _forms(struct: Struct, schema: Schema, dialect: Dialect) -> tuple[Codec, ...]:
    """The form that YARP writes, then whatever it reads."""
    if struct.option("thrift"):
        return (_message(struct, schema, dialect),)
    expected = Bottles(schema, dialect, exact=True).message(struct)
    general = Bottles(schema, dialect).message(struct)
    return (expected, general) if expected != general else (general,)


def _message(struct: Struct, schema: Schema, dialect: Dialect) -> Codec:
    if not struct.option("thrift"):
        return Bottles(schema, dialect).message(struct)
    for name in sorted(recursive_structs(Ref(struct.name), schema)):
        raise SchemaError((endless(schema.types[name].span, name),))
    return Thrift(schema, dialect).message(struct)


def _missing(struct: Struct, schema: Schema, dialect: Dialect) -> bool:
    try:
        _message(struct, schema, dialect)
    except SchemaError:
        return True
    return False


def _has_text(type_: Type, schema: Schema) -> bool:
    match schema.resolve(type_):
        case String() | Map():
            return True
        case Array(element, _):
            return _has_text(element, schema)
        case Struct(_, fields):
            return any(each.option("key") is not None or _has_text(each.type, schema) for each in fields)
        case _:
            return False
