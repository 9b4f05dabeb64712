"""Headers as tests write them."""

from __future__ import annotations

from hypothesis import strategies as st

from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.orocos.header import parse
from rosetta_jit.source import Source

SCALARS = {
    "bool": "?",
    "char": "b",
    "signed char": "b",
    "unsigned char": "B",
    "short": "h",
    "uint16_t": "H",
    "int": "i",
    "unsigned": "I",
    "long": "q",
    "unsigned long long": "Q",
    "float": "f",
    "double": "d",
}
"""Words of C++, and the codes of the `struct` module."""


def nothing(name):
    return None


def types(text, load=nothing):
    return parse(Source("test.hpp", text), load).types


def refusal(read, *arguments):
    """The report on a text that cannot be used, None for one that can."""
    try:
        read(*arguments)
    except SchemaError as error:
        assert error.diagnostics  # noqa: PT017 - nothing need be raised
        return str(error)
    return None


@st.composite
def structs(draw, *, containers):
    """Structs ``S0``, ``S1``, ...: lists of (name, type, dimensions), where a type is a word or an earlier struct."""
    found = {}
    for number in range(draw(st.integers(1, 4))):
        choices = [*SCALARS, *found]
        if containers:
            choices += ["std::string", "std::vector<double>", *(f"std::vector<{name}>" for name in found)]
        members = st.tuples(st.sampled_from(choices), st.lists(st.integers(1, 3), max_size=2))
        found[f"S{number}"] = [(f"m{index}", *member) for index, member in enumerate(draw(st.lists(members, min_size=1, max_size=6)))]
    return found


def header(declared):
    """The structs as C++."""
    lines = ["#include <cstdint>", "#include <string>", "#include <vector>"]
    for name, members in declared.items():
        lines.append(f"struct {name} {{")
        lines += [f"    {type_} {member}{''.join(f'[{length}]' for length in dimensions)};" for member, type_, dimensions in members]
        lines.append("};")
    return "\n".join([*lines, ""])
