"""What a language prints: the kernels of one holder type, what they were made from, and how its lanes lie."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Literal, cast

from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import Scalar
from rosetta_jit.model.layout import Layout
from rosetta_jit.model.types import Schema
from rosetta_jit.startup.dataclass import dataclass, field

if TYPE_CHECKING:
    from rosetta_jit.generate.origins import Origin
    from rosetta_jit.generate.shares import Ways

MADE = "Made by rosetta-jit. Changes will be lost."
"""The first line of the files of a unit, as a comment: what has it may be replaced."""

Purpose = Literal["decode", "borrow", "encode", "size"]
"""What a kernel does; `borrow` decodes and leaves bytes in the message."""

Role = str
"""What a kernel is for: its kind, or `decode_WIRE` where it decodes the messages of one of several wires."""


def kind_of(role: Role) -> Purpose:
    """What the kernel of a role does."""
    return cast("Purpose", role.partition("_")[0])


def wire_of(role: Role) -> str:
    """The wire whose messages the kernel of a role decodes; empty where the mapping has one, without a name."""
    return role.partition("_")[2]


@dataclass(frozen=True, slots=True)
class UserFunction:
    """A function that the mapping declares, and that whoever uses the source must write."""

    name: str
    parameters: tuple[Scalar, ...]
    result: Scalar


@dataclass(frozen=True, slots=True)
class Unit:
    """Everything about one pair of files.

    Attributes
    ----------
    name
        Of the files, and what begins all names in them; `Language.may_name` says that it can.
    made_from
        Lines for a person: the mapping and its rules, or the type, and the encoding.
    layout
        Where the holder's fields lie, structs within structs padded.
    bounds
        How many rows of each lane a message can need; None where nothing bounds them.
    freestanding
        Only headers that a compiler has without a C library are included.
    type, schema, framework
        The holder's type, what declares it, and the framework whose IDL does.
    holder, include
        Which classes are filled, and the header that declares them, where the user says so.
    state
        The state variables of the mapping, in the order of registers, and the words that they are at first.
    announced
        What transports call the type of the messages: protobuf's with a dot in front.
    numpy
        Arrays of numbers are numpy's, where the language has them.
    arrivals
        For each of several wires the registers that have the number of the last message of all, and of its own last one.
    shares
        For each decoder of one of several wires the fields that its messages fill.
    origins
        Which fields of the holder the rules of the mapping name, for each kernel.
    """

    name: str
    made_from: tuple[str, ...]
    layout: Layout
    bounds: tuple[int | None, ...]
    kernels: Mapping[Role, Kernel]
    functions: tuple[UserFunction, ...] = ()
    freestanding: bool = False
    type: str = ""
    schema: Schema = field(default_factory=lambda: Schema({}))
    holder: str = ""
    include: str = ""
    origins: Mapping[Role, tuple[Origin, ...]] = field(default_factory=dict["Role", "tuple[Origin, ...]"])
    state: tuple[tuple[str, int], ...] = ()
    numpy: bool = False
    arrivals: Mapping[str, tuple[int, int]] = field(default_factory=dict[str, "tuple[int, int]"])
    shares: Mapping[Role, Ways] = field(default_factory=dict["Role", "Ways"])
    framework: str = ""
    announced: str = ""


def wires_of(unit: Unit) -> list[str]:
    """The wires, if there are several, whose messages are decoded."""
    return [wire for role in unit.kernels if (wire := wire_of(role))]
