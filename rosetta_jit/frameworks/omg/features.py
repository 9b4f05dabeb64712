"""What OMG IDL can say."""

from __future__ import annotations

from rosetta_jit.frameworks.probe import Probe


def struct(members: str, before: str = "") -> str:
    """A struct of some members, behind what they need."""
    return f"{before} module pkg {{ struct Probe {{ {members} }}; }};"


WORDS = {"int8": "int8", "int16": "short", "int32": "long", "int64": "long long"}
UNSIGNED = {"uint8": "octet", "uint16": "unsigned short", "uint32": "unsigned long", "uint64": "unsigned long long"}
POINT = "struct Point { double x; double y; };"

PROBES: dict[str, str | Probe] = {
    "boolean": struct("boolean x;"),
    **{feature: struct(f"{word} x;") for feature, word in (WORDS | UNSIGNED).items()},
    "float32": struct("float x;"),
    "float64": struct("double x;"),
    "long double": struct("long double x;"),
    "fixed point": struct("fixed<5, 2> x;"),
    "character": struct("char x;"),
    "wide character": struct("wchar x;"),
    "string, UTF-8": struct("string x;"),
    "string, wide": struct("wstring x;"),
    "string, bounded": struct("string<5> x;"),
    "string, fixed": struct("char x[16];"),
    "blob": struct("sequence<octet> x;"),
    "blob, fixed": struct("octet x[16];"),
    "blob, bounded": struct("sequence<octet, 5> x;"),
    "array, fixed": struct("double x[9];"),
    "array, variable": struct("sequence<double> x;"),
    "array, bounded": struct("sequence<double, 5> x;"),
    "array, several fixed dimensions": struct("double x[3][4];"),
    "array of arrays": struct("sequence<sequence<double> > x;"),
    "struct": struct("Point x;", POINT),
    "union with a discriminator": struct("U x;", "union U switch (long) { case 1: double d; default: long l; };"),
    "enum, closed": struct("Color x;", "enum Color { RED, GREEN };"),
    "bit set": struct("Flags x;", "bitmask Flags { A, B };"),
    "optional": struct("@optional long x;"),
    "default": struct("@default(5) long x;"),
    "map": struct("map<long, double> x;"),
    "any type": struct("any x;"),
    "constant": struct("long x;", "const long LIMIT = 5;"),
    "recursion": struct("sequence<Probe> x;"),
    "inheritance": "struct Base { long x; }; struct Probe : Base { long y; };",
    "evolution": "module pkg { @mutable struct Probe { @id(5) long x; }; };",
    "namespace": struct("long x;"),
    "import": Probe('#include "point.idl"\nstruct Probe { Point x; };', {"point.idl": POINT}),
    "time": struct("Time x;", "struct Time { unsigned long sec; unsigned long nsec; };"),
    "unit": struct('@unit("metre") double x;'),
    "documentation": struct('@verbatim(language="comment", text="where it is") long x;'),
    "service": struct("long x;", "interface Server { long ask(in long question); };"),
}
"""With what its annotations and DDS-XTypes have added."""
