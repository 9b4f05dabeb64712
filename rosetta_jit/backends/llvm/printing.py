"""Modules as text: in one piece, or in parts that LLVM takes one after another.

What is made for a large kernel is several times its text, in objects that refer to one another. Until the next search for garbage it would
stay beside what LLVM makes of the text; so each block is let go of once it is printed.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from llvmlite import ir

PART = 8_000
"""Lines of functions from which on a part is full. LLVM holds some 300 bytes of each line, and twice as much while it makes code of it."""

_REFERENCE = re.compile(r'@"([^"]*)"')


def taken_text(module: ir.Module) -> str:
    """The text of a module, which is left without what its functions do."""
    return _with_others(module, _taken(module))


def taken_parts(module: ir.Module) -> Iterator[str]:
    """The same as modules which are linked when they are code: each declares those functions of the others that it calls."""
    functions = _taken(module)
    for each in module.functions:
        each.linkage = ""
    part, lines = dict[str, str](), 0
    for name, text in functions.items():
        part[name] = text.replace("define internal", "define", 1)
        lines += text.count("\n")
        if lines >= PART:
            yield _with_others(module, part)
            part, lines = {}, 0
    if part:
        yield _with_others(module, part)


def _with_others(module: ir.Module, functions: Mapping[str, str]) -> str:
    """Some functions of a module, behind what they refer to, as a module of their own."""
    wanted = {name for text in functions.values() for name in _REFERENCE.findall(text)} - functions.keys()
    others = [str(each) for name, each in module.globals.items() if name in wanted]
    return "\n".join([*others, *functions.values(), *map(str, module.metadata)])


def _taken(module: ir.Module) -> dict[str, str]:
    """The texts of the functions that a module defines, by their names; from now on it declares them."""
    return {each.name: _taken_function(each) for each in module.functions if each.blocks}


def _taken_function(function: ir.Function) -> str:
    texts = list[str]()
    function.descr_prototype(texts)
    texts.append("{\n")
    for block in function.blocks:
        lines = list[str]()
        block.descr(lines)
        texts.append("".join(lines))
        block.instructions.clear()
        block.terminator = None
    function.blocks.clear()
    function.scope = type(function.scope)()
    return "".join([*texts, "}\n"])
