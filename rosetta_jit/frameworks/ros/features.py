"""What `.msg`, `.srv` and `.action` files of both dialects can say."""

from __future__ import annotations

from collections.abc import Mapping

from rosetta_jit.frameworks.probe import Probe
from rosetta_jit.startup.dataclass import replace

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
}


def first_part(probes: Mapping[str, str | Probe], further_parts: int, declares: str, added: Mapping[str, str]) -> dict[str, str | Probe]:
    """The same in the first part of a service or an action, which has some others; ``added`` is what peers add needs."""
    whole = {feature: each if isinstance(each, Probe) else Probe(each) for feature, each in probes.items()}
    whole["service"] = Probe("int32 question")
    return {
        feature: replace(each, text=each.text + "\n---\n" * further_parts, files={**added, **each.files}, declares=declares)
        for feature, each in whole.items()
    }
