"""The scalar types of the language, by their words."""

from __future__ import annotations

from collections.abc import Mapping

from rosetta_jit.model.types import Bool, Bytes, Float, Int, String

Scalar = Bool | Bytes | Float | Int | String

SCALARS: Mapping[str, Scalar] = {
    "double": Float(64, "double"),
    "float": Float(32, "float"),
    "int32": Int(32, True, "int32"),
    "int64": Int(64, True, "int64"),
    "uint32": Int(32, False, "uint32"),
    "uint64": Int(64, False, "uint64"),
    "sint32": Int(32, True, "sint32"),
    "sint64": Int(64, True, "sint64"),
    "fixed32": Int(32, False, "fixed32"),
    "fixed64": Int(64, False, "fixed64"),
    "sfixed32": Int(32, True, "sfixed32"),
    "sfixed64": Int(64, True, "sfixed64"),
    "bool": Bool("bool"),
    "string": String("utf-8", "string"),
    "bytes": Bytes("bytes"),
}
"""https://protobuf.dev/programming-guides/proto3/#scalar"""


def is_packable(word: str) -> bool:
    """Whether a scalar's repetitions can share one length-delimited record: numbers can."""
    return not isinstance(SCALARS[word], String | Bytes)
