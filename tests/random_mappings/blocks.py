"""Random relations with more to them than a field each: conditions, checks, what may be absent, arrays."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from tests.random_mappings.meaning import TEXTS, Refused, fits
from tests.random_mappings.message_types import Array, Maybe, Message, Scalar, some
from tests.random_mappings.relations import Part, Scalars, Values
from tests.random_mappings.values import quoted

if TYPE_CHECKING:
    import random
    from collections.abc import Callable


@dataclass
class Relations(Scalars):
    """Makes relations of all kinds."""

    more: tuple[Callable[[Relations, str], Part], ...] = ()
    """Forms of other modules, for all wires."""
    more_arrays: tuple[Callable[[Relations, str], Part], ...] = ()
    depth: int = 0
    """How many messages within each other are made."""
    blocks: int = 0
    """How many `when`s of three ways there are, and images: more of them take long to compile."""

    @property
    def is_counted(self) -> bool:
        """Whether arrays need fields for their lengths."""
        return "lcm" in (self.wire.options["encoding"], self.holder.options["encoding"])

    def part(self) -> Part:
        self.made += 1
        name = f"f{self.made}"
        forms = [
            self.integers,
            self.integers,
            self.floats,
            self.measured,
            self.flags,
            self.texts,
            self.text_numbers,
            self.kinds,
            self.told,
            self.checked,
        ]
        forms += [partial(form, self) for form in self.more]
        if not self.is_counted:
            forms += [self.arrays, self.lists, self.structs, *(partial(form, self) for form in self.more_arrays)]
        if self.holder.constant:
            forms += [self.enums, self.enums, self.enum_names]
        if self.wire.constant:
            forms.append(self.named_enums)
        if self.wire.has_optional and self.holder.has_optional:
            forms.append(self.optional)
        return self.rng.choice(forms)(name)

    def told(self, name: str) -> Part:
        """A `when` whose condition other relations tell."""
        a, b = f"{name}a", f"{name}b"
        limit = self.rng.choice([0, 3, 100])
        operator, holds = self.rng.choice([(">", lambda x: x > limit), ("==", lambda x: x == limit), ("!=", lambda x: x != limit)])
        then, run = self.chain(f".{b}", 1)
        other, turn = self.chain(f".{b}", 1)
        shift = self.rng.choice([0, 1, -4])
        condition = f".{a} {operator} {limit}"
        relation = f".{a} <-> int64(.{a} + {shift})\n" if shift > 0 else f".{a} <-> .{a}\n" if not shift else f".{a} <-> .{a} - {-shift}\n"
        if self.rng.random() < 0.3:
            rules = f".{b} <-> ({then} if {condition} else {other})\n"
        else:
            rules = f"when {condition}\n.{b} <-> {then}\nelse\n.{b} <-> {other}\nend\n"

        def unpack(fields: Values) -> Values:
            return {a: fits(fields[a] + shift), b: (run if holds(fields[a]) else turn)(fields[b])}

        kinds = {a: Scalar("int64"), b: Scalar("int64")}
        near = lambda rng: {a: rng.choice([limit, limit + 1, limit + shift, rng.randrange(-200, 200)]), b: rng.randrange(-(10**6), 10**6)}  # noqa: E731 - one line
        ordered = [relation, rules] if self.rng.random() < 0.5 else [rules, relation]
        return Part(kinds, kinds, "".join(ordered), unpack, near, near)

    def kinds(self, name: str) -> Part:
        """A `when` whose blocks relate a field to other constants."""
        a, b = f"{name}a", f"{name}b"
        keys = self.rng.sample(["on", "off", "", "é"], 3)
        then, run = self.chain(f".{b}", 1)
        other, turn = self.chain(f".{b}", 1)
        is_closed = self.rng.random() < 0.5
        last = f'else when .{a} == {quoted(keys[1])}\n.{a} <-> 2\n.{b} <-> {other}\nelse\nreject "no"\nend end\n'
        rules = f"when .{a} == {quoted(keys[0])}\n.{a} <-> 1\n.{b} <-> {then}\n{last}"
        if is_closed:
            rules = f"when .{a}\n.{a} <-> 1\n.{b} <-> {then}\nelse\n.{a} <-> 2\n.{b} <-> {other}\nend\n"

        def unpack(fields: Values) -> Values:
            if not is_closed and fields[a] not in keys[:2]:
                raise Refused("rejected", "")
            is_first = fields[a] if is_closed else fields[a] == keys[0]
            return {a: 1 if is_first else 2, b: (run if is_first else turn)(fields[b])}

        wires = (
            (lambda rng: {a: rng.random() < 0.5, b: rng.randrange(-(10**6), 10**6)})
            if is_closed
            else (lambda rng: {a: rng.choice(keys), b: rng.randrange(-(10**6), 10**6)})
        )
        return Part(
            {a: Scalar("bool" if is_closed else "string"), b: Scalar("int64")},
            {a: Scalar("int32"), b: Scalar("int64")},
            rules,
            unpack,
            wires,
            lambda rng: {a: rng.choice([1, 2]), b: rng.randrange(-(10**6), 10**6)},
        )

    def checked(self, name: str) -> Part:
        """A field that several relations tell, and a constant."""
        a, b = f"{name}a", f"{name}b"
        text, run = self.chain(f".{name}", 1)

        def unpack(fields: Values) -> Values:
            return {a: fields[name], b: run(fields[name]), name: 42}

        def holders(rng: random.Random) -> Values:
            value = rng.randrange(-1000, 1000)
            try:
                return unpack({name: value})
            except Refused:
                return {a: value, b: value, name: 42}

        rules = [f".{a} <-> .{name}\n", f".{b} <-> {text}\n", f".{name} <-> 42\n"]
        self.rng.shuffle(rules)
        kinds = {a: Scalar("int64"), b: Scalar("int64"), name: Scalar("int32")}
        return Part({name: Scalar("int64")}, kinds, "".join(rules), unpack, holders=holders)

    def optional(self, name: str) -> Part:
        """What is there on one side is on the other."""
        type_ = self.rng.choice(["int64", "float64", "string", "bool"])
        sign = "-" if type_ in ("int64", "float64") and self.rng.random() < 0.5 else ""
        rules = f"when has(.{name}) .{name} <-> {sign}.{name} else default .{name} end\n"
        if self.rng.random() < 0.3:
            rules = f"when not has(.{name}) default .{name} else .{name} <-> {sign}.{name} end\n"

        def unpack(fields: Values) -> Values:
            if name not in fields:
                return {}
            value = fields[name]
            return {name: value if not sign else fits(-value) if type_ == "int64" else -value}

        kinds = {name: Maybe(Scalar(type_))}
        return Part(kinds, kinds, rules, unpack)

    def arrays(self, name: str) -> Part:
        rng = self.rng
        size = rng.choice([2, 3])
        forms: list[tuple[str, Callable[[list[Any]], list[Any]]]] = [
            (f".{name} <-> .{name}\n", lambda a: a),
            (f".{name} <-> reversed(.{name})\n", lambda a: a[::-1]),
            (f".{name} <-> reversed(.{name}, {size})\n", lambda a: [x for g in grouped(a, size, name) for x in g[::-1]]),
            (f".{name} <-> permuted(.{name}, [2, 0, 1])\n", lambda a: [g[i] for g in grouped(a, 3, name) for i in (2, 0, 1)]),
            (f".{name} <-> planar(.{name}, {size})\n", lambda a: [g[c] for c in range(size) for g in grouped(a, size, name)]),
            (f".{name}[] <-> -.{name}[]\n", lambda a: [-x for x in a]),
            (
                f"len(.{name}) <-> len(.{name})\nfor i from 0 to len(.{name})\n.{name}[i] <-> .{name}[i] * 2.0\nend\n",
                lambda a: [x * 2.0 for x in a],
            ),
            (
                f"len(.{name}) <-> len(.{name})\nfor i from 0 to len(.{name})\n.{name}[len(.{name}) - 1 - i] <-> .{name}[i]\nend\n",
                lambda a: a[::-1],
            ),
        ]
        text, function = rng.choice(forms)
        kinds = {name: Array(Scalar("float64"))}
        six = lambda rng: {name: [some(rng, Scalar("float64")) for _ in range(rng.choice([0, 6, 12]))]}  # noqa: E731 - one line
        return Part(kinds, kinds, text, lambda fields: {name: function(fields[name])}, six, six)

    def lists(self, name: str) -> Part:
        a, b = f"{name}a", f"{name}b"
        return Part(
            {a: Scalar("float64"), b: Scalar("float64")},
            {name: Array(Scalar("float64"))},
            f".{name} <-> [.{b}, 1.5, -.{a}]\n",
            lambda fields: {name: [fields[b], np.float64(1.5), -fields[a]]},
            holders=lambda rng: {name: [some(rng, Scalar("float64")), np.float64(1.5), some(rng, Scalar("float64"))]},
        )

    def structs(self, name: str) -> Part:
        """An array of messages, member by member."""
        members = {"u": Scalar("int32"), "v": Scalar("string")}
        inner = Array(Message(f"Src{name.upper()}", members)), Array(Message(f"Dst{name.upper()}", members))
        text, run = self.chain(f".{name}[i].u", 1)
        rules = (
            f"len(.{name}) <-> len(.{name})\nfor i from 0 to len(.{name})\n"
            f'.{name}[i].u <-> int32({text})\n.{name}[i].v <-> "#" + .{name}[i].v\nend\n'
        )

        def unpack(fields: Values) -> Values:
            return {name: [{"u": fits(run(each["u"]), "int32"), "v": "#" + each["v"]} for each in fields[name]]}

        def holders(rng: random.Random) -> Values:
            return {name: [{"u": rng.randrange(-1000, 1000), "v": "#" + rng.choice(TEXTS)} for _ in range(rng.randrange(4))]}

        return Part({name: inner[0]}, {name: inner[1]}, rules, unpack, holders=holders)


def grouped(array: list[Any], size: int, name: str) -> list[list[Any]]:
    if len(array) % size:
        raise Refused("range", f".{name}")
    return [array[i : i + size] for i in range(0, len(array), size)]
