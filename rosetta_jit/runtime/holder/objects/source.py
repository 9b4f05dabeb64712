"""Functions that are written for one class of objects, and then run: their text, and what it refers to."""

from __future__ import annotations

import keyword
from collections.abc import Callable, Generator
from contextlib import contextmanager
from typing import Any

from rosetta_jit.runtime.limits import MAX_CLASSES


class ByClass(dict[type, Callable[..., Any]]):
    """A function for each class, written when an object of that class first comes, and kept for some."""

    __slots__ = ("make",)

    def __init__(self, make: Callable[[type], Callable[..., Any]]) -> None:
        self.make = make

    def __missing__(self, object_type: type) -> Callable[..., Any]:
        made = self.make(object_type)
        if len(self) < MAX_CLASSES:
            self[object_type] = made
        return made


class Source:
    """The text of a function of two objects, ``target`` and ``source``, and the names that it uses."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.lines: list[str] = []
        self.indent = "    "
        self.scope: dict[str, Any] = {}

    def add(self, line: str) -> None:
        """One more line of its body."""
        self.lines.append(f"{self.indent}{line}")

    @contextmanager
    def indented(self) -> Generator[None]:
        """Around the lines of a block."""
        self.indent += "    "
        yield
        self.indent = self.indent[:-4]

    def name_of(self, value: object) -> str:
        """A name by which the text refers to a value."""
        name = f"_{len(self.scope)}"
        self.scope[name] = value
        return name

    def made(self, parameters: str) -> Callable[..., Any]:
        """The function."""
        text = "\n".join([f"def {self.name}({parameters}):", *(self.lines or ["    pass"])])
        exec(compile(text, f"<{self.name}>", "exec"), self.scope)  # noqa: S102 - ours; names of fields are in it as `attribute` writes them
        return self.scope[self.name]


def attribute(of: str, name: str) -> str:
    """An attribute as Python writes it to read it."""
    return f"{of}.{name}" if is_word(name) else f"getattr({of}, {name!r})"


def assignment(of: str, name: str, value: str) -> str:
    """An attribute as Python writes it to set it."""
    return f"{of}.{name} = {value}" if is_word(name) else f"setattr({of}, {name!r}, {value})"


def is_word(name: str) -> bool:
    """Whether a name can stand behind a dot: `__debug__` is no keyword and no attribute, and within no class are names of two leading
    underscores others.
    """
    return name.isascii() and name.isidentifier() and not keyword.iskeyword(name) and name != "__debug__"
