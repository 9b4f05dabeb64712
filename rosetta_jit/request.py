"""What a user asks for when making a program, as data: all that the answer depends on besides the files that it names."""

from __future__ import annotations

import os
from dataclasses import asdict, replace
from typing import TYPE_CHECKING, Any, Literal

from rosetta_jit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

Direction = Literal["decode", "encode"]
ByteOrder = Literal["little", "big"]
Backend = Literal["numba", "llvm", "python", "interpreter"]


@dataclass(frozen=True, slots=True)
class GivenFunction:
    """A function of the user's own. The digest changes with whatever it computes."""

    name: str
    digest: str
    function: Callable[..., Any]


@dataclass(frozen=True, slots=True)
class Request:
    """One program.

    Attributes
    ----------
    mapping
        Path or name of a mapping; None for a type into its own holder.
    type
        Qualified name of that type.
    encoding
        Name of the encoding; None for the framework's usual one.
    imports
        IDL files, by their names on the search path.
    files
        Names and texts, as if they lay on the search path.
    plain
        A type that came as descriptors: as `rosetta_jit.model.serial` writes it.
    framework
        The framework whose type it is, where its name, its file or the encoding do not tell.
    folders
        The user's search path.
    borrow
        Bytes fields of decoded holders are views into the message.
    byte_order
        None for the usual one, or for either, where messages say which it is.
    lenient
        What the encoding is asked to forgive, by name.
    functions
        Functions of the user's own that the mapping calls.
    backend
        What runs the kernels; None for LLVM.
    """

    direction: Direction
    mapping: str | None = None
    type: str | None = None
    encoding: str | None = None
    imports: tuple[str, ...] = ()
    files: tuple[tuple[str, str], ...] = ()
    plain: str | None = None
    framework: str | None = None
    folders: tuple[str, ...] = ()
    borrow: bool = False
    byte_order: ByteOrder | None = None
    lenient: tuple[str, ...] = ()
    functions: tuple[GivenFunction, ...] = ()
    backend: Backend | None = None

    def key(self, environment: Mapping[str, str] = os.environ) -> dict[str, Any]:
        """The request as plain data, with the surroundings that relative names depend on."""
        functions = [[each.name, each.digest] for each in self.functions]
        plain = asdict(replace(self, functions=()))
        return {**plain, "functions": functions, "cwd": os.getcwd(), "path": environment.get("ROSETTA_JIT_PATH", "")}  # noqa: PTH109 - Path.cwd() imports no less and says no more
