"""Scopes and what they declare: names are looked up from the inside out, and are the same in whatever case (OMG IDL 4.2, 7.5)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from rosetta_jit.frameworks.omg import diagnostics as say
from rosetta_jit.frameworks.omg.limits import MAX_BASES, MAX_NAME
from rosetta_jit.frameworks.omg.problems import LookupProblem
from rosetta_jit.startup.dataclass import dataclass, field

if TYPE_CHECKING:
    from rosetta_jit.frameworks.omg.constants import Value
    from rosetta_jit.frameworks.omg.expressions import ScopedName
    from rosetta_jit.frameworks.omg.tree import Name
    from rosetta_jit.model.types import Type
    from rosetta_jit.source import Span

Kind = Literal[
    "module", "struct", "union", "exception", "enum", "typedef", "constant", "enumerator", "member", "interface", "valuetype", "native"
]


@dataclass(slots=True)
class Entry:
    """A declaration. What it means stands in one of the last fields, according to its kind.

    ``state`` of a struct or union says whether it can be used: it is named, its members are being read, or it is whole.
    ``target`` is the declaration that a typedef gives another name.
    """

    kind: Kind
    name: str
    full: str
    span: Span
    state: Literal["named", "open", "whole"] = "whole"
    scope: Scope | None = None
    type: Type | None = None
    value: Value | None = None
    target: Entry | None = None


@dataclass(slots=True)
class Scope:
    """The names that a module, interface, struct or union declares, and those of others that it has used."""

    full: str = ""
    name: str = ""
    outer: Scope | None = None
    entries: dict[str, Entry] = field(default_factory=dict[str, Entry])
    used: dict[str, tuple[Entry, Span]] = field(default_factory=dict[str, "tuple[Entry, Span]"])
    bases: list[Scope] = field(default_factory=list["Scope"])

    def join(self, name: Name) -> str:
        """The qualified name of something in here."""
        full = f"{self.full}::{name.text}" if self.full else name.text
        if len(full) > MAX_NAME:
            raise LookupProblem(say.name_too_long(name.span, MAX_NAME))
        return full

    def declare(self, name: Name, entry: Entry) -> Entry:
        """Add a declaration; raises LookupProblem where its name has another meaning here already."""
        key = name.text.lower()
        first = self.entries.get(key)
        if first is not None:
            raise LookupProblem(say.repeated_name(name.span, entry.full, entry.kind, first.name, first.kind, first.span))
        if not name.free:
            self._check(name, entry, key)
        self.entries[key] = entry
        return entry

    def _check(self, name: Name, entry: Entry, key: str) -> None:
        if self.outer is not None and key == self.name.lower() and entry.kind != "enumerator":
            raise LookupProblem(say.name_of_scope(name.span, name.text, self.full))
        other, span = self.used.get(key, (entry, None))
        if other is not entry and span is not None:
            raise LookupProblem(say.used_before(name.span, name.text, other.full, span))

    def find(self, name: ScopedName, *, free: bool = False) -> Entry:
        """The entry that a name means in this scope.

        Raises
        ------
        LookupProblem
            Nothing, or it is written in another case than where it is declared.
        """
        entry, home = self._first(name)
        if not name.absolute and not free:
            self._use(name, entry, home)
        for part in name.parts[1:]:
            inner = entry.scope and entry.scope.own(part, name)
            if inner is None:
                raise LookupProblem(say.unknown_name(name.span, str(name), f"`{entry.full}` declares no `{part}`"))
            entry = inner
        return entry

    def own(self, part: str, name: ScopedName) -> Entry | None:
        """What is declared in here or inherited, if anything."""
        waiting, seen = [self], 0
        while waiting and seen < MAX_BASES:
            scope = waiting.pop()
            seen += 1
            entry = scope.entries.get(part.lower())
            if entry is not None and entry.name != part:
                raise LookupProblem(say.other_case(name.span, part, entry.name, entry.span))
            if entry is not None:
                return entry
            waiting += scope.bases
        return None

    def _first(self, name: ScopedName) -> tuple[Entry, Scope]:
        scope: Scope | None = self
        while scope is not None:
            entry = None if name.absolute and scope.outer else scope.own(name.parts[0], name)
            if entry is not None:
                return entry, scope
            scope = scope.outer
        raise LookupProblem(say.unknown_name(name.span, str(name), "declare it before it is used, or include the file that does"))

    def _use(self, name: ScopedName, entry: Entry, home: Scope) -> None:
        """A name that was used in a scope keeps its meaning there (OMG IDL 4.2, 7.5.3)."""
        scope: Scope | None = self
        while scope is not None and scope is not home:
            scope.used.setdefault(name.parts[0].lower(), (entry, name.span))
            scope = scope.outer
