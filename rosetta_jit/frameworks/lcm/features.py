"""What LCM's IDL can say."""

from __future__ import annotations

from rosetta_jit.frameworks.probe import Probe


def struct(members: str) -> str:
    """A struct of some members."""
    return f"package probe; struct Probe {{ {members} }}"


PROBES = {
    ".lcm": {
        "boolean": struct("boolean x;"),
        **{f"int{bits}": struct(f"int{bits}_t x;") for bits in (8, 16, 32, 64)},
        "uint8": struct("byte x;"),
        "float32": struct("float x;"),
        "float64": struct("double x;"),
        "string, UTF-8": struct("string x;"),
        "blob, fixed": struct("byte x[16];"),
        "blob, sized by a field": struct("int32_t n; byte x[n];"),
        "array, fixed": struct("double x[9];"),
        "array, sized by a field": struct("int32_t n; double x[n];"),
        "array, several fixed dimensions": struct("double x[3][4];"),
        "array, several variable dimensions": struct("int32_t n; int32_t m; double x[n][m];"),
        "struct": Probe("package probe; struct Point { double x; } struct Probe { Point p; }"),
        "enum, open": Probe("package probe; enum Color { RED=0, GREEN=1 } struct Probe { Color c; }"),
        "constant": struct("const int32_t LIMIT = 5; int32_t x;"),
        "recursion": struct("int32_t n; Probe children[n];"),
        "namespace": struct("int32_t x;"),
        "import": Probe("package probe; struct Probe { other.Point p; }", {"other/Point.lcm": "package other; struct Point { double x; }"}),
        "documentation": struct("\n// where it is\nint32_t x;"),
    }
}
