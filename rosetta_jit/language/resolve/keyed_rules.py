"""Elements that rules set by a key: `.values[.key = "speed"].value = .speed` sets the first element that is set so, the next key the next.

The keys of an array that rules of a block name are its first elements, in the order of the text. Each gets its key, and the array a length
of as many, unless a rule sets that.
"""

from __future__ import annotations

from dataclasses import field, replace
from itertools import islice
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import resolve as words
from rosetta_jit.language.folding import folded, is_constant
from rosetta_jit.language.resolve.expressions import type_index
from rosetta_jit.language.scope import Broken, resolve_path
from rosetta_jit.model.expr import Index, Keyed, Literal, Member, Name, Path
from rosetta_jit.model.mapping import Arranged, Assign, Default, For, SetLength, When
from rosetta_jit.model.types import Array
from rosetta_jit.model.walk import parts
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.language.scope import Scope
    from rosetta_jit.model.expr import Expr
    from rosetta_jit.model.mapping import Rule

Key = tuple[tuple[str, ...], "Expr"]
"""The field of an element, and what it has."""


def numbered(rules: tuple[Rule, ...], scope: Scope) -> tuple[Rule, ...]:
    """The rules with numbers in place of the keys of elements that they set, and rules for the keys and lengths."""
    return _Block(scope).rules(rules)


@dataclass(slots=True)
class _Block:
    """The arrays of a block whose elements are set by keys, and those whose length a rule sets."""

    scope: Scope
    arrays: dict[Path, dict[Key, Index]] = field(default_factory=dict["Path", "dict[Key, Index]"])
    measured: set[Path] = field(default_factory=set["Path"])

    def rules(self, rules: tuple[Rule, ...]) -> tuple[Rule, ...]:
        """All rules of a block, those for its arrays last."""
        made = [self.rule(rule) for rule in rules]
        return (*made, *(each for array in list(self.arrays) for each in self.made(array)))

    def rule(self, rule: Rule) -> Rule:
        match rule:
            case Assign(place) | Default(place):
                return replace(rule, place=self.placed(place))
            case SetLength(place):
                array = self.placed(place)
                self.measured.add(array)
                return replace(rule, place=array)
            case Arranged(place, flag):
                return replace(rule, place=self.placed(place), flag=self.placed(flag))
            case For():
                return self.loop(rule)
            case When(then=then, otherwise=otherwise):
                return replace(rule, then=tuple(map(self.rule, then)), otherwise=tuple(map(self.rule, otherwise)))
            case _:
                return rule

    def loop(self, rule: For[Rule, Expr]) -> Rule:
        """Arrays of which each round has its own are made in the loop; the others around it."""
        known, around = len(self.arrays), self.scope
        self.scope = around.inside(rule.variable)
        body = [self.rule(each) for each in rule.body]
        own = [array for array in islice(self.arrays, known, None) if _varies(array, rule.variable)]
        body += [each for array in own for each in self.made(array)]
        for array in own:
            del self.arrays[array]
        self.scope = around
        return replace(rule, body=tuple(body))

    def placed(self, path: Path) -> Path:
        """A place with numbers in place of keys."""
        found = Path(path.side, (), path.span)
        for step in path.steps:
            found = replace(found, steps=(*found.steps, self.number(found, step) if isinstance(step, Keyed) else step))
        return found

    def number(self, array: Path, step: Keyed) -> Index:
        """Which element of its array a key has; the first to name it says so."""
        value = folded(step.value)
        if not is_constant(value):
            self.scope.problems.append(words.key_to_set(step.value.span))
        keys = self.arrays.setdefault(array, {})
        return keys.setdefault((step.names, value), Index(Literal(len(keys), step.span), step.span))

    def made(self, array: Path) -> list[Rule]:
        """The rules for the keys of an array, and for its length."""
        keys = self.arrays[array]
        found: list[Rule] = []
        if array not in self.measured and not self.is_fixed(array):
            found.append(SetLength(array, Literal(len(keys)), array.span))
        for (names, value), index in keys.items():
            members = tuple(Member(name, index.span) for name in names)
            found.append(Assign(Path(array.side, (*array.steps, index, *members), index.span), value, index.span))
        return found

    def is_fixed(self, array: Path) -> bool:
        """Whether the type says how long an array is; one that is not there is reported with the rules for its elements."""
        place = resolve_path(array, replace(self.scope, problems=[]), type_index)
        return isinstance(place, Broken) or (isinstance(place.type, Array) and place.type.fixed is not None)


def _varies(array: Path, variable: str) -> bool:
    """Whether each round of a loop has its own array."""
    return any(part == Name(variable) for part in parts(array))
