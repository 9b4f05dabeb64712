"""OROCOS as a `Framework`: where its front ends, encodings and manners are found."""

from __future__ import annotations

from rosetta_jit.frameworks.base import ANY_BYTE, Framework

HERE = "rosetta_jit.frameworks.orocos"
ENCODING = f"{HERE}.encoding:encode_type"

FRAMEWORK = Framework(
    "orocos",
    features=f"{HERE}.features:PROBES",
    idl={".hpp": f"{HERE}.header:parse", ".h": f"{HERE}.header:parse", ".tlb": f"{HERE}.typelib:parse"},
    encodings={"rtt-mqueue": ENCODING, "typelib": ENCODING, "native": ENCODING},
    leniencies={each: {"bool": f"{ANY_BYTE} (any C++ compiler)"} for each in ("rtt-mqueue", "typelib", "native")},
)
