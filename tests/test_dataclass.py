"""Our `dataclass` does what the standard library's does, but for the time that it takes."""

from __future__ import annotations

import copy
import dataclasses
import inspect
import math
import pickle
import weakref
from pathlib import Path
from typing import ClassVar

import pytest

from rosetta_jit.startup.dataclass import dataclass, field, replace
from rosetta_jit.startup.stores import STORES

PACKAGE = Path(__file__).resolve().parent.parent / "rosetta_jit"


@dataclass(frozen=True, slots=True)
class Ours:
    """Every kind of field."""

    first: int
    second: str = "two"
    third: list = field(default_factory=list)
    span: object = field(default=None, compare=False, repr=False)
    derived: float = field(default=0.5, init=False)
    KIND: ClassVar[str] = "kind"

    def double(self):
        return 2 * self.first


@dataclasses.dataclass(frozen=True, slots=True)
class Theirs:
    """The same, made by the standard library."""

    first: int
    second: str = "two"
    third: list = dataclasses.field(default_factory=list)
    span: object = dataclasses.field(default=None, compare=False, repr=False)
    derived: float = dataclasses.field(default=0.5, init=False)
    KIND: ClassVar[str] = "kind"


@dataclass(slots=True)
class Changing:
    value: int
    twice: int = 0

    def __post_init__(self):
        self.twice = 2 * self.value


@dataclass(frozen=True, slots=True)
class One:
    value: float


@dataclass(frozen=True, slots=True)
class Empty:
    pass


def test_fields_and_parameters_are_the_standard_ones():
    described = [[(each.name, each.default, each.init, each.compare) for each in dataclasses.fields(cls)] for cls in (Ours, Theirs)]
    assert described[0] == described[1]
    names = [list(inspect.signature(cls).parameters) for cls in (Ours, Theirs)]
    assert names[0] == names[1] == ["first", "second", "third", "span"]
    assert Ours.__match_args__ == Theirs.__match_args__
    assert Ours.__slots__ == Theirs.__slots__


def test_values_and_defaults():
    made = Ours(1)
    assert (made.first, made.second, made.third, made.span, made.derived, made.double()) == (1, "two", [], None, 0.5, 2)
    assert Ours(1).third is not Ours(1).third
    assert Ours(3, span="here", second="x") == Ours(3, "x", span="elsewhere")
    assert dataclasses.replace(made, first=7) == Ours(7)
    assert dataclasses.asdict(One(2.0)) == {"value": 2.0}
    for wrong in [(), (1, 2, 3, 4, 5)]:
        with pytest.raises(TypeError):
            Ours(*wrong)
    with pytest.raises(TypeError):
        Ours(1, none=2)


def test_equality_and_hash_are_of_what_is_compared():
    assert One(1.0) == One(1.0)
    assert One(1.0) != One(2.0)
    assert One(1.0) != (1.0,)
    assert Empty() == Empty()
    assert hash(One(1.0)) == hash(One(1))
    assert len({One(1.0), One(1.0), Empty(), Empty()}) == 2
    assert One(math.nan) == One(math.nan), "one object is equal to itself in tuples"
    with pytest.raises(TypeError, match="unhashable"):
        hash(Changing(1))


def test_repr_is_the_standard_one():
    assert repr(Ours(1)) == repr(Theirs(1)).replace("Theirs", "Ours") == "Ours(first=1, second='two', third=[], derived=0.5)"
    assert repr(Empty()) == "Empty()"


def test_frozen_ones_refuse_to_be_changed():
    for change in [lambda: setattr(One(1.0), "value", 2.0), lambda: setattr(One(1.0), "other", 2.0), lambda: delattr(One(1.0), "value")]:
        with pytest.raises(dataclasses.FrozenInstanceError):
            change()
    changing = Changing(4)
    assert changing.twice == 8
    changing.value = 5
    assert changing.value == 5
    with pytest.raises(AttributeError):
        changing.other = 5


def test_copies_and_pickles():
    for value in [Ours(1, "x", [2]), Changing(3), One(2.0)]:
        assert copy.copy(value) == copy.deepcopy(value) == pickle.loads(pickle.dumps(value)) == value  # noqa: S301 - our own


def test_what_is_asked_for_besides_is_left_to_the_standard_library():
    @dataclass(frozen=True, slots=True)
    class Derived(One):
        more: int = 1

    @dataclass(frozen=True, slots=True)
    class Shown:
        value: int

        def __repr__(self):
            return "shown"

    @dataclass
    class Plain:
        value: int

    @dataclass(frozen=True, eq=False)
    class Identity:
        value: int

    assert Derived(1.0) == Derived(1.0, 1)
    assert repr(Shown(1)) == "shown"
    assert Shown(1) == Shown(1)
    assert Plain(1) == Plain(1)
    assert Identity(1) != Identity(1)
    for changed in [Derived(1.0), Shown(1), Identity(1)]:
        with pytest.raises(dataclasses.FrozenInstanceError):
            changed.value = 2


def test_standard_ones_may_inherit_ours():
    @dataclasses.dataclass(frozen=True)
    class Derived(One):
        more: int = 1

    assert Derived(1.0).more == 1


TEMPLATE = PACKAGE / "generate" / "python" / "runtime" / "printed.py"
"""What generated modules import, which need the standard library alone."""


def test_every_module_takes_it():
    """Each class made the standard way costs every process half a millisecond."""
    wrong = [
        str(path.relative_to(PACKAGE))
        for path in PACKAGE.rglob("*.py")
        if path.name != "dataclass.py" and path != TEMPLATE
        for line in path.read_text("utf-8").splitlines()
        if line.startswith("from dataclasses import") and "dataclass" in line.partition("import")[2].replace(",", " ").split()
    ]
    assert not wrong, "import it from rosetta_jit.startup.dataclass"


@dataclass(slots=True, eq=False, repr=False)
class Apart:
    """Of each object only itself is equal to it."""

    value: int = 1


@dataclass(frozen=True, slots=True, weakref_slot=True)
class Watched:
    value: int


def test_fields_of_the_standard_library_are_refused():
    """They would be taken for values."""
    with pytest.raises(TypeError, match="imported from where"):

        @dataclass(frozen=True, slots=True)
        class Mixed:
            value: list = dataclasses.field(default_factory=list)


@pytest.mark.parametrize("count", range(len(STORES) + 2))
def test_each_number_of_fields_is_set(count):
    names = [f"field{number}" for number in range(count)]
    made = dataclass(slots=True)(type("Made", (), {"__annotations__": dict.fromkeys(names, "int")}))
    value = made(*range(count))
    assert [getattr(value, name) for name in names] == list(range(count))
    assert made(**{name: number for number, name in enumerate(names)}) == value
    with pytest.raises(TypeError, match=r"__init__\(\)"):
        made(*range(count + 1))


def test_objects_may_be_equal_to_themselves_alone():
    one, other = Apart(), Apart()
    assert one != other
    assert len({one, other, one}) == 2
    assert "Apart object" in repr(one)
    one.value = 2
    assert one.value == 2


def test_objects_may_be_watched():
    one = Watched(3)
    assert weakref.ref(one)() is one
    assert {one: 1}[Watched(3)] == 1


def test_replaced_fields():
    one = Ours(1, span="here")
    changed = replace(one, first=2, span="there")
    assert (changed.first, changed.second, changed.span, one.first) == (2, "two", "there", 1)
    assert replace(one) == one
    for wrong in ({"other": 1}, {"derived": 1.0}, {"KIND": "other"}):
        with pytest.raises(TypeError, match=next(iter(wrong))):
            replace(one, **wrong)
