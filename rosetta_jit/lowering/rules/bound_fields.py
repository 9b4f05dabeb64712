"""What the walk over a codec will bind where rules work in place (`rosetta_jit.lowering.codec.wire_fields`), known beforehand.

It follows the walk (`rosetta_jit.lowering.codec.walk`) without a kernel: which numbers, counts and places of elements are bound by the
time that rules run, and what is in the way of binding one.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import assert_never

from rosetta_jit.kernel.nodes import Direction
from rosetta_jit.language import typed
from rosetta_jit.lowering.codec.wire_fields import EACH, inner_leaves, leaves, numbers_of_counts
from rosetta_jit.lowering.rules.packed_values import rule_for
from rosetta_jit.model import expr
from rosetta_jit.model.walk import names_of, parts
from rosetta_jit.startup.dataclass import dataclass, field
from rosetta_jit.wire import codec as wire
from rosetta_jit.wire.size import fixed_size


@dataclass(frozen=True, slots=True)
class Obstacle:
    """A field of the wire that rules cannot read or write in place, or have no need to, but the walk has; and why."""

    path: wire.Path
    why: str


@dataclass(frozen=True, slots=True)
class _Here:
    """Where the walk stands: in the message, or in an element, of which the numbers ``passing`` by are known as long as it is there."""

    path: wire.Path = ()
    outer: _Here | None = None
    passing: set[wire.Path] = field(default_factory=set["wire.Path"])

    @property
    def scope(self) -> _Here:
        """An element of which nothing has come is an array in an array: its length is stated further out."""
        return self if self.passing or self.outer is None else self.outer.scope


@dataclass(slots=True)
class BoundFields:
    """The fields that are bound so far, by absolute path; what rules give is bound when the walk asks for it.

    The values of ``translated`` fields have other numbers on the wire. Of ``fixed`` arrays each element of an array has one, which is
    always as long. How elements lie ``varies`` in the alternatives of a choice.
    """

    direction: Direction
    rules: tuple[typed.Rule, ...]
    numbers: set[wire.Path] = field(default_factory=set["wire.Path"])
    counts: set[wire.Path] = field(default_factory=set["wire.Path"])
    regions: set[wire.Path] = field(default_factory=set["wire.Path"])
    fixed: set[wire.Path] = field(default_factory=set["wire.Path"])
    translated: set[wire.Path] = field(default_factory=set["wire.Path"])
    varies: bool = False
    deferred: list[Iterator[Obstacle]] = field(default_factory=list["Iterator[Obstacle]"])

    def message(self, codec: wire.Codec) -> Iterator[Obstacle]:
        """What is in the way of the walk over a message."""
        yield from self.whole(codec, _Here())

    def whole(self, codec: wire.Codec, here: _Here) -> Iterator[Obstacle]:
        """A message or an element: what is checked at its end is looked at then."""
        outer, self.deferred = self.deferred, []
        yield from self.walk(codec, here)
        for each in self.deferred:
            yield from each
        self.deferred = outer

    def walk(self, codec: wire.Codec, here: _Here) -> Iterator[Obstacle]:
        match codec:
            case wire.Seq(items):
                for item in items:
                    yield from self.walk(item, here)
            case wire.Number(path) | wire.Unsent(path):
                yield from self.number(path, here)
            case wire.Table(path):
                self.translated.add(here.path + path)
                yield from self.number(path, here)
            case wire.Computed(path, _, value):
                yield from self.computed(path, value, here)
            case wire.Constant(path, value, kind=kind):
                self.constant(path, value, kind, here)
            case wire.Blob():
                yield from self.blob(codec, here)
            case wire.Utf16():
                yield from self.utf16(codec, here)
            case wire.Repeat():
                yield from self.repeat(codec, here)
            case wire.Choice():
                yield from self.choice(codec, here)
            case wire.Delimited(_, value):
                yield from self.walk(value, here)
            case wire.Cases() | wire.Maybe() | wire.Members() | wire.Parameter() | wire.Parameters():
                yield from self.conditional(codec, here)
            case wire.Tagged(path) | wire.Varint(path) | wire.Recursion(path):
                yield Obstacle(here.path + path, "fields with tags come in any order, and more than once")
            case wire.Padding() | wire.Align():
                pass
            case _:
                assert_never(codec)

    def conditional(
        self, codec: wire.Cases | wire.Maybe | wire.Members | wire.Parameter | wire.Parameters, here: _Here
    ) -> Iterator[Obstacle]:
        """What need not be there, or may be anywhere. Members that always are have their places when they are written."""
        match codec:
            case wire.Members(path, members) | wire.Parameters(path, members) if self.direction != "decode":
                for member in members:
                    if member.optional:
                        yield Obstacle(here.path + member.path, "it may be absent")
                    yield from self.walk(member.value, here)
            case wire.Parameter(member, _, second) if self.direction != "decode" and (second or not member.optional):
                yield from self.walk(member.value, here)
            case wire.Members(path) | wire.Parameters(path):
                yield Obstacle(here.path + path, "its members come in any order")
            case wire.Parameter(member):
                yield Obstacle(here.path + member.path, "it may be absent")
            case wire.Maybe(path):
                yield Obstacle(here.path + path, "it may be absent")
            case wire.Cases(path):
                yield Obstacle(here.path + path, "it is of one of several cases")

    # --- leaves ----------------------------------------------------------------------------------------------------------

    def number(self, path: wire.Path, here: _Here) -> Iterator[Obstacle]:
        if self.direction == "decode":
            self.put(path, here)
        elif self.direction == "encode" and here.outer is None:
            yield from self.deciding(path, here)

    def put(self, path: wire.Path, here: _Here) -> None:
        """A number that has come."""
        if here.outer is None:
            self.numbers.add(path)
        else:
            here.passing.add(path)

    def put_bytes(self, path: wire.Path, here: _Here) -> None:
        if here.outer is None:
            self.counts.add(path)
            self.regions.add((*path, EACH))

    def computed(self, path: wire.Path, value: expr.Expr, here: _Here) -> Iterator[Obstacle]:
        if self.direction == "decode":
            self.put(path, here)
            self.deferred.append(self.expression(value, here))
        elif self.direction == "encode":
            yield from self.expression(value, here)

    def constant(self, path: wire.Path, value: float | bytes, kind: str, here: _Here) -> None:
        if self.direction != "decode" or not path:
            return
        if isinstance(value, bytes):
            self.put_bytes(path, here)
        elif kind == "constant":
            self.put(path, here)

    def blob(self, blob: wire.Blob, here: _Here) -> Iterator[Obstacle]:
        yield from self.count(blob.path, blob.count, here)
        if self.direction == "decode":
            self.put_bytes(blob.path, here)
        elif self.direction == "encode":
            match rule_for(here.path + blob.path, self.rules):
                case typed.Assign(_, typed.Access()):
                    pass  # the walk copies it
                case _:
                    self.regions.add((*here.path, *blob.path, EACH))

    def utf16(self, text: wire.Utf16, here: _Here) -> Iterator[Obstacle]:
        yield from self.count(text.path, text.count, here)
        if self.direction == "decode":
            self.counts.add(here.path + text.path)
        elif self.direction == "encode":
            yield Obstacle(here.path + text.path, "its units are written by the walk")

    # --- arrays and choices ----------------------------------------------------------------------------------------------

    def count(self, path: wire.Path, count: wire.Count, here: _Here) -> Iterator[Obstacle]:
        """A count is read, or asked for; where other fields determine it, these must be known."""
        computed = None if count.value is None or isinstance(count.value, int) else count.value
        if self.direction != "decode":
            yield from self.counted(path, here)
        if computed is None:
            return
        if self.direction == "decode" and count.scalar is not None:
            self.deferred += [self.counted(path, here), self.expression(computed, here)]
        else:
            yield from self.expression(computed, here.scope)

    def repeat(self, repeat: wire.Repeat, here: _Here) -> Iterator[Obstacle]:
        key, size = here.path + repeat.path, fixed_size(repeat.item)
        if self.direction != "decode" and isinstance(repeat.count.value, int):
            self.counts.add(key)
        yield from self.count(repeat.path, repeat.count, here)
        yield from self.walk(wire.Seq(repeat.head), here)
        self.counts.add(key)
        if size is not None and self.direction == "size":
            return
        if size is not None and here.outer is None:
            self.place(repeat.item, (*key, EACH))
        yield from self.whole(repeat.item, _Here((*key, EACH), here))

    def place(self, item: wire.Codec, element: wire.Path) -> None:
        """The places of numbers in elements of one size, and in arrays of fixed length within them."""
        self.regions.update(element + leaf.path for leaf in leaves(item))
        if self.direction == "decode" and not self.varies:
            for path in (element + leaf.path for leaf in inner_leaves(item)):
                self.regions.add(path)
                self.fixed.update(path[:end] for end in range(len(element), len(path)) if path[end] == EACH)

    def choice(self, choice: wire.Choice, here: _Here) -> Iterator[Obstacle]:
        """All alternatives are read; which one is written, its label or the number of elements says, or it is the first."""
        alternatives = [codec for _, codec in choice.alternatives]
        if self.direction != "decode":
            if choice.labels:
                yield from self.deciding(choice.path, here)
            if not choice.labels and not choice.when_empty:
                alternatives = alternatives[:1]
            elif here.outer is None:
                for path in (path for codec in alternatives for path in numbers_of_counts(codec)):
                    yield from self.deciding(path, here)
            if choice.when_empty and not choice.labels:
                yield from self.counted(choice.path, here)
                alternatives = [alternatives[choice.when_empty], alternatives[0]]
        outer, self.varies = self.varies, True
        for codec in alternatives:
            yield from self.walk(codec, here)
        self.varies = outer

    # --- what is asked for -----------------------------------------------------------------------------------------------

    def expression(self, value: expr.Expr, here: _Here) -> Iterator[Obstacle]:
        """What the schema computes of fields."""
        for part in parts(value):
            match part:
                case expr.Path():
                    yield from self.deciding(names_of(part), here)
                case expr.Len(path):
                    yield from self.counted(names_of(path), here)
                case _:
                    pass

    def deciding(self, path: wire.Path, here: _Here) -> Iterator[Obstacle]:
        """A number that says something of what follows."""
        key = here.path + path
        if key in self.numbers or path in here.passing:
            return
        if here.outer is not None:
            yield Obstacle(key, "what follows depends on it, and rules set it later")
        elif self.direction == "decode":
            yield Obstacle(key, "it comes too late")
        elif rule_for(key, self.rules) is None:
            yield Obstacle(key, "no rule gives it by itself")
        else:
            self.numbers.add(key)

    def counted(self, path: wire.Path, here: _Here) -> Iterator[Obstacle]:
        """How many elements or bytes there are."""
        key = here.path + path
        if key in self.counts:
            return
        if self.direction == "decode":
            yield Obstacle(key, "its length is not known where it is needed")
        elif rule_for(key, self.rules) is None:
            yield Obstacle(key, "no rule gives its length by itself")
        elif _is_made(key, self.rules):
            yield Obstacle(key, "how long it becomes is known only when it is made")
        else:
            self.counts.add(key)


def _is_made(key: wire.Path, rules: tuple[typed.Rule, ...]) -> bool:
    """Whether a rule, or one of those in its blocks, sets a field to what a function makes."""
    match rule_for(key, rules):
        case typed.Assign(_, typed.Call()):
            return True
        case typed.When(_, then, otherwise):
            return _is_made(key, then) or _is_made(key, otherwise)
        case _:
            return False
