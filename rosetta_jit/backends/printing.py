"""What backends that print text share: lines, identifiers, and a walk over statements."""

from __future__ import annotations

import re
from collections.abc import Generator
from contextlib import contextmanager

from rosetta_jit.kernel import walk
from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import Advance, Block, Stmt
from rosetta_jit.startup.dataclass import dataclass, field

MAX_IDENTIFIER = 60
"""Longer names from schemas are cut."""


@dataclass(slots=True)
class Writer:
    """Lines of source text, each at the current indentation."""

    lines: list[str] = field(default_factory=list[str])
    depth: int = 0

    def line(self, text: str = "") -> None:
        self.lines.append("    " * self.depth + text if text else "")

    @contextmanager
    def indented(self, head: str) -> Generator[None]:
        """A head and, below it, what is written until the end of the `with`."""
        self.line(head)
        self.depth += 1
        yield
        self.depth -= 1

    def text(self) -> str:
        return "\n".join((*self.lines, ""))


@dataclass(slots=True)
class Namespace:
    """Identifiers for names that come from schemas: of letters, digits and underscores, not reserved, and of each name another.

    A reserved name gets an underscore, ``class_``; what another name has already, a number, ``at_2``.
    """

    reserved: frozenset[str]
    identifiers: dict[str, str] = field(default_factory=dict[str, str])
    taken: set[str] = field(default_factory=set[str])

    def identifier(self, name: str) -> str:
        """The identifier of a name, always the same one."""
        if name not in self.identifiers:
            self.identifiers[name] = self._free(re.sub(r"[^A-Za-z0-9_]", "_", name)[:MAX_IDENTIFIER])
            self.taken.add(self.identifiers[name])
        return self.identifiers[name]

    def _free(self, wanted: str) -> str:
        start = wanted if wanted[:1].isalpha() else f"v{wanted}"
        candidate, number = f"{start}_" if start in self.reserved else start, len(self.taken)
        while candidate in self.taken or candidate in self.reserved:
            candidate = f"{start.rstrip('_')}_{number}"
            number += 1
        return candidate


def joined(path: str) -> str:
    """The words of a path as one."""
    return re.sub(r"\W+", "_", path).strip("_")


def class_name(scope: Namespace, type_: str) -> str:
    """The simple name of a type, or all of its name where another type has that: each type gets another identifier."""
    simple = re.split(r"[./:]+", type_)[-1]
    if simple not in scope.identifiers:
        return scope.identifier(simple)
    return scope.identifier(f"{type_}\0" if type_ == simple else re.sub(r"[./:]+", ".", type_))


def statements(block: Block) -> list[Stmt]:
    """All statements of a block, those of inner blocks included."""
    return walk.flat(block)


def counted_lanes(kernel: Kernel, body: Block) -> list[int]:
    """The holder's lanes whose used length the body's success may change: see `emptied_lanes`."""
    advanced = (each.lane for each in statements(body) if isinstance(each, Advance))
    return sorted({*emptied_lanes(kernel), *(lane for lane in advanced if lane < kernel.lanes)})


def emptied_lanes(kernel: Kernel) -> frozenset[int]:
    """The holder's lanes that decoding into row 0 empties: all behind lane 0, but for those that the kernel keeps."""
    return frozenset(range(1, kernel.lanes)) - frozenset(kernel.kept) if kernel.direction == "decode" else frozenset()
