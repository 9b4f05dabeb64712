"""The frameworks that come with rosetta_jit."""

from __future__ import annotations

from rosetta_jit.frameworks.base import Framework

_BOTTLES = "rosetta_jit.frameworks.yarp.encoding:encode_type"
_MESSAGES = "rosetta_jit.frameworks.protobuf.encoding:encode_type"

FRAMEWORKS = (
    Framework(
        "yarp",
        idl={".bottle-schema": "rosetta_jit.frameworks.yarp.schema:parse"},
        encodings={"yarp": _BOTTLES, "yarp3": _BOTTLES, "yarp4": _BOTTLES, "yarp2012": _BOTTLES},
    ),
    Framework(
        "protobuf",
        idl={".proto": "rosetta_jit.frameworks.protobuf.idl:parse"},
        encodings={"protobuf": _MESSAGES, "protobuf-partial": _MESSAGES},
        manners="rosetta_jit.frameworks.protobuf.manners:PROTOBUF",
    ),
)
