"""Forms of a bottle schema into types and fields of the meta-model."""

from __future__ import annotations

from dataclasses import replace
from types import MappingProxyType
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import bottle as catalogue
from rosetta_jit.frameworks.yarp.names import FIELD_NAME
from rosetta_jit.frameworks.yarp.schema_expr import read_constant, read_expr
from rosetta_jit.frameworks.yarp.sexpr import MAX_PROBLEMS, Form, Number, Text, Vocab, Word, head
from rosetta_jit.frameworks.yarp.tree import MAX_NESTING
from rosetta_jit.model.expr import Literal
from rosetta_jit.model.types import Array, Bool, Bytes, Field, Float, Int, Map, Ref, String, Struct

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.frameworks.yarp.sexpr import Node
    from rosetta_jit.model.types import Constant, Type
    from rosetta_jit.source import Span

TEXT = String("octets", "string")

SCALARS: Mapping[str, Type] = MappingProxyType(
    {
        ":int8": Int(8, True, "int8"),
        ":uint8": Int(8, False, "int8"),
        ":int16": Int(16, True, "int16"),
        ":int": Int(32, True, "int32"),
        ":int32": Int(32, True, "int32"),
        ":int64": Int(64, True, "int64"),
        ":float32": Float(32, "float32"),
        ":double": Float(64, "float64"),
        ":float64": Float(64, "float64"),
        ":vocab": Int(32, True, "vocab32"),
        ":vocab32": Int(32, True, "vocab32"),
        ":vocab64": Int(64, True, "vocab64"),
        ":string": TEXT,
        ":blob": Bytes("blob"),
        ":bool": Bool("bool"),
        ":quantum": Int(32, True, "quantum"),
    }
)

OPTIONS: Mapping[str, str] = MappingProxyType(
    {
        ":unit": "(:unit :degree)",
        ":documentation": '(:documentation "...")',
        ":default": "(:default 0)",
        ":length": "(:length 16)",
        ":rest": ":rest",
        ":vector": ":vector",
        ":key": '(:key "...")',
    }
)
"""The options of a field, and how each is written."""

_GROUPS = MappingProxyType(
    {":vocab": "(:vocab :|set|)", ":list": "(:list :double)", ":bottle": "(:bottle FIELD ...)", ":dict": "(:dict :double)"}
)


def read_struct(name: str, nodes: Sequence[Node], problems: list[Diagnostic], *, span: Span, depth: int = 0, keyed: bool = False) -> Struct:
    """A struct of the fields that the nodes are; ``keyed`` where they are entries of a dict."""
    doc = ""
    match nodes:
        case (Form((Word(":documentation"), Text(doc))), *nodes):
            pass
        case _:
            pass
    fields: dict[str, Field] = {}
    for node in nodes:
        field = _read_field(name, node, problems, depth, keyed=keyed)
        if len(problems) >= MAX_PROBLEMS:
            break
        if field is None:
            continue
        if field.name in fields and field.span is not None:
            problems.append(catalogue.duplicate(field.span, "field", field.name, fields[field.name].span))
        fields[field.name] = field
    problems += [catalogue.rest_not_last(one.span, one.name) for one in list(fields.values())[:-1] if one.option("rest")]
    return Struct(name, tuple(fields.values()), doc, span)


def _read_field(owner: str, node: Node, problems: list[Diagnostic], depth: int, *, keyed: bool) -> Field | None:
    match node:
        case Form((Text(name, span),)):
            problems.append(catalogue.no_type(span, name))
        case Form((Text(name, span), type_node, *rest)) if FIELD_NAME.fullmatch(name):
            type_, implied = _read_field_type(type_node, f"{owner}.{name}", problems, depth)
            constants, options = _sort_rest(rest, problems)
            if type_ is not None:
                field = Field(name, type_, doc=_text_option(options, ":documentation", problems), span=span)
                field = _with_constant(field, [*implied, *constants], problems)
                return _with_options(field, options, problems, keyed=keyed)
        case Form((Text(name, span), *_)):
            problems.append(catalogue.invalid_name(span, name))
        case _:
            problems.append(catalogue.not_a_field(node.span))
    return None


def _read_field_type(node: Node, name: str, problems: list[Diagnostic], depth: int) -> tuple[Type | None, list[Node]]:
    """The type, and the constant that ``(:vocab :|set|)`` implies; only a field can have one."""
    match node:
        case Form((Word(":vocab"), Vocab() as constant)):
            return SCALARS[":vocab"], [constant]
        case _:
            return _read_type(node, name, problems, depth), []


def _read_type(node: Node, name: str, problems: list[Diagnostic], depth: int) -> Type | None:
    if depth > MAX_NESTING:
        problems.append(catalogue.nesting_too_deep(node.span, MAX_NESTING))
        return None
    match node:
        case Word(word) if word in SCALARS:
            return SCALARS[word]
        case Text(declared, span):
            return Ref(declared, span)
        case Form((Word(":list"), element)):
            return _array(_read_type(element, name, problems, depth + 1), None)
        case Form((Word(":list"), element, Form((Word(":length"), Number(int(length)))))) if 0 <= length < 2**31:
            return _array(_read_type(element, name, problems, depth + 1), length)
        case Form((Word(":bottle"), *fields)):
            return read_struct(name, fields, problems, span=node.span, depth=depth + 1)
        case Form((Word(":dict"), (Word() | Text()) | Form((Word(), *_)) as value)):
            element = _read_type(value, name, problems, depth + 2)
            return None if element is None else Map(TEXT, element)
        case Form((Word(":dict"), *fields)) if fields:
            return read_struct(name, fields, problems, span=node.span, depth=depth + 2, keyed=True)
        case _:
            problems.append(_not_a_type(node))
            return None


def _array(element: Type | None, length: int | None) -> Type | None:
    return None if element is None else Array(element, length)


def _not_a_type(node: Node) -> Diagnostic:
    word = node.name if isinstance(node, Word) else head(node)
    if word in _GROUPS:
        return catalogue.malformed_type(node.span, _GROUPS[word])
    return catalogue.unknown_type_word(node.span, word or "this", {*SCALARS, *_GROUPS})


def _sort_rest(nodes: Sequence[Node], problems: list[Diagnostic]) -> tuple[list[Node], dict[str, Node]]:
    """What follows a field's type: constants, and options by their word."""
    constants: list[Node] = []
    options: dict[str, Node] = {}
    for node in nodes:
        word = node.name if isinstance(node, Word) else head(node)
        if not word.startswith(":"):
            constants.append(node)
        elif word not in OPTIONS:
            problems.append(catalogue.unknown_option(node.span, word, OPTIONS))
        elif word in options:
            problems.append(catalogue.duplicate(node.span, "option", word, options[word].span))
        else:
            options[word] = node
    return constants, options


def _with_constant(field: Field, constants: Sequence[Node], problems: list[Diagnostic]) -> Field:
    values = [read_constant(node, field.type, problems) for node in constants]
    if len(values) > 1 and any(value != values[0] for value in values):
        problems.append(catalogue.second_constant(constants[1].span))
    return replace(field, constant=values[0] if values else None)


def _with_options(field: Field, options: Mapping[str, Node], problems: list[Diagnostic], *, keyed: bool) -> Field:
    unit = options.get(":unit")
    if unit is not None:
        field = replace(field, unit=_unit(unit, problems))
    default = options.get(":default")
    if default is not None:
        field = replace(field, default=_default(default, field.type, problems))
    length = options.get(":length")
    if length is not None:
        field = _with_length(field, length, problems)
    return replace(field, options=_marks(field, options, problems, keyed=keyed))


def _marks(field: Field, options: Mapping[str, Node], problems: list[Diagnostic], *, keyed: bool) -> tuple[tuple[str, Constant], ...]:
    """The options that an encoding must know, as the model wants them: sorted pairs."""
    marks: list[tuple[str, Constant]] = []
    if keyed:
        marks.append(("key", _text_option(options, ":key", problems) if ":key" in options else field.name))
    elif ":key" in options:
        problems.append(catalogue.misplaced_option(options[":key"].span, ":key", "a field of a :dict"))
    rest = options.get(":rest")
    if rest is not None:
        if keyed or not isinstance(field.type, Array):
            problems.append(catalogue.misplaced_option(rest.span, ":rest", "a :list at the end of a bottle"))
        marks.append(("rest", True))
    vector = options.get(":vector")
    if vector is not None:
        if not isinstance(field.type, Array):
            problems.append(catalogue.misplaced_option(vector.span, ":vector", "a :list of numbers"))
        marks.append(("vector", True))
    return tuple(marks)


def _text_option(options: Mapping[str, Node], word: str, problems: list[Diagnostic]) -> str:
    match options.get(word):
        case None:
            return ""
        case Form((_, Text(value))):
            return value
        case node:
            problems.append(catalogue.malformed_option(node.span, OPTIONS[word]))
            return ""


def _unit(node: Node, problems: list[Diagnostic]) -> str | None:
    match node:
        case Form((_, Word(name))) if name.startswith(":") and len(name) > 1:
            return name[1:]
        case Form((_, Text(name))) if name:
            return name
        case _:
            problems.append(catalogue.malformed_option(node.span, OPTIONS[":unit"]))
            return None


def _default(node: Node, type_: Type, problems: list[Diagnostic]) -> Constant | None:
    match node:
        case Form((_, value)):
            match read_constant(value, type_, problems):
                case Literal(constant):
                    return constant
                case None:
                    return None
                case _:
                    pass
        case _:
            pass
    problems.append(catalogue.malformed_option(node.span, OPTIONS[":default"]))
    return None


def _with_length(field: Field, node: Node, problems: list[Diagnostic]) -> Field:
    match node, field.type:
        case Form((_, Number(int(length)))), Array(element, None) if 0 <= length < 2**31:
            return replace(field, type=Array(element, length))
        case Form((_, Number(int(length), span))), String() | Bytes() if 0 <= length < 2**31:
            return replace(field, length=Literal(length, span))
        case Form((_, (Word() | Form()) as expr)), Array(_, None) | String() | Bytes():
            return replace(field, length=read_expr(expr, problems))
        case Form((_, _)), _:
            problems.append(catalogue.misplaced_option(node.span, ":length", "a :list, :string or :blob without one"))
        case _:
            problems.append(catalogue.malformed_option(node.span, OPTIONS[":length"]))
    return field
