"""The accessors as code: the text of LLVM, and what it becomes, which the cache keeps."""

from __future__ import annotations

import ctypes
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache, partial
from typing import Any, cast

from rosetta_jit.errors import warn
from rosetta_jit.runtime.attributes.groups import END, GROUPS, Group, group_of, symbols
from rosetta_jit.runtime.cache.texts import kept, known
from rosetta_jit.runtime.callable import is_native
from rosetta_jit.runtime.cells import SCALARS
from rosetta_jit.runtime.code import native
from rosetta_jit.runtime.code.allowed import ForeignCodeError
from rosetta_jit.runtime.code.lazy import Stubs, is_supported
from rosetta_jit.runtime.code.native import Library
from rosetta_jit.runtime.type_specs import function_of, read_word, size_with_weak_list, weak_list_offset

FILES = (
    *("shared/message.ll", "shared/boxes.ll"),
    *("fields/content.ll", "fields/nested.ll", "fields/sequence.ll"),
    *("fields/writing.ll", "fields/writing_numbers.ll", "fields/writing_texts.ll"),
    *("holders/making.ll", "holders/ending.ll", "holders/sameness.ll"),
    *("programs/methods.ll", "programs/handing.ll", "programs/filling.ll", "objects/taking.ll"),
)
"""All but the templates."""

SYMBOLS = tuple(symbols())
"""What the library defines."""

ALL = "all accessors"
"""What names the code of all groups together in the cache."""

HEAP_TYPE_BYTES: int = cast("Any", type).__basicsize__
"""The size of a class that a class statement makes, in bytes. Behind it lies what a class of its own class has besides."""

ASCII_FLAGS = 0x60
"""The flags `compact` and `ascii` of a str (Include/cpython/unicodeobject.h): its characters are bytes that lie behind its head."""

ASCII_BYTES = sys.getsizeof("a") - 2
"""The size of that head."""

MESSAGE_SLOTS_END, LANES_SLOTS_END = 104, 152
"""Where in a message (`holder.message.Message`) and in lanes (`runtime.lanes.Lanes`) the slots end that all of them have."""


def _has_ascii_flags() -> bool:
    """Whether texts of this Python are as that header of CPython 3.11 to 3.13 has them."""
    if not is_native():
        return False
    plain, others = ("", "a", "ab" * 9, str(12345)), ("\x80", "\xe9" * 9, "\u6f22", "a\U0001f680")
    flags = [read_word(id(each) + 32) & 0xFFFFFFFF & ASCII_FLAGS for each in (*plain, *others)]
    return all(each == ASCII_FLAGS for each in flags[: len(plain)]) and ASCII_FLAGS not in flags[len(plain) :]


OFFSETS = {
    "ASCII_BYTES": ASCII_BYTES,
    "ASCII_FLAGS": ASCII_FLAGS,
    "ASCII_KIND": ASCII_FLAGS if _has_ascii_flags() else ~ASCII_FLAGS,
    "HEAP_TYPE_BYTES": HEAP_TYPE_BYTES,
    "NAMES_AT": HEAP_TYPE_BYTES + 8,
    "MESSAGE_END": size_with_weak_list(MESSAGE_SLOTS_END),
    "MESSAGE_WEAK_LIST": weak_list_offset(MESSAGE_SLOTS_END),
    "LANES_WEAK_LIST": weak_list_offset(LANES_SLOTS_END),
}
"""Offsets that differ between versions of CPython, by the names that the text has for them."""

CELLS = {"bool": "i8", "f32": "float", "f64": "double"}
"""LLVM's type of a scalar in memory, where it is not an integer of that size."""


class Accessors:
    """The addresses of the accessors, which are good as long as the process lives.

    What the cache has is loaded when its address is first asked for. All else has that of a stub (`runtime.code.lazy`), whose first call
    compiles its group.
    """

    def __init__(self) -> None:
        self._loaded: list[Library] = []
        self._awaited: dict[str, Callable[[int], None]] = {}
        self._looked_for = set[Group]()
        self._direct: dict[str, int] = {}
        self._first_end = 0
        finders = {symbol: partial(self.make, group_of(symbol)) for symbol in SYMBOLS if symbol != END}
        self._stubs = Stubs(finders, {name: -1 for name in finders if name.startswith("set_") or name == "length"})

    def __getitem__(self, symbol: str) -> int:
        if symbol not in self._direct:
            self._look_for(symbol)
        if symbol == END and not self._first_end:
            self.make(group_of(symbol))
        return self._direct.get(symbol) or (self._first_end if symbol == END else self._stubs[symbol])

    def has(self, symbol: str) -> bool:
        """Whether there is code for an accessor, here or in the cache."""
        if not self._is_loaded(symbol):
            self._look_for(symbol)
        return self._is_loaded(symbol)

    def _is_loaded(self, symbol: str) -> bool:
        return any(symbol in library.addresses for library in tuple(self._loaded))

    def when_there(self, symbol: str, do: Callable[[int], None]) -> None:
        """Give the address of an accessor's code to a function as soon as there is some, perhaps more than once; of several functions for
        one accessor, to the last.
        """
        self._awaited[symbol] = do  # before it is asked: another thread may be compiling it
        if self.has(symbol):
            self._tell(symbol)

    def _tell(self, symbol: str) -> None:
        do = self._awaited.pop(symbol, None)
        if do is not None:
            do(self[symbol])

    def _look_for(self, symbol: str) -> None:
        """Take the groups that have a symbol from the cache, which is asked once for each."""
        for group in GROUPS:
            if symbol in group.symbols and group not in self._looked_for:
                image = known(_name(group))
                if image is not None:
                    self._take(group, image)
                self._looked_for.add(group)

    def make(self, group: Group) -> None:
        """Compile a group. Threads may do so at once: the code of each of them is as good, and stays."""

        def compiled() -> bytes:
            return assembled(text(), group.symbols, hurried=group.hurried)

        self._take(group, kept("accessors", _name(group), compiled))

    def _take(self, group: Group, image: bytes) -> None:
        library = native.load(image, group.symbols)
        self._loaded.append(library)
        for symbol in group.symbols:
            if symbol == END:
                self._first_end = self._first_end or library[symbol]
            else:
                self._stubs.bind(symbol, library[symbol])
            if not group.hurried:
                self._direct[symbol] = library[symbol]
        for symbol in group.symbols:
            self._tell(symbol)


def _name(group: Group) -> str:
    """The kind under which the cache keeps a group's code; the name of the file depends on our sources, too."""
    return f"accessors: {group.name}"


@cache
def library() -> Accessors | Library | None:
    """The accessors, loaded; None where Python is none that they know, or its memory cannot be executed.

    They are bound lazily where that is supported, unless the cache has all of them together.
    """
    if not is_native():
        return None
    try:
        image = known(ALL)
        code = native.load(image, SYMBOLS) if image is not None else Accessors() if is_supported() else whole()
    except ForeignCodeError as error:
        warn(f"attributes of messages are read in Python, which takes ten times as long: {error}", RuntimeWarning)
        return None
    ctypes.pythonapi.Py_IncRef(ctypes.py_object(code))  # objects that end when Python does still call the code
    return code


def is_compiled(symbol: str) -> bool:
    """Whether an accessor has code; where not, what is done a few times takes less time in Python than to compile it."""
    code = library()
    return code is not None and (isinstance(code, Library) or code.has(symbol))


def when_there(symbol: str, do: Callable[[int], None]) -> None:
    """Give the address of an accessor's code to a function: now, or when it is compiled."""
    code = library()
    assert code is not None, "there are accessors"
    if isinstance(code, Library):
        do(code[symbol])
    else:
        code.when_there(symbol, do)


def make_ready() -> None:
    """Compile all accessors now, into the cache, so that no later process has to: together, in half of the time that their groups take."""
    if library() is not None:
        whole()


def whole() -> Library:
    """All accessors at once: for later processes, and for systems without lazy binding."""
    return native.load(kept("accessors", ALL, lambda: assembled(text(), SYMBOLS)), SYMBOLS)


class _Functions(dict[str, Callable[..., Any]]):
    """The functions of the library that Python calls, as built-in functions; each is made when it is first called."""

    __slots__ = ()

    def __missing__(self, name: str) -> Callable[..., Any]:
        code = library()
        assert code is not None, "there are accessors"
        made = self[name] = function_of(name, code[name])
        return made


@cache
def functions() -> Mapping[str, Callable[..., Any]]:
    """What Python calls of the library, by name."""
    return _Functions()


def assembled(module: str, exported: Sequence[str], *, hurried: bool = False) -> bytes:
    """Code of a module; to make it, LLVM is imported."""
    from rosetta_jit.runtime.code import assembler

    return assembler.assembled(module, exported, hurried=hurried)


@cache
def text() -> str:
    """The module."""
    from string import Template  # slow to import

    shared = "\n".join(_read(file) for file in (*FILES, _integers(), "holders/calling.ll"))
    return "\n".join([Template(shared).substitute(OFFSETS), *_scalars()])


def _integers() -> str:
    """How integers are made: those of the one Python whose layout of them is known are given out again."""
    known = sys.version_info[:2] == (3, 11) and (sys.int_info.bits_per_digit, sys.int_info.sizeof_digit) == (30, 4)
    return "shared/integers_again.ll" if known else "shared/integers.ll"


def _scalars() -> Iterator[str]:
    from string import Template

    template = Template(_read("fields/scalar.ll"))
    for name in SCALARS:
        yield template.substitute(_conversions(name), NAME=name)


def _conversions(name: str) -> dict[str, str]:
    """How a scalar becomes one of Python's, and back. An integer that does not come back as it was is out of range; floats are rounded."""
    cell = CELLS.get(name, f"i{name[1:]}")
    match name[0]:
        case "b":
            box, wide = "bool", "i8"
        case "f":
            box, wide = "float", "double"
        case _:
            box, wide = "signed" if name[0] == "i" else "unsigned", "i64"
    if cell == wide:
        widen, narrow = f"bitcast {cell} %cell to {cell}", f"bitcast {cell} %wide to {cell}"
    elif box == "float":
        widen, narrow = "fpext float %cell to double", "fptrunc double %wide to float"
    else:
        widen, narrow = f"{'sext' if box == 'signed' else 'zext'} {cell} %cell to i64", f"trunc i64 %wide to {cell}"
    unbox = "unbox_real" if box == "float" else f"unbox_{box}"
    fits = "icmp eq i64 %back, %wide" if wide == "i64" else "icmp eq i1 true, true"
    return {"CELL": cell, "WIDE": wide, "BOX": box, "WIDEN": widen, "NARROW": narrow, "BACK": widen, "FITS": fits, "UNBOX": unbox}


def _read(file: str) -> str:
    from pathlib import Path  # slow to import

    return (Path(__file__).parent / file).read_text("utf-8")
