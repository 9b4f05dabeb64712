"""Elements that rules set by a key: `.values[.key = "speed"].value = .speed` sets the first element that is set so, the next key the next.

The keys of an array that rules of a block name are its first elements, in the order of the text. Each gets its key, and the array a length
of as many, unless a rule sets that. Where the keys are in an array beside, `.position[.name[] = "elbow"]`, all arrays that have elements by
its keys get this length. A loop over a list of keys, `for i from 0 to len(joints) .position[.name[] = joints[i]] = ... end`, sets the
elements of the loop's numbers.
"""

from __future__ import annotations

from itertools import islice
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import resolve as words
from rosetta_jit.language.resolve.expressions import type_index
from rosetta_jit.language.scope import Broken, Scope, resolve_path
from rosetta_jit.model.expr import Expr, Given, Index, Item, Keyed, List, Literal, Member, Name, Path
from rosetta_jit.model.mapping import Arranged, Assign, Default, For, Rule, SetLength, When
from rosetta_jit.model.types import Array
from rosetta_jit.model.walk import parts
from rosetta_jit.startup.dataclass import dataclass, field, replace
from rosetta_jit.startup.late import Late

if TYPE_CHECKING:
    from rosetta_jit.language import folding
    from rosetta_jit.model import printer

    Loop = For[Rule, Expr]
else:
    printer = Late("rosetta_jit.model.printer")
    folding = Late("rosetta_jit.language.folding")

Key = tuple[tuple[str, ...], "Expr"]
"""The field of an element, and what it has."""


def numbered(rules: tuple[Rule, ...], scope: Scope) -> tuple[Rule, ...]:
    """The rules with numbers in place of the keys of elements that they set, and rules for the keys and lengths."""
    return _Block(scope).rules(rules)


@dataclass(slots=True)
class _Keys:
    """The keys that rules name of an array, each with its number, and the arrays whose elements they tell: itself, or some beside.

    Where they are the items of a list, ``loop`` is a loop over its numbers.
    """

    numbers: dict[Key, Index] = field(default_factory=dict["Key", "Index"])
    elements: dict[Path, None] = field(default_factory=dict["Path", None])
    loop: Loop | None = None


@dataclass(slots=True)
class _Block:
    """The arrays of a block that have keys, those whose length a rule sets, and the loops around."""

    scope: Scope
    arrays: dict[Path, _Keys] = field(default_factory=dict["Path", "_Keys"])
    measured: set[Path] = field(default_factory=set["Path"])
    loops: tuple[Loop, ...] = ()

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

    def loop(self, rule: Loop) -> Rule:
        """Arrays of which each round has its own are made in the loop; the others around it."""
        known, around, outer = len(self.arrays), self.scope, self.loops
        self.scope, self.loops = around.inside(rule.variable), (*outer, rule)
        body = [self.rule(each) for each in rule.body]
        own = [array for array in islice(self.arrays, known, None) if _varies(array, rule.variable)]
        body += [each for array in own for each in self.made(array)]
        for array in own:
            del self.arrays[array]
        self.scope, self.loops = around, outer
        return replace(rule, body=tuple(body))

    def placed(self, path: Path) -> Path:
        """A place with numbers in place of keys."""
        found = Path(path.side, (), path.span)
        for step in path.steps:
            found = replace(found, steps=(*found.steps, self.number(found, step) if isinstance(step, Keyed) else step))
        return found

    def number(self, array: Path, step: Keyed) -> Index:
        """Which element of its array a key has; the first to name it says so."""
        value = folding.folded(step.value)
        keys = self.arrays.setdefault(_array_of_keys(array, step), _Keys())
        keys.elements[array] = None
        key = step.names, value
        if key not in keys.numbers:
            keys.numbers[key] = self.next_number(keys, value, step)
        return keys.numbers[key]

    def next_number(self, keys: _Keys, value: Expr, step: Keyed) -> Index:
        """The number of a key that no rule before has named: the next one, or the one that its list has it by."""
        loop = next((loop for loop in self.loops if _is_item(value, loop)), None)
        if loop is None:
            if not folding.is_constant(value):
                self.scope.problems.append(words.key_to_set(step.value.span))
            elif keys.loop is not None:
                self.scope.problems.append(words.keys_of_list(step.value.span))
            return Index(Literal(len(keys.numbers), step.span), step.span)
        if keys.numbers:
            self.scope.problems.append(words.keys_of_list(step.value.span))
        if isinstance(value, Item) and (twice := _repeated(value)) is not None:
            self.scope.problems.append(words.key_twice(step.value.span, twice))
        keys.loop = loop
        return Index(Name(loop.variable, step.span), step.span)

    def made(self, array: Path) -> list[Rule]:
        """The rules for the keys of an array, and for the lengths of those whose elements they tell."""
        keys = self.arrays[array]
        count: Expr = Literal(len(keys.numbers)) if keys.loop is None else keys.loop.stop
        found: list[Rule] = [
            SetLength(each, count, each.span)
            for each in dict.fromkeys((array, *keys.elements))
            if each not in self.measured and not self.is_fixed(each)
        ]
        for (names, value), index in keys.numbers.items():
            members = tuple(Member(name, index.span) for name in names)
            key: Rule = Assign(Path(array.side, (*array.steps, index, *members), index.span), value, index.span)
            found.append(key if keys.loop is None else replace(keys.loop, body=(key,)))
        return found

    def is_fixed(self, array: Path) -> bool:
        """Whether the type says how long an array is; one that is not there is reported with the rules for its elements."""
        place = resolve_path(array, replace(self.scope, problems=[]), type_index)
        return isinstance(place, Broken) or (isinstance(place.type, Array) and place.type.fixed is not None)


def _array_of_keys(array: Path, step: Keyed) -> Path:
    """The array whose elements have the keys: the array of the elements, or one in the same message."""
    if not step.beside:
        return array
    within = max(number for number, each in enumerate(array.steps) if isinstance(each, Member))
    return replace(array, steps=(*array.steps[:within], *(Member(name, step.span) for name in step.beside)))


def _is_item(value: Expr, loop: Loop) -> bool:
    """Whether a key is the item of a list that a loop over all of its numbers is at."""
    if loop.start != Literal(0):
        return False
    match value:
        case Item(List(items), Name(name)):
            return name == loop.variable and folding.folded(loop.stop) == Literal(len(items)) and all(map(folding.is_constant, items))
        case Given(name, (Name(variable),)):
            stop = folding.folded(loop.stop)
            return variable == loop.variable and isinstance(stop, Given) and stop.name == f"len({name})"
        case _:
            return False


def _repeated(value: Item) -> str | None:
    """The first item of a list that stands in it before."""
    items = [printer.show_expr(folding.folded(each)) for each in value.items.items] if isinstance(value.items, List) else []
    return next((each for number, each in enumerate(items) if each in items[:number]), None)


def _varies(array: Path, variable: str) -> bool:
    """Whether each round of a loop has its own array."""
    return any(part == Name(variable) for part in parts(array))
