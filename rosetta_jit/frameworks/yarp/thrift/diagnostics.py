"""Mistakes in YARP's Thrift files."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from rosetta_jit.catalogue.suggestions import closest
from rosetta_jit.diagnostics import Diagnostic, Mistake, error

if TYPE_CHECKING:
    from rosetta_jit.source import Span


def strange_character(span: Span, text: str) -> Diagnostic:
    return error("character", f"{text!r} means nothing here", span, "not a word of Thrift", help_="remove it")


def unclosed(span: Span, what: str) -> Diagnostic:
    return error("unclosed", f"the {what} is never closed", span, "begins here", help_=f"end the {what}")


def expected(span: Span, wanted: str, found: str) -> Diagnostic:
    return error("syntax", f"expected {wanted}, found {found}", span, "not expected here")


def nesting(span: Span, most: int) -> Diagnostic:
    return error("nesting", f"more than {most} within each other", span, "too deep", help_="name the inner ones with a typedef")


def unknown_type(span: Span, name: str, known: Iterable[str]) -> Diagnostic:
    near = closest(name, known)
    help_ = f"did you mean `{near}`?" if near else "declare it, or include the file that does"
    return error("unknown-type", f"there is no type `{name}`", span, "not declared", help_=help_)


def repeated(span: Span, name: str) -> Diagnostic:
    return error("repeated", f"`{name}` is declared twice", span, "declared before", help_="choose another name")


def not_included(span: Span, name: str) -> Diagnostic:
    return error("include-not-found", f"`{name}` is not on the search path", span, "not found", help_="add its folder")


def endless(span: Span | None, name: str) -> Diagnostic:
    why = "YARP writes fields of inner structs in place, so it would have no end"
    return error("endless", f"`{name}` contains itself", span, why, help_="break the circle")


def only_in_lists(span: Span | None, name: str) -> Diagnostic:
    why = "as a `list` of it alone does that have an end"
    return error("only-in-lists", f"`{name}` contains itself, and not in a list of its own", span, why, help_="use a `list`")


union = Mistake("union", "YARP's wire cannot say which case of a union is there", "yarpidl_thrift has no unions", help="declare a struct")


def unknown_service(span: Span, name: str, known: Iterable[str]) -> Diagnostic:
    near = closest(name, known)
    help_ = f"did you mean `{near}`?" if near else "declare it, or include the file that does"
    return error("unknown-service", f"there is no service `{name}`", span, "not declared", help_=help_)


def endless_service(span: Span, name: str) -> Diagnostic:
    return error("endless-service", f"`{name}` extends itself, or too many others", span, "in this one", help_="extend fewer")


def too_many_functions(span: Span, most: int) -> Diagnostic:
    return error("too-many-functions", f"there are more than {most} functions in all", span, "here", help_="split the file")


def no_wire(span: Span, what: str) -> Diagnostic:
    return error("no-wire", f"{what} has no form on YARP's wire", span, "cannot be sent")


def native_type(span: Span, name: str) -> Diagnostic:
    what = f"`{name}` writes itself, and this declaration does not say how"
    return error("native-type", what, span, "a class of C++", help_="use the schema of that type in idl/yarp")
