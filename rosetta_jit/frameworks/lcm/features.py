"""What LCM's IDL can say."""

from __future__ import annotations

from rosetta_jit.frameworks.features import Probe


def struct(members: str) -> str:
    """A struct of some members."""
    return f"package probe; struct Probe {{ {members} }}"


PROBES = {
    ".lcm": {
        "boolean": struct("boolean x;"),
        **{f"int{bits}": struct(f"int{bits}_t x;") for bits in (8, 16, 32, 64)},
        "float32": struct("float x;"),
        "float64": struct("double x;"),
        "string, UTF-8": struct("string x;"),
        "blob, fixed": struct("byte x[16];"),
        "uint8": struct("byte x;"),
        "array, fixed": struct("double x[9];"),
        "array, sized by a field": struct("int32_t n; double x[n];"),
        "array, multi-dimensional": struct("double x[3][4];"),
        "struct": Probe("package probe; struct Point { double x; } struct Probe { Point p; }"),
        "enum": Probe("package probe; enum Color { RED=0, GREEN=1 } struct Probe { Color c; }"),
        "constant": struct("const int32_t LIMIT = 5; int32_t x;"),
        "recursion": struct("int32_t n; Probe children[n];"),
        "namespace": struct("int32_t x;"),
        "import": Probe("package probe; struct Probe { other.Point p; }", {"other/Point.lcm": "package other; struct Point { double x; }"}),
    }
}
