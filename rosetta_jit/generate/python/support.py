"""What a generated module has of `runtime`: the imports and definitions that its text names, and those that these need."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Iterator, Sequence
from functools import cache
from itertools import groupby, zip_longest
from pathlib import Path

from rosetta_jit.startup.dataclass import dataclass

RUNTIME = Path(__file__).with_name("runtime")
FILES = ("printed", "host", "errors", "objects", "numbers", "decimals", "texts", "lists", "arrays", "varints", "long_parts", "late_lists")
"""Those of the runtime, as their definitions follow one another in a module."""
ALWAYS = ("DecodeError", "EncodeError")
"""What every module has, for its users."""
IS_FOR_TOOLS = re.compile(r"  # (?:noqa|pyright)\b.*")


@dataclass(frozen=True, slots=True)
class Definition:
    """A statement that binds ``names``, with what documents it; ``needs`` are those that it mentions.

    ``is_large``: it is a function or class; ``is_documented``: a string stands behind it.
    """

    names: tuple[str, ...]
    text: str
    needs: frozenset[str]
    is_large: bool
    is_documented: bool


@dataclass(frozen=True, slots=True)
class Import:
    """A name that is imported: of a module, or where ``name`` is empty a module itself."""

    module: str
    name: str
    alias: str

    @property
    def bound(self) -> str:
        return self.alias or self.name or self.module

    @property
    def is_standard(self) -> bool:
        return self.module.partition(".")[0] != "numpy"


def mentioned(text: str) -> frozenset[str]:
    """The names in the text of a module."""
    return frozenset(each.id for each in ast.walk(ast.parse(text)) if isinstance(each, ast.Name))


def support(named: Iterable[str]) -> str:
    """What goes before the text of a module that names so much: imports, then definitions."""
    imports, definitions = _runtime()
    taken, wanted = _taken(definitions, {*ALWAYS, *named})
    return _imports(each for each in imports if each.bound in wanted) + "\n" + _apart(taken)


def needed(constants: str, named: Iterable[str]) -> str:
    """Those of the definitions in a text that have such names, or that these need."""
    taken, _ = _taken([*_defined(constants, ast.parse(constants).body)], named)
    return _apart(taken)


def _taken(definitions: Sequence[Definition], named: Iterable[str]) -> tuple[list[Definition], set[str]]:
    """The definitions of some names and of what these need, and all names that they need."""
    wanted, pending = set[str](), [*named]
    needs = {name: each.needs for each in definitions for name in each.names}
    while pending:
        name = pending.pop()
        if name not in wanted:
            wanted.add(name)
            pending += needs.get(name, ())
    return [each for each in definitions if not wanted.isdisjoint(each.names)], wanted


@cache
def _runtime() -> tuple[tuple[Import, ...], tuple[Definition, ...]]:
    imports, definitions = set[Import](), list[Definition]()
    for file in FILES:
        text = (RUNTIME / f"{file}.py").read_text("utf-8")
        statements = ast.parse(text).body
        imports.update(each for statement in statements for each in _imported(statement))
        definitions += _defined(text, statements)
    order = sorted(imports, key=lambda each: (not each.is_standard, bool(each.name), each.module, each.alias != "", each.name))
    return tuple(order), tuple(definitions)


def _imported(statement: ast.stmt) -> Iterator[Import]:
    match statement:
        case ast.Import(names):
            yield from (Import(each.name, "", each.asname or "") for each in names)
        case ast.ImportFrom(str(module), names) if module != "__future__" and not module.startswith("rosetta_jit."):
            yield from (Import(module, each.name, each.asname or "") for each in names)
        case _:
            pass


def _defined(text: str, statements: Sequence[ast.stmt]) -> Iterator[Definition]:
    """The definitions of a file, each with the string behind it."""
    lines = text.split("\n")
    for statement, after in zip_longest(statements, statements[1:]):
        if names := _bound(statement):
            is_large, is_documented = isinstance(statement, ast.FunctionDef | ast.ClassDef), isinstance(after, ast.Expr)
            last = after if after and is_documented else statement
            piece = "\n".join(IS_FOR_TOOLS.sub("", line) for line in lines[statement.lineno - 1 : last.end_lineno])
            yield Definition(names, piece, mentioned(piece), is_large, is_documented)


def _bound(statement: ast.stmt) -> tuple[str, ...]:
    """The names that a definition binds."""
    match statement:
        case ast.FunctionDef(name) | ast.ClassDef(name) | ast.AnnAssign(ast.Name(name)):
            return (name,)
        case ast.Assign(targets):
            return tuple(each.id for target in targets for each in ast.walk(target) if isinstance(each, ast.Name))
        case _:
            return ()


def _imports(taken: Iterable[Import]) -> str:
    """Their statements, those of numpy apart; what keeps its name stands in one for each module."""
    blocks = list[str]()
    for _, block in groupby(taken, lambda each: each.is_standard):
        lines = list[str]()
        for (module, _, alias), same in groupby(block, lambda each: (each.module, bool(each.name), each.name if each.alias else "")):
            first, *more = same
            name = f"{first.name} as {first.alias}" if alias else ", ".join(each.name for each in (first, *more))
            renamed = f" as {first.alias}" if first.alias else ""
            lines.append(f"from {module} import {name}" if first.name else f"import {module}{renamed}")
        blocks.append("\n".join(lines) + "\n")
    return "\n".join(blocks)


def _apart(taken: Sequence[Definition]) -> str:
    """Functions and classes two lines from all else, and what is documented one line from what follows."""
    text, before = "", None
    for each in taken:
        is_apart = before is not None and before.is_documented
        text += f"\n\n{each.text}\n" if each.is_large or (before and before.is_large) else f"{chr(10) * is_apart}{each.text}\n"
        before = each
    return text
