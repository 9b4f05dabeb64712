"""What ROS 2's `.msg` and `.idl` files can say."""

from __future__ import annotations

from rosetta_jit.frameworks.features import Probe
from rosetta_jit.frameworks.omg.features import PROBES as IDL
from rosetta_jit.frameworks.omg.features import struct
from rosetta_jit.frameworks.ros.features import PROBES as SHARED

BUILTIN = {
    "builtin_interfaces/msg/Time.msg": "int32 sec\nuint32 nanosec",
    "builtin_interfaces/msg/Duration.msg": "int32 sec\nuint32 nanosec",
}

PROBES = {
    ".msg": SHARED
    | {
        "string, wide": "wstring x",
        "string, bounded": "string<=5 x",
        "blob, bounded": "uint8[<=5] x",
        "array, bounded": "float64[<=5] x",
        "default": "int32 x 5",
        "optional": "@optional\nint32 x",
        "time": Probe("builtin_interfaces/Time x", BUILTIN),
        "duration": Probe("builtin_interfaces/Duration x", BUILTIN),
    },
    ".idl": IDL | {"duration": struct("Duration x;", "struct Duration { long sec; unsigned long nanosec; };")},
}
