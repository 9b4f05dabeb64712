"""Random types, as a schema of ours and as classes of Cyclone DDS, with random values."""

from __future__ import annotations

import math
import typing
from dataclasses import dataclass, field
from random import Random

import cyclonedds.idl as cyclone
from cyclonedds.idl import annotations, types

from rosetta_jit.model.types import Array, Bool, Bytes, Enum, Field, Float, Int, Optional, Ref, Schema, String, Struct, Union

INTEGERS = {
    (8, True): types.int8,
    (8, False): types.uint8,
    (16, True): types.int16,
    (16, False): types.uint16,
    (32, True): types.int32,
    (32, False): types.uint32,
    (64, True): types.int64,
    (64, False): types.uint64,
}
FLOATS = {32: types.float32, 64: types.float64}
EXTENSIBILITY = {"final": annotations.final, "appendable": annotations.appendable, "mutable": annotations.mutable}
NUMBERS = [0.0, -0.0, 1.5, -2.25, math.inf, -math.inf, math.nan, 2.0**-120]
TEXTS = ["", "a", "map", "é€😀", "x" * 33]


@dataclass
class Types:
    """Declarations under way: ours by name, theirs by name, and how values are made."""

    random: Random
    ours: dict = field(default_factory=dict)
    theirs: dict = field(default_factory=dict)

    def struct(self, depth=0):
        """A struct; gives its name."""
        name = f"test::S{len(self.ours)}"
        self.ours[name] = None
        kind = self.random.choice(list(EXTENSIBILITY))
        fields, members = [], {}
        for number in range(self.random.randint(1, 6)):
            type_, theirs = self.type(depth)
            if self.random.random() < 0.2:
                type_, theirs = Optional(type_), typing.Union[theirs, None]  # noqa: UP007 - their classes know no other
            fields.append(Field(f"f{number}", type_, number=number))
            members[f"f{number}"] = theirs
        self.ours[name] = Struct(name, tuple(fields), options=(("extensibility", kind),))
        self.theirs[name] = EXTENSIBILITY[kind](cyclone.make_idl_struct(name.replace("::", "_"), name.replace("::", "."), members))
        return name

    def enum(self):
        name = f"test::E{len(self.ours)}"
        words = {f"W{number}": number for number in range(self.random.randint(1, 4))}
        self.ours[name] = Enum(name, tuple(words.items()))
        self.theirs[name] = cyclone.make_idl_enum(name.replace("::", "_"), name.replace("::", "."), words)
        return name

    def union(self, depth):
        name = f"test::U{len(self.ours)}"
        self.ours[name] = None
        cases, labels, members, label = [], [], {}, 1
        count = self.random.randint(1, 3)
        default = count - 1 if count > 1 and self.random.random() < 0.5 else None
        for number in range(count):
            type_, theirs = self.type(depth + 1)
            own = tuple(range(label, label + self.random.randint(1, 2)))
            label = own[-1] + 1
            members[f"c{number}"] = types.default[theirs] if number == default else types.case[list(own), theirs]
            cases.append(Field(f"c{number}", type_))
            labels.append(() if number == default else own)
        union = Union("_u", tuple(cases), None, "_d", tuple(labels), default)
        self.ours[name] = Struct(name, (Field("_d", Int(32)), Field("_u", union)), options=(("extensibility", "final"),))
        self.theirs[name] = cyclone.make_idl_union(name.replace("::", "_"), name.replace("::", "."), members, types.int32)
        return name

    def type(self, depth):
        """A type, ours and theirs."""
        kinds = ["int", "float", "bool", "string", "sequence", "array", "enum", *(["struct", "union"] if depth < 2 else [])]
        match self.random.choice(kinds):
            case "int":
                bits, signed = self.random.choice(list(INTEGERS))
                return Int(bits, signed), INTEGERS[bits, signed]
            case "float":
                bits = self.random.choice((32, 64))
                return Float(bits), FLOATS[bits]
            case "bool":
                return Bool(), bool
            case "string":
                return String(), str
            case "sequence":
                ours, theirs = self.type(depth + 1)
                return (Bytes() if ours == Int(8, False) else Array(ours)), types.sequence[theirs]
            case "array":
                ours, theirs = self.type(depth + 1)
                length = self.random.randint(1, 3)
                return (Bytes("", length) if ours == Int(8, False) else Array(ours, length)), types.array[theirs, length]
            case "enum":
                name = self.enum()
            case "struct":
                name = self.struct(depth + 1)
            case "union":
                name = self.union(depth + 1)
        return Ref(name), self.theirs[name]

    # --- values ----------------------------------------------------------------------------------------------------

    def value(self, type_):
        """A random value, as theirs and as what our holder's ``to_dict`` gives."""
        match type_:
            case Bool():
                value = self.random.random() < 0.5
                return value, value
            case Int(bits, signed):
                low = -(1 << bits - 1) if signed else 0
                value = self.random.choice([low, low + (1 << bits) - 1, low + self.random.getrandbits(bits), 0])
                return value, value
            case Float():
                value = self.random.choice(NUMBERS)
                return value, value
            case String():
                value = self.random.choice(TEXTS)
                return value, value
            case Bytes(_, length):
                value = self.random.randbytes(self.random.randint(0, 9) if length is None else length)
                return value if length is not None else list(value), value
            case Array(element, length):
                pairs = [self.value(element) for _ in range(self.random.randint(0, 3) if length is None else length)]
                return [theirs for theirs, _ in pairs], [ours for _, ours in pairs]
            case Ref(name):
                return self.declared(self.ours[name], self.theirs[name])
        raise AssertionError(type_)

    def declared(self, ours, theirs):
        if isinstance(ours, Enum):
            word, number = self.random.choice(ours.values)
            return theirs(number), word
        if isinstance(ours.fields[-1].type, Union):
            return self.case(ours.fields[-1].type, theirs)
        values, plain = {}, {}
        for each in ours.fields:
            if isinstance(each.type, Optional) and self.random.random() < 0.5:
                values[each.name] = None
                continue
            type_ = each.type.value if isinstance(each.type, Optional) else each.type
            values[each.name], plain[each.name] = self.value(type_)
        return theirs(**values), plain

    def case(self, union, theirs):
        number = self.random.randrange(len(union.cases))
        label = self.random.choice(union.labels[number]) if union.labels[number] else 77
        value, plain = self.value(union.cases[number].type)
        return theirs(discriminator=label, value=value), {"_d": label, union.cases[number].name: plain}


def random_types(seed):
    """A schema of ours, the name of its message, and what makes values."""
    made = Types(Random(seed))
    name = made.struct()
    return Schema(made.ours), name, made
