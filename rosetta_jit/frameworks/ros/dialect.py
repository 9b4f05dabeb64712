"""What differs between the `.msg`, `.srv` and `.action` files of ROS 1 and of ROS 2."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import TYPE_CHECKING

from rosetta_jit.model.types import Bool, Field, Float, Int, String, Struct
from rosetta_jit.startup.dataclass import dataclass, field

if TYPE_CHECKING:
    Scalar = Bool | Int | Float | String


@dataclass(frozen=True, slots=True)
class Rule:
    """How names of one kind look: a pattern, and the same in words."""

    pattern: re.Pattern[str]
    words: str

    def allows(self, name: str) -> bool:
        """Whether a name is one of these."""
        return self.pattern.fullmatch(name) is not None


@dataclass(frozen=True, slots=True)
class Interface:
    """The messages that a file of another kind declares: a service, an action. ``{}`` in names and texts is the file's own name.

    Attributes
    ----------
    parts
        The names of the messages in the text, between lines of ``---``.
    added
        The names and texts of messages that peers make for them.
    """

    parts: tuple[str, ...]
    added: Mapping[str, str] = field(default_factory=dict[str, str])


@dataclass(frozen=True, slots=True)
class Dialect:
    """One of the two languages.

    Attributes
    ----------
    name
        Of the framework, and of the folder in which its definitions are shipped.
    qualified
        The name of a message, made from ``package``, ``folder`` and ``name``.
    scalars
        What the builtin words mean.
    octets
        Those of them whose arrays are bytes.
    structs
        Builtin words that are structs.
    aliases
        Words that stand for a message of a certain package.
    usual
        Words that stand for one where the package around has no message of that name.
    line_ends
        Where a line ends, as the peer splits them.
    truths
        The words for true and false, in lower case if case does not matter.
    extended
        Defaults, bounds, `@optional` and quoted strings; a string constant of the other language goes to the end of its line.
    interfaces
        What there is besides messages, by folder, which is also the suffix of the files.
    dashes
        A line between two messages of these.
    foreign
        The suffix of files of another IDL in which messages may be declared, too.
    empty
        The fields of a message without any: rosidl gives it one, which is on the wire and can hold anything.
    """

    name: str
    qualified: str
    scalars: Mapping[str, Scalar]
    octets: frozenset[str]
    packages: Rule
    messages: Rule
    fields: Rule
    constants: Rule
    integers: re.Pattern[str]
    line_ends: re.Pattern[str]
    dashes: re.Pattern[str]
    extended: bool
    structs: Mapping[str, Struct] = field(default_factory=dict[str, "Struct"])
    aliases: Mapping[str, str] = field(default_factory=dict[str, str])
    usual: Mapping[str, str] = field(default_factory=dict[str, str])
    interfaces: Mapping[str, Interface] = field(default_factory=dict[str, Interface])
    foreign: str = ""
    empty: tuple[Field, ...] = ()

    def message(self, package: str, name: str, folder: str = "msg") -> str:
        """The qualified name of a message; a package that is not known is left out."""
        return self.qualified.format(package=package, folder=folder, name=name) if package else name
