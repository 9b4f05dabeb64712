"""What the IDL of CORBA 3 can say: OMG IDL without what DDS has added, whose annotations and maps CORBA does not know."""

from __future__ import annotations

from rosetta_jit.frameworks.omg.features import PROBES as IDL
from rosetta_jit.frameworks.omg.features import struct

ADDED = {"int8", "bit set", "optional", "default", "map", "evolution", "unit"}

PROBES = {
    ".idl": {feature: probe for feature, probe in IDL.items() if feature not in ADDED}
    | {
        "inheritance": "valuetype Base { public long x; }; valuetype Probe : Base { public long y; };",
        "documentation": struct("// where it is\n long x;"),
    }
}
