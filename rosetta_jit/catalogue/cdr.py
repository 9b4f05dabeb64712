"""What CDR cannot carry."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.diagnostics import Diagnostic

if TYPE_CHECKING:
    from rosetta_jit.source import Span


def no_optionals(span: Span | None, name: str) -> Diagnostic:
    """An optional member in CORBA."""
    return Diagnostic("error", "optional-member", f"`{name}` is optional, which CORBA has no bytes for", span, help='choose encoding="cdr"')


def no_mutables(span: Span | None, name: str) -> Diagnostic:
    """A mutable struct in CORBA."""
    return Diagnostic("error", "mutable-struct", f"`{name}` is mutable, which CORBA has no bytes for", span, help='choose encoding="cdr"')


def recursive_parameter(span: Span | None, name: str) -> Diagnostic:
    """A recursive struct in an optional member, or a member of a mutable struct, in XCDR1."""
    what = f"`{name}` is recursive and has its length before it, which rosetta_jit does not write"
    help_ = "make it a sequence of a final struct, which may be empty"
    return Diagnostic("error", "recursive-parameter", what, span, help=help_)


def no_recursion(span: Span | None, name: str) -> Diagnostic:
    """A recursive struct in XCDR2, where sizes stand before everything."""
    return Diagnostic(
        "error", "recursive-struct", f"`{name}` contains itself, which cdr2 does not carry yet", span, help='choose encoding="cdr"'
    )


def nested_recursion(span: Span | None, name: str) -> Diagnostic:
    """A recursive struct within the elements of an array, which are something else."""
    what = f"the elements of `{name}` contain a recursive struct, and are not recursive themselves"
    return Diagnostic("error", "nested-recursion", what, span, help="make the recursive struct itself the element")


def no_such_scalar(span: Span | None, name: str) -> Diagnostic:
    """A type that CDR has no bytes for."""
    return Diagnostic("error", "no-encoding", f"CDR has no bytes for `{name}`", span)
