"""What a user asks for when making a program, as data: all that the answer depends on besides the files that it names."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any, Literal, cast

from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.runtime.functions.identity import Identity

Direction = Literal["decode", "encode"]
ByteOrder = Literal["little", "big"]
Backend = Literal["numba", "llvm", "python", "interpreter"] | str
"""Ours, or the name of an installed one."""

NO_PARAMETERS = "{}"
"""What a mapping's parameters are where none are given, as JSON."""


@dataclass(frozen=True, slots=True)
class GivenFunction:
    """A function of the user's own, and which one it is. Those without a digest cannot be told from others: see `uncertain`."""

    name: str
    function: Callable[..., Any]
    identity: Identity


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
    parameters
        The values of the mapping's parameters, as JSON.
    functions
        Functions of the user's own that the mapping calls.
    backend
        What runs the kernels; None for LLVM.
    wire
        The name of one of several wires of the mapping; empty for the first of them.
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
    parameters: str = NO_PARAMETERS
    functions: tuple[GivenFunction, ...] = ()
    backend: Backend | None = None
    wire: str | None = None

    def __str__(self) -> str:
        return f"{self.mapping or self.type} ({self.direction})"

    @property
    def values(self) -> Mapping[str, object]:
        """The values of the mapping's parameters, by their names."""
        if self.parameters == NO_PARAMETERS:
            return {}
        import json  # most mappings have none

        return json.loads(self.parameters)

    def is_identified(self) -> bool:
        """Whether the cache can know the answer: a function that is not identified may be another one each time."""
        return all(each.identity.digest is not None for each in self.functions)

    def key(self, environment: Mapping[str, str] = os.environ) -> dict[str, Any]:
        """The request as plain data, with the surroundings that relative names depend on."""
        functions = [[each.name, each.identity.digest] for each in self.functions]
        plain: dict[str, Any] = {name: getattr(self, name) for name in self.__match_args__}
        return {**plain, "functions": functions, "cwd": here(), "path": environment.get("ROSETTA_JIT_PATH", "")}


@dataclass(frozen=True, slots=True)
class BridgeRequest:
    """One bridge: what decodes, and what encodes what was decoded.

    Where one of them has neither mapping nor type, it is the data-holder of the other one, in the encoding of its own framework.
    """

    decode: Request
    encode: Request

    @property
    def functions(self) -> tuple[GivenFunction, ...]:
        """Functions of the user's own that the mappings call."""
        return tuple(dict.fromkeys((*self.decode.functions, *self.encode.functions)))

    def is_identified(self) -> bool:
        """As of a `Request`."""
        return self.decode.is_identified() and self.encode.is_identified()

    def key(self, environment: Mapping[str, str] = os.environ) -> dict[str, Any]:
        """As of a `Request`."""
        return {"bridge": [self.decode.key(environment), self.encode.key(environment)]}

    def __str__(self) -> str:
        return f"{ends(self.decode)} to {ends(self.encode)} (bridge)"


def ends(request: Request) -> str:
    """One side of a bridge, for people."""
    what = request.mapping or request.type or "the same message"
    return what if request.encoding is None else f"{what}, {request.encoding}"


def here() -> str:
    """The folder that relative names start from; empty where it was removed."""
    try:
        return os.getcwd()  # noqa: PTH109 - Path.cwd() imports no less and says no more
    except OSError:
        return ""


def plain_parameters(parameters: Mapping[str, object]) -> str:
    """The values of parameters as JSON; arrays and scalars of numpy are lists and numbers.

    Raises
    ------
    TypeError
        A value is no bool, number, text or list of these.
    """
    if not parameters:
        return NO_PARAMETERS
    import json  # most programs have none

    return json.dumps({name: _plain(name, value) for name, value in parameters.items()}, sort_keys=True)


def _plain(name: str, value: Any) -> Any:
    """A list is looked into once: parameters are lists of scalars."""
    plain: object = value.tolist() if hasattr(value, "tolist") else value
    items: list[object] = list(cast("Iterable[object]", plain)) if isinstance(plain, list | tuple) else [plain]
    if not all(isinstance(item, bool | int | float | str) for item in items):
        raise TypeError(f"parameter {name!r}: a bool, a number, a text, or a list of these is needed, not {type(value).__name__}")
    return items if isinstance(plain, list | tuple) else plain
