"""Checks of generated functions: what ends an attempt to read or write a message, and whether bytes are missing."""

from __future__ import annotations

from rosetta_jit.generate.parentheses import bare
from rosetta_jit.generate.python.passes.groups import is_not_negative
from rosetta_jit.generate.python.printing.expressions import expression
from rosetta_jit.generate.python.printing.printed import Function
from rosetta_jit.kernel import nodes


def lacks(function: Function, at: nodes.Expr, size: nodes.Expr) -> str:
    """The condition under which bytes are missing."""
    where, length = function.text(at), expression(function.scope, size)
    behind = function.scope.sums.get(nodes.Binary("add", at, size))
    if behind is not None and is_not_negative(at, function.positive) and is_not_negative(size, function.positive):
        return f"{behind} > end"
    if is_not_negative(at, function.positive) and is_not_negative(size, function.positive):
        if isinstance(size, nodes.Const):
            return f"end < {where} + {length}" if not isinstance(at, nodes.Const) else f"end < {int(at.value) + int(size.value)}"
        return f"{bare(length)} > end - {expression(function.scope, at)}"
    if isinstance(size, nodes.Const):
        if isinstance(at, nodes.Const):
            return f"end < {int(at.value) + int(size.value)}"
        return f"not 0 <= {where} <= end - {length}"
    if not isinstance(at, nodes.Const):
        return f"{where} < 0 or not 0 <= {bare(length)} <= end - {expression(function.scope, at)}"
    return f"not 0 <= {bare(length)} <= end - {where}"


def fail_if(function: Function, condition: str, failure: nodes.Failure) -> None:
    """The lines that end an attempt under a condition."""
    with function.writer.indented(f"if {condition}:"):
        fail(function, failure)


def fail(function: Function, failure: nodes.Failure) -> None:
    """The line that ends an attempt."""
    site = function.sites[failure.site]
    at = function.text(failure.at)
    if function.is_routine:
        function.line(f"raise _Failed(sites[{failure.site - 1}], {at}, indices)")
        return
    indices = [function.text(each) for each in failure.indices]
    detail = ""
    if site.detail_lane is not None:
        *indices, first, count = indices
        detail = f", bytes({function.scope.view(site.detail_lane, '')}[{first} : {first} + {count}])"
    said = f"  # {ascii(f'{site.kind} {site.path}: {site.detail}')[1:-1]}"
    places = f", ({', '.join(indices)}{',' if len(indices) == 1 else ''})" if indices or detail else ""
    function.line(f"raise _Failed({failure.site}, {at}{places}{detail}){said}")
