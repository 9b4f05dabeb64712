"""Kernel → text: one statement a line, the same text for the same kernel, different texts for different kernels.

It is what a person reads as ``stage("kernel")`` and a part of the cache's key, so that nothing of the kernel may be left out.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import assert_never

from rosetta_jit.kernel import ir, nodes

SYMBOL = {
    "add": "+",
    "wrapping_add": "+%",
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


def to_text(kernel: ir.Kernel) -> str:
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
    goes_on = ", another kernel goes on" if kernel.goes_on else ""
    lines = [f"kernel {_name(kernel.name)}: {kernel.direction}, strides {list(kernel.strides)}{hidden}{registers}{kept}{goes_on}"]
    for routine in kernel.routines:
        lines.extend(_routine(routine))
    for number, body in enumerate(kernel.bodies):
        lines.append(f"body {number}:")
        lines.extend(_block(body, 1))
    lines.append("sites:")
    for number, site in enumerate(kernel.sites):
        lines.extend(_site(number, site))
    return "\n".join(lines) + "\n"


def statement_text(stmt: nodes.Stmt) -> str:
    """First line of a statement."""
    return next(_statement(stmt, 0))


def expression_text(expr: nodes.Expr) -> str:
    """Text of an expression, on one line."""
    match expr:
        case nodes.Const("i64", value):
            return str(value)
        case nodes.Const(type_, value):
            return f"{value!r}:{type_}"
        case nodes.Local(type_, name):
            return _name(name) if type_ == "i64" else f"{_name(name)}:{type_}"
        case nodes.Load(type_, at, order):
            return f"load {type_}{order} [{expression_text(at)}]"
        case nodes.Get(type_, place):
            return f"get {type_} {_address(place)}"
        case nodes.Used() | nodes.Capacity() | nodes.HostValue() | nodes.Register():
            return _known(expr)
        case nodes.Unary(function, operand):
            return f"{function}({expression_text(operand)})"
        case nodes.Binary(op, left, right) | nodes.Compare(op, left, right):
            return f"({expression_text(left)} {SYMBOL[op]} {expression_text(right)})"
        case nodes.Fits(op, left, right):
            return f"fits({expression_text(left)} {SYMBOL[op]} {expression_text(right)})"
        case nodes.Convert(type_, operand) | nodes.Bits(type_, operand):
            return f"{'bits ' * isinstance(expr, nodes.Bits)}{type_}({expression_text(operand)})"
        case nodes.Select(condition, then, otherwise):
            return f"({expression_text(then)} if {expression_text(condition)} else {expression_text(otherwise)})"
        case nodes.IsText(address, size):
            return f"is_text({_address(address)}, {expression_text(size)})"
        case nodes.Nearest() | nodes.Digits() | nodes.Scale():
            return _decimal(expr)
        case nodes.Lookup(type_, values, index):
            return f"{type_}({', '.join(map(str, values))})[{expression_text(index)}]"
        case _:
            assert_never(expr)


def _known(expr: nodes.Known) -> str:
    match expr:
        case nodes.Used(lane):
            return f"used({lane})"
        case nodes.Capacity(lane):
            return f"capacity({lane})"
        case nodes.HostValue(what):
            return what
        case nodes.Register(number):
            return f"register({number})"
        case _:
            assert_never(expr)


def _decimal(expr: nodes.Nearest | nodes.Digits | nodes.Scale) -> str:
    match expr:
        case nodes.Nearest(address, size, exponent):
            return f"nearest({_address(address)}, {expression_text(size)}, {expression_text(exponent)})"
        case nodes.Digits(value, places):
            return f"digits({expression_text(value)}{'' if places is None else f', {places}'})"
        case nodes.Scale(value):
            return f"scale({expression_text(value)})"
        case _:
            assert_never(expr)


def _statement(stmt: nodes.Stmt, depth: int) -> Iterator[str]:
    match stmt:
        case nodes.Require(at, size, failure):
            yield f"require [{expression_text(at)}] {expression_text(size)}{_failure(failure)}"
        case nodes.Expect(condition, failure):
            yield f"expect {expression_text(condition)}{_failure(failure)}"
        case nodes.Let(name, value):
            yield f"let {_name(name)} = {expression_text(value)}"
        case nodes.Var(name, value):
            yield f"var {_name(name)} = {expression_text(value)}"
        case nodes.Assign(name, value):
            yield f"{_name(name)} = {expression_text(value)}"
        case nodes.Store(at, value, order):
            yield f"store{order} [{expression_text(at)}] = {expression_text(value)}"
        case nodes.SetField(place, value):
            yield f"set {_address(place)} = {expression_text(value)}"
        case nodes.Reserve(lane, count):
            yield f"reserve {lane}, {expression_text(count)}"
        case nodes.Advance(lane, count):
            yield f"advance {lane}, {expression_text(count)}"
        case nodes.Copy(target, source, size):
            yield f"copy {_address(target)} = {_address(source)}, {expression_text(size)}"
        case nodes.Fill(target, size, byte):
            yield f"fill {_address(target)}, {expression_text(size)}, {byte}"
        case nodes.Return(position, registers):
            changed = ", ".join(f"register({number}) = {expression_text(value)}" for number, value in registers)
            yield f"return {expression_text(position)}{' with ' * bool(changed)}{changed}"
        case nodes.Call(routine, arguments, results, sites, indices):
            bound = ", ".join(map(expression_text, results))
            texts = ", ".join(map(expression_text, arguments))
            within = "".join(f"[{expression_text(i)}]" for i in indices)
            yield f"let {bound} = call {_name(routine)}({texts}) else {list(sites)}{within}"
        case nodes.HostCall(function, arguments, result, failure, inputs, target):
            texts = ", ".join((*map(expression_text, arguments), *map(_extent, inputs)))
            filled = "" if target is None else f" into {_extent(target)}"
            yield f"let {expression_text(result)} = host {_name(function)}({texts}){filled}{_failure(failure)}"
        case nodes.For() | nodes.While() | nodes.If() | nodes.Switch():
            yield from _nested(stmt, depth)
        case _:
            assert_never(stmt)


def _nested(stmt: nodes.For | nodes.While | nodes.If | nodes.Switch, depth: int) -> Iterator[str]:
    indent = "  " * depth
    match stmt:
        case nodes.For(variable, count, body):
            yield f"for {_name(variable)} < {expression_text(count)}:"
            yield from _block(body, depth + 1)
        case nodes.While(condition, body, invariant, measure):
            kept = "; ".join(map(expression_text, invariant))
            yield f"while {expression_text(condition)} (keeps {kept}) (grows {expression_text(measure)}):"
            yield from _block(body, depth + 1)
        case nodes.If(condition, then, otherwise):
            yield f"if {expression_text(condition)}:"
            yield from _block(then, depth + 1)
            if otherwise:
                yield f"{indent}else:"
                yield from _block(otherwise, depth + 1)
        case nodes.Switch(value, cases, default):
            yield f"switch {expression_text(value)}:"
            for number, block in cases:
                yield f"{indent}case {number}:"
                yield from _block(block, depth + 1)
            yield f"{indent}default:"
            yield from _block(default, depth + 1)


def _routine(routine: ir.Routine) -> Iterator[str]:
    parameters, found = (", ".join(map(expression_text, some)) for some in (routine.parameters, routine.results))
    yield f"routine {_name(routine.name)}({parameters}) gives {found}:"
    yield from (f"  requires {expression_text(each)}" for each in routine.requires)
    yield from (f"  ensures {expression_text(each)}" for each in routine.ensures)
    yield from _block(routine.body, 1)
    yield "  sites:"
    for number, site in enumerate(routine.sites):
        yield from (f"  {line}" for line in _site(number, site))


def _block(block: nodes.Block, depth: int) -> Iterator[str]:
    indent = "  " * depth
    for stmt in block:
        lines = _statement(stmt, depth)
        yield indent + next(lines)
        yield from lines


def _failure(failure: nodes.Failure) -> str:
    indices = "".join(f"[{expression_text(i)}]" for i in failure.indices)
    return f" else {failure.site} @ {expression_text(failure.at)}{indices}"


def _address(address: nodes.Address) -> str:
    match address:
        case nodes.Place(lane, row, offset):
            return f"lane {lane}[{expression_text(row)}].{offset}"
        case nodes.Wire(at):
            return f"[{expression_text(at)}]"
        case _:
            assert_never(address)


def _extent(extent: nodes.Extent) -> str:
    return f"{_address(extent.address)} {expression_text(extent.size)}"


def _site(number: int, site: ir.Site) -> Iterator[str]:
    lane = "" if site.detail_lane is None else f" of lane {site.detail_lane}"
    yield f"  {number}: {site.kind!r} {site.path!r} {site.detail!r} {site.line!r}{lane}"
    yield from (f"    {_part(part)}" for part in site.parts)


def _part(part: ir.Part) -> str:
    step = f" every {part.step}" if part.step else ""
    return f"+{part.offset}, {part.size}{step}: {part.path!r}"


def _name(name: str) -> str:
    """A schema's names may hold anything; quoted they stay on their line and apart from the rest."""
    return name if name.isidentifier() else repr(name)
