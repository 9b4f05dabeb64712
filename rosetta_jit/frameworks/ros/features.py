"""What `.msg` files of both dialects can say."""

from __future__ import annotations

from rosetta_jit.frameworks.features import Probe

POINT = {"probe/Point.msg": "float64 x\nfloat64 y"}

PROBES: dict[str, str | Probe] = {
    "boolean": "bool x",
    **{f"{sign}int{bits}": f"{sign}int{bits} x" for sign in ("", "u") for bits in (8, 16, 32, 64)},
    "float32": "float32 x",
    "float64": "float64 x",
    "character": "char x",
    "string, UTF-8": "string x",
    "blob": "uint8[] x",
    "blob, fixed": "uint8[16] x",
    "array, fixed": "float64[9] x",
    "array, variable": "float64[] x",
    "struct": Probe("Point x", POINT),
    "constant": "int32 LIMIT=5\nint32 x",
    "namespace": "int32 x",
    "import": Probe("Point x", POINT),
    "documentation": "int32 x # where it is",
    "service": Probe("int32 question\n---\nint32 answer", file="probe/Probe.srv"),
}
