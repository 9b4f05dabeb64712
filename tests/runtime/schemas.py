"""A small schema with every kind of field."""

from __future__ import annotations

from rosetta_jit.model.types import Array, Bool, Bytes, Enum, Field, Float, Int, Map, Optional, Ref, Schema, String, Struct, Union
from rosetta_jit.runtime.holder import holder_class

PART = Struct("t.Part", (Field("x", Optional(Int(64))), Field("name", String("octets")), Field("values", Array(Float(64)))))
KIND = Enum("t.Kind", (("A", 0), ("B", 5)))
WHOLE = Struct(
    "t.Whole",
    (
        Field("small", Int(8)),
        Field("single", Float(32)),
        Field("maybe", Optional(Float(64)), default=2.5),
        Field("flag", Bool()),
        Field("kind", Ref("t.Kind")),
        Field("angles", Array(Float(32))),
        Field("text", String()),
        Field("data", Bytes()),
        Field("part", Ref("t.Part")),
        Field("parts", Array(Ref("t.Part"))),
        Field("names", Array(String())),
        Field("matrix", Array(Array(Int(16, signed=False)))),
        Field("fixed", Array(Int(32), 3)),
        Field("by_name", Map(String(), Ref("t.Part"))),
        Field("counts", Map(Int(32), Int(64))),
        Field("either", Union("t.Whole.either", (Field("left", Int(32)), Field("right", Ref("t.Part"))))),
        Field("child", Optional(Ref("t.Whole"))),
        Field("children", Array(Ref("t.Whole"))),
    ),
)
SCHEMA = Schema({"t.Part": PART, "t.Kind": KIND, "t.Whole": WHOLE})
FLAT = Struct("t.Flat", tuple(field for field in WHOLE.fields if not field.name.startswith("child")))


def whole():
    return holder_class(Ref("t.Whole"), SCHEMA)


def flat():
    """The same without recursion."""
    return holder_class(FLAT, SCHEMA)
