"""What can be wrong with the functions that a mapping declares, with those that its user gives, and with reductions."""

from __future__ import annotations

import re
from collections.abc import Collection

from rosetta_jit.catalogue.mapping import CALLED, shorten
from rosetta_jit.catalogue.resolve import written_at
from rosetta_jit.catalogue.suggestions import nearest
from rosetta_jit.diagnostics import Diagnostic, Mistake, error
from rosetta_jit.source import Span


def no_scalar(span: Span | None, name: str, known: Collection[str]) -> Diagnostic:
    found = CALLED.get(name) or nearest(name, known)
    help_ = f"did you mean `{found}`?" if found else f"functions take and give {', '.join(known)}"
    return error("no-scalar", f"`{shorten(name)}` is no type of numbers", span, "not a number's type", help_=help_)


def taken(span: Span | None, name: str) -> Diagnostic:
    why = "names of functions have no dots" if "." in name else "the language has a function of this name"
    return error("function-name", f"no function can be declared as `{shorten(name)}`", span, why, help_="give it another name")


def repeated(span: Span | None, name: str, first: Span | None) -> Diagnostic:
    return error("repeated-function", f"`{shorten(name)}` is declared twice", span, "again", notes=_declared(first))


def many_parameters(span: Span | None, most: int) -> Diagnostic:
    return error("many-parameters", f"a function takes at most {most} numbers", span, help_="make several functions of it")


def arguments(span: Span | None, name: str, wanted: int, found: int, declared: Span | None) -> Diagnostic:
    message = f"`{shorten(name)}` takes {wanted} value{'' if wanted == 1 else 's'}, not {found}"
    return error("arguments", message, span, notes=_declared(declared))


def argument(span: Span | None, name: str, types: tuple[str, str], how: str, declared: Span | None) -> Diagnostic:
    found, wanted = types
    message = f"`{shorten(name)}` takes {wanted} here, not {found}"
    help_ = f"say how: {how.replace('...', written_at(span))}" if how else ""
    return error("argument-type", message, span, f"this is {found}", notes=_declared(declared), help_=help_)


def not_given(span: Span | None, name: str) -> Diagnostic:
    help_ = f'give it when you make the program: functions={{"{shorten(name)}": …}}'
    return error("function-missing", f"the mapping calls `{shorten(name)}`, which was not given", span, "declared here", help_=help_)


def not_declared(name: str, known: Collection[str]) -> Diagnostic:
    found = nearest(name, known)
    help_ = f"did you mean `{found}`?" if found else f"declare it in the mapping: function {shorten(name)}(float64): float64"
    return error("function-unknown", f"the mapping declares no function `{shorten(name)}`", help_=help_)


def does_not_compile(span: Span | None, name: str, why: str) -> Diagnostic:
    return error("function-type", f"`{shorten(name)}` does not compile to what is declared", span, "declared here", notes=(why,))


no_compiler = Mistake(
    "no-numba",
    "functions of one's own are compiled by numba, which is not installed",
    "declared here",
    help='pip install numba, or say backend="python"',
)


def _declared(span: Span | None) -> tuple[str, ...]:
    if span is None:
        return ()
    line, _ = span.source.line_column(span.start)
    return (f"declared at {span.source.name}, line {line}",)


def not_of_each(span: Span | None, function: str) -> Diagnostic:
    call = re.fullmatch(rf"{function}\((\.[\w.]*\w)([^][\n]*)\)", written_at(span))
    array, rest = (call[1], call[2]) if call else (".a", " > 3" if function in ("any", "all", "count") else "")
    rest = re.sub(rf"{re.escape(array)}(?![\w.\[])", f"{array}[]", rest)
    help_ = f"write `[]` behind the array: `{function}({array}[]{rest})`"
    return error("reduction", f"`{function}` takes one value of each element", span, help_=help_)


def no_reduction(span: Span | None, function: str) -> Diagnostic:
    help_ = "a reduction takes elements so, `mean(.a[] where .a[] > 0)`; a rule, `.a[] = f(.b[]) where .b[] > 0`"
    return error("filter", f"`where` chooses among elements, and `{shorten(function)}` takes none", span, help_=help_)


def in_order(span: Span | None, function: str) -> Diagnostic:
    help_ = "write `.a[]`, or a slice of it"
    return error("layout-order", f"`{function}` takes the elements of an array as they lie", span, help_=help_)


def within_each(span: Span | None, function: str) -> Diagnostic:
    help_ = f"write a loop over the outer ones: `for i from 0 to len(.rows) ... {function}(.rows[i].cells[]) ... end`"
    return error("many-elements", f"`{function}` takes the elements of one array, not those of each of several", span, help_=help_)
