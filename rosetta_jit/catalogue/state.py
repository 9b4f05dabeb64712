"""What can be wrong with state: the variables of a mapping that keep values from one message to the next."""

from __future__ import annotations

from collections.abc import Collection

from rosetta_jit.catalogue.mapping import CALLED, shorten
from rosetta_jit.catalogue.suggestions import nearest
from rosetta_jit.diagnostics import Diagnostic, error, warning
from rosetta_jit.source import Span


def unknown(span: Span | None, name: str, known: Collection[str]) -> Diagnostic:
    found = nearest(name, known)
    help_ = f"did you mean `{found}`?" if found else f"declare it above the rules: `state {shorten(name)}: int64 = 0`"
    listed = ", ".join(f"`{shorten(each)}`" for each in sorted(known)[:20]) or "none"
    title = f"there is no state variable `{shorten(name)}`"
    return error("unknown-state", title, span, "not declared", notes=(f"declared: {listed}",), help_=help_)


def repeated(span: Span | None, name: str, other: str) -> Diagnostic:
    return error("repeated-state", f"`{shorten(name)}` is {other} already", span, "again here", help_="choose another name")


def many(span: Span | None, most: int) -> Diagnostic:
    title = f"a mapping has at most {most} state variables"
    return error("many-state", title, span, "one too many", help_="keep less from message to message")


def unknown_type(span: Span | None, name: str, known: Collection[str]) -> Diagnostic:
    found = CALLED.get(name) or nearest(name, known)
    help_ = f"did you mean `{found}`?" if found in known else "keep what is needed of a text or an array as a number"
    notes = (f"types: {', '.join(known)}",)
    return error("state-type", f"a state variable cannot be `{shorten(name)}`", span, notes=notes, help_=help_)


def unfit(span: Span | None, name: str, why: str) -> Diagnostic:
    help_ = "give it a value of its type: a number, `true`, `false` or a parameter"
    return error("state-initial", f"`{shorten(name)}` cannot be this at first: {why}", span, "here", help_=help_)


def set_in_loop(span: Span | None, name: str, variable: str) -> Diagnostic:
    help_ = "state is set once a message: move the rule out of the loop"
    return error("set-in-loop", f"`{name}` is set again in each round of the loop over `{variable}`", span, "here", help_=help_)


def set_for_both(span: Span | None, name: str) -> Diagnostic:
    help_ = "each direction has its own: write the rule under `unpack-rules:`, under `pack-rules:`, or under both"
    return error("state-in-relation", f"`{name}` cannot be set for both directions at once", span, "under `rules:`", help_=help_)


def in_relation(span: Span | None, name: str) -> Diagnostic:
    help_ = "write a rule under `unpack-rules:` and one under `pack-rules:`; under `rules:` only the condition of a `reject` may read state"
    title = f"a rule for both directions reads `{name}`, which each direction has for itself: no value would come back"
    return error("state-in-relation", title, span, "state", help_=help_)


def in_used(span: Span | None, file: str) -> Diagnostic:
    help_ = "declare it in the mapping that uses this one, and set it there: state is of whole messages"
    return error("state-in-used", f"`{shorten(file)}` is used by another mapping, and declares state", span, "here", help_=help_)


def never_set(span: Span | None, name: str) -> Diagnostic:
    title = f"no rule sets `{shorten(name)}`: it stays what it is at first"
    return warning("state-never-set", title, span, help_="set it, or make it a parameter")


def never_read(span: Span | None, name: str) -> Diagnostic:
    title = f"no rule reads `{shorten(name)}`, but to set it again"
    return warning("state-never-read", title, span, help_="remove it")
