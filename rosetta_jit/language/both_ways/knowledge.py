"""What relations say of the wire's fields, so that packing has what the message is going to hold before it is written.

`.a <-> .b + 1`                    of `.b`        it is `.a - 1`
`.a <-> .b`                        of `len(.b)`   it is `len(.a)`; of `.b[n]` it is `.a[n]`
`for i … .a[i].x <-> .b[i].y`      of `.b[n].y`   it is `.a[n].x`
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.language.limits import MAX_PARTS
from rosetta_jit.model.expr import Call, Coerced, Each, Expr, Index, Keyed, Len, Name, Path, Side
from rosetta_jit.model.mapping import Relation
from rosetta_jit.model.walk import Field, names_of, parts, path_of, rebuilt, renamed, with_indices
from rosetta_jit.startup.dataclass import dataclass, field, replace

if TYPE_CHECKING:
    from rosetta_jit.language.both_ways.inverse import TypeOf
    from rosetta_jit.language.both_ways.inverse_parts import Digit


@dataclass(frozen=True, slots=True)
class Loop:
    """A loop around a relation."""

    variable: str
    start: Expr
    stop: Expr


Loops = tuple[Loop, ...]
Key = tuple[Field, tuple[tuple[Expr, Expr], ...]]
"""A field with its loop variables by number, and their ranges."""

Shape = tuple[bool, tuple[str, ...]]
"""A field without its indices, and whether it is a length."""


@dataclass(slots=True)
class Budget:
    """How much may still be put in place of fields: what is known of one may have fields of which something is known."""

    parts: int = MAX_PARTS


@dataclass(frozen=True, slots=True)
class Beside:
    """What must hold besides: for messages, that a relation sets all of its fields; for holders, that two set one field."""

    rule: Relation
    side: Side
    digits: tuple[Digit, ...]
    refused: tuple[tuple[Expr, str], ...] = ()
    """Conditions that must not hold, and why."""
    is_asked: bool = False
    """Whether packing asks that unpacking gives the holder's value again."""


@dataclass(slots=True)
class Knowledge:
    """Which relation sets each field of the wire, to what, and what is known of fields by expressions of the holder alone."""

    type_of: TypeOf
    setters: dict[Key, tuple[Relation, Expr]] = field(default_factory=dict["Key", "tuple[Relation, Expr]"])
    values: dict[Key, Expr] = field(default_factory=dict["Key", "Expr"])
    shapes: dict[Shape, list[Key]] = field(default_factory=dict["Shape", "list[Key]"])
    sizes: dict[Key, int] = field(default_factory=dict["Key", int])
    budget: Budget = field(default_factory=Budget)
    beside: dict[int, Beside] = field(default_factory=dict[int, "Beside"])
    unpacked: dict[int, Beside] = field(default_factory=dict[int, "Beside"])
    """What must hold of messages alone: packing takes the field from another relation."""
    unsolved: dict[int, str] = field(default_factory=dict[int, str])
    """Why a relation is not solved together with others, of which there are as many as fields."""
    flags: dict[Key, Expr] = field(default_factory=dict["Key", "Expr"])
    """What of the holder says whether a field of the wire is there."""
    signals: dict[Call, Expr] = field(default_factory=dict["Call", "Expr"])
    """What signals must be that conditions ask for."""

    def inside(self) -> Knowledge:
        """The same, for a block that may know more."""
        shapes = {shape: list(keys) for shape, keys in self.shapes.items()}
        known = dict(self.setters), dict(self.values), shapes, dict(self.sizes)
        return Knowledge(self.type_of, *known, self.budget, self.beside, self.unpacked, self.unsolved, dict(self.flags), dict(self.signals))

    def learn(self, place: Field, value: Expr, loops: Loops) -> None:
        """That a field has a value, unless that is known."""
        key, names = key_of(place, loops)
        if key not in self.values:
            self.values[key] = renamed(value, names)
            self.sizes[key] = sum(1 for _ in parts(value))
            self.shapes.setdefault(_shape(place), []).append(key)

    def learn_flag(self, flag: Path, wire_field: Path, loops: Loops) -> None:
        """That a field of the wire is there where a bool of the holder is true."""
        key, names = key_of(wire_field, loops)
        self.flags.setdefault(key, renamed(flag, names))

    def flag(self, wire_field: Path, loops: Loops) -> Expr | None:
        """What of the holder says whether a field of the wire is there."""
        key, names = key_of(wire_field, loops)
        found = self.flags.get(key)
        return None if found is None else renamed(found, {number.name: Name(name) for name, number in names.items()})

    def forget(self, places: list[Field], loops: Loops) -> None:
        """Fields that another relation is going to set."""
        for place in places:
            key, _ = key_of(place, loops)
            self.setters.pop(key, None)
            self.values.pop(key, None)
            self.shapes[_shape(place)] = [each for each in self.shapes.get(_shape(place), []) if each != key]

    def value(self, place: Field, loops: Loops) -> Expr | None:
        """What is known of a field; nothing when the budget is spent."""
        key, names = key_of(place, loops)
        self.budget.parts -= self.sizes.get(key, 1)
        if self.budget.parts < 0:
            return None
        if key in self.values:
            return renamed(self.values[key], {number.name: Name(name) for name, number in names.items()})
        alike = self.shapes.get(_shape(place), [])
        found: dict[str, Expr] = {}
        if len(alike) == 1 and _unify(path_of(alike[0][0]), path_of(place), found):
            return renamed(self.values[alike[0]], {name: self.replaced(index, loops) for name, index in found.items()})
        return self._around(place, loops)

    def _around(self, place: Field, loops: Loops) -> Expr | None:
        """What is known of a field as part of an array that is equal to one of the holder."""
        path = path_of(place)
        for length in range(len(path.steps) - (not isinstance(place, Len)), 0, -1):
            key, names = key_of(replace(path, steps=path.steps[:length]), loops)
            whole = self.values.get(key)
            if isinstance(whole, Path) and all(isinstance(step, Index | Each) for step in path.steps[length:]):
                whole = _with_variables(whole, names)
                rest = with_indices(replace(path, steps=path.steps[length:]), lambda index: self.replaced(index, loops))
                found = Path(whole.side, (*whole.steps, *rest.steps), path.span)
                return Len(found, place.span) if isinstance(place, Len) else found
        return None

    def replaced(self, expr: Expr, loops: Loops) -> Expr:
        """An expression with what is known of the wire's fields in place of them; whether one is there does not follow from its value."""
        if isinstance(expr, Call) and expr.function == "has":
            wire_field = expr.arguments[0]
            flag = self.flag(wire_field, loops) if isinstance(wire_field, Path) else None
            return expr if flag is None else flag
        if isinstance(expr, Call) and expr in self.signals and not loops:
            return self.signals[expr]
        if isinstance(expr, Path | Len) and path_of(expr).side == "wire":
            value = self.value(expr, loops)
            if value is not None:
                return Coerced(self.placed(expr, loops), value, expr.span) if isinstance(expr, Path) else value
        return rebuilt(expr, lambda part: self.replaced(part, loops))

    def placed(self, path: Path, loops: Loops) -> Path:
        """A place of the wire with indices that packing has."""
        return with_indices(path, lambda index: self.replaced(index, loops))


def key_of(place: Field, loops: Loops) -> tuple[Key, dict[str, Name]]:
    """A field as it is looked up, and the numbers of its loop variables."""
    path = path_of(place)
    variables = {loop.variable: loop for loop in loops}
    used: dict[str, Loop] = {}
    for step in path.steps:
        if isinstance(step, Index | Keyed):
            expr = step.index if isinstance(step, Index) else step.value
            used |= {name: variables[name] for name in _names(expr) if name in variables}
    names = {name: Name(f"#{number}") for number, name in enumerate(used)}
    plain = with_indices(path, lambda index: renamed(index, names))
    ranges = tuple((loop.start, loop.stop) for loop in used.values())
    return (Len(plain) if isinstance(place, Len) else plain, ranges), names


def _with_variables(path: Path, names: dict[str, Name]) -> Path:
    """A path with loop variables in place of their numbers."""
    variables = {number.name: Name(name) for name, number in names.items()}
    return with_indices(path, lambda index: renamed(index, variables))


def _names(expr: Expr) -> list[str]:
    found: list[str] = [expr.name] if isinstance(expr, Name) else []

    def below(part: Expr) -> Expr:
        found.extend(_names(part))
        return part

    rebuilt(expr, below)
    return found


def _shape(place: Field) -> Shape:
    return isinstance(place, Len), names_of(path_of(place))


def _unify(pattern: Path, path: Path, found: dict[str, Expr]) -> bool:
    """Whether a path is the pattern with expressions in place of its numbered variables; those are then ``found``."""
    if len(pattern.steps) != len(path.steps):
        return False
    for wanted, step in zip(pattern.steps, path.steps, strict=True):
        match wanted, step:
            case Index(Name(name)), Index(index) if name.startswith("#"):
                if found.setdefault(name, index) != index:
                    return False
            case _ if wanted != step:
                return False
            case _:
                pass
    return True
