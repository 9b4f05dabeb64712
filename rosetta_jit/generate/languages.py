"""The languages that programs can be generated in: values, as frameworks are. A language prints a `Unit`; it decides nothing."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from functools import cache
from typing import TYPE_CHECKING, cast

from rosetta_jit.startup.dataclass import dataclass
from rosetta_jit.startup.entry_points import loaded
from rosetta_jit.startup.garbage import object_at

if TYPE_CHECKING:
    from rosetta_jit.generate.unit import Role, Unit

    Files = Callable[[Unit], dict[str, str]]
    """From a unit to the texts of its files by their names."""

HEADERS = frozenset(
    """assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp signal stdalign stdarg stdatomic stdbool stddef
    stdint stdio stdlib stdnoreturn string tgmath threads time uchar wchar wctype""".split()  # noqa: SIM905 - nobody reads 29 quoted words
)
"""Headers of C11, 7.1.2: who includes one of these must not find ours."""

GROUP = "rosetta_jit.languages"
"""The entry-point group in which packages offer languages of their own: a `Language` each."""


@dataclass(frozen=True, slots=True)
class Language:
    """One language.

    Attributes
    ----------
    name
        What it is asked for by.
    summary
        One line for who chooses.
    printer
        The function that prints units, from a `Unit` to texts by the names of files, as ``module:name``.
    borrows
        Its decoders leave bytes in the message, from where the code around them takes them.
    low_byte_first
        What it prints need not run on machines whose numbers have their high byte first.
    fills_objects
        What it prints is such, and the code around its decoders takes texts from the message, too. The code around its encoders makes rows
        of objects, those of what an object contains after its own.
    makes_objects
        What it prints is such, too, and makes an object in each round of a loop: loops that fill structs with lists are not written out.
    freestanding
        What it prints can do without the language's library.
    holders
        It can fill classes that headers declare, besides its own.
    numpy
        Its arrays of numbers can be numpy's.
    wires
        Its decoders of several wires fill one holder.
    also_in_names
        What the names of units may have besides letters, digits and underscores.
    taken
        A set of names that no unit may have, as ``module:name``: words of the language, and modules that a file would hide.
    """

    name: str
    summary: str
    printer: str
    borrows: bool = False
    low_byte_first: bool = False
    fills_objects: bool = False
    makes_objects: bool = False
    freestanding: bool = False
    holders: bool = False
    numpy: bool = False
    wires: bool = False
    also_in_names: str = ""
    taken: str = ""

    def may_name(self, name: str) -> bool:
        """Whether a unit may be called so."""
        is_name = re.fullmatch(f"[A-Za-z][A-Za-z0-9_{re.escape(self.also_in_names)}]{{0,39}}", name) is not None
        is_taken = name in HEADERS or (self.taken != "" and name in cast("frozenset[str]", object_at(self.taken)))
        return is_name and not is_taken

    def roles(self, wanted: tuple[Role, ...]) -> tuple[Role, ...]:
        """The kernels that the printer needs for what is wanted."""
        return tuple(dict.fromkeys("borrow" if each == "decode" and self.borrows else each for each in wanted))

    def shown(self, role: Role) -> str:
        """What a kernel does to who calls the unit."""
        return "decode" if role == "borrow" and self.borrows else role

    def files(self, unit: Unit) -> dict[str, str]:
        """The texts of a unit's files by their names."""
        return cast("Files", object_at(self.printer))(unit)


LANGUAGES = (
    Language(
        "python",
        "one module of dataclasses",
        "rosetta_jit.generate.python.language:files",
        borrows=True,
        makes_objects=True,
        numpy=True,
        wires=True,
        taken="rosetta_jit.generate.python.printing.classes:NOT_MODULES",
    ),
    Language(
        "c",
        "C11: NAME.h and NAME.c, without allocation, globals or dependencies",
        "rosetta_jit.generate.c.language:files",
        freestanding=True,
        wires=True,
    ),
    Language(
        "cpp",
        "C++17: NAME.hpp and NAME.cpp, which fill classes",
        "rosetta_jit.generate.cpp.language:files",
        borrows=True,
        low_byte_first=True,
        fills_objects=True,
        holders=True,
        wires=True,
        taken="rosetta_jit.generate.cpp.objects.names:NOT_NAMESPACES",
    ),
    Language(
        "lisp",
        "Common Lisp: an ASDF system of classes, for SBCL",
        "rosetta_jit.generate.lisp.language:files",
        borrows=True,
        low_byte_first=True,
        wires=True,
        also_in_names="-",
    ),
)


@cache
def installed() -> Mapping[str, Language]:
    """Every language by name: ours, whose place none takes, and those of installed packages."""
    offers = cast("tuple[Language, ...]", loaded(GROUP))
    ours = {each.name: each for each in LANGUAGES}
    return ours | {each.name: each for each in offers if each.name not in ours}


def language_named(name: str) -> Language | None:
    """The language of a name, or None. Packages are looked at where it is none of ours: one that is broken says nothing about others."""
    ours = next((each for each in LANGUAGES if each.name == name), None)
    return ours or installed().get(name)
