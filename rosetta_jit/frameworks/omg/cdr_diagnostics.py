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
    """A recursive struct in an optional member in XCDR1, or in a member of a mutable struct."""
    what = f"`{name}` is recursive and has an id and a length before it, which rosetta_jit does not write"
    help_ = "make it a sequence in a struct that is not mutable"
    return Diagnostic("error", "recursive-parameter", what, span, help=help_)


def deep_recursion(span: Span | None, name: str, most: int) -> Diagnostic:
    """A recursive struct in structs that have their sizes before them, within another."""
    what = f"`{name}` has more than {most} sizes around a recursive struct, which cdr2 does not carry"
    return Diagnostic("error", "deep-recursion", what, span, help="make the structs between them final")


def nested_recursion(span: Span | None, name: str) -> Diagnostic:
    """A recursive struct within the elements of an array, which are something else."""
    what = f"the elements of `{name}` contain a recursive struct, and are not recursive themselves"
    return Diagnostic("error", "nested-recursion", what, span, help="make the recursive struct itself the element")


def no_such_scalar(span: Span | None, name: str) -> Diagnostic:
    """A type that CDR has no bytes for."""
    return Diagnostic("error", "no-encoding", f"CDR has no bytes for `{name}`", span)
