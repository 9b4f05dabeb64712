"""The front end of OMG IDL, for OpenRTM's CORBA and for what rosidl and DDS write: a `.idl` file and what it includes, to a schema.

text ─ lexer ─▶ tokens ─ preprocessor ─▶ tokens of all files ─ grammar ─▶ tree ─ declare ─▶ declarations ─ usable ─▶ schema
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.frameworks.omg import diagnostics as say
from rosetta_jit.frameworks.omg.declare import declare
from rosetta_jit.frameworks.omg.grammar import parse as definitions_of
from rosetta_jit.frameworks.omg.limits import MAX_REPORTED
from rosetta_jit.frameworks.omg.preprocessor import preprocess
from rosetta_jit.model.types import Array, Declaration, Map, NamedConstant, Optional, Ref, Schema, Struct, Type, Union
from rosetta_jit.parsing.idl import Load, refuse
from rosetta_jit.source import Source
from rosetta_jit.startup.dataclass import replace


def parse(source: Source, load: Load) -> Schema:
    """All structs, unions and enums of a `.idl` file and of what it includes, keyed by qualified names (``RTC::TimedDouble``).

    A declaration that the model has nothing for (``any``, ``long double``, references to objects) is left out, and so is what needs it;
    `Schema.left_out` says why.

    Parameters
    ----------
    source
        The text, and the name that it has on the search path.
    load
        Finds the files that it includes.

    Raises
    ------
    SchemaError
        With everything that is wrong.
    """
    problems: list[Diagnostic] = []
    tokens, files = preprocess(source, load, problems)
    refuse(problems, MAX_REPORTED)
    definitions = definitions_of(tokens, problems)
    refuse(problems, MAX_REPORTED)
    declared = declare(definitions, problems)
    refuse(problems, MAX_REPORTED)
    types, left_out = usable(declared.types)
    types, constants = attach_constants(types, declared.constants)
    return Schema(types, files, constants, left_out)


CONSTANTS = "_Constants"
"""rosidl puts the constants of a message ``X`` into the module ``X_Constants``."""

Types = dict[str, "Declaration"]


def usable(types: Mapping[str, Declaration]) -> tuple[Types, dict[str, Diagnostic]]:
    """The declarations that need nothing that is missing, and why the others do."""
    users: dict[str, list[tuple[str, Ref]]] = {}
    for declared in types.values():
        for ref in refs_of(declared):
            users.setdefault(ref.name, []).append((declared.name, ref))
    left_out: dict[str, Diagnostic] = {}
    waiting = [name for name in users if name not in types]
    while waiting:
        missing = waiting.pop()
        for user, ref in users.get(missing, ()):
            if user not in left_out:
                left_out[user] = say.unsupported(ref.span, user, missing)
                waiting.append(user)
    return {name: declared for name, declared in types.items() if name not in left_out}, left_out


def refs_of(declared: Declaration) -> Iterator[Ref]:
    """Every type that a declaration refers to."""
    if isinstance(declared, Struct):
        for field in declared.fields:
            yield from _refs(field.type)


def _refs(type_: Type) -> Iterator[Ref]:
    match type_:
        case Ref():
            yield type_
        case Array(element):
            yield from _refs(element)
        case Optional(value):
            yield from _refs(value)
        case Map(key, value):
            yield from _refs(key)
            yield from _refs(value)
        case Union(_, cases):
            for case in cases:
                yield from _refs(case.type)
        case _:
            pass


def attach_constants(types: Types, constants: Mapping[str, NamedConstant]) -> tuple[Types, dict[str, NamedConstant]]:
    """The constants of messages moved into them; the others stay."""
    own: dict[str, list[NamedConstant]] = {}
    rest: dict[str, NamedConstant] = {}
    for full, constant in constants.items():
        scope, _, name = full.rpartition("::")
        owner = scope.removesuffix(CONSTANTS)
        if owner != scope and isinstance(types.get(owner), Struct):
            own.setdefault(owner, []).append(replace(constant, name=name))
        else:
            rest[full] = constant
    return {name: _with(declared, own.get(name, [])) for name, declared in types.items()}, rest


def _with(declared: Declaration, constants: list[NamedConstant]) -> Declaration:
    return replace(declared, constants=tuple(constants)) if isinstance(declared, Struct) and constants else declared
