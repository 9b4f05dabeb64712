"""The types of a mapping's sides as it names them, and its wires: `wire-schema pose: geometry_msgs/Pose`."""

from __future__ import annotations

from rosetta_jit.catalogue import wires as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.language.limits import MAX_WIRES
from rosetta_jit.language.parse.rules import read_string
from rosetta_jit.model.mapping import OF_WIRES, Wire
from rosetta_jit.parsing.lalr import Token, Tree
from rosetta_jit.source import Source, Span


def read_type_name(statement: Tree, source: Source, problems: list[Diagnostic]) -> tuple[str, Span]:
    """The type that a statement names behind its colon, and where."""
    tokens = [child for child in statement.children if isinstance(child, Token)]
    tokens = tokens[next(number for number, each in enumerate(tokens) if each.type == "COLON") + 1 :]
    span = Span(source, tokens[0].start_pos, tokens[-1].end_pos)
    return (read_string(tokens[0], source, problems) if tokens[0].type == "STRING" else "".join(tokens)), span


def read_wires(statements: list[Tree], source: Source, problems: list[Diagnostic]) -> tuple[Wire, ...]:
    """The wires of a mapping in the order of the text; none where it has one wire, which has no name."""
    names = [_name(statement) for statement in statements]
    if not any(names):
        return ()
    found: dict[str, Wire] = {}
    for statement, name in zip(statements, names, strict=True):
        type_, span = read_type_name(statement, source, problems)
        if name is None:
            problems.append(words.nameless(span))
            continue
        at = Span(source, name.start_pos, name.end_pos)
        if not name.isidentifier():
            problems.append(words.unfit(at, name))
        elif name in found:
            problems.append(words.repeated(at, name))
        elif len(found) == MAX_WIRES:
            problems.append(words.many(at, MAX_WIRES))
            break
        else:
            found[str(name)] = Wire(str(name), type_, span)
    if len(statements) == 1 and found:
        problems.append(words.alone(Span(source, statements[0].start_pos, statements[0].end_pos), next(iter(found))))
    return tuple(found.values())


def message_of(wires: tuple[Wire, ...]) -> str:
    """The name of the struct that has a field for each wire."""
    return f"{OF_WIRES}{', '.join(each.name for each in wires)}"


def _name(statement: Tree) -> Token | None:
    """What stands between the word and the colon."""
    tokens = [child for child in statement.children if isinstance(child, Token)]
    before = next((number for number, each in enumerate(tokens) if each.type == "COLON"), 0)
    return next((each for each in tokens[:before] if each.type == "NAME"), None)
