"""How YARP writes a type: bottles in one of three dialects, or in whichever a message is.

A bottle of fields is a list with a place for each. Where all its elements have one scalar type, YARP specialises it: the type is told
once, in the list's code. Thrift's writer never does, so a reader takes both forms. (os/impl/BottleImpl.cpp, os/idl/WireWriter.cpp)

What is written always has the form that YARP's own writer chooses, so the common case of reading is a message of known shape: it is the
first attempt, and the general one comes after it.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import takewhile
from typing import TYPE_CHECKING

from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.yarp.bottle_codec import Bottles
from rosetta_jit.frameworks.yarp.tags import DIALECTS, YARP3, YARP4, YARP2012, Dialect
from rosetta_jit.model.recursive_structs import recursive_structs
from rosetta_jit.model.types import Array, Map, Ref, Schema, String, Struct, Type, Union
from rosetta_jit.startup.dataclass import dataclass, replace
from rosetta_jit.wire.codec import Choice, Codec, Constant, Encoding, Seq

if TYPE_CHECKING:
    from rosetta_jit.frameworks.base import Choices


def encode_type(struct: Struct, schema: Schema, dialect: str, choices: Choices) -> Encoding:
    """The encoding of a bottle schema's type: of one dialect by name, or ``yarp`` for any.

    Raises
    ------
    SchemaError
        If the dialect has no tag for a type of the schema.
    """
    if dialect != "yarp":
        attempts = _attempts(struct, schema, DIALECTS[dialect])
        return Encoding(dialect, _codecs(attempts), attempts[-1].codec, nested=_nested(attempts), expected=len(attempts) - 1)
    usable = [each for each in (YARP2012, YARP3, YARP4) if not _missing(struct, schema, each)]
    if not usable:
        return encode_type(struct, schema, "yarp4", choices)
    if not _has_text(struct, schema) and len(usable) > 1:
        usable = [each for each in usable if each is not YARP2012]
    forms = [_attempts(struct, schema, each) for each in usable]
    ordered = [form[0] for form in forms] + [each for form in forms for each in form[1:]]
    different = [*dict.fromkeys(ordered)]
    general = {form[-1] for form in forms}
    expected = sum(1 for _ in takewhile(lambda each: each not in general, different))
    return Encoding("yarp", _codecs(different), None, nested=_nested(different), expected=expected)


@dataclass(frozen=True, slots=True)
class _Attempt:
    """The codec of a message, and those of the structs in it that contain themselves."""

    codec: Codec
    nested: tuple[tuple[str, Codec], ...] = ()


def _codecs(attempts: Sequence[_Attempt]) -> tuple[Codec, ...]:
    return tuple(each.codec for each in attempts)


def _nested(attempts: Sequence[_Attempt]) -> tuple[dict[str, Codec], ...]:
    return tuple(dict(each.nested) for each in attempts) if any(each.nested for each in attempts) else ()


def _attempts(struct: Struct, schema: Schema, dialect: Dialect) -> tuple[_Attempt, ...]:
    """What a reader tries: the form that YARP writes for what is not empty, then whatever it reads. The last one is written."""
    if struct.option("thrift"):
        from rosetta_jit.frameworks.yarp.thrift.encoding import Thrift

        thrift = Thrift(schema, dialect, recursive_structs(Ref(struct.name), schema))
        return (_Attempt(thrift.message(struct), tuple(thrift.nested().items())),)
    expected = _Attempt(Bottles(schema, dialect, exact=True).message(struct))
    general = _Attempt(_behind(expected.codec, Bottles(schema, dialect).message(struct)))
    return (expected, general) if expected != general else (general,)


def _behind(expected: Codec, general: Codec) -> Codec:
    """The general form as a reader takes it that has tried the expected one, which is the first of its alternatives or something else."""
    match expected, general:
        case Seq((Constant(_, code, _, _, "tag"), body)), Choice(_, _, ((first, same), *_)) if (code, body) == (first, same):
            return replace(general, tried=1)
        case _:
            return general


def _missing(struct: Struct, schema: Schema, dialect: Dialect) -> bool:
    try:
        _attempts(struct, schema, dialect)
    except SchemaError:
        return True
    return False


def _has_text(struct: Struct, schema: Schema) -> bool:
    """Whether strings are in a message, which 2012 wrote in its own way."""
    pending: list[Type] = [struct]
    seen: set[str] = set()
    while pending:
        match pending.pop():
            case String() | Map():
                return True
            case Array(element):
                pending.append(element)
            case Struct(_, fields) | Union(_, fields):
                if any(each.option("key") is not None for each in fields):
                    return True
                pending += [each.type for each in fields]
            case Ref(name) if name not in seen:
                seen.add(name)
                pending.append(schema.types[name])
            case _:
                pass
    return False
