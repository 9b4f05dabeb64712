"""What can be wrong with the address of a transport, and with the options behind it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from rosetta_jit.catalogue.suggestions import closest
from rosetta_jit.diagnostics import Diagnostic, error

if TYPE_CHECKING:
    from rosetta_jit.source import Span


def no_scheme(span: Span, known: Iterable[str]) -> Diagnostic:
    names = ", ".join(f"`{each}:`" for each in known)
    return error("no-scheme", "an address begins with its transport", span, "which transport?", help_=f"put one before it: {names}")


def unknown_scheme(span: Span, name: str, known: Iterable[str]) -> Diagnostic:
    names = tuple(known)
    near = closest(name, names)
    text = f"did you mean `{near}:`?" if near else f"known are {', '.join(f'`{each}:`' for each in names)}"
    return error("unknown-transport", f"there is no transport `{name}`", span, "not known", help_=text)


def cannot(span: Span, name: str, what: str) -> Diagnostic:
    return error("transport-cannot", f"the transport `{name}` cannot {what}", span, "no such direction")


def unknown_option(span: Span | None, name: str, known: Iterable[str]) -> Diagnostic:
    names = sorted(known)
    near = closest(name, names)
    text = f"did you mean `{near}`?" if near else f"known are {', '.join(f'`{each}`' for each in names)}"
    return error("unknown-option", f"there is no option `{name}`", span, "not known here", help_=text)


def bad_option(span: Span | None, name: str, wanted: str) -> Diagnostic:
    return error("option-value", f"`{name}` takes {wanted}", span, "not that")


def option_twice(span: Span, name: str) -> Diagnostic:
    return error("option-twice", f"`{name}` is said twice", span, "again")


def bad_place(span: Span, wanted: str, example: str) -> Diagnostic:
    return error("address", f"this is not {wanted}", span, f"expected {wanted}", help_=f"for example `{example}`")
