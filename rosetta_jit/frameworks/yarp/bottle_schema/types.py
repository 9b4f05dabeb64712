"""Forms of a bottle schema into types and fields of the meta-model."""

from __future__ import annotations

from collections.abc import Sequence
from types import MappingProxyType
from typing import TYPE_CHECKING

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.frameworks.yarp import bottle_diagnostics as catalogue
from rosetta_jit.frameworks.yarp.bottle_schema.options import CASE, SCALARS, TEXT, Place, sort_rest, text_option, with_options
from rosetta_jit.frameworks.yarp.bottle_schema.sexpr import Form, Node, Number, Text, Vocab, Word, head
from rosetta_jit.frameworks.yarp.forms import make_union
from rosetta_jit.frameworks.yarp.limits import MAX_NESTING, MAX_PROBLEMS
from rosetta_jit.frameworks.yarp.names import FIELD_NAME
from rosetta_jit.model.types import Array, Constant, Field, Map, Ref, Struct, Type
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import replace
from rosetta_jit.startup.late import Late

if TYPE_CHECKING:
    from rosetta_jit.frameworks.yarp.bottle_schema import expressions as schema_expr
else:
    schema_expr = Late("rosetta_jit.frameworks.yarp.bottle_schema.expressions")

_GROUPS = MappingProxyType(
    {
        ":vocab": "(:vocab :|set|)",
        ":list": "(:list :double)",
        ":bottle": "(:bottle FIELD ...)",
        ":dict": "(:dict :double)",
        ":union": "(:union FIELD ...)",
        ":blob": "(:blob (:bottle FIELD ...))",
    }
)


def read_struct(name: str, nodes: Sequence[Node], problems: list[Diagnostic], *, span: Span, depth: int = 0, keyed: bool = False) -> Struct:
    """A struct of the fields that the nodes are; ``keyed`` where they are entries of a dict."""
    doc, form = "", ""
    match nodes:
        case (Word(":packed" | ":bare" as word), *nodes) if not keyed:
            form = word[1:]
        case _:
            pass
    match nodes:
        case (Form((Word(":documentation"), Text(doc))), *nodes):
            pass
        case _:
            pass
    fields = read_fields(name, nodes, problems, depth, Place(keyed=keyed, form=form))
    problems += [catalogue.rest_not_last(one.span, one.name) for one in fields[:-1] if one.option("rest")]
    return Struct(name, fields, doc, span, options=(("form", form),) if form else ())


def read_fields(owner: str, nodes: Sequence[Node], problems: list[Diagnostic], depth: int, place: Place) -> tuple[Field, ...]:
    """The fields that the nodes are, of different names."""
    fields: dict[str, Field] = {}
    for node in nodes:
        field = _read_field(owner, node, problems, depth, place)
        if len(problems) >= MAX_PROBLEMS:
            break
        if field is None:
            continue
        if field.name in fields and field.span is not None:
            problems.append(catalogue.duplicate(field.span, "field", field.name, fields[field.name].span))
        fields[field.name] = field
    return tuple(fields.values())


def _read_field(owner: str, node: Node, problems: list[Diagnostic], depth: int, place: Place) -> Field | None:
    match node:
        case Form((Text(name, span),)):
            problems.append(catalogue.no_type(span, name))
        case Form((Text(name, span), type_node, *rest)) if FIELD_NAME.fullmatch(name):
            type_, implied, marks = _read_field_type(type_node, f"{owner}.{name}", problems, depth)
            constants, options = sort_rest(rest, problems)
            if type_ is not None:
                field = Field(name, type_, doc=text_option(options, ":documentation", problems), span=span, options=marks)
                field = _with_constant(field, [*implied, *constants], problems)
                return with_options(field, options, problems, place)
        case Form((Text(name, span), *_)):
            problems.append(catalogue.invalid_name(span, name))
        case _:
            problems.append(catalogue.not_a_field(node.span))
    return None


def _read_field_type(
    node: Node, name: str, problems: list[Diagnostic], depth: int
) -> tuple[Type | None, list[Node], tuple[tuple[str, Constant], ...]]:
    """What only a field can have: a type, the constant that ``(:vocab :|set|)`` implies, and the mark of a blob's content."""
    match node:
        case Form((Word(":vocab"), Vocab() as constant)):
            return SCALARS[":vocab"], [constant], ()
        case Form((Word(":blob"), (Text() | Form((Word(":bottle"), *_))) as content)):
            return _read_type(content, name, problems, depth), [], (("blob", True),)
        case _:
            return _read_type(node, name, problems, depth), [], ()


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
        case Form((Word(":union"), *cases)) if cases:
            return make_union(name, read_fields(name, cases, problems, depth + 1, CASE), node.span)
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


def _with_constant(field: Field, constants: Sequence[Node], problems: list[Diagnostic]) -> Field:
    values = [schema_expr.read_constant(node, field.type, problems) for node in constants]
    if len(values) > 1 and any(value != values[0] for value in values):
        problems.append(catalogue.second_constant(constants[1].span))
    return replace(field, constant=values[0] if values else None)
