"""The content of a function: code, defaults, closure, and of its globals those that the code names, each followed to its end.

A module is followed by the attributes that stand behind its name: of `pkg.consts.K` the content has what `K` is, however many modules are
on the way. Whatever is not known for certain is noted, by the path on which the code reaches it.
"""

from __future__ import annotations

import builtins
import dis
import enum
from collections.abc import Iterator, Mapping, Sequence
from itertools import takewhile
from types import CodeType, FunctionType, ModuleType
from typing import Any, Literal, cast

import numpy as np

from rosetta_jit.catalogue import uncertain as words
from rosetta_jit.runtime.functions import kinds
from rosetta_jit.runtime.functions.known import has_known_attributes, is_known, is_known_dispatcher
from rosetta_jit.runtime.limits import MAX_FUNCTION_DEPTH, MAX_FUNCTION_VALUES, MAX_FUNCTIONS
from rosetta_jit.startup.dataclass import dataclass, field
from rosetta_jit.startup.sha import sha256

_ABSENT = object()


@dataclass(frozen=True, slots=True)
class Content:
    """All that a function can reach.

    Attributes
    ----------
    digest
        Of all of it, if nothing is uncertain.
    uncertain
        What cannot be told for certain, and why.
    dispatchers
        The functions of numba's that it calls, each with the path to it.
    objects
        All objects that were met and are no plain values: what compiled code may have addresses of.
    """

    digest: str
    uncertain: tuple[str, ...]
    dispatchers: tuple[tuple[str, Any], ...]
    objects: tuple[object, ...]


def content_of(callee: object, name: str) -> Content:
    """The content of a function, or of what numba's `njit` made of it; ``name`` begins all paths."""
    walk = _Walk()
    function = python_function(callee)
    walk.items(kinds.options(callee), f"{name}: options of njit")
    walk.function(function, name)
    while walk.pending:
        walk.inside(*walk.pending.pop())
    digest = sha256("".join(f"{len(part)}:{part}" for part in walk.parts).encode("utf-8", "surrogatepass")).hexdigest()
    return Content(digest, tuple(walk.uncertain), tuple(walk.dispatchers), tuple(walk.objects))


def python_function(callee: object) -> FunctionType:
    """The function that Python runs: itself, or what numba's `njit` was put on; raises TypeError where it is neither.

    Another object that has a `py_func` is no such function: `functools.wraps` gives one to what it makes around a function of numba's.
    """
    found = cast("Any", callee).py_func if kinds.is_dispatcher(callee) else callee
    if not isinstance(found, FunctionType):
        raise TypeError(f"a mapping calls Python functions, and those of numba's njit; {type(callee).__name__} is neither")
    return found


@dataclass(slots=True)
class _Walk:
    """What was found so far, and the functions that are still to be looked into."""

    parts: list[str] = field(default_factory=list[str])
    pending: list[tuple[FunctionType, str]] = field(default_factory=list[tuple[FunctionType, str]])
    seen: dict[FunctionType, int] = field(default_factory=dict[FunctionType, int])
    uncertain: dict[str, None] = field(default_factory=dict[str, None])
    dispatchers: list[tuple[str, Any]] = field(default_factory=list[tuple[str, Any]])
    objects: list[object] = field(default_factory=list[object])
    depth: int = 0
    values: int = 0

    def function(self, function: FunctionType, path: str) -> None:
        if function not in self.seen:
            self.seen[function] = len(self.seen)
            if len(self.seen) > MAX_FUNCTIONS:
                self.doubt(words.too_much(path))
            else:
                self.pending.append((function, path))
        self.parts.append(f"function {self.seen[function]}")

    def inside(self, function: FunctionType, path: str) -> None:
        """All that a function consists of, and what its code names."""
        code = function.__code__
        self.code(code, path)
        self.value(function.__defaults__, f"{path}: defaults")
        self.value(tuple(sorted((function.__kwdefaults__ or {}).items())), f"{path}: defaults")
        for name in vars(function):
            if name.startswith("__"):  # `__wrapped__`, `__signature__`, `__numba__`; numba sees no other attribute
                self.doubt(words.own_attribute(f"{path}.{name}"))
        cells = dict(zip(code.co_freevars, function.__closure__ or (), strict=True))
        for use in sorted(set(named(code)), key=lambda use: (use.kind, use.name, use.attributes)):
            self.use(use, cells, function.__globals__, path)

    def code(self, code: CodeType, path: str) -> None:
        counts = code.co_argcount, code.co_posonlyargcount, code.co_kwonlyargcount, code.co_flags
        names = code.co_names, code.co_varnames, code.co_freevars, code.co_cellvars
        self.parts += [code.co_code.hex(), code.co_exceptiontable.hex(), repr(counts), repr(names)]
        for constant in code.co_consts:
            if isinstance(constant, CodeType):
                self.parts.append(f"code {constant.co_name}")
                self.code(constant, path)
            else:
                self.value(constant, f"{path}: a constant")

    def use(self, use: Named, cells: Mapping[str, Any], variables: Mapping[str, Any], path: str) -> None:
        """What a name stands for. A cell that is not the function's own belongs to a function around it, within the same code."""
        self.parts.append(f"{use.kind} {use.name}")
        is_plain_dict = type(cast("object", variables)) is dict  # a class derived from it may give whatever it likes
        if use.kind == "strange" or not is_plain_dict:
            self.doubt(words.strange_name(path, use.name))
        elif use.kind == "global":
            self.chain(variables.get(use.name, vars(builtins).get(use.name, _ABSENT)), use.name, use.attributes)
        elif use.name in cells:
            try:
                self.chain(cells[use.name].cell_contents, use.name, use.attributes)
            except ValueError:
                self.doubt(words.no_such_name(use.name))

    def chain(self, value: object, path: str, attributes: tuple[str, ...]) -> None:
        """A value, from module to module as far as attributes lead."""
        for number, attribute in enumerate(attributes):
            if type(value) is not ModuleType:
                break
            path = f"{path}.{attribute}"
            module, value = value, vars(value).get(attribute, _ABSENT)
            self.parts.append(f"attribute {attribute}")
            if value is _ABSENT and has_known_attributes(module):
                self.parts.append(f"of {module.__name__}: {attributes[number:]}")
                return
        if value is _ABSENT:
            self.doubt(words.no_attribute(path) if "." in path else words.no_such_name(path))
        elif isinstance(value, ModuleType):
            self.doubt(words.module_as_value(path))
        else:
            self.value(value, path)

    def value(self, value: Any, path: str) -> None:
        """A value that numba may compile; what is not known for certain is noted."""
        self.values += 1
        plain = kinds.plain(value)
        if self.depth > MAX_FUNCTION_DEPTH or self.values > MAX_FUNCTION_VALUES:
            self.doubt(words.too_much(path.partition(".")[0]))
        elif plain is not None:
            self.parts.append(f"{type(value).__name__} {plain}")
        elif type(value) is tuple:
            self.items(cast("tuple[object, ...]", value), path)
        elif is_known(value):
            self.parts.append(f"known {type(value).__name__} {getattr(value, '__module__', '')} {getattr(value, '__qualname__', value)}")
        elif type(value) is FunctionType:
            self.doubt(words.plain_function(path))
        elif kinds.is_dispatcher(value):
            self.dispatcher(value, path)
        else:
            self.structure(value, path)

    def items(self, items: tuple[object, ...], path: str) -> None:
        self.parts.append(f"tuple {len(items)}")
        self.depth += 1
        for each in items:
            self.value(each, path)
        self.depth -= 1

    def dispatcher(self, callee: Any, path: str) -> None:
        """A function of numba's that the code calls."""
        if is_known_dispatcher(callee):
            self.parts.append(f"numba's {callee.py_func.__module__}.{callee.py_func.__qualname__}")
        elif kinds.is_ordinary(callee):
            self.dispatchers.append((path, callee))
            self.parts.append("dispatcher")
            self.items(kinds.options(callee), f"{path}: options of njit")
            self.function(python_function(callee), path)
        else:
            self.doubt(words.other_compiler(path))

    def structure(self, value: Any, path: str) -> None:
        """An object that has values in it, if it is of a kind that is known."""
        self.objects.append(value)
        self.parts.append(f"object of {type(value).__module__}.{type(value).__qualname__}")
        if type(value) is np.ndarray and kinds.is_at_its_address(cast("np.ndarray[Any, Any]", value)):
            self.doubt(words.at_its_address(path))
            return
        found = _structure(value)
        if found is None:
            self.doubt(words.unknown_object(path, value))
        else:
            self.items(found, path)

    def doubt(self, why: str) -> None:
        self.uncertain[why] = None


def _structure(value: Any) -> tuple[object, ...] | None:
    """The values in an object; None where its kind is not known."""
    if isinstance(value, enum.EnumType):
        return kinds.enumeration(value)
    if isinstance(value, type):
        is_exception = type(value) is type and issubclass(value, BaseException)
        return ("exception", value.__qualname__) if is_exception else kinds.named_tuple(value)
    if isinstance(value, enum.Enum):
        return kinds.enumeration_member(value)
    if isinstance(value, tuple):
        made = kinds.named_tuple(type(cast("tuple[object, ...]", value)))
        return None if made is None else (made, tuple(cast("tuple[object, ...]", value)))
    if isinstance(value, np.dtype):
        return kinds.dtype(cast("np.dtype[Any]", value))
    if type(value) is np.ndarray:
        return kinds.array(cast("np.ndarray[Any, Any]", value))
    if isinstance(value, np.generic):
        return kinds.scalar(cast("np.generic[Any]", value))
    if type(value) is slice:
        return "slice", value.start, value.stop, value.step
    return kinds.set_of_plain(cast("frozenset[object]", value)) if type(value) is frozenset else None


ATTRIBUTES = frozenset(("LOAD_ATTR", "LOAD_METHOD"))
SILENT = frozenset(("EXTENDED_ARG", "CACHE", "NOP"))
"""Instructions that may stand between a value and the attribute that is taken of it."""

LOCAL = frozenset(("MAKE_CELL", "LOAD_CLOSURE", "STORE_DEREF", "DELETE_DEREF", "STORE_ATTR"))
"""Instructions that have a name and reach nothing outside by it."""

_NAMING = frozenset((*dis.hasname, *dis.hasfree))


@dataclass(frozen=True, slots=True)
class Named:
    """One use of a name: of a global, of a cell of the closure, or in an instruction that is not known."""

    kind: Literal["global", "cell", "strange"]
    name: str
    attributes: tuple[str, ...] = ()


def named(code: CodeType) -> Iterator[Named]:
    """All uses of names, in code and in the code within it.

    `pkg.consts.K * SCALE` names the global `pkg` with the attributes `consts` and `K`, and the global `SCALE`. A name that an unknown
    instruction uses is given as `strange`.
    """
    instructions = [each for each in dis.get_instructions(code) if each.opname not in SILENT]
    for position, instruction in enumerate(instructions):
        if instruction.opcode in _NAMING:
            yield from _use(instructions, position)
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from named(constant)


def _use(instructions: Sequence[dis.Instruction], position: int) -> Iterator[Named]:
    operation, name = instructions[position].opname, str(instructions[position].argval)
    if operation in ("LOAD_GLOBAL", "LOAD_DEREF"):
        following = takewhile(lambda each: each.opname in ATTRIBUTES, instructions[position + 1 :])
        yield Named("global" if operation == "LOAD_GLOBAL" else "cell", name, tuple(str(each.argval) for each in following))
    elif operation not in ATTRIBUTES and operation not in LOCAL:
        yield Named("strange", name)
