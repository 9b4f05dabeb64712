"""The rows of the paper's table 1: every feature of data description, and how a model shows that it has arrived there."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

from rosetta_jit.model import types
from rosetta_jit.model.expr import Literal
from rosetta_jit.model.recursive_structs import recursive_structs

Arrived = Callable[[types.Struct, types.Schema], bool]
"""Whether a model shows the feature that its struct was written for."""

DOC, NUMBER, UNIT = "where it is", 5, "metre"
"""What the probes of comments, defaults and constants, and units say: the model must repeat it."""

DURATIONS = ("duration",)
TIMES = ("time", "timestamp", "stamp")
CHARACTERS = ("char", "wchar", "char16_t")


def _reached(struct: types.Struct, schema: types.Schema) -> Iterator[types.Type]:
    """Every type that a struct mentions, each declaration once."""
    pending: list[types.Type] = [struct]
    seen: set[str] = set()
    while pending:
        type_ = pending.pop()
        yield type_
        match type_:
            case types.Struct(_, fields) | types.Union(_, fields):
                pending += [each.type for each in fields]
            case types.Array(element) | types.Optional(element):
                pending.append(element)
            case types.Map(key, value):
                pending += [key, value]
            case types.Ref(name) if name not in seen:
                seen.add(name)
                pending.append(schema.types[name])
            case _:
                pass


def _mentions(wanted: Callable[[types.Type], bool]) -> Arrived:
    return lambda struct, schema: any(wanted(each) for each in _reached(struct, schema))


def _member(wanted: Callable[[types.Field], bool]) -> Arrived:
    return lambda struct, _: any(wanted(each) for each in struct.fields)


def _integer(bits: int, *, signed: bool) -> Arrived:
    return _mentions(lambda each: isinstance(each, types.Int) and (each.bits, each.signed) == (bits, signed))


def _float(bits: int) -> Arrived:
    return _mentions(lambda each: isinstance(each, types.Float) and each.bits == bits)


def _character(bits: int) -> Arrived:
    return _mentions(lambda each: isinstance(each, types.Int) and each.bits == bits and each.spelling in CHARACTERS)


def _text(encoding: str) -> Arrived:
    return _mentions(lambda each: isinstance(each, types.String) and each.encoding == encoding)


def _array(wanted: Callable[[types.Array], bool]) -> Arrived:
    return _mentions(lambda each: isinstance(each, types.Array) and wanted(each))


def _bytes(wanted: Callable[[types.Bytes], bool]) -> Arrived:
    return _mentions(lambda each: isinstance(each, types.Bytes) and wanted(each))


def _enum(*, closed: bool) -> Arrived:
    return _mentions(lambda each: isinstance(each, types.Enum) and each.closed == closed and bool(each.values))


def _named(words: tuple[str, ...]) -> Arrived:
    return _mentions(lambda each: isinstance(each, types.Struct) and types.name_parts(each.name)[-1].lower() in words)


def _fixed(field: types.Field) -> bool:
    """Whether the length of a field is a number: of its type, or of the field beside it (YARP)."""
    return isinstance(field.length, Literal) or (isinstance(field.type, types.Array | types.Bytes) and isinstance(field.type.length, int))


def _is_sized_by_field(field: types.Field) -> bool:
    """Whether other fields tell the length of a field."""
    length = field.length or (field.type.length if isinstance(field.type, types.Array | types.Bytes) else None)
    return length is not None and not isinstance(length, int | Literal)


def _letters(field: types.Field) -> bool:
    match field.type:
        case types.String():
            return True
        case types.Bytes(spelling) | types.Array(types.Int(8, _, spelling)):
            return spelling == "char"
        case _:
            return False


def _has_struct(struct: types.Struct, schema: types.Schema) -> bool:
    bare = (each.type.value if isinstance(each.type, types.Optional) else each.type for each in struct.fields)
    return any(isinstance(schema.resolve(each), types.Struct) for each in bare)


def _has_constant(struct: types.Struct, schema: types.Schema) -> bool:
    named = any(each.value == NUMBER for each in (*struct.constants, *schema.constants.values()))
    return named or any(isinstance(each.constant, Literal) and each.constant.value == NUMBER for each in struct.fields)


def _spans_files(struct: types.Struct, schema: types.Schema) -> bool:
    return bool(struct.fields) and len({each.span.source.name for each in schema.types.values() if each.span}) > 1


def _documented(struct: types.Struct, _: types.Schema) -> bool:
    return any(DOC in each.doc for each in (struct, *struct.fields))


def _never(_: types.Struct, __: types.Schema) -> bool:
    """The meta-model has nothing of the kind."""
    return False


FEATURES: Mapping[str, Arrived] = {
    "boolean": _mentions(lambda each: isinstance(each, types.Bool)),
    **{f"int{bits}": _integer(bits, signed=True) for bits in (8, 16, 32, 64)},
    **{f"uint{bits}": _integer(bits, signed=False) for bits in (8, 16, 32, 64)},
    "float32": _float(32),
    "float64": _float(64),
    "long double": _never,
    "fixed point": _never,
    "character": _character(8),
    "wide character": _character(16),
    "string, UTF-8": _text("utf-8"),
    "string, unchecked": _text("octets"),
    "string, wide": _text("utf-16"),
    "string, bounded": _mentions(lambda each: isinstance(each, types.String) and each.maximum is not None),
    "string, fixed": _member(lambda each: _fixed(each) and _letters(each)),
    "blob": _bytes(lambda each: each.length is None and each.maximum is None),
    "blob, fixed": _member(lambda each: isinstance(each.type, types.Bytes) and _fixed(each)),
    "blob, bounded": _bytes(lambda each: each.maximum is not None),
    "blob, sized by a field": _member(lambda each: isinstance(each.type, types.Bytes) and _is_sized_by_field(each)),
    "array, fixed": _member(lambda each: isinstance(each.type, types.Array) and _fixed(each)),
    "array, variable": _array(lambda each: each.length is None and each.maximum is None),
    "array, bounded": _array(lambda each: each.maximum is not None),
    "array, sized by a field": _member(lambda each: isinstance(each.type, types.Array) and _is_sized_by_field(each)),
    "array, several fixed dimensions": _array(
        lambda each: each.fixed is not None and isinstance(each.element, types.Array) and each.element.fixed is not None
    ),
    "array, several variable dimensions": _array(
        lambda each: (
            isinstance(each.element, types.Array)
            and each.length is not None is not each.element.length
            and each.fixed is None is each.element.fixed
        )
    ),
    "array of arrays": _array(lambda each: each.length is None and isinstance(each.element, types.Array) and each.element.length is None),
    "struct": _has_struct,
    "oneof": _mentions(lambda each: isinstance(each, types.Union) and not each.discriminator),
    "union with a discriminator": _mentions(lambda each: isinstance(each, types.Union) and bool(each.discriminator)),
    "enum, closed": _enum(closed=True),
    "enum, open": _enum(closed=False),
    "bit set": _never,
    "optional": _mentions(lambda each: isinstance(each, types.Optional)),
    "required": _member(lambda each: each.required),
    "default": _member(lambda each: each.default == NUMBER),
    "map": _mentions(lambda each: isinstance(each, types.Map)),
    "set": _member(lambda each: bool(each.option("set"))),
    "any type": _never,
    "constant": _has_constant,
    "recursion": lambda struct, schema: bool(recursive_structs(types.Ref(struct.name), schema)),
    "inheritance": lambda struct, _: [each.name for each in struct.fields] == ["x", "y"],
    "extension": lambda struct, _: len(struct.fields) > 1,
    "evolution": lambda struct, _: struct.option("extensibility") == "mutable" or all(each.number for each in struct.fields),
    "namespace": lambda struct, _: len(types.name_parts(struct.name)) > 1,
    "import": _spans_files,
    "time": _named(TIMES),
    "duration": _named(DURATIONS),
    "unit": _member(lambda each: each.unit == UNIT),
    "documentation": _documented,
    "service": lambda _, schema: any(types.name_parts(name)[-1].lower().endswith(("request", "call", "goal")) for name in schema.types),
}
"""Every feature, and what shows it."""
