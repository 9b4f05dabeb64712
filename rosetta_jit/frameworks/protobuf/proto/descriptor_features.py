"""What descriptors say since there are editions: features, and imports for options alone.

Older versions of protobuf's Python package know fewer of these fields; to them the others are unknown fields.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from rosetta_jit.frameworks.protobuf.proto.features import FEATURES
from rosetta_jit.frameworks.protobuf.proto.tree import Aggregate, Entry, Option, Word

if TYPE_CHECKING:
    from google.protobuf.descriptor_pb2 import (
        EnumOptions,
        FieldOptions,
        FileDescriptorProto,
        FileOptions,
        MessageOptions,
        OneofOptions,
    )

    Holder = FileOptions | MessageOptions | FieldOptions | OneofOptions | EnumOptions

OPTION_DEPENDENCY = 15
"""The number of `FileDescriptorProto.option_dependency`."""
MEANT = range(1, 7)
"""Numbers of the features in a FeatureSet that change what is on the wire; those behind them are for protoc alone."""


def features(options: Holder) -> Iterator[Option]:
    """The features that an options message chooses, as one option."""
    if options.HasField("features"):
        chosen = options.features.ListFields()
        words = ((field.name, field.enum_type.values_by_number[value].name) for field, value in chosen if field.enum_type is not None)
        yield Option(("features",), Aggregate(tuple(Entry(name, Word(word)) for name, word in words if name in FEATURES)))


def has_unknown_features(options: Holder) -> bool:
    """Whether a feature that changes what is on the wire has a value that is not known."""
    from google.protobuf.unknown_fields import UnknownFieldSet

    return options.HasField("features") and any(each.field_number in MEANT for each in UnknownFieldSet(options.features))


def option_dependencies(file: FileDescriptorProto) -> Sequence[str]:
    """The files that a file imports for its options alone."""
    from google.protobuf.unknown_fields import UnknownFieldSet

    if hasattr(file, "option_dependency"):
        return file.option_dependency
    unknown = (each for each in UnknownFieldSet(file) if each.field_number == OPTION_DEPENDENCY)
    return [each.data.decode(errors="replace") for each in unknown if isinstance(each.data, bytes)]
