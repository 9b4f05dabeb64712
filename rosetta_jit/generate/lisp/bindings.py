"""Forms that bind names: variables with their types (`let*`), and names that stand for forms (`symbol-macrolet`)."""

from __future__ import annotations

from collections.abc import Generator, Mapping, Sequence
from contextlib import contextmanager

from rosetta_jit.generate.lisp.lines import Lines
from rosetta_jit.startup.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class Variable:
    """A name that is bound, its type in Lisp, and its first value."""

    name: str
    type: str
    value: str = ""


@contextmanager
def bound(lines: Lines, variables: Sequence[Variable]) -> Generator[None]:
    """A `let*` of variables, if there are any, around what is written until the end of the `with`."""
    with _with_names(lines, "let*", [(each.name, each.value) for each in variables]):
        if variables:
            lines.line(declaration(variables))
        yield


@contextmanager
def named_forms(lines: Lines, forms: Mapping[str, str]) -> Generator[None]:
    """Names for forms, if there are any, within what is written until the end of the `with`."""
    with _with_names(lines, "symbol-macrolet", list(forms.items())):
        yield


@contextmanager
def _with_names(lines: Lines, operator: str, names: Sequence[tuple[str, str]]) -> Generator[None]:
    if not names:
        yield
        return
    start, opened = len(lines.lines), f"({operator} ("
    lines.column += len(opened)
    for name, form in names:
        lines.line(f"({name} {form})")
    lines.close()
    lines.column -= len(opened) - 2
    lines.lines[start].column -= len(opened)
    lines.lines[start].text = f"{opened}{lines.lines[start].text}"
    yield
    lines.column -= 2
    lines.close()


def declaration(variables: Sequence[Variable]) -> str:
    """The types of variables, each of which may be of no use."""
    names: dict[str, list[str]] = {}
    for each in variables:
        names.setdefault(each.type, []).append(each.name)
    declared = " ".join(f"(type {type_} {' '.join(some)})" for type_, some in names.items())
    return f"(declare {declared} (ignorable {' '.join(each.name for each in variables)}))"
