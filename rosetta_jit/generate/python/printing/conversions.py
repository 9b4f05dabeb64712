"""Scalars of one type as those of another, as Python expressions."""

from __future__ import annotations

from rosetta_jit.generate.parentheses import bare
from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.arithmetic import FLOATS
from rosetta_jit.kernel.terms import is_wider


def wrapped(type_: nodes.Scalar, value: str) -> str:
    """The low bits of an integer."""
    bits = 8 * nodes.WIDTH[type_]
    if type_[0] == "u":
        return f"({value} & {2**bits - 1})"
    return f"(({value} + {2 ** (bits - 1)} & {2**bits - 1}) - {2 ** (bits - 1)})"


def converted(target: nodes.Scalar, source: nodes.Scalar, value: str) -> str:
    """The same number, rounded or saturated, or the low bits of an integer."""
    if target == source:
        return value
    if target == "bool":
        return f"({value} != 0)"
    if source in FLOATS and target in FLOATS:
        return value if target == "f64" else f"_single({bare(value)})"
    if target in FLOATS:
        return f"float({bare(value)})" if target == "f64" else f"_single_of_int({bare(value)})"
    if source in FLOATS:
        bits, signed = 8 * nodes.WIDTH[target], target[0] == "i"
        least, most = (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1) if signed else (0, 2**bits - 1)
        return f"_saturated({bare(value)}, {least}, {most})"
    if source == "bool":
        return f"int({bare(value)})"
    if (source[0], target[0]) == ("u", "i") and nodes.WIDTH[source] == nodes.WIDTH[target] and value.isidentifier():
        bits = 8 * nodes.WIDTH[target]
        return f"({value} if {value} < {2 ** (bits - 1)} else {value} - {2**bits})"
    return value if is_wider(target, source) else wrapped(target, value)


def bits_of(target: nodes.Scalar, source: nodes.Scalar, value: str) -> str:
    """The scalar that has the same bits."""
    if target == source:
        return value
    width = 8 * nodes.WIDTH[source]
    if source in FLOATS:
        return converted(target, "u64" if width == 64 else "u32", f"_bits{width}({bare(value)})")
    if target in FLOATS:
        return f"_float{width}({bare(converted('u64' if width == 64 else 'u32', source, value))})"
    return converted(target, source, value)


def within(text: str, scalar: str) -> str:
    """An integer, which is looked at first."""
    bits, signed = 8 * nodes.WIDTH[scalar], scalar[0] == "i"
    return f"_within({bare(text)}, {-(1 << bits - 1) if signed else 0}, {(1 << bits - signed) - 1})"
