"""Random rules that fill arrays, each with what it is by plain Python: whole arrays, slices, orders, `[]`, loops, and blocks of them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import reduce
from operator import xor
from typing import TYPE_CHECKING, Any

from tests.random_mappings.fields import some_value
from tests.random_mappings.meaning import Refused, fits
from tests.random_mappings.values import Maker

if TYPE_CHECKING:
    import random
    from collections.abc import Callable

    from tests.random_mappings.meaning import Fields

ARRAYS = {"xs": "float64", "ks": "int32"}
"""The arrays that rules read, beside `ps`, an array of `x`, float64, `n`, int32, and `s`, string."""


@dataclass
class Rules:
    """Rules that set one array, and what it is then."""

    text: str
    evaluate: Callable[[Fields], list[Any]]


def refused(kind: str) -> Refused:
    return Refused(kind)


@dataclass
class Arrays:
    rng: random.Random
    scalars: dict[str, str]

    def of(self, name: str, type_: str, depth: int = 2) -> Rules:
        """Rules for an array of "float64", "int64" or "string"."""
        choice = self.rng.randrange(8)
        if choice == 0 and depth:
            return self.block(name, type_, depth)
        if choice == 1:
            return self.loop(name, type_)
        if choice == 2 and type_ != "string":
            return self.each(name, type_)
        if choice == 6 and type_ != "string":
            return self.reduced(name, type_)
        if choice == 7:
            return self.filtered(name, type_)
        return self.members(name, type_) if choice == 3 or type_ == "string" else self.ordered(name, type_)

    def block(self, name: str, type_: str, depth: int) -> Rules:
        condition = Maker(self.rng, self.scalars).live("bool", 2)
        then, other = self.of(name, type_, depth - 1), self.of(name, type_, depth - 1)
        return Rules(
            f"when {condition.text}\n{then.text}\nelse\n{other.text}\nend",
            lambda fields: (then if condition.evaluate(fields) else other).evaluate(fields),
        )

    def loop(self, name: str, type_: str) -> Rules:
        count, text = self.rng.choice(
            [(lambda fields: len(fields["xs"]), "len(.xs)"), (lambda fields: fields["u8"] % 5, ".u8 % 5"), (lambda _: 3, "3")]
        )
        value = Maker(self.rng, self.scalars, variables=("i",)).live(type_, 3)

        def evaluate(fields: Fields) -> list[Any]:
            return [value.evaluate({**fields, "i": i}) for i in range(count(fields))]

        return Rules(f"len(.{name}) = {text}\nfor i from 0 to {text}\n.{name}[i] = {value.text}\nend", evaluate)

    def each(self, name: str, type_: str) -> Rules:
        made = self.of_each(type_)
        return Rules(f".{name}[] = {made.text}", made.evaluate)

    def of_each(self, type_: str) -> Rules:
        """An expression of the elements of an array, and what it is for each."""
        array, element = ("xs", "float64") if type_ == "float64" else ("ks", "int32")
        place = f"{array}[]"
        made = Maker(self.rng, {**self.scalars, place: element}).live(type_, 2)
        operator = self.rng.choice(["max({}, {})", "min({}, {})"])

        def evaluate(fields: Fields) -> list[Any]:
            found = []
            for each in fields[array]:
                left, right = made.evaluate({**fields, place: each}), each
                found.append(left if (left > right if operator[:3] == "max" else left < right) else right)
            return found

        return Rules(operator.format(made.text, "." + place), evaluate)

    def reduced(self, name: str, type_: str) -> Rules:
        """A reduction that is the same in each round of a loop, beside what is not; half of them take elements by a condition."""
        made, of_floats = self.of_each(type_), type_ == "float64"
        array, least = "xs" if of_floats else "ks", self.rng.choice([None, None, -1, 1])
        where = "" if least is None else f" where .{array}[] > {least}"
        function = self.rng.choice(["sum", "min", "max", "mean"] if of_floats else ["sum", "min", "max", "count", "xor"])
        text = f"{function}({made.text}{' > 0' if function == 'count' else ''}{where})"
        limit = self.rng.choice([0, 2])

        def evaluate(fields: Fields) -> list[Any]:
            zero = 0.0 if of_floats else 0
            taken = {**fields, array: [each for each in fields[array] if least is None or each > least]}
            return [reduced(function, made.evaluate(taken), zero) if k > limit else zero for k in fields["ks"]]

        zero = "0.0" if of_floats else "0"
        return Rules(f".{name}[] = {text} if .ks[] > {limit} else {zero}", evaluate)

    def filtered(self, name: str, type_: str) -> Rules:
        """The elements for which a condition on them holds, by their values, their numbers, or both."""
        array, of_one = ("ps", self.rng.choice([".x", ".n"])) if type_ == "string" else ("xs" if type_ == "float64" else "ks", "")
        element = f"{array}[]{of_one}"
        kind = "float64" if of_one == ".x" or array == "xs" else "int32"
        condition = Maker(self.rng, {**self.scalars, element: kind}).live("bool", 2)
        every = self.rng.choice([1, 2, 3])
        text = f"({condition.text}) and index() % {every} == 0" if every > 1 else condition.text
        place = "ps[].s" if of_one else element

        def evaluate(fields: Fields) -> list[Any]:
            found = []
            for number, each in enumerate(fields[array]):
                value = each if not of_one else each[of_one[1:]]
                if condition.evaluate({**fields, element: value}) and number % every == 0:
                    found.append(each["s"] if of_one else each)
            return found

        return Rules(f".{name}[] = .{place} where {text}", evaluate)

    def members(self, name: str, type_: str) -> Rules:
        member = {"float64": "x", "int64": "n", "string": "s"}[type_]
        return Rules(f".{name}[] = .ps[].{member}", lambda fields: [each[member] for each in fields["ps"]])

    def ordered(self, name: str, type_: str) -> Rules:
        array = "xs" if type_ == "float64" else "ks"
        start, stop, step = self.rng.randrange(3), self.rng.choice([None, 3, 5]), self.rng.choice([1, 2, 3])
        ends = "" if stop is None else f" {max(stop, start)} by {step}"
        size = self.rng.choice([2, 3])
        forms: list[tuple[str, Callable[[list[Any]], list[Any]]]] = [
            (f".{array}", lambda a: a),
            (f".{array}[{start} to{ends}]", lambda a: sliced(a, start, stop, step)),
            (f"reversed(.{array})", lambda a: a[::-1]),
            (f"reversed(.{array}, {size})", lambda a: [x for g in grouped(a, size) for x in g[::-1]]),
            (f"permuted(.{array}, [1, 0])", lambda a: [x for g in grouped(a, 2) for x in g[::-1]]),
            (f"planar(.{array}, {size})", lambda a: [g[c] for c in range(size) for g in grouped(a, size)]),
            (f"interleaved(.{array}, {size})", lambda a: interleaved(a, size)),
            (f"reversed(.{array}[{start} to{ends}])", lambda a: sliced(a, start, stop, step)[::-1]),
            (f".{array}[[2, 0, 0]]", lambda a: [at(a, i) for i in (2, 0, 0)]),
        ]
        text, function = self.rng.choice(forms)
        return Rules(f".{name} = {text}", lambda fields: function(fields[array]))


def reduced(function: str, values: list[Any], zero: float) -> Any:
    """What a reduction makes of values, from the first to the last."""
    if function in ("sum", "mean"):
        total = zero
        for value in values:
            total = fits(total + value) if isinstance(zero, int) else total + value
        if function == "mean" and not values:
            raise refused("range")
        return total / len(values) if function == "mean" else total
    if function == "count":
        return sum(value > 0 for value in values)
    if function == "xor":
        return reduce(xor, values, 0)
    if not values:
        raise refused("range")
    nan = next((value for value in values if value != value), None)  # noqa: PLR0124 - it is what NaN is known by
    return nan if nan is not None else (min if function == "min" else max)(values)


def at(array: list[Any], index: int) -> Any:
    if not 0 <= index < len(array):
        raise refused("index")
    return array[index]


def sliced(array: list[Any], start: int, stop: int | None, step: int) -> list[Any]:
    if stop is None:
        if start > len(array):
            raise refused("rejected")
        return array[start:]
    return [at(array, i) for i in range(start, max(stop, start), step)]


def grouped(array: list[Any], size: int) -> list[list[Any]]:
    if len(array) % size:
        raise refused("range")
    return [array[i : i + size] for i in range(0, len(array), size)]


def interleaved(array: list[Any], size: int) -> list[Any]:
    planes = len(array) // size
    grouped(array, size)
    return [array[c * planes + i] for i in range(planes) for c in range(size)]


def some_arrays(rng: random.Random) -> Fields:
    """Values of all arrays; with lengths that fit and lengths that do not."""
    count = rng.choice([0, 1, 3, 4, 6, 6, 12])
    fields: Fields = {name: [some_value(rng, type_) for _ in range(count)] for name, type_ in ARRAYS.items()}
    members = {"x": "float64", "n": "int32", "s": "string"}
    fields["ps"] = [{name: some_value(rng, type_) for name, type_ in members.items()} for _ in range(count % 5)]
    fields["q"] = [some_value(rng, "int16") for _ in range(4)]
    return fields
