"""Loops of an encoder that joins parts: through the elements of arrays and maps, each of which is taken apart where the loop begins."""

from __future__ import annotations

import re
from collections import Counter

from rosetta_jit.generate.python.encoding.flags import Flags, flags_of
from rosetta_jit.generate.python.encoding.messages_in_parts import Messages
from rosetta_jit.generate.python.encoding.object_rows import Listed
from rosetta_jit.generate.python.passes.bools import Bools, bools_written
from rosetta_jit.generate.python.passes.groups import turned
from rosetta_jit.generate.python.passes.nested_arrays import MANY, Nested, nested_of
from rosetta_jit.generate.python.passes.positions import NotInParts, Sum, known_width
from rosetta_jit.generate.python.printing.classes import member_names
from rosetta_jit.generate.python.printing.scope import CODES
from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.terms import index
from rosetta_jit.kernel.walk import expressions_of, statements, subexpressions
from rosetta_jit.model.layout import Number
from rosetta_jit.model.types import Array, Struct


class Loops(Messages):
    """Prints loops; ``block`` prints the statements in them, ``reads`` says how often anything reads a local.

    ``in_nested`` is whether the loop at hand is within one through arrays of which numpy joins all.
    """

    reads: Counter[str]
    in_nested = False

    def block(self, block: nodes.Block) -> None:
        """The statements of a block."""
        raise NotImplementedError

    def _for(self, loop: nodes.For) -> None:
        if self._at_once(loop):
            return
        width = known_width(loop.body)
        self.flush()
        outer = self.positions.at
        holds = self.positions.loop(stmt.name for stmt, _ in statements(loop.body) if isinstance(stmt, nodes.Assign))
        self.positions.values[loop.variable] = self.positions.new()
        if holds is None:
            self.positions.at = outer.plus(self.positions.values[loop.variable], width)
        begin = self.positions.at
        exact, objects = dict(self.exact), dict(self.scope.objects)
        self._check_numbers(loop)
        nested = nested_of(loop, self.function.read) if self.unit.numpy and not self.in_nested else None
        self.in_nested |= nested is not None
        lines = self.function.writer.lines
        before = len(lines)
        with self.function.writer.indented(self._head(loop, is_counted=True)):
            self._rows(loop)
            self.block(loop.body)
            self.flush()
        if not any(re.search(rf"\b{self.scope.locals.identifier(loop.variable)}\b", line) for line in lines[before + 1 :]):
            lines[before] = lines[before][: -len(lines[before].lstrip())] + f"{self._head(loop, is_counted=False)}"
            before -= nested is None and self._without_count(loop, before)
        if len(lines) == before + 1:
            lines.pop()  # the loop does nothing
        elif (flags := flags_of(loop)) is not None and (sequence := self._sequence_of_flags(loop, flags)) is not None:
            del lines[before:]
            self.line(f"{self.list_name} += [{flags.true!r} if each else {flags.false!r} for each in {sequence.local}]")
        elif nested is not None and isinstance((slot := self.unit.layout.lanes[nested.lane].element), Number):
            self._nested(nested, slot.scalar, loop, before)
        self.in_nested &= nested is None
        self.exact, self.scope.objects = exact, objects
        self._end(holds, begin, width)
        if holds is None:
            self.positions.at = outer.plus(self.positions.sum(loop.count), width)

    def _nested(self, nested: Nested, scalar: str, loop: nodes.For, at: int) -> None:
        """Ask numpy for all numbers of a loop, whose lines begin ``at``, before it."""
        writer, sequence = self.function.writer, self._sequence_of(loop)
        rows = None if sequence is None else self._arrays_of(sequence)
        if rows is None or self.scope.sequences[nested.lane].element is None:
            return
        lines, own = writer.lines[at:], self.binder.local("rows")
        del writer.lines[at:]
        shape = ", ".join(self.function.text(each) for each in nested.lengths)
        is_bool = ", is_bool=True" if scalar == "bool" else ""
        asked = "" if isinstance(loop.count, nodes.Const) else f" if {self.function.text(loop.count)} >= {MANY} else None"
        self.line(f"{own} = _table({self.scope.dtype(scalar, nested.order)}, {rows}, ({shape}){is_bool}){asked}")
        with writer.indented(f"if {own} is not None:"):
            self.line(f"{self.list_name}.append({own})")
        self.line("else:")
        writer.lines += [f"    {line}" for line in lines]

    def _arrays_of(self, sequence: Listed) -> str | None:
        """The arrays of an array, if its elements are arrays, or structs that have one and nothing else; no array of structs within."""
        assert sequence.element is not None
        type_, path = self.unit.schema.resolve(sequence.element), ""
        while isinstance(type_, Struct) and len(type_.fields) == 1:
            path += f".{member_names(type_)[0]}"
            type_ = self.unit.schema.resolve(type_.fields[0].type)
        while isinstance(type_, Array):
            type_ = self.unit.schema.resolve(type_.element)
        if isinstance(type_, Struct):
            return None
        return f"(each{path} for each in {sequence.local})" if path else sequence.local

    def _without_count(self, loop: nodes.For, at: int) -> bool:
        """Leave out the line above a loop which says how many rounds it has, where nothing else needs that."""
        lines, sequence = self.function.writer.lines, self._sequence_of(loop)
        is_needed = sequence is None or not isinstance(loop.count, nodes.Local) or self.reads[loop.count.name] > 1
        if is_needed or not at or not lines[at - 1].lstrip().startswith(f"{self.function.text(loop.count)} = len("):
            return False
        del lines[at - 1]
        return True

    def _check_numbers(self, loop: nodes.For) -> None:
        """Integers of an array fit their field, which is seen of all of them before a loop goes through them; numpy's become Python's."""
        in_all = [(stmt, expr) for stmt, _ in statements(loop.body) for expr in expressions_of(stmt)]
        parts = [(stmt, part) for stmt, expr in in_all for part in subexpressions(expr) if isinstance(part, nodes.Get)]
        lanes = {part.place.lane for _, part in parts if part.place.row != index(0)}
        computed = {part.place.lane for stmt, part in parts if not (isinstance(stmt, nodes.Store) and stmt.value == part)}
        for lane in sorted(lanes):
            sequence = self.scope.sequences.get(lane)
            if sequence is None or not isinstance(sequence.slot, Number) or sequence.element is None:
                continue
            scalar, own = sequence.slot.scalar, sequence.local
            if scalar[0] in "iu" and lane in computed:
                numbers = f"_integers({self.scope.dtype(scalar)}, {own})" if self.unit.numpy else f'_fitting("{CODES[scalar]}", {own})'
                self.line(f"{own} = {numbers}")
                self.scope.integers.add(lane)
            elif self.unit.numpy:
                self.line(f"{own} = _few({own})")

    def _end(self, holds: str | None, begin: Sum, width: int) -> None:
        now = self.positions.at
        if (begin.plus(Sum(width)) if holds is None else self.positions.values[holds]) != now:
            raise NotInParts
        if holds is not None:
            self.positions.at = self.positions.values[holds] = self.positions.new()

    def _sequence_of(self, loop: nodes.For) -> Listed | None:
        """What a loop over rows goes through."""
        parts = [part for stmt, _ in statements(loop.body) for expr in expressions_of(stmt) for part in subexpressions(expr)]
        round_ = nodes.Local("i64", loop.variable)
        found = {part.place.lane for part in parts if isinstance(part, nodes.Get) and self.scope.behind(part.place) == round_}
        rows = [self.scope.sequences[lane] for lane in found if not isinstance(self.scope.sequences[lane].slot, Number)]
        if len(rows) > 1 or (rows and not self._is_count_of(rows[0].lane, loop.count)):
            raise NotInParts
        return rows[0] if rows else None

    def _sequence_of_flags(self, loop: nodes.For, flags: Flags) -> Listed | None:
        """The bools that a loop writes, if those are all of a sequence."""
        is_round = self.scope.behind(flags.place) == nodes.Local("i64", loop.variable)
        return self.scope.sequences.get(flags.place.lane) if is_round and self._is_count_of(flags.place.lane, loop.count) else None

    def _head(self, loop: nodes.For, *, is_counted: bool) -> str:
        sequence, own = self._sequence_of(loop), self.scope.locals.identifier(loop.variable)
        if sequence is None:
            return f"for {own} in range({self.function.text(loop.count)}):"
        rows, elements = ", ".join(self._row_names(loop, sequence)), f"{sequence.local}.items()" if sequence.is_map else sequence.local
        if not is_counted:
            return f"for {rows} in {elements}:"
        return f"for {own}, {f'({rows})' if sequence.is_map else rows} in enumerate({elements}):"

    def _row_names(self, loop: nodes.For, sequence: Listed) -> list[str]:
        """The locals for an element, or for key and value of a map."""
        return [
            self.scope.locals.identifier(f"{each}\0{loop.variable}") for each in (("key", "value") if sequence.is_map else ("element",))
        ]

    def _rows(self, loop: nodes.For) -> None:
        sequence = self._sequence_of(loop)
        if sequence is None:
            return
        assert sequence.element is not None
        start = next(name for name, lane in self.scope.starts.items() if lane == sequence.lane)
        row = nodes.Binary("add", nodes.Local("i64", start), nodes.Local("i64", loop.variable))
        names = self._row_names(loop, sequence)
        if not sequence.is_map and self.unit.layout.lanes[sequence.lane].links is not None:
            self.scope.messages[sequence.lane, row] = names[0]
        elif sequence.is_map:
            self.at_entry = True
            self.binder.bind_entry(sequence, row, names)
        else:
            self.binder.bind(sequence.lane, row, names[0], sequence.element, sequence.slot)

    def _at_once(self, loop: nodes.For) -> bool:
        """Write the numbers of an array by one call, if a loop does nothing else."""
        found, bools = turned(loop), bools_written(loop)
        if found is not None and isinstance(loop.body[-1], nodes.Store) and self._has_numbers(found[0].lane):
            self._turned(loop, *found)
            return True
        if bools is not None and self._has_numbers(bools.first.lane) and self._is_count_of(bools.first.lane, loop.count):
            self._bools(loop, bools)
            return True
        return False

    def _has_numbers(self, lane: int) -> bool:
        """Whether the elements of an array are numbers, and no structs of one."""
        return isinstance(self.unit.layout.lanes[lane].element, Number)

    def _turned(self, loop: nodes.For, place: nodes.Place, base: nodes.Expr, type_: str) -> None:
        sequence = self.scope.sequences.get(place.lane)
        if sequence is None or self.scope.behind(place) != index(0) or not self._is_count_of(place.lane, loop.count):
            raise NotInParts
        self._numbers(sequence, ">", self.exact.get(place.lane))
        self.positions.written(base, Sum().plus(self.positions.sum(loop.count), nodes.WIDTH[type_]))

    def _bools(self, loop: nodes.For, bools: Bools) -> None:
        sequence = self.scope.sequences[bools.first.lane]
        if self.scope.behind(bools.first) != index(0):
            raise NotInParts
        self._numbers(sequence, "<", self.exact.get(bools.first.lane))
        self.positions.written(bools.base, self.positions.sum(loop.count))

    def _while(self, loop: nodes.While) -> None:
        self.flush()
        holds = self.positions.loop(stmt.name for stmt, _ in statements(loop.body) if isinstance(stmt, nodes.Assign))
        begin, exact, objects = self.positions.at, dict(self.exact), dict(self.scope.objects)
        with self.function.writer.indented(f"while {self.function.text(loop.condition)}:"):
            self.block(loop.body)
            self.flush()
            if not loop.body:
                self.line("pass")
        self.exact, self.scope.objects = exact, objects
        self._end(holds, begin, 0)
