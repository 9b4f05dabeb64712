"""Types as plain data and back: what a cached program keeps so that a warm process rebuilds its holder without an IDL.

    {"type": Type, "declared": {name: Type}}          only what the type reaches
    Type  = [word, ...]                               the word of the model in lower case, then its attributes in order
    Field = [name, Type, number, unit, default, required, options, constant, length, part units]
    Expr  = [word, ...], as of a type: see `model.serial_expressions`

Documentation and spans stay behind: only the compiler reads them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, assert_never, cast

from rosetta_jit.model import types
from rosetta_jit.model.limits import MAX_SERIAL_DEPTH

if TYPE_CHECKING:
    from rosetta_jit.model.expr import Expr

Plain = dict[str, Any]
"""What JSON can carry."""


def to_plain(type_: types.Type, schema: types.Schema) -> Plain:
    """The type and every declaration that it reaches, as plain data.

    Raises
    ------
    ValueError
        If types are written inside each other more than `MAX_SERIAL_DEPTH` deep.
    """
    writing = _Writing()
    root = writing.type(type_, 0)
    declared: dict[str, list[Any]] = {}
    while writing.pending:
        name = writing.pending.pop()
        if name not in declared:
            declared[name] = writing.type(schema.types[name], 0)
    return {"type": root, "declared": dict(sorted(declared.items()))}


def from_plain(plain: Plain) -> tuple[types.Type, types.Schema]:
    """The type, and a schema of the declarations that it reaches; raises ValueError if the data is not what `to_plain` makes."""
    try:
        declared = {name: _type(each, 0) for name, each in plain["declared"].items()}
        root = _type(plain["type"], 0)
    except (KeyError, IndexError, TypeError, AttributeError) as problem:
        raise ValueError(f"not a type: {problem}") from None
    return root, types.Schema({name: each for name, each in declared.items() if isinstance(each, types.Struct | types.Enum)})


class _Writing:
    """Names that were referred to and not yet written."""

    def __init__(self) -> None:
        self.pending: list[str] = []

    def type(self, type_: types.Type, depth: int) -> list[Any]:
        if depth > MAX_SERIAL_DEPTH:
            raise ValueError(f"types nest more than {MAX_SERIAL_DEPTH} deep")
        match type_:
            case types.Bool(spelling):
                return ["bool", spelling]
            case types.Int(bits, signed, spelling):
                return ["int", bits, signed, spelling]
            case types.Float(bits, spelling):
                return ["float", bits, spelling]
            case types.String(encoding, spelling, maximum):
                return ["string", encoding, spelling, maximum]
            case types.Bytes(spelling, length, maximum):
                return ["bytes", spelling, _plain_length(length), maximum]
            case types.Enum(name, values, closed, _, bits):
                return ["enum", name, [list(pair) for pair in values], closed, bits]
            case types.Array(element, length, maximum):
                return ["array", self.type(element, depth + 1), _plain_length(length), maximum]
            case types.Struct(name, fields):
                constants = [[each.name, self.type(each.type, depth + 1), _plain_constant(each.value)] for each in type_.constants]
                return ["struct", name, [self.field(each, depth + 1) for each in fields], constants, _plain_options(type_.options)]
            case types.Union(name, cases, _, discriminator, labels, default):
                fields = [self.field(each, depth + 1) for each in cases]
                return ["union", name, fields, discriminator, [list(each) for each in labels], default]
            case types.Optional(value):
                return ["optional", self.type(value, depth + 1)]
            case types.Map(key, value, maximum):
                return ["map", self.type(key, depth + 1), self.type(value, depth + 1), maximum]
            case types.Ref(name):
                self.pending.append(name)
                return ["ref", name]
            case _:
                assert_never(type_)

    def field(self, field: types.Field, depth: int) -> list[Any]:
        default, options = _plain_constant(field.default), _plain_options(field.options)
        computed = [_plain_expr(field.constant), _plain_expr(field.length)]
        parts = [[list(path), unit] for path, unit in field.part_units]
        return [field.name, self.type(field.type, depth), field.number, field.unit, default, field.required, options, *computed, parts]


def _plain_expr(value: Expr | None) -> list[Any] | None:
    if value is None:
        return None
    from rosetta_jit.model.serial_expressions import plain_expression

    return plain_expression(value)


def _expr(plain: Any, depth: int) -> Any:
    """Few fields have an expression: who reads none does not import them."""
    if plain is None:
        return None
    from rosetta_jit.model.serial_expressions import expression_of

    return expression_of(plain, depth, MAX_SERIAL_DEPTH)


def _plain_length(length: object) -> Any:
    """A number, or the path of the field that tells it."""
    if length is None or isinstance(length, int):
        return length
    from rosetta_jit.model.serial_expressions import names_on

    return names_on(length)


def _length(plain: Any) -> Any:
    if not isinstance(plain, list):
        return plain
    from rosetta_jit.model.serial_expressions import path_of

    return path_of(cast("list[str]", plain))


def _plain_options(options: tuple[tuple[str, types.Constant], ...]) -> list[Any]:
    return [[name, _plain_constant(value)] for name, value in options]


def _options(plain: list[Any]) -> tuple[tuple[str, types.Constant], ...]:
    return tuple((name, _constant(value)) for name, value in plain)


def _type(plain: list[Any], depth: int) -> types.Type:
    if depth > MAX_SERIAL_DEPTH:
        raise ValueError(f"types nest more than {MAX_SERIAL_DEPTH} deep")
    match plain:
        case ["bool", spelling]:
            return types.Bool(spelling)
        case ["int", bits, signed, spelling]:
            return types.Int(bits, signed, spelling)
        case ["float", bits, spelling]:
            return types.Float(bits, spelling)
        case ["string", encoding, spelling, maximum]:
            return types.String(encoding, spelling, maximum)
        case ["bytes", spelling, length, maximum]:
            return types.Bytes(spelling, _length(length), maximum)
        case ["enum", name, values, closed, bits]:
            return types.Enum(name, tuple((each, number) for each, number in values), closed, bits=bits)
        case ["array", element, length, maximum]:
            return types.Array(_type(element, depth + 1), _length(length), maximum)
        case ["struct", name, fields, constants, options]:
            named = tuple(types.NamedConstant(each, _type(type_, depth + 1), _constant(value)) for each, type_, value in constants)
            return types.Struct(name, tuple(_field(each, depth + 1) for each in fields), constants=named, options=_options(options))
        case ["union", name, cases, discriminator, labels, default]:
            fields = tuple(_field(each, depth + 1) for each in cases)
            return types.Union(name, fields, None, discriminator, tuple(tuple(each) for each in labels), default)
        case ["optional", value]:
            return types.Optional(_type(value, depth + 1))
        case ["map", key, value, maximum]:
            return types.Map(_type(key, depth + 1), _type(value, depth + 1), maximum)
        case ["ref", name]:
            return types.Ref(name)
        case _:
            raise ValueError(f"not a type: {plain!r:.80}")


def _field(plain: list[Any], depth: int) -> types.Field:
    name, type_, number, unit, default, required, options, constant, length, parts = plain
    return types.Field(
        name,
        _type(type_, depth),
        number=number,
        unit=unit,
        constant=_expr(constant, depth),
        length=_expr(length, depth),
        default=_constant(default),
        required=required,
        options=_options(options),
        part_units=tuple((tuple(path), unit) for path, unit in parts),
    )


def _plain_constant(value: object) -> Any:
    """Bytes are the one constant that JSON has no word for."""
    return {"hex": value.hex()} if isinstance(value, bytes) else value


def _constant(plain: Any) -> Any:
    return bytes.fromhex(cast("str", plain["hex"])) if isinstance(plain, dict) else plain
