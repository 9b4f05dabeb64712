"""Holders that behave as protobuf's generated Python classes do, so that code written against those keeps working.

What differs, and why: repeated numbers are numpy arrays (see `rosetta_jit.frameworks.protobuf.number_array`); bytes fields also take
bytearrays, memoryviews and numpy arrays; views of nested messages do not outlive the next decode into their holder, and show the element
at their index where elements before it are deleted; NaN differs from NaN; errors of parsing and serialising are
`rosetta_jit.errors.DecodeError` and `EncodeError`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Self, cast

from rosetta_jit.errors import EncodeError
from rosetta_jit.frameworks.protobuf.number_array import NumberArray
from rosetta_jit.frameworks.protobuf.presence import known, missing, requires, set_entries
from rosetta_jit.model.types import Enum, Union
from rosetta_jit.runtime.holder import Family, Holder, Manners
from rosetta_jit.runtime.holder.classes import clear
from rosetta_jit.runtime.holder.message import Message, View, make_present, place
from rosetta_jit.runtime.holder.record import Entry, Record
from rosetta_jit.runtime.holder.serialising import Kind, Programs, encoded, programs_of
from rosetta_jit.startup.late import late

if TYPE_CHECKING:
    from rosetta_jit.frameworks.protobuf import introspection
    from rosetta_jit.frameworks.protobuf.introspection import FieldDescriptor, MessageDescriptor
    from rosetta_jit.runtime.holder import access, arena, merge
else:
    (introspection,) = late("rosetta_jit.frameworks.protobuf", "introspection")
    access, arena, merge = late("rosetta_jit.runtime.holder", "access", "arena", "merge")


class ProtobufMessage(Holder):
    """A message of a type that protobuf's IDL describes.

    Attributes
    ----------
    DESCRIPTOR : MessageDescriptor
        Its fields, by name and number.
    """

    __slots__ = ()

    begins_alike_ = True

    DESCRIPTOR: ClassVar[MessageDescriptor]
    requires_: ClassVar[bool]
    programs_: ClassVar[Programs | None] = None

    def __init__(self, **fields: Any) -> None:
        super().__init__()
        if fields:
            merge.fill(self, {name: value for name, value in fields.items() if value is not None})

    def HasField(self, name: str) -> bool:  # noqa: N802  as protobuf names it
        """Whether a field, or any field of a oneof, is set.

        Raises
        ------
        ValueError
            If there is no such field, or it is always there.
        """
        record = self.access_.record
        if name in record.unions:
            return ProtobufMessage.WhichOneof(self, name) is not None
        entry = self._entry(name)
        if entry.presence is None:
            raise ValueError(f"Field {record.struct}.{name} does not have presence.")
        lanes, row = place(self)
        return arena.present(lanes, entry.presence, row)

    def __contains__(self, name: object) -> bool:
        """``name in message``, as `HasField` says it."""
        if not isinstance(name, str):
            raise ValueError(f"Expected a field name, but got non-string argument {name!r}.")  # noqa: TRY004 - as protobuf has it
        return ProtobufMessage.HasField(self, name)

    def ClearField(self, name: str) -> None:  # noqa: N802
        """Make a field absent, or whichever field of a oneof is set. The message itself is present in the one around it from then on."""
        if isinstance(self, View):
            make_present(self)
        if name in self.access_.record.unions:
            case = ProtobufMessage.WhichOneof(self, name)
            if case is not None:
                clear(self, case)
            return
        clear(self, self._entry(name).name)

    def Clear(self) -> None:  # noqa: N802
        """Make all fields absent. The message itself is present in the one around it from then on."""
        if isinstance(self, View):
            make_present(self)
        clear(self, None)

    def WhichOneof(self, name: str) -> str | None:  # noqa: N802
        """The name of the field of a oneof that is set."""
        record = self.access_.record
        if name not in record.unions:
            raise ValueError(f'Protocol message {type(self).__name__} has no oneof "{name}" field.')
        lanes, row = place(self)
        return next((case for case in record.unions[name] if arena.present(lanes, record.entries[case].presence, row)), None)

    def ListFields(self) -> list[tuple[FieldDescriptor, Any]]:  # noqa: N802
        """Descriptors and values of the fields that are set, by number."""
        fields = self.DESCRIPTOR.fields_by_name
        entries = set_entries(self.access_.record, access.raw(self))
        return [(fields[entry.name], self.access_.getters[entry.name](self)) for entry, _ in entries]

    def SetInParent(self) -> None:  # noqa: N802
        """Make this message present in the one around it."""
        make_present(self)

    def MergeFrom(self, other: Any) -> None:  # noqa: N802
        """Take over what another message of the type has: singular fields replace, repeated ones are appended, messages merge."""
        values = self._raw_of(other, "MergeFrom")
        make_present(self)
        merge.merge(self, values)

    def CopyFrom(self, other: Any) -> None:  # noqa: N802
        """Become equal to another message of the type."""
        if other is not self:
            values = self._raw_of(other, "CopyFrom")
            make_present(self)
            clear(self, None)
            merge.merge(self, values)

    def DiscardUnknownFields(self) -> None:  # noqa: N802
        """Forget the fields that the schema does not know, and those of messages within."""
        values = access.raw(self)
        make_present(self)
        clear(self, None)
        merge.merge(self, known(self.access_.record, values))

    def IsInitialized(self) -> bool:  # noqa: N802
        """Whether all required fields are set."""
        return not ProtobufMessage.FindInitializationErrors(self)

    def FindInitializationErrors(self) -> list[str]:  # noqa: N802
        """Paths of the required fields that are not set."""
        return list(missing(self.access_.record, access.raw(self)))

    def SerializeToString(self, *, deterministic: bool | None = None) -> bytes:  # noqa: N802, ARG002  always deterministic
        """The message's bytes. They are the same every time, whatever ``deterministic`` says.

        Raises
        ------
        EncodeError
            If a required field is not set.
        """
        errors = ProtobufMessage.FindInitializationErrors(self) if self.requires_ else ()
        if errors:
            raise EncodeError(
                "missing", f".{errors[0]}", f"Message {self.DESCRIPTOR.full_name} is missing required fields: {','.join(errors)}"
            )
        return encoded(self)

    def SerializePartialToString(self, *, deterministic: bool | None = None) -> bytes:  # noqa: N802, ARG002  always deterministic
        """The message's bytes, even if required fields are missing."""
        return encoded(self)

    def ByteSize(self) -> int:  # noqa: N802
        """How many bytes the message takes."""
        return programs_of(self).size(self.__deepcopy__({}) if isinstance(self, View) else self)

    def ParseFromString(self, data: Any) -> int:  # noqa: N802
        """Become what bytes say; how many they were.

        Raises
        ------
        DecodeError
            If they are no message of the type.
        """
        if isinstance(self, View):
            ProtobufMessage.CopyFrom(self, self._parsed(data))
        else:
            programs_of(self).decode(data, self)
        return len(data)

    def MergeFromString(self, data: Any) -> int:  # noqa: N802
        """Merge with what bytes say; how many they were."""
        ProtobufMessage.MergeFrom(self, self._parsed(data))
        return len(data)

    @classmethod
    def FromString(cls, data: Any) -> Self:  # noqa: N802
        """A new message of bytes."""
        return cast("Self", cls._parsed(data))

    def __str__(self) -> str:
        from rosetta_jit.frameworks.protobuf import text_format

        return text_format.text(self.access_.record, access.raw(self))

    __repr__ = __str__

    def picture_(self) -> Any:
        from rosetta_jit.frameworks.protobuf.pictures import picture

        return picture(self)

    def set_fields_(self, fields: Mapping[str, Any]) -> None:
        """Set fields as the constructor does."""
        merge.fill(self, fields)

    @classmethod
    def _parsed(cls, data: Any) -> ProtobufMessage:
        message = programs_of(cls.family_.holder).new()
        ProtobufMessage.ParseFromString(message, data)
        return message

    def _entry(self, name: str) -> Entry:
        try:
            return self.access_.record.entries[name]
        except KeyError:
            raise ValueError(f'Protocol message {type(self).__name__} has no "{name}" field.') from None

    def _raw_of(self, other: Any, method: str) -> dict[str, Any]:
        record: Record = self.access_.record
        if not isinstance(other, Message) or other.access_.record.struct != record.struct:
            expected = f"expected {record.struct} got {type(other).__name__}"
            raise TypeError(f"Parameter to {method}() must be instance of same class: {expected}.")
        return access.raw(other)


class _Nested:
    """The class of a message declared in another, made when first asked for."""

    def __init__(self, family: Family, name: str) -> None:
        self.family = family
        self.name = name

    def __get__(self, instance: object, owner: type) -> type[Holder]:
        return self.family.of_struct(self.name)


class _Descriptor:
    """The descriptor of a class, made when first asked for: then it is an attribute of the class."""

    def __init__(self, family: Family) -> None:
        self.family = family

    def __get__(self, instance: object, owner: type) -> MessageDescriptor:
        made = introspection.MessageDescriptor(self.family.struct, self.family.schema)
        self.family.holder.DESCRIPTOR = made  # pyright: ignore[reportAttributeAccessIssue] - it is a class of these manners
        return made


def members(family: Family) -> dict[str, Any]:
    """What a generated class has besides its fields: its descriptor, its enums and their constants, the classes declared in it."""
    fields = [case for each in family.struct.fields for case in (each.type.cases if isinstance(each.type, Union) else (each,))]
    found: dict[str, Any] = {f"{each.name.upper()}_FIELD_NUMBER": each.number or 0 for each in fields}
    for name in sorted(each for each in family.schema.types if each.rpartition(".")[0] == family.struct.name):
        declared, own = family.schema.types[name], name.rpartition(".")[2]
        if isinstance(declared, Enum):
            found |= dict(declared.values)
            found[own] = introspection.EnumClass(declared)
        else:
            found[own] = _Nested(family, name)
    return (
        {name: value for name, value in found.items() if not name.startswith("__")}
        | methods_of(family.struct.name)
        | {"DESCRIPTOR": _Descriptor(family), "requires_": requires(family.tree.root)}
    )


def methods(family: Family) -> dict[str, Kind]:
    """The methods that do nothing but serialise: where fields are required, one asks for these first."""
    found: dict[str, Kind] = {"SerializePartialToString": "encode", "ParseFromString": "parse", "FromString": "make"}
    return found if requires(family.tree.root) else {**found, "SerializeToString": "encode"}


PROTOBUF = Manners(
    ProtobufMessage,
    NumberArray,
    "rosetta_jit.frameworks.protobuf.repeated:repeated",
    "rosetta_jit.frameworks.protobuf.repeated:MapField",
    assigns_whole=False,
    members=members,
    serialising=("protobuf", "protobuf-partial"),
    foreign="rosetta_jit.frameworks.protobuf.objects:OBJECTS",
    place="rosetta_jit.frameworks.protobuf.manners:PROTOBUF",
    methods=methods,
)
"""The manners of protobuf's messages."""


_SECONDS = (
    "FromMicroseconds",
    "FromMilliseconds",
    "FromNanoseconds",
    "FromSeconds",
    "ToMicroseconds",
    "ToMilliseconds",
    "ToNanoseconds",
    "ToSeconds",
)
_SUMS = ("__add__", "__radd__", "__rsub__", "__sub__")
_JSON = ("FromJsonString", "ToJsonString")
_ITEMS = ("__delitem__", "__getitem__", "__len__", "__setitem__", "items")
METHODS = {
    "google.protobuf.Any": ("Is", "Pack", "TypeName", "Unpack"),
    "google.protobuf.Duration": (*_SECONDS, *_SUMS, *_JSON, "FromTimedelta", "ToTimedelta", "_NormalizeDuration"),
    "google.protobuf.FieldMask": (
        *_JSON,
        "AllFieldsFromDescriptor",
        "CanonicalFormFromMask",
        "Intersect",
        "IsValidForDescriptor",
        "MergeMessage",
        "Union",
    ),
    "google.protobuf.ListValue": (*_ITEMS, "add_list", "add_struct", "append", "extend"),
    "google.protobuf.Struct": (*_ITEMS, "__iter__", "get_or_create_list", "get_or_create_struct", "keys", "update", "values"),
    "google.protobuf.Timestamp": (*_SECONDS, *_SUMS, *_JSON, "FromDatetime", "GetCurrentTime", "ToDatetime"),
}
"""The methods that protobuf's package gives its well-known types, by the names of these types.

They are the package's own functions, which need nothing of a message but its fields.
"""


def methods_of(struct: str) -> dict[str, Any]:
    """The methods of a type, by name; none of any other. What those that are containers contain is not a matter of their fields."""
    found: dict[str, Any] = {name: _Theirs(struct, name) for name in METHODS.get(struct, ())}
    return {**found, "__contains__": _among} if "__getitem__" in found else found


def _among(self: Any, value: object) -> bool:
    return any(each == value for each in iter(self))


class _Theirs:
    """A method of a class of the package, which is imported when one is first asked for."""

    def __init__(self, struct: str, name: str) -> None:
        self._struct = struct
        self._name = name

    def __get__(self, instance: object, owner: type) -> Any:
        from google.protobuf.internal.well_known_types import WKTBASES

        found: Any = vars(WKTBASES[self._struct])[self._name]
        return found.__get__(instance, owner)
