"""The front end of ROS 1: `.msg` files, and the concatenated definitions of a bag (https://wiki.ros.org/msg), as genmsg reads them."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from rosetta_jit.frameworks.ros import Dialect, Rule, definitions_of, schema_of
from rosetta_jit.frameworks.ros1.md5 import md5_sums
from rosetta_jit.model.types import Bool, Field, Float, Int, String, Struct

if TYPE_CHECKING:
    from rosetta_jit.frontend.idl import Load
    from rosetta_jit.model.types import Schema
    from rosetta_jit.source import Source

UINT32, INT32 = Int(32, signed=False, spelling="uint32"), Int(32, spelling="int32")

SCALARS = {
    "int8": Int(8, spelling="int8"),
    "uint8": Int(8, signed=False, spelling="uint8"),
    "int16": Int(16, spelling="int16"),
    "uint16": Int(16, signed=False, spelling="uint16"),
    "int32": INT32,
    "uint32": UINT32,
    "int64": Int(64, spelling="int64"),
    "uint64": Int(64, signed=False, spelling="uint64"),
    "float32": Float(32, "float32"),
    "float64": Float(64, "float64"),
    "string": String("utf-8", "string"),
    "bool": Bool("bool"),
    "char": Int(8, signed=False, spelling="char"),
    "byte": Int(8, spelling="byte"),
}

IDENTIFIER = Rule(re.compile(r"[A-Za-z][A-Za-z0-9_]*"), "letters, digits and underscores, a letter first")

ROS1 = Dialect(
    name="ros1",
    qualified="{package}/{name}",
    scalars=SCALARS,
    octets=frozenset({"uint8", "char"}),
    packages=IDENTIFIER,
    messages=IDENTIFIER,
    fields=IDENTIFIER,
    constants=IDENTIFIER,
    integers=re.compile(r"[+-]?[0-9]+"),
    line_ends=re.compile(r"\n"),
    extended=False,
    structs={
        "time": Struct("time", (Field("secs", UINT32), Field("nsecs", UINT32))),
        "duration": Struct("duration", (Field("secs", INT32), Field("nsecs", INT32))),
    },
    aliases={"Header": "std_msgs/Header"},
)


def parse(source: Source, load: Load) -> Schema:
    """A `.msg` file and the messages that it needs, from the text itself where it has their definitions, else from the search path.

    The options of a struct are its ``definition``, the text without those of other messages, and its ``md5sum``.

    Parameters
    ----------
    source
        The text, named after the message: ``sensor_msgs/Imu.msg``, ``sensor_msgs/msg/Imu.msg``.
    load
        Finds the files of other messages.

    Raises
    ------
    SchemaError
        With everything that is wrong in any of the texts.
    """
    definitions = definitions_of(source, load, ROS1)
    sums = md5_sums(definitions)
    return schema_of(definitions, ROS1, lambda each: (("definition", each.text), ("md5sum", sums[each.name])))
