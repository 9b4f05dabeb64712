"""What ROS 2's `.msg`, `.srv`, `.action` and `.idl` files can say."""

from __future__ import annotations

from rosetta_jit.frameworks.omg.features import PROBES as IDL
from rosetta_jit.frameworks.omg.features import struct
from rosetta_jit.frameworks.probe import Probe
from rosetta_jit.frameworks.ros.features import PROBES as SHARED
from rosetta_jit.frameworks.ros.features import first_part

BUILTIN = {
    "builtin_interfaces/msg/Time.msg": "int32 sec\nuint32 nanosec",
    "builtin_interfaces/msg/Duration.msg": "int32 sec\nuint32 nanosec",
}

MESSAGES: dict[str, str | Probe] = SHARED | {
    "string, wide": "wstring x",
    "string, bounded": "string<=5 x",
    "blob, bounded": "uint8[<=5] x",
    "array, bounded": "float64[<=5] x",
    "default": "int32 x 5",
    "optional": "@optional\nint32 x",
    "time": Probe("builtin_interfaces/Time x", BUILTIN),
    "duration": Probe("builtin_interfaces/Duration x", BUILTIN),
}
ADDED = {
    **BUILTIN,
    "unique_identifier_msgs/msg/UUID.msg": "uint8[16] uuid",
    "service_msgs/msg/ServiceEventInfo.msg": "builtin_interfaces/Time stamp\nchar[16] client_gid\nint64 sequence_number",
}
"""What rosidl adds to services and actions needs these."""

SERVICE = "module pkg { module srv { struct Probe_Request { long x; }; struct Probe_Response { long y; }; }; };"
"""As rosidl writes it."""

PROBES = {
    ".msg": MESSAGES,
    ".srv": first_part(MESSAGES, 1, "Probe_Request", ADDED),
    ".action": first_part(MESSAGES, 2, "Probe_Goal", ADDED),
    ".idl": IDL
    | {
        "duration": struct("Duration x;", "struct Duration { long sec; unsigned long nanosec; };"),
        "service": Probe(SERVICE, declares="Probe_Request"),
    },
}
