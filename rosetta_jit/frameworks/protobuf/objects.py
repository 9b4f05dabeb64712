"""Messages of protobuf's own Python package, handed over as bytes: its C code writes and reads them faster than any attribute is read.

So presence, oneofs, fields that the schema does not know, and the order of maps come along. The class must be of the holder's type: of the
same fields with the same numbers, which is asked once a class, of its descriptor.
"""

from __future__ import annotations

from typing import Any

from rosetta_jit.errors import RosettaError
from rosetta_jit.model.types import Array, Bool, Bytes, Enum, Float, Int, Map, Optional, Ref, Schema, String, Struct, Type, Union
from rosetta_jit.runtime.holder import Family
from rosetta_jit.runtime.holder.message import Message
from rosetta_jit.runtime.holder.objects.foreign import Foreign, Whole
from rosetta_jit.runtime.holder.objects.in_c import InC, functions_in_c
from rosetta_jit.runtime.holder.serialising import programs_of

READS: frozenset[str | None] = frozenset({None, "protobuf", "protobuf-partial"})
"""The encodings that are protobuf's own bytes, the framework's usual one among them."""

UPB = "google._upb._message"
"""The module of the class from which those of protobuf's C code derive."""

PARTIAL: frozenset[str | None] = frozenset({"protobuf-partial"})
"""Those of them in which a message may lack what is required."""


def whole(family: Family, object_type: Any) -> Whole | None:
    """How messages of a class are handed over, if it is one of protobuf's; raises TypeError if it is of another type than the holders."""
    if not _is_protobuf(object_type):
        return None
    _check(family, object_type)
    programs, parse, write = programs_of(family.holder), object_type.FromString, object_type.SerializePartialToString

    def take(holder: Any, message: Any) -> None:
        programs.decode(write(message), holder)

    def fill(message: Any, holder: Any) -> None:
        message.ParseFromString(programs.encode(holder))

    def make(holder: Any) -> Any:
        return parse(programs.encode(holder))

    has_required = _has_required(family.schema)
    writes = PARTIAL if has_required else READS
    is_exact = not has_required and _Alike().message(object_type.DESCRIPTOR)
    direct = in_c(object_type)
    return Whole(
        take, fill, make, programs=programs, bytes_of=write, of_bytes=parse, reads=READS, writes=writes, is_exact=is_exact, in_c=direct
    )


def in_c(object_type: Any) -> InC | None:
    """The functions in C of a class of upb's; None of other classes.

    In upb (python/message.c of protobuf) `FromString` makes an empty message and merges the bytes into it. The initialiser does nothing
    where it is given nothing.
    """
    return functions_in_c(object_type, UPB, write="SerializePartialToString", merge="MergeFromString")


def _has_required(schema: Schema) -> bool:
    """Whether there is a field without which a message cannot be written."""
    return any(field.required for struct in schema.types.values() if isinstance(struct, Struct) for field in struct.fields)


class _Alike:
    """Whether protobuf's package refuses whatever our programs do, given descriptors of messages.

    Of texts that is sure in files of proto3, where they must be UTF-8; of messages within themselves it is not, as the depths differ.
    """

    def __init__(self) -> None:
        self._messages: dict[str, bool] = {}
        self._files: dict[str, bool] = {}

    def message(self, message: Any) -> bool:
        """Of a message and all within it."""
        if message.full_name not in self._messages:
            self._messages[message.full_name] = False  # until all of it is known, so also of one that is within itself
            self._messages[message.full_name] = all(map(self._field, message.fields))
        return self._messages[message.full_name]

    def _field(self, field: Any) -> bool:
        match field.type:
            case field.TYPE_STRING:
                return self._has_checked_texts(field.file)
            case field.TYPE_MESSAGE:
                return self.message(field.message_type)
            case type_:
                return type_ != field.TYPE_GROUP

    def _has_checked_texts(self, file: Any) -> bool:
        from google.protobuf.descriptor_pb2 import FileDescriptorProto

        if file.name not in self._files:
            self._files[file.name] = FileDescriptorProto.FromString(file.serialized_pb).syntax == "proto3"
        return self._files[file.name]


def _is_protobuf(object_type: Any) -> bool:
    file = getattr(getattr(object_type, "DESCRIPTOR", None), "file", None)
    return hasattr(file, "serialized_pb") and not issubclass(object_type, Message)


def _check(family: Family, object_type: Any) -> None:
    from rosetta_jit.frameworks.protobuf.descriptors import from_message_class

    name = object_type.DESCRIPTOR.full_name
    try:
        schema = from_message_class(object_type)
    except RosettaError as problem:
        raise TypeError(f"the descriptor of {name} cannot be read: {problem}") from problem
    different = None if name != family.struct.name else _Comparison(family.schema, schema).difference(Ref(name), Ref(name), name)
    if name != family.struct.name or different is not None:
        raise TypeError(f"a message of {family.struct.name} is needed, not of {name}" + (f": {different} is another" if different else ""))


class _Comparison:
    """Two schemas, of which types are compared: what decides how their bytes are read. Structs that are being compared count as equal."""

    def __init__(self, one: Schema, other: Schema) -> None:
        self._one, self._other = one, other
        self._seen: set[str] = set()

    def difference(self, one: Type, other: Type, path: str) -> str | None:
        """Where two types differ first; None if they do not."""
        mine, its = self._one.resolve(one), self._other.resolve(other)
        match mine, its:
            case Struct(), Struct():
                return self._of_structs(mine, its, path)
            case Array(inner), Array(own):
                return self.difference(inner, own, path)
            case Optional(inner), Optional(own):
                return self.difference(inner, own, path)
            case Map(key, value), Map(other_key, other_value):
                return self.difference(key, other_key, path) or self.difference(value, other_value, path)
            case Union(), Union():
                return self._of_fields(mine.cases, its.cases, path)
            case Enum(), Enum():
                return None if (mine.closed, dict(mine.values)) == (its.closed, dict(its.values)) else path
            case ((Bool() | Int() | Float() | String() | Bytes()), _):
                return None if mine == its else path
            case _:
                return path

    def _of_structs(self, mine: Struct, its: Struct, path: str) -> str | None:
        if mine.name in self._seen:
            return None
        self._seen.add(mine.name)
        return self._of_fields(mine.fields, its.fields, path)

    def _of_fields(self, mine: Any, its: Any, path: str) -> str | None:
        its_fields = {each.name: each for each in its}
        for each in mine:
            other = its_fields.pop(each.name, None)
            if other is None or other.number != each.number or other.required != each.required:
                return f"{path}.{each.name}"
            found = self.difference(each.type, other.type, f"{path}.{each.name}")
            if found is not None:
                return found
        return f"{path}.{next(iter(its_fields))}" if its_fields else None


OBJECTS = Foreign(whole=whole)
"""What is particular about the messages of protobuf's package."""
