"""Messages as the `.idl` files that rosidl_adapter makes of `.msg` files, so that both kinds can refer to each other.

Names are escaped by an underscore before them, since many are keywords of IDL (OMG IDL 4.2, 7.2.3.2).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import isfinite

from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.ros import Definition, Dialect, Field, definition_of
from rosetta_jit.frameworks.ros import diagnostics as say
from rosetta_jit.frameworks.ros.reading import unit_in
from rosetta_jit.frameworks.ros.tree import Constant, TypeName
from rosetta_jit.model.types import Constant as Value
from rosetta_jit.parsing.idl import Load
from rosetta_jit.source import Source, Span

WORDS = {"bool": "boolean", "byte": "octet", "char": "uint8", "float32": "float", "float64": "double"}
"""Words of `.msg` files that IDL has other words for."""
BRACKETS = "()[]{}"


def with_messages(load: Load, dialect: Dialect, texts: Mapping[str, str] | None = None) -> Load:
    """Finds files by some texts, else as before, and `.idl` files that there are none of by the `.msg` files that they would be made of."""
    own = texts or {}

    def find(name: str) -> Source | None:
        if name in own:
            return Source(name.removesuffix(".idl") + ".msg", own[name])
        found = load(name)
        if found is not None or not name.endswith(".idl"):
            return found
        stem = name.removesuffix(".idl")
        found = load(f"{stem}.msg") or load(f"{stem.replace('/msg/', '/')}.msg")
        return None if found is None else Source(found.name, idl_text(definition_of(found, dialect), dialect))

    return find


def idl_text(definition: Definition, dialect: Dialect) -> str:
    """A definition in IDL; raises SchemaError where it has values that IDL has no literals for."""
    *modules, name = definition.name.split("/")
    includes = sorted({each.type.base for each in definition.fields if not each.type.builtin} - {definition.name})
    constants = "".join(_constant(each) for each in definition.constants)
    lines = [
        *(f'#include "{each}.idl"' for each in includes),
        *(f"module _{each} {{" for each in modules),
        *([f"module _{name}_Constants {{", constants, "};"] if constants else []),
        f"{_comment(definition.doc)}struct _{name} {{",
        *(_member(each) for each in definition.fields),
        *(f"uint8 _{each.name};" for each in dialect.empty if not definition.fields),
        "};",
        *("};" for _ in modules),
    ]
    return "\n".join(lines) + "\n"


def _constant(constant: Constant) -> str:
    wide = "L" if constant.type.base == "wstring" else ""
    word = _scalar(constant.type)
    return f"{_comment(constant.doc)}const {word} _{constant.name.text} = {wide}{_literal(constant.value, constant.name.span)};\n"


def _member(field: Field) -> str:
    notes = "@optional " if field.optional else ""
    unit = unit_in(field.doc)
    notes += f"@unit(value={_quoted(unit)}) " if unit else ""
    if field.default is not None:
        notes += f"@default(value={_default(field)}) "
    type_ = field.type
    word = _scalar(type_)
    if type_.array and type_.length is None:
        word = f"sequence<{word}>" if type_.maximum is None else f"sequence<{word}, {type_.maximum}>"
    length = f"[{type_.length}]" if type_.length is not None else ""
    return f"{_comment(field.doc)}{notes}{word} _{field.name.text}{length};"


def _scalar(type_: TypeName) -> str:
    if not type_.builtin:
        return "::" + "::".join(f"_{part}" for part in type_.base.split("/"))
    bound = f"<{type_.text_maximum}>" if type_.text_maximum is not None else ""
    return WORDS.get(type_.base, type_.base) + bound


def _default(field: Field) -> str:
    """A value, or the text of a list."""
    if not isinstance(field.default, tuple):
        assert field.default is not None
        return _literal(field.default, field.name.span)
    return _quoted(f"[{', '.join(_element(each) for each in field.default)}]")


def _element(value: Value) -> str:
    """A value within the text of a list, in which there are no other brackets."""
    return "".join(f"\\x{ord(each):02x}" if each in BRACKETS else each for each in repr(value))


def _literal(value: Value, span: Span) -> str:
    match value:
        case bool():
            return "TRUE" if value else "FALSE"
        case float() if not isfinite(value):
            raise SchemaError((say.no_literal(span, str(value)),))
        case str():
            return _quoted(value)
        case _:
            return repr(value)


def _quoted(text: str) -> str:
    return '"' + "".join(_characters(text)) + '"'


def _characters(text: str) -> Iterator[str]:
    for each in text:
        if each in '"\\':
            yield f"\\{each}"
        else:
            yield each if each.isprintable() else f"\\{ord(each):03o}"


def _comment(doc: str) -> str:
    return f'@verbatim(language="comment", text={_quoted(doc)}) ' if doc else ""
