"""What the IDL of CORBA can say: all of OMG IDL but what DDS has added."""

from __future__ import annotations

from rosetta_jit.frameworks.omg.features import PROBES as IDL

ADDED = {"int8", "optional", "default", "map", "inheritance", "unit"}

PROBES = {".idl": {feature: probe for feature, probe in IDL.items() if feature not in ADDED}}
