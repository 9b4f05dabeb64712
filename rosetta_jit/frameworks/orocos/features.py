"""What the C++ headers and type registries of OROCOS can say."""

from __future__ import annotations

from rosetta_jit.frameworks.features import Probe


def struct(members: str, before: str = "") -> str:
    """A header with a struct of some members."""
    return f"#include <vector>\n#include <string>\n#include <cstdint>\nnamespace probe {{ {before} struct Probe {{ {members} }}; }}"


HEADER: dict[str, str | Probe] = {
    "boolean": struct("bool x;"),
    **{f"{sign}int{bits}": struct(f"std::{sign}int{bits}_t x;") for sign in ("", "u") for bits in (8, 16, 32, 64)},
    "float32": struct("float x;"),
    "float64": struct("double x;"),
    "long double": struct("long double x;"),
    "character": struct("char x;"),
    "wide character": struct("wchar_t x;"),
    "string, unchecked": struct("std::string x;"),
    "blob": struct("std::vector<unsigned char> x;"),
    "blob, fixed": struct("unsigned char x[16];"),
    "array, fixed": struct("double x[9];"),
    "array, variable": struct("std::vector<double> x;"),
    "array, multi-dimensional": struct("double x[3][4];"),
    "array of arrays": struct("std::vector<std::vector<double>> x;"),
    "struct": struct("Point p;", "struct Point { double x, y; };"),
    "oneof": struct("union { int i; double d; } x;"),
    "enum": struct("Color c;", "enum Color { RED, GREEN };"),
    "map": Probe("#include <map>\nnamespace probe { struct Probe { std::map<int, double> x; }; }"),
    "recursion": struct("std::vector<Probe> x;"),
    "inheritance": struct("int y; };  struct Unused { int z;", "struct Base { int x; };").replace(
        "struct Probe {", "struct Probe : Base {"
    ),
    "namespace": struct("int x;"),
    "import": Probe('#include "point.hpp"\nstruct Probe { Point p; };', {"point.hpp": "struct Point { double x; };"}),
}


def registry(name: str, more: str = "") -> str:
    """A registry with a struct of one field of a type."""
    numbers = "".join(
        f'<numeric name="/{name}" category="{kind}" size="{size}"/>'
        for name, kind, size in (
            ("int32_t", "sint", 4),
            ("double", "float", 8),
            ("float", "float", 4),
            ("bool", "uint", 1),
            ("uint8_t", "uint", 1),
        )
    )
    probe = f'<compound name="/probe/Probe" size="72"><field name="x" type="{name}" offset="0"/></compound>'
    return f'<?xml version="1.0"?><typelib>{numbers}{more}{probe}</typelib>'


REGISTRY: dict[str, str | Probe] = {
    "int32": registry("/int32_t"),
    "uint8": registry("/uint8_t"),
    "float32": registry("/float"),
    "float64": registry("/double"),
    "array, fixed": registry("/double[9]", '<array name="/double[9]" of="/double" dimension="9"/>'),
    "array, variable": registry(
        "/std/vector&lt;/double&gt;", '<container name="/std/vector&lt;/double&gt;" of="/double" size="24" kind="/std/vector"/>'
    ),
    "enum": registry("/Color", '<enum name="/Color"><value symbol="RED" value="0"/></enum>'),
    "namespace": registry("/int32_t"),
}

PROBES = {".hpp": HEADER, ".h": HEADER, ".tlb": REGISTRY}
