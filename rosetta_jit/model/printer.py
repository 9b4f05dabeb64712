"""Types as text for a person: one declaration a paragraph, one field a line."""

from __future__ import annotations

from collections.abc import Iterable
from typing import assert_never

from rosetta_jit.model import expr
from rosetta_jit.model.types import (
    Array,
    Bool,
    Bytes,
    Declaration,
    Enum,
    Field,
    Float,
    Int,
    Map,
    Optional,
    Ref,
    Schema,
    String,
    Struct,
    Type,
    Union,
)

ESCAPED = str.maketrans({'"': '\\"', "\\": "\\\\", "\n": "\\n", "\t": "\\t", "\r": "\\r"})
"""Characters that a text in quotes writes otherwise."""


def show_types(schema: Schema, structs: Iterable[Struct]) -> str:
    """The structs, and every declaration that they reach, each once."""
    shown: dict[str, str] = {}
    pending: list[Declaration] = [*structs]
    while pending:
        declaration = pending.pop(0)
        if declaration.name not in shown:
            shown[declaration.name] = _declaration(declaration)
            pending += [schema.types[each] if isinstance(each, str) else each for each in _referred_by(declaration)]
    return "\n".join(shown.values())


def show_type(type_: Type) -> str:
    """A type in one line."""
    match type_:
        case Bool() | Int() | Float():
            return _scalar(type_)
        case String(encoding, _, maximum):
            return ("string" if encoding == "utf-8" else f"string of {encoding}") + _bounds(None, maximum)
        case Bytes(_, length, maximum):
            return "bytes" + _bounds(length, maximum)
        case Enum(name) | Struct(name) | Ref(name):
            return name
        case Array(element, length, maximum):
            return f"[{show_type(element)}{_bounds(length, maximum)}]"
        case Optional(value):
            return f"{show_type(value)}?"
        case Map(key, value):
            return f"{{{show_type(key)}: {show_type(value)}}}"
        case Union(_, cases):
            labels = [f"{', '.join(map(str, each))} = " for each in type_.labels] or [""] * len(cases)
            return " | ".join(f"{label}{each.name}: {show_type(each.type)}" for label, each in zip(labels, cases, strict=True))
        case _:
            assert_never(type_)


def show_expr(value: expr.Expr) -> str:
    """An expression, with all parentheses."""
    match value:
        case expr.Literal(literal):
            return _literal(literal)
        case expr.Name(name):
            return name
        case expr.Path(_, steps):
            return "".join(map(_step, steps))
        case expr.Len(path):
            return f"len({show_expr(path)})"
        case expr.Unary(operator, operand):
            return f"{operator}{' ' if operator == 'not' else ''}{show_expr(operand)}"
        case expr.Binary(operator, left, right):
            word = "!=" if operator == "differs" else operator  # as near as a text comes to it
            return f"({show_expr(left)} {word} {show_expr(right)})"
        case expr.Call(function, arguments):
            where = "" if value.where is None else f" where {show_expr(value.where)}"
            return f"{function}({', '.join(map(_argument, arguments))}{where})"
        case expr.Choice() if (subject := _subject(value)) is not None:
            entries = [f"{show_expr(key.right)} = {show_expr(each)}" for key, each in value.cases if isinstance(key, expr.Binary)]
            return f"table({show_expr(subject)}) {{ {', '.join([*entries, _last(value)])} }}"
        case expr.Choice(cases, otherwise, reason):
            last = f"reject {_literal(reason)}" if otherwise is None else show_expr(otherwise)
            return f"({' else '.join([f'{show_expr(value)} if {show_expr(condition)}' for condition, value in cases])} else {last})"
        case expr.List(items):
            return f"[{', '.join(map(show_expr, items))}]"
        case expr.Item(items, expr.Literal(str(name))):
            return f"{show_expr(items)}.{name}"
        case expr.Item(items, at):
            return f"{show_expr(items)}[{show_expr(at)}]"
        case expr.Given(name, arguments):
            return name + "".join(f"[{show_expr(argument)}]" for argument in arguments)
        case expr.Coerced(value=inner) | expr.Nearest(inner):
            return show_expr(inner)
        case _:
            assert_never(value)


def _argument(value: expr.Expr) -> str:
    """An expression that stands in brackets already."""
    text = show_expr(value)
    return text[1:-1] if isinstance(value, expr.Binary) else text


def _literal(value: bool | float | str) -> str:
    """A constant as mappings write it."""
    match value:
        case bool():
            return "true" if value else "false"
        case str():
            return f'"{value.translate(ESCAPED)}"'
        case _:
            return repr(value)


def _step(step: expr.Step) -> str:
    match step:
        case expr.Member(name):
            return f".{name}"
        case expr.Index(index):
            return f"[{show_expr(index)}]"
        case expr.Keyed(names, key, _, beside):
            array = f"{_names(beside)}[]" if beside else ""
            return f"[{array}{_names(names)} = {show_expr(key)}]"
        case expr.Slice(start, stop, by):
            end = "" if stop is None else f" {show_expr(stop)}"
            return f"[{show_expr(start)} to{end}{'' if by == expr.Literal(1) else f' by {show_expr(by)}'}]"
        case expr.Pick(indices):
            return f"[[{', '.join(map(str, indices))}]]"
        case expr.Each():
            return "[]"
        case _:
            assert_never(step)


def _names(names: tuple[str, ...]) -> str:
    return "".join(f".{name}" for name in names)


def _subject(choice: expr.Choice) -> expr.Expr | None:
    """What a table looks up, if a choice is one: all of its conditions compare the same."""
    subjects = {key.left if isinstance(key, expr.Binary) and key.operator == "==" else None for key, _ in choice.cases}
    return subjects.pop() if len(subjects) == 1 else None


def _last(choice: expr.Choice) -> str:
    """How a table ends."""
    return f"otherwise {f'reject {_literal(choice.reason)}' if choice.otherwise is None else show_expr(choice.otherwise)}"


def show_way(path: tuple[str | int | None, ...]) -> str:
    """The way to a part of a value, as a path: ``[2].x``."""
    return "".join(f".{step}" if isinstance(step, str) else "[]" if step is None else f"[{step}]" for step in path)


def _bounds(length: int | expr.Expr | None, maximum: int | None) -> str:
    if length is not None:
        return f"; {length if isinstance(length, int) else show_expr(length)}"
    return "" if maximum is None else f"; at most {maximum}"


def _scalar(type_: Bool | Int | Float) -> str:
    match type_:
        case Bool(spelling):
            plain = "bool"
        case Int(bits, signed, spelling):
            plain = f"{'int' if signed else 'uint'}{bits}"
        case Float(bits, spelling):
            plain = f"float{bits}"
    return plain if spelling in ("", plain) else f"{plain} ({spelling})"


def _declaration(declaration: Declaration) -> str:
    match declaration:
        case Struct(name, fields):
            constants = [f"  {each.name}: {show_type(each.type)} = {each.value!r}" for each in declaration.constants]
            options = "".join(f", {each} {value!r}" for each, value in declaration.options)
            return "\n".join([f"struct {name}{options}", *constants, *(f"  {_field(each)}" for each in fields), ""])
        case Enum(name, values, closed):
            kind = "enum" if closed else "open enum"
            return "\n".join([f"{kind} {name}", *(f"  {each} = {number}" for each, number in values), ""])


def _field(field: Field) -> str:
    parts = [f"{field.name}: {show_type(field.type)}"]
    parts += [f"number {field.number}"] if field.number is not None else []
    parts += ["required"] if field.required else []
    parts += [f"in {field.unit}"] if field.unit is not None else []
    parts += [f"{show_way(path)} in {unit}" for path, unit in field.part_units]
    parts += [f"always {show_expr(field.constant)}"] if field.constant is not None else []
    parts += [f"length {show_expr(field.length)}"] if field.length is not None else []
    parts += [f"default {field.default!r}"] if field.default is not None else []
    parts += [f"{name} {value!r}" for name, value in field.options]
    return ", ".join(parts)


def _referred_by(declaration: Declaration) -> list[str | Struct]:
    """The declarations that one refers to by name, and the structs that are written within it, in order."""
    return [found for each in declaration.fields for found in _referred(each.type)] if isinstance(declaration, Struct) else []


def _referred(type_: Type) -> list[str | Struct]:
    match type_:
        case Ref(name):
            return [name]
        case Struct():
            return [type_]
        case Array(inner, _) | Optional(inner):
            return _referred(inner)
        case Map(key, value):
            return _referred(key) + _referred(value)
        case Union(_, cases):
            return [found for each in cases for found in _referred(each.type)]
        case _:
            return []
