"""The two messages of a mapping, and the names that its rules know."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.catalogue import pipeline
from rosetta_jit.catalogue import resolve as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.language.constants import constants_of
from rosetta_jit.language.scope import Message, Scope, enums_of
from rosetta_jit.language.uses import UsableMappings
from rosetta_jit.model.expansion import excess
from rosetta_jit.model.expr import Side
from rosetta_jit.model.mapping import Mapping
from rosetta_jit.model.types import Schema, Struct, Type, same_name
from rosetta_jit.source import Span
from rosetta_jit.startup.late import Late

if TYPE_CHECKING:
    from rosetta_jit.language.functions import user_functions
else:
    user_functions = Late("rosetta_jit.language.functions.user_functions")


def message_named(schema: Schema, name: str) -> Message | None:
    """The message of a name; None where there is none, or something else has it."""
    found = _type_named(schema, name)
    return Message(found, schema) if isinstance(found, Struct) else None


def checked_message(schema: Schema, name: str, span: Span | None, problems: list[Diagnostic]) -> Message | None:
    """The same; what is wrong is reported, a message that is too large, too."""
    found = _type_named(schema, name)
    if isinstance(found, Struct):
        why = excess(found, schema)
        problems += [pipeline.too_large(found.name, span, why)] if why else []
        return None if why else Message(found, schema)
    if found is None:
        problems.append(words.unknown_type(span, name, [known for known, type_ in schema.types.items() if isinstance(type_, Struct)]))
    else:
        problems.append(words.not_a_message(span, name))
    return None


def scope_between(messages: dict[Side, Message], mapping: Mapping, usable: UsableMappings, problems: list[Diagnostic]) -> Scope:
    """What the rules of a mapping that unpack can name."""
    holder, wire = (messages[side].schema for side in ("holder", "wire"))
    constants = constants_of(*((holder,) if holder is wire else (holder, wire)))
    every = (mapping, *usable.mappings())
    functions = user_functions.signatures(every, problems) if any(each.functions for each in every) else {}
    enums, rounds = enums_of(holder, wire), mapping.rounds
    return Scope(messages, enums, constants, "holder", (), problems, set(), functions, usable, rounds=rounds, is_old=mapping.is_old)


def _type_named(schema: Schema, name: str) -> Type | None:
    return schema.types.get(name) or next((type_ for known, type_ in schema.types.items() if same_name(known, name)), None)
