"""The functions that generated C calls, of which a file has those that it needs: sections of `support.c`, for small machines of `small.c`.

A section's head names it, says for which words it is repeated (``bits: 16 32``) and which other sections it needs.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from functools import cache
from itertools import product
from pathlib import Path
from string import Template

from rosetta_jit.generate.c.words import C_TYPES
from rosetta_jit.startup.dataclass import dataclass

HEAD = re.compile(r"^/\* == (.*) == \*/$", re.MULTILINE)
REAL = {"32": "float", "64": "double"}
DECIMALS = ("shortest_digits", "shortest_scale", "fixed_digits", "nearest", "shortest", "decimal_of", "reads_back")


@dataclass(frozen=True, slots=True)
class Section:
    """A function with all that belongs to it."""

    name: str
    needs: tuple[str, ...]
    text: str


@cache
def sections(*, small: bool = False) -> dict[str, Section]:
    """All sections, in the order of the file; with ``small`` those of `small.c` stand for those of the same names."""
    files = ("support.c", "small.c") if small else ("support.c",)
    return {each.name: each for file in files for each in _sections(Path(__file__).with_name(file).read_text("utf-8"), small=small)}


def _sections(text: str, *, small: bool) -> Iterator[Section]:
    _, *parts = HEAD.split(text)
    for head, body in zip(parts[::2], parts[1::2], strict=True):
        yield from _expanded(head, body.strip("\n"), small=small)


def _expanded(head: str, body: str, *, small: bool) -> Iterator[Section]:
    """A section for each combination of its words."""
    name, *clauses = (part.strip() for part in head.split("|"))
    words = {key: values.split() for key, _, values in (clause.partition(":") for clause in clauses)}
    needs = words.pop("needs", [])
    for chosen in product(*words.values()):
        known = dict(zip(words, chosen, strict=True))
        known["real"] = REAL.get(known.get("float", known.get("bits", "")), "")
        known["ctype"] = C_TYPES.get(known.get("scalar", ""), "")
        known["static"] = "ONCE" if small and known.get("bits") == "32" else "static inline"
        filled = [Template(each).substitute(known) for each in (name, *needs, body)]
        yield Section(filled[0], (*filled[1:-1], *(["once"] if "ONCE " in filled[-1] and name != "once" else [])), filled[-1])


def support(called: Iterable[str], *, small: bool = False) -> str:
    """The text of some sections, and of those that they need."""
    known, wanted = sections(small=small), set[str]()
    pending = list(called)
    while pending:
        name = pending.pop()
        if name not in wanted:
            wanted.add(name)
            pending += known[name].needs
    ordered = [*_in_order(wanted, known)]
    return "\n\n".join(known[name].text for name in ordered if known[name].text)


def _in_order(wanted: set[str], known: dict[str, Section]) -> Iterator[str]:
    """Each after those that it needs, else as in the file."""
    done = set[str]()

    def visit(name: str) -> Iterator[str]:
        if name not in done:
            done.add(name)
            for each in known[name].needs:
                yield from visit(each)
            yield name

    for name in known:
        if name in wanted:
            yield from visit(name)


@cache
def function_names() -> frozenset[str]:
    """What no local variable may be called."""
    return frozenset((*sections(), *DECIMALS, "main", "strtod", "strtoll", "snprintf"))
