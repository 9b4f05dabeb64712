"""Kernel → text: one statement a line, the same text for the same kernel, different texts for different kernels.

It is what a person reads as ``stage("kernel")`` and a part of the cache's key, so that nothing of the kernel may be left out.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, assert_never

from rosetta_jit.kernel.ir import (
    Advance,
    Assign,
    Binary,
    Bits,
    Call,
    Capacity,
    Compare,
    Const,
    Convert,
    Copy,
    Digits,
    Expect,
    Fill,
    Fits,
    For,
    Get,
    HostCall,
    HostValue,
    If,
    IsText,
    Let,
    Load,
    Local,
    Lookup,
    Nearest,
    Place,
    Register,
    Require,
    Reserve,
    Return,
    Scale,
    Select,
    SetField,
    Store,
    Switch,
    Unary,
    Used,
    Var,
    While,
    Wire,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rosetta_jit.kernel.ir import Address, Block, Expr, Extent, Failure, Kernel, Known, Part, Routine, Site, Stmt

SYMBOL = {
    "add": "+",
    "sub": "-",
    "mul": "*",
    "div": "/",
    "rem": "%",
    "and": "&",
    "or": "|",
    "xor": "^",
    "shl": "<<",
    "shr": ">>",
    "min": "min",
    "max": "max",
    "atan2": "atan2",
    "eq": "==",
    "ne": "!=",
    "lt": "<",
    "le": "<=",
    "gt": ">",
    "ge": ">=",
}


def to_text(kernel: Kernel) -> str:
    """Text of a kernel.

    Parameters
    ----------
    kernel
        Any kernel, verified or not.

    Returns
    -------
    str
        Lines that end in a newline: the head, each routine and body, the sites.
    """
    hidden = f", {kernel.hidden} hidden" if kernel.hidden else ""
    registers = f", {kernel.registers} registers" if kernel.registers else ""
    kept = f", keeps lanes {list(kernel.kept)}" if kernel.kept else ""
    lines = [f"kernel {_name(kernel.name)}: {kernel.direction}, strides {list(kernel.strides)}{hidden}{registers}{kept}"]
    for routine in kernel.routines:
        lines.extend(_routine(routine))
    for number, body in enumerate(kernel.bodies):
        lines.append(f"body {number}:")
        lines.extend(_block(body, 1))
    lines.append("sites:")
    for number, site in enumerate(kernel.sites):
        lines.extend(_site(number, site))
    return "\n".join(lines) + "\n"


def statement_text(stmt: Stmt) -> str:
    """First line of a statement."""
    return next(_statement(stmt, 0))


def expression_text(expr: Expr) -> str:
    """Text of an expression, on one line."""
    match expr:
        case Const("i64", value):
            return str(value)
        case Const(type_, value):
            return f"{value!r}:{type_}"
        case Local(type_, name):
            return _name(name) if type_ == "i64" else f"{_name(name)}:{type_}"
        case Load(type_, at, order):
            return f"load {type_}{order} [{expression_text(at)}]"
        case Get(type_, place):
            return f"get {type_} {_address(place)}"
        case Used() | Capacity() | HostValue() | Register():
            return _known(expr)
        case Unary(function, operand):
            return f"{function}({expression_text(operand)})"
        case Binary(op, left, right) | Compare(op, left, right):
            return f"({expression_text(left)} {SYMBOL[op]} {expression_text(right)})"
        case Fits(op, left, right):
            return f"fits({expression_text(left)} {SYMBOL[op]} {expression_text(right)})"
        case Convert(type_, operand) | Bits(type_, operand):
            return f"{'bits ' * isinstance(expr, Bits)}{type_}({expression_text(operand)})"
        case Select(condition, then, otherwise):
            return f"({expression_text(then)} if {expression_text(condition)} else {expression_text(otherwise)})"
        case IsText(address, size):
            return f"is_text({_address(address)}, {expression_text(size)})"
        case Nearest() | Digits() | Scale():
            return _decimal(expr)
        case Lookup(type_, values, index):
            return f"{type_}({', '.join(map(str, values))})[{expression_text(index)}]"
        case _:
            assert_never(expr)


def _known(expr: Known) -> str:
    match expr:
        case Used(lane):
            return f"used({lane})"
        case Capacity(lane):
            return f"capacity({lane})"
        case HostValue(what):
            return what
        case Register(number):
            return f"register({number})"
        case _:
            assert_never(expr)


def _decimal(expr: Nearest | Digits | Scale) -> str:
    match expr:
        case Nearest(address, size, exponent):
            return f"nearest({_address(address)}, {expression_text(size)}, {expression_text(exponent)})"
        case Digits(value, places):
            return f"digits({expression_text(value)}{'' if places is None else f', {places}'})"
        case Scale(value):
            return f"scale({expression_text(value)})"
        case _:
            assert_never(expr)


def _statement(stmt: Stmt, depth: int) -> Iterator[str]:
    match stmt:
        case Require(at, size, failure):
            yield f"require [{expression_text(at)}] {expression_text(size)}{_failure(failure)}"
        case Expect(condition, failure):
            yield f"expect {expression_text(condition)}{_failure(failure)}"
        case Let(name, value):
            yield f"let {_name(name)} = {expression_text(value)}"
        case Var(name, value):
            yield f"var {_name(name)} = {expression_text(value)}"
        case Assign(name, value):
            yield f"{_name(name)} = {expression_text(value)}"
        case Store(at, value, order):
            yield f"store{order} [{expression_text(at)}] = {expression_text(value)}"
        case SetField(place, value):
            yield f"set {_address(place)} = {expression_text(value)}"
        case Reserve(lane, count):
            yield f"reserve {lane}, {expression_text(count)}"
        case Advance(lane, count):
            yield f"advance {lane}, {expression_text(count)}"
        case Copy(target, source, size):
            yield f"copy {_address(target)} = {_address(source)}, {expression_text(size)}"
        case Fill(target, size, byte):
            yield f"fill {_address(target)}, {expression_text(size)}, {byte}"
        case Return(position, registers):
            changed = ", ".join(f"register({number}) = {expression_text(value)}" for number, value in registers)
            yield f"return {expression_text(position)}{' with ' * bool(changed)}{changed}"
        case Call(routine, arguments, results, sites, indices):
            bound = ", ".join(map(expression_text, results))
            given = ", ".join(map(expression_text, arguments))
            within = "".join(f"[{expression_text(i)}]" for i in indices)
            yield f"let {bound} = call {_name(routine)}({given}) else {list(sites)}{within}"
        case HostCall(function, arguments, result, failure, inputs, target):
            given = ", ".join((*map(expression_text, arguments), *map(_extent, inputs)))
            filled = "" if target is None else f" into {_extent(target)}"
            yield f"let {expression_text(result)} = host {_name(function)}({given}){filled}{_failure(failure)}"
        case For() | While() | If() | Switch():
            yield from _nested(stmt, depth)
        case _:
            assert_never(stmt)


def _nested(stmt: For | While | If | Switch, depth: int) -> Iterator[str]:
    indent = "  " * depth
    match stmt:
        case For(variable, count, body):
            yield f"for {_name(variable)} < {expression_text(count)}:"
            yield from _block(body, depth + 1)
        case While(condition, body, invariant, measure):
            kept = "; ".join(map(expression_text, invariant))
            yield f"while {expression_text(condition)} (keeps {kept}) (grows {expression_text(measure)}):"
            yield from _block(body, depth + 1)
        case If(condition, then, otherwise):
            yield f"if {expression_text(condition)}:"
            yield from _block(then, depth + 1)
            if otherwise:
                yield f"{indent}else:"
                yield from _block(otherwise, depth + 1)
        case Switch(value, cases, default):
            yield f"switch {expression_text(value)}:"
            for number, block in cases:
                yield f"{indent}case {number}:"
                yield from _block(block, depth + 1)
            yield f"{indent}default:"
            yield from _block(default, depth + 1)


def _routine(routine: Routine) -> Iterator[str]:
    given, found = (", ".join(map(expression_text, some)) for some in (routine.parameters, routine.results))
    yield f"routine {_name(routine.name)}({given}) gives {found}:"
    yield from (f"  requires {expression_text(each)}" for each in routine.requires)
    yield from (f"  ensures {expression_text(each)}" for each in routine.ensures)
    yield from _block(routine.body, 1)
    yield "  sites:"
    for number, site in enumerate(routine.sites):
        yield from (f"  {line}" for line in _site(number, site))


def _block(block: Block, depth: int) -> Iterator[str]:
    indent = "  " * depth
    for stmt in block:
        lines = _statement(stmt, depth)
        yield indent + next(lines)
        yield from lines


def _failure(failure: Failure) -> str:
    indices = "".join(f"[{expression_text(i)}]" for i in failure.indices)
    return f" else {failure.site} @ {expression_text(failure.at)}{indices}"


def _address(address: Address) -> str:
    match address:
        case Place(lane, row, offset):
            return f"lane {lane}[{expression_text(row)}].{offset}"
        case Wire(at):
            return f"[{expression_text(at)}]"
        case _:
            assert_never(address)


def _extent(extent: Extent) -> str:
    return f"{_address(extent.address)} {expression_text(extent.size)}"


def _site(number: int, site: Site) -> Iterator[str]:
    lane = "" if site.detail_lane is None else f" of lane {site.detail_lane}"
    yield f"  {number}: {site.kind!r} {site.path!r} {site.detail!r} {site.line!r}{lane}"
    yield from (f"    {_part(part)}" for part in site.parts)


def _part(part: Part) -> str:
    step = f" every {part.step}" if part.step else ""
    return f"+{part.offset}, {part.size}{step}: {part.path!r}"


def _name(name: str) -> str:
    """A schema's names may hold anything; quoted they stay on their line and apart from the rest."""
    return name if name.isidentifier() else repr(name)
