"""Groups of accessors: what is compiled at once, when one of a group is first called. So a process compiles what it uses."""

from __future__ import annotations

from collections.abc import Iterator

from rosetta_jit.runtime.cells import SCALARS
from rosetta_jit.startup.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class Group:
    """Symbols by what they have in common.

    ``hurried`` is for what a program calls once or twice while it is made: code that takes twice as long, compiled in a tenth of the time.
    A later group may have the same symbols: once it is compiled, they are its own.
    """

    name: str
    symbols: tuple[str, ...]
    hurried: bool = False


BEGINNING = ("begin", "bind", "is_readable", "restart", "spawn", "equip")
END = "end_holder"
"""What ends a holder. It looks for its own address in a class, which therefore must be that of code, and none of a stub."""

GROUPS = (
    *(Group(f"scalar {name}", (f"get_{name}", f"set_{name}")) for name in SCALARS),
    Group("texts and bytes", ("get_utf8", "get_octets", "get_bytes", "set_utf8", "set_bytes")),
    Group("arrays of numbers", ("get_numbers", "set_numbers")),
    Group("arrays of texts", ("set_texts", "extend_texts")),
    Group("messages within messages", ("get_kept",)),
    Group("other fields", ("get_python", "set_python")),
    Group("names", ("get_attribute", "set_attribute")),
    Group("sequences", ("length", "subscript", "iterate", "itself", "next", "end_iterator")),
    Group("first holders", (*BEGINNING, END), hurried=True),
    Group("holders", (*BEGINNING, END, "call_class", "call_maker")),
    Group("sameness", ("same",)),
    Group("objects of other classes", ("take", "take_anew", "method_build")),
    Group("methods", ("method_encode", "method_write", "method_decode", "method_parse", "method_make", "method_turn")),
    Group("objects handed over", ("hand_in", "hand_out")),
    Group("many messages", ("fill_rows",)),
)


def group_of(symbol: str) -> Group:
    """The first group that has a symbol."""
    return next(group for group in GROUPS if symbol in group.symbols)


def symbols() -> Iterator[str]:
    """All symbols, each once."""
    yield from dict.fromkeys(symbol for group in GROUPS for symbol in group.symbols)
