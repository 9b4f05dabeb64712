"""What the locals of a function are called: those of one case of a switch may be called as those of another one are.

A function of Python clears all its locals when it is called: messages of many fields would have thousands.
"""

from __future__ import annotations

import re
from collections.abc import Generator
from contextlib import contextmanager

from rosetta_jit.backends.printing import Namespace
from rosetta_jit.kernel.nodes import Block
from rosetta_jit.kernel.walk import bound_names, statements
from rosetta_jit.startup.dataclass import dataclass, field


@dataclass(slots=True)
class Locals(Namespace):
    """Identifiers of locals; ``of_case`` are those that a case at hand binds, ``again`` what such are called in any case."""

    of_case: frozenset[str] = frozenset()
    again: set[str] = field(default_factory=set[str])

    def identifier(self, name: str) -> str:
        """The identifier of a name, always the same one; nothing but the locals of other cases is called so."""
        if name in self.of_case and name not in self.identifiers:
            outside = self.taken - self.again
            self.identifiers[name] = self._of_case(re.sub(r"(_\d+)+$", "", name), outside)
            self.again.add(self.identifiers[name])
            self.taken.add(self.identifiers[name])
        return Namespace.identifier(self, name)

    def _of_case(self, stem: str, outside: set[str]) -> str:
        stem = re.sub(r"[^A-Za-z0-9_]", "_", stem)
        here, number = {self.identifiers[each] for each in self.of_case & self.identifiers.keys()}, 1
        candidate = stem
        while candidate in outside or candidate in here or candidate in self.reserved:
            number += 1
            candidate = f"{stem}_{number}"
        return candidate

    @contextmanager
    def case(self, block: Block) -> Generator[None]:
        """Locals that a block binds are known within it alone; in a case within another one they are those of that."""
        if self.of_case:
            yield
            return
        self.of_case = frozenset(name for stmt, _ in statements(block) for name in bound_names(stmt))
        try:
            yield
        finally:
            for name in self.of_case & self.identifiers.keys():
                del self.identifiers[name]
            self.of_case = frozenset()
