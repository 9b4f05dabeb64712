"""Mistakes in YARP's Thrift files."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.catalogue.spelling import closest
from rosetta_jit.diagnostics import Diagnostic

if TYPE_CHECKING:
    from collections.abc import Iterable

    from rosetta_jit.source import Span


def strange_character(span: Span, text: str) -> Diagnostic:
    """A character that begins no word."""
    return Diagnostic("error", "character", f"{text!r} means nothing here", span, "not a word of Thrift", help="remove it")


def unclosed(span: Span, what: str) -> Diagnostic:
    """A comment or a text that has no end."""
    return Diagnostic("error", "unclosed", f"the {what} is never closed", span, "begins here", help=f"end the {what}")


def expected(span: Span, wanted: str, found: str) -> Diagnostic:
    """Another word than the grammar allows."""
    return Diagnostic("error", "syntax", f"expected {wanted}, found {found}", span, "not expected here")


def nesting(span: Span, most: int) -> Diagnostic:
    """Types or values within each other without end."""
    return Diagnostic(
        "error", "nesting", f"more than {most} within each other", span, "too deep", help="name the inner ones with a typedef"
    )


def unknown_type(span: Span, name: str, known: Iterable[str]) -> Diagnostic:
    """A name that nothing declares."""
    near = closest(name, known)
    help_ = f"did you mean `{near}`?" if near else "declare it, or include the file that does"
    return Diagnostic("error", "unknown-type", f"there is no type `{name}`", span, "not declared", help=help_)


def repeated(span: Span, name: str) -> Diagnostic:
    """Two declarations of one name."""
    return Diagnostic("error", "repeated", f"`{name}` is declared twice", span, "declared before", help="choose another name")


def not_included(span: Span, name: str) -> Diagnostic:
    """A file that is not on the search path."""
    return Diagnostic("error", "include-not-found", f"`{name}` is not on the search path", span, "not found", help="add its folder")


def endless(span: Span | None, name: str) -> Diagnostic:
    """A struct that contains itself."""
    why = "YARP writes fields of inner structs in place, so it would have no end"
    return Diagnostic("error", "endless", f"`{name}` contains itself", span, why, help="break the circle")


def only_in_lists(span: Span | None, name: str) -> Diagnostic:
    """A struct that contains itself in a map, or in lists of lists, or in a struct that it contains."""
    why = "as a `list` of it alone does that have an end"
    return Diagnostic("error", "only-in-lists", f"`{name}` contains itself, and not in a list of its own", span, why, help="use a `list`")


def union(span: Span) -> Diagnostic:
    """A union, for which YARP's compiler writes nothing that would say which case is there."""
    why = "yarpidl_thrift has no unions"
    return Diagnostic("error", "union", "YARP's wire cannot say which case of a union is there", span, why, help="declare a struct")


def unknown_service(span: Span, name: str, known: Iterable[str]) -> Diagnostic:
    """A service that extends what nothing declares."""
    near = closest(name, known)
    help_ = f"did you mean `{near}`?" if near else "declare it, or include the file that does"
    return Diagnostic("error", "unknown-service", f"there is no service `{name}`", span, "not declared", help=help_)


def endless_service(span: Span, name: str) -> Diagnostic:
    """Services that extend each other in a circle, or very many in a row."""
    return Diagnostic("error", "endless-service", f"`{name}` extends itself, or too many others", span, "in this one", help="extend fewer")


def too_many_functions(span: Span, most: int) -> Diagnostic:
    """Services that inherit functions by the thousand."""
    return Diagnostic("error", "too-many-functions", f"there are more than {most} functions in all", span, "here", help="split the file")


def no_wire(span: Span, what: str) -> Diagnostic:
    """What YARP's compiler takes, and has no bytes for."""
    return Diagnostic("error", "no-wire", f"{what} has no form on YARP's wire", span, "cannot be sent")


def native_type(span: Span, name: str) -> Diagnostic:
    """A C++ class of YARP whose bytes are not those of its Thrift declaration."""
    what = f"`{name}` writes itself, and this declaration does not say how"
    return Diagnostic("error", "native-type", what, span, "a class of C++", help="use the schema of that type in idl/yarp")
