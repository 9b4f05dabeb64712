"""What the C++ headers and type registries of OROCOS can say."""

from __future__ import annotations

from rosetta_jit.frameworks.probe import Probe

INCLUDES = "".join(f"#include <{name}>\n" for name in ("cstdint", "string", "vector"))


def struct(members: str, before: str = "", include: str = "") -> str:
    """A header with a struct of some members."""
    more = f"#include <{include}>\n" if include else ""
    return f"{INCLUDES}{more}namespace probe {{ {before} struct Probe {{ {members} }}; }}"


def elsewhere(text: str, *more: str) -> Probe:
    """What lies behind a pointer, which the memory of an object cannot carry to others."""
    return Probe(text, without=("native", *more))


HEADER: dict[str, str | Probe] = {
    "boolean": struct("bool x;"),
    **{f"{sign}int{bits}": struct(f"std::{sign}int{bits}_t x;") for sign in ("", "u") for bits in (8, 16, 32, 64)},
    "float32": struct("float x;"),
    "float64": struct("double x;"),
    "long double": struct("long double x;"),
    "character": struct("char x;"),
    "wide character": struct("wchar_t x;"),
    "string, unchecked": elsewhere(struct("std::string x;")),
    "string, wide": struct("std::wstring x;"),
    "string, fixed": struct("char x[16];"),
    "blob": elsewhere(struct("std::vector<unsigned char> x;")),
    "blob, fixed": struct("unsigned char x[16];"),
    "array, fixed": struct("double x[9];"),
    "array, variable": elsewhere(struct("std::vector<double> x;")),
    "array, several fixed dimensions": struct("double x[3][4];"),
    "array of arrays": elsewhere(struct("std::vector<std::vector<double>> x;")),
    "struct": struct("Point p;", "struct Point { double x, y; };"),
    "oneof": struct("union { int i; double d; } x;"),
    "enum, open": struct("Color c;", "enum Color { RED, GREEN };"),
    "bit set": struct("unsigned x : 3;"),
    "default": struct("int x = 5;"),
    "map": struct("std::map<int, double> x;", include="map"),
    "set": struct("std::set<int> x;", include="set"),
    "constant": struct("static const int LIMIT = 5; int x;"),
    "recursion": elsewhere(struct("std::vector<Probe> x;"), "typelib"),
    "inheritance": struct("int y;", "struct Base { int x; };").replace("struct Probe {", "struct Probe : Base {"),
    "namespace": struct("int x;"),
    "import": Probe('#include "point.hpp"\nstruct Probe { Point p; };', {"point.hpp": "struct Point { double x; };"}),
    "time": struct("Time x;", "struct Time { std::int64_t microseconds; };"),
    "documentation": struct("\n/// where it is\nint x;"),
}

NUMBERS = {
    "boolean": ("bool", "uint", 1),
    **{f"int{bits}": (f"int{bits}_t", "sint", bits // 8) for bits in (8, 16, 32, 64)},
    **{f"uint{bits}": (f"uint{bits}_t", "uint", bits // 8) for bits in (8, 16, 32, 64)},
    "float32": ("float", "float", 4),
    "float64": ("double", "float", 8),
    "character": ("char", "sint", 1),
}
"""The numbers of a registry: name, category, bytes."""


def registry(name: str, *more: str, size: int = 72) -> str:
    """A registry with a struct of one field of a type."""
    numbers = "".join(f'<numeric name="/{word}" category="{kind}" size="{bytes_}"/>' for word, kind, bytes_ in NUMBERS.values())
    probe = f'<compound name="/probe/Probe" size="{size}"><field name="x" type="{name}" offset="0"/></compound>'
    return f'<?xml version="1.0"?><typelib>{numbers}{"".join(more)}{probe}</typelib>'


def array(of: str, length: int) -> str:
    """An array in a registry."""
    return f'<array name="{of}[{length}]" of="{of}" dimension="{length}"/>'


def vector(of: str) -> str:
    """A vector in a registry."""
    return f'<container name="/std/vector&lt;{of}&gt;" of="{of}" size="24" kind="/std/vector"/>'


DOUBLES = "/std/vector&lt;/double&gt;"

REGISTRY: dict[str, str | Probe] = {
    **{feature: registry(f"/{word}", size=8) for feature, (word, _, _) in NUMBERS.items()},
    "string, unchecked": elsewhere(
        registry("/std/string", '<container name="/std/string" of="/char" size="32" kind="/std/string"/>', size=32)
    ),
    "string, fixed": registry("/char[16]", array("/char", 16), size=16),
    "blob": elsewhere(registry("/std/vector&lt;/uint8_t&gt;", vector("/uint8_t"), size=24)),
    "blob, fixed": registry("/uint8_t[16]", array("/uint8_t", 16), size=16),
    "array, fixed": registry("/double[9]", array("/double", 9)),
    "array, variable": elsewhere(registry(DOUBLES, vector("/double"), size=24)),
    "array, several fixed dimensions": registry("/double[4][3]", array("/double", 4), array("/double[4]", 3), size=96),
    "array of arrays": elsewhere(registry(f"/std/vector&lt;{DOUBLES}&gt;", vector("/double"), vector(DOUBLES), size=24)),
    "struct": registry("/Point", '<compound name="/Point" size="8"><field name="x" type="/double" offset="0"/></compound>', size=8),
    "enum, open": registry("/Color", '<enum name="/Color"><value symbol="RED" value="0"/></enum>', size=4),
    "recursion": elsewhere(registry("/std/vector&lt;/probe/Probe&gt;", vector("/probe/Probe"), size=24), "typelib"),
    "namespace": registry("/int32_t", size=4),
    "time": registry(
        "/base/Time", '<compound name="/base/Time" size="8"><field name="microseconds" type="/int64_t" offset="0"/></compound>', size=8
    ),
}

PROBES = {".hpp": HEADER, ".h": HEADER, ".tlb": REGISTRY}
