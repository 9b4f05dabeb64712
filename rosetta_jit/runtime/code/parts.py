"""Parts of LLVM modules that a person wrote: what some of their functions need, as LLVM takes its time for all that it is given."""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import lru_cache

_FUNCTION = re.compile(r"^(?:declare [^\n]*|define [^\n]*\n.*?\n})\n", re.MULTILINE | re.DOTALL)
_REFERENCE = re.compile(r"@([\w.]+)")
_COMMENT = re.compile(r"^;[^\n]*\n", re.MULTILINE)


def part_of(text: str, symbols: Sequence[str]) -> str:
    """Of a module the functions that some symbols need, defined or declared, and all that is no function."""
    functions, others = _taken_apart(text)
    needed, pending = set[str](), [*symbols, *_REFERENCE.findall(others)]
    while pending:
        name = pending.pop()
        if name in functions and name not in needed:
            needed.add(name)
            pending += _REFERENCE.findall(functions[name])
    return "".join([others, *(function for name, function in functions.items() if name in needed)])


@lru_cache(maxsize=1)
def _taken_apart(text: str) -> tuple[dict[str, str], str]:
    """The functions of a module by their names, and all else without the comments between them."""
    functions, others, end = dict[str, str](), list[str](), 0
    for found in _FUNCTION.finditer(f"{text}\n"):
        function = found[0]
        functions[function[function.index("@") + 1 : function.index("(", function.index("@"))]] = function
        others.append(text[end : found.start()])
        end = found.end()
    others.append(text[end:])
    return functions, _COMMENT.sub("", "".join(others))
