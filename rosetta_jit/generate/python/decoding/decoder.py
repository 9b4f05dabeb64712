"""The decoder of a unit: its kernel as functions, and what makes objects of what these find."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from rosetta_jit.generate.c.holder.lanes import Lanes
from rosetta_jit.generate.passes.undamaged import undamaged_kernel
from rosetta_jit.generate.python.decoding.late_objects import late_rows
from rosetta_jit.generate.python.decoding.making import arrays_of
from rosetta_jit.generate.python.decoding.making_late_rows import MakeLate
from rosetta_jit.generate.python.decoding.sparse import OBJECT, attributes_of, begun, settings
from rosetta_jit.generate.python.passes.borrowed import borrowed
from rosetta_jit.generate.python.passes.direct import Direct
from rosetta_jit.generate.python.passes.guards import without_guards
from rosetta_jit.generate.python.printing.functions import is_flat, print_kernel
from rosetta_jit.generate.python.printing.late_lists import late_lists
from rosetta_jit.generate.python.printing.printed import Attempt, Objects
from rosetta_jit.generate.python.printing.scope import Scope
from rosetta_jit.generate.unit import Unit
from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import Advance, Block
from rosetta_jit.kernel.rewrite import with_bodies
from rosetta_jit.kernel.walk import statements
from rosetta_jit.model.layout import Span
from rosetta_jit.model.types import Bytes, Ref
from rosetta_jit.startup.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class _Decoder:
    """The parts of a decoder that make objects; ``names`` are the classes, ``beside`` the functions that make lists, by their text."""

    unit: Unit
    names: Mapping[str, str]
    kernel: Kernel
    beside: dict[str, str] | None

    def make(self, scope: Scope, beside: dict[str, str] | None = None) -> MakeLate:
        return MakeLate(self.unit, scope, self.names, taken_lanes(self.kernel), beside)

    def made(self, scope: Scope, _: str) -> str:
        """The object of the message."""
        if scope.attributes is not None:
            return OBJECT
        return self.make(scope, self.beside).value(Ref(self.unit.type), self.unit.layout.root, 0, "0")

    def inner(self, scope: Scope) -> list[str]:
        """Functions for rows that contain rows of their own type."""
        lines: list[str] = []
        for lane, struct in self.unit.layout.recursive:
            made = self.make(scope).function_of(Ref(struct), lane)
            lines += [f"def made_{scope.lanes.rows(lane)}(index):", *(f"    {line}" for line in made), ""]
        return lines

    def inner_names(self, scope: Scope) -> list[str]:
        return [f"made_{scope.lanes.rows(lane)}" for lane, _ in self.unit.layout.recursive]

    def row(self, scope: Scope, lane: int) -> str:
        """The object of a row that a loop fills."""
        rows = {**arrays_of(self.unit, in_recursive=True), **{lane: Ref(struct) for lane, struct in self.unit.layout.recursive}}
        return self.make(scope).value(rows[lane], self.unit.layout.lanes[lane].element, lane, "")

    def attributes(self, body: Block, settled: frozenset[tuple[int, str]], direct: Direct) -> dict[int, str] | None:
        return attributes_of(self.unit, body, settled, direct)

    def begun(self, scope: Scope) -> list[str]:
        return begun(self.make(scope)) if scope.attributes is not None else []

    def settings(self, scope: Scope) -> list[str]:
        return [*settings(self.make(scope, self.beside))] if scope.attributes is not None else []

    def late_lists(self, scope: Scope) -> tuple[tuple[Span, ...], ...]:
        return late_lists(self.unit, scope)

    def objects(self) -> Objects:
        """What the printers of functions need of all this."""
        in_all, numpy = arrays_of(self.unit, in_recursive=True), self.unit.numpy
        blobs = frozenset(lane for lane, type_ in in_all.items() if isinstance(self.unit.schema.resolve(type_), Bytes))
        lists = frozenset(arrays_of(self.unit)), frozenset(in_all), blobs
        made = self.made, self.attributes, self.begun, self.settings, self.late_lists, self.row, self.inner, self.inner_names
        return Objects(*made, self.unit.layout, *lists, numpy, frozenset(self.names.values()), late_rows(self.unit))


def taken_lanes(kernel: Kernel) -> frozenset[int]:
    """The lanes of which a kernel takes rows."""
    return frozenset(stmt.lane for body in kernel.bodies for stmt, _ in statements(body) if isinstance(stmt, Advance))


def print_decoder(
    unit: Unit, names: Mapping[str, str], lanes: Callable[[Sequence[int]], Lanes], loads: set[str], paths: tuple[str, ...]
) -> tuple[str, tuple[Attempt, ...]]:
    """The functions that read a message, as text, and how they are called."""
    kernel = undamaged_kernel(unit.kernels["borrow"])
    kernel = borrowed(with_bodies(kernel, tuple(map(without_guards, kernel.bodies))), unit.layout)
    all_lanes = lanes(kernel.strides)
    flat = is_flat(kernel, all_lanes)
    decoder = _Decoder(unit, names, kernel, dict[str, str]() if flat and not unit.layout.recursive else None)
    origins = unit.origins.get("borrow", ())
    text, attempts = print_kernel(kernel, all_lanes, "borrow", loads, origins, decoder.objects(), paths, flat=flat)
    functions = [f"\ndef {name}{function}" for function, name in (decoder.beside or {}).items()]
    return "\n\n".join([*functions, f"\n{text.rstrip()}"]), attempts
