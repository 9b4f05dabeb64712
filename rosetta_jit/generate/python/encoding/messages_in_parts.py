"""Messages of types that contain themselves, in an encoder that joins parts: functions write them (see `recursive_rows`, `descents`)."""

from __future__ import annotations

from collections.abc import Mapping

from rosetta_jit.generate.passes.descents import Visit
from rosetta_jit.generate.python.encoding.joined_parts import Written
from rosetta_jit.generate.python.encoding.object_rows import ObjectScope
from rosetta_jit.generate.python.encoding.recursive_rows import row_function
from rosetta_jit.generate.python.passes.positions import NotInParts, without_positions
from rosetta_jit.generate.python.printing.printed import Function
from rosetta_jit.generate.python.printing.statements import print_statement
from rosetta_jit.generate.unit import Unit
from rosetta_jit.kernel.nodes import Call, Const, Expr, Local, Place


class Messages(Written):
    """Prints the calls of the functions, of the lanes ``rows_called``.

    Of those that give the bytes of one message, ``bodies`` are the locals that have these by those for their ``sizes``, which have names by
    the rows of the messages; ``visits`` are the calls of those that add the parts of each message of an array.
    """

    def __init__(self, unit: Unit, function: Function, scope: ObjectScope, needed: set[tuple[int, int]]) -> None:
        super().__init__(unit, function, scope, needed)
        self.bodies, self.sizes, self.rows_called = dict[str, str](), dict[Expr, str](), set[int]()
        self.visits: Mapping[str, Visit] = {}

    def _message(self, size: str, place: Place) -> None:
        """A message whose size is a local of the kernel."""
        body = self.binder.local("body")
        self.line(f"{body} = {row_function(self.scope.lanes, place.lane)}({self.scope.message(place)})")
        self.bodies[size], self.sizes[place.row] = body, size
        self.rows_called.add(place.lane)
        self.has_long = True
        self.positions.values[size] = self.positions.new()

    def _visit(self, call: Call, visit: Visit) -> None:
        """The messages of an array, one behind the other."""
        scope, writer = self.scope, self.function.writer
        sequence, count = scope.sequences.get(visit.lane), self.function.text(visit.count)
        is_whole = isinstance(visit.start, Local) and scope.starts.get(visit.start.name) == visit.lane
        if sequence is None or not is_whole or not self._is_count_of(visit.lane, visit.count) or self.list_name != "parts":
            raise NotInParts
        self.flush()
        self.begun = True
        self.rows_called.add(visit.lane)
        behind = self.positions.new()
        self.positions.written(call.arguments[0], behind.plus(self.positions.at, -1))
        self.positions.values[call.results[0].name] = behind
        if visit.shallow is not None:
            with writer.indented(f"if {count} > 0:"):
                for check in without_positions((visit.shallow,)):
                    print_statement(self.function, check)
        element = self.binder.local("element")
        with writer.indented(f"for {element} in {sequence.local}:"):
            self.line(f"{row_function(scope.lanes, visit.lane)}({element}, parts, {self.function.text(visit.depth)})")

    def _is_count_of(self, lane: int, count: Expr) -> bool:
        """Whether a number is that of all elements of a sequence."""
        match count:
            case Local(_, name):
                return self.scope.counts.get(name) == lane
            case Const(_, number):
                return self.exact.get(lane) == number
            case _:
                return False
