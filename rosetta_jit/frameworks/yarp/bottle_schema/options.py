"""Options of a field of a bottle schema: what follows its type."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import TYPE_CHECKING

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.frameworks.yarp import bottle_diagnostics as catalogue
from rosetta_jit.frameworks.yarp.bottle_schema.sexpr import Form, Node, Number, Text, Word, head
from rosetta_jit.frameworks.yarp.limits import MAX_PADDING
from rosetta_jit.frameworks.yarp.tags import DIALECTS
from rosetta_jit.model.expr import Literal
from rosetta_jit.model.limits import MAX_UNIT_PARTS
from rosetta_jit.model.types import Array, Bool, Bytes, Constant, Field, Float, Int, String, Type
from rosetta_jit.model.units import with_units
from rosetta_jit.startup.dataclass import dataclass, replace
from rosetta_jit.startup.late import Late

if TYPE_CHECKING:
    from rosetta_jit.frameworks.yarp.bottle_schema import expressions as schema_expr
else:
    schema_expr = Late("rosetta_jit.frameworks.yarp.bottle_schema.expressions")

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
        ":blob-size": Int(32, True, "blob-size"),
    }
)

OPTIONS: Mapping[str, str] = MappingProxyType(
    {
        ":unit": "(:unit :degree)",
        ":units": "(:units :degree :degree :m)",
        ":documentation": '(:documentation "...")',
        ":default": "(:default 0)",
        ":length": "(:length 16)",
        ":rest": ":rest",
        ":spread": ":spread",
        ":vector": ":vector",
        ":code": "(:code :double)",
        ":padding": "(:padding 4)",
        ":since": "(:since :yarp4)",
        ":key": '(:key "...")',
    }
)
"""The options of a field, and how each is written."""


@dataclass(frozen=True, slots=True)
class Place:
    """Where a field stands: in a dict, in a struct of some form (`forms`), or among the cases of a union."""

    keyed: bool = False
    form: str = ""
    case: bool = False


CASE = Place(case=True)


def sort_rest(nodes: Sequence[Node], problems: list[Diagnostic]) -> tuple[list[Node], dict[str, Node]]:
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


def with_options(field: Field, options: Mapping[str, Node], problems: list[Diagnostic], place: Place) -> Field:
    """The field with what its options say."""
    unit = options.get(":unit")
    if unit is not None:
        field = replace(field, unit=_unit(unit, problems))
    units = options.get(":units")
    if units is not None:
        field = _with_units(field, units, problems)
    default = options.get(":default")
    if default is not None:
        field = replace(field, default=_default(default, field.type, problems))
    length = options.get(":length")
    if length is not None:
        field = _with_length(field, length, problems)
    return replace(field, options=(*field.options, *_marks(field, options, problems, place)))


def _marks(field: Field, options: Mapping[str, Node], problems: list[Diagnostic], place: Place) -> tuple[tuple[str, Constant], ...]:
    """The options that an encoding must know, as the model wants them: sorted pairs."""
    key = text_option(options, ":key", problems) if ":key" in options else field.name
    marks: dict[str, Constant] = {"key": key} if place.keyed else {}
    listed, plain = isinstance(field.type, Array), not place.keyed and not place.form and not place.case
    rules = (
        (":key", place.keyed, "a field of a :dict"),
        (":rest", listed and plain, "a :list at the end of a bottle"),
        (":spread", listed and plain and ":rest" in options, "a :list with :rest"),
        (":vector", listed, "a :list of numbers"),
        (":code", listed, "a :list"),
        (":padding", place.form != "", "a field of a :packed or :bare struct"),
        (":since", listed and plain and ":rest" not in options, "a :list in a bottle, without :rest"),
    )
    for word, belongs, where in rules:
        node = options.get(word)
        if node is not None and not belongs:
            problems.append(catalogue.misplaced_option(node.span, word, where))
        elif node is not None and word != ":key":
            value = _mark(word, node)
            if value is None:
                problems.append(catalogue.malformed_option(node.span, OPTIONS[word]))
            else:
                marks[word[1:]] = value
    return tuple(sorted(marks.items()))


def _mark(word: str, node: Node) -> Constant | None:
    """The value of an option that is one; None where it is written otherwise."""
    match word, node:
        case ((":rest" | ":spread" | ":vector"), Word()):
            return True
        case ":code", Form((_, Word(name))) if isinstance(SCALARS.get(name), Int | Float):
            scalar = SCALARS[name]
            return scalar.spelling if isinstance(scalar, Int | Float) else None
        case ":padding", Form((_, Number(int(size)))) if 0 < size <= MAX_PADDING:
            return size
        case ":since", Form((_, Word(name))) if name[1:] in DIALECTS:
            return name[1:]
        case _:
            return None


def text_option(options: Mapping[str, Node], word: str, problems: list[Diagnostic]) -> str:
    """The text of an option, empty where it is not given."""
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
        case Form((_, name)) if _unit_name(name):
            return _unit_name(name)
        case _:
            problems.append(catalogue.malformed_option(node.span, OPTIONS[":unit"]))
            return None


def _with_units(field: Field, node: Node, problems: list[Diagnostic]) -> Field:
    """The field with a unit for each of its first elements."""
    if not isinstance(field.type, Array):
        problems.append(catalogue.misplaced_option(node.span, ":units", "a :list"))
        return field
    match node:
        case Form((_, *names)) if 0 < len(names) <= MAX_UNIT_PARTS and all(map(_unit_name, names)):
            return with_units(field, [_unit_name(name) for name in names])
        case _:
            problems.append(catalogue.malformed_option(node.span, OPTIONS[":units"]))
            return field


def _unit_name(node: Node) -> str:
    """The unit that a word or text names; empty where it is none."""
    match node:
        case Word(name) if name.startswith(":"):
            return name[1:]
        case Text(name):
            return name
        case _:
            return ""


def _default(node: Node, type_: Type, problems: list[Diagnostic]) -> Constant | None:
    match node:
        case Form((_, value)):
            match schema_expr.read_constant(value, type_, problems):
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
            return replace(field, length=schema_expr.read_expr(expr, problems))
        case Form((_, _)), _:
            problems.append(catalogue.misplaced_option(node.span, ":length", "a :list, :string or :blob without one"))
        case _:
            problems.append(catalogue.malformed_option(node.span, OPTIONS[":length"]))
    return field
