"""Manners: how holders of a framework behave."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from rosetta_jit.runtime.attributes.methods import Kind
from rosetta_jit.runtime.holder.classes import Holder
from rosetta_jit.startup.dataclass import dataclass
from rosetta_jit.startup.garbage import object_at


def no_methods(family: Any) -> Mapping[str, Kind]:  # noqa: ARG001  a plain class has none
    """None."""
    return {}


@dataclass(frozen=True, slots=True)
class Manners:
    """How holders of a framework behave.

    Attributes
    ----------
    base : type
        What holder classes inherit from: a subclass of `Holder` without slots of its own.
    array_type : type
        What arrays of numbers are shown as: numpy's class, or a subclass with a slot ``owner_`` for message and field.
    sequence, mapping : str
        What shows arrays of anything else, and maps, given a view and one of its fields, as ``module:name``.
    assigns_whole : bool
        Whether arrays, maps and messages can be assigned to.
    members : callable
        What else the class of a struct has, by name, given its family: constants, nested classes.
    serialising : tuple of str
        Framework and encoding of the base's methods that serialise; with it, ``programs_`` of every holder is what
        `rosetta_jit.runtime.holder.serialising.Programs` says.
    foreign : str
        What is particular about the objects of the framework's own package, as ``module:name`` of a
        `rosetta_jit.runtime.holder.objects.foreign.Foreign`: few processes meet any.
    methods : callable
        Which of the base's methods do nothing but serialise, and how, given the family: compiled code does so where it can.
    place : str
        ``module:name`` of these manners, by which pickles name them; empty if they are pickled by value.
    """

    base: type[Holder]
    array_type: type[np.ndarray[Any, Any]]
    sequence: str
    mapping: str
    assigns_whole: bool
    members: Callable[[Any], dict[str, Any]]
    serialising: tuple[str, str] | None = None
    foreign: str = "rosetta_jit.runtime.holder.objects.foreign:ORDINARY"
    methods: Callable[[Any], Mapping[str, Kind]] = no_methods
    place: str = ""

    def __reduce__(self) -> tuple[Any, ...]:
        """By the place, where there is one."""
        fields = tuple(getattr(self, each) for each in self.__slots__)
        return (manners_at, (self.place,)) if self.place else (Manners, fields)


def no_members(family: Any) -> dict[str, Any]:  # noqa: ARG001  a plain class has nothing but its fields
    """Nothing."""
    return {}


PLAIN = Manners(
    Holder,
    np.ndarray,
    "rosetta_jit.runtime.holder.sequence:Sequence",
    "rosetta_jit.runtime.holder.dictionary:Dictionary",
    assigns_whole=True,
    members=no_members,
    place="rosetta_jit.runtime.holder.manners:PLAIN",
)


def manners_at(place: str) -> Manners:
    """The manners at a place, plain ones for none."""
    return object_at(place) if place else PLAIN
