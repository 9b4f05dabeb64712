"""An encoder as one function that joins parts: for messages that are written from front to back, straight from the objects.

    parts += _whole_4I(header.seq, stamp.secs, stamp.nsecs, count), frame_id, ...
    return b"".join(parts)

`NotInParts` ends the attempt to print one.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.generate.cleared import slots_of
from rosetta_jit.generate.python.direct import numbers_of
from rosetta_jit.generate.python.expressions import CODES, bare, expression
from rosetta_jit.generate.python.given import Binder
from rosetta_jit.generate.python.groups import turned
from rosetta_jit.generate.python.packed import Part, part_text, with_numbers
from rosetta_jit.generate.python.positions import NotInParts, Positions, Sum
from rosetta_jit.generate.python.statements import print_statement
from rosetta_jit.kernel.ir import (
    WIDTH,
    Assign,
    Binary,
    Call,
    Compare,
    Const,
    Convert,
    Copy,
    Expect,
    Fill,
    For,
    Get,
    HostCall,
    If,
    Let,
    Local,
    Place,
    Return,
    Store,
    Switch,
    Unary,
    Var,
    While,
    Wire,
)
from rosetta_jit.kernel.passes.fold import FALSE, folded
from rosetta_jit.kernel.shape import expressions_of, statements, subexpressions
from rosetta_jit.kernel.terms import index, type_of
from rosetta_jit.model.layout import Number

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from rosetta_jit.generate.python.given import Given, Listed
    from rosetta_jit.generate.python.statements import Function
    from rosetta_jit.generate.unit import Unit
    from rosetta_jit.kernel.ir import Block, Expr, Stmt

MOST_STARRED = 40
"""Numbers of an array of a fixed length that are packed together with those around it."""

FEW_STARRED = 4
"""The same of an array of numpy's, whose elements become Python's one by one."""


class Parts:
    """Prints a body; ``pending`` are parts that no line has written yet, ``begun`` is whether any has.

    ``routines`` are the functions that give the bytes which routines write, ``called`` those of them that are.
    """

    def __init__(self, unit: Unit, function: Function, scope: Given, body: Block, routines: Mapping[str, str]) -> None:
        self.unit, self.function, self.scope, self.body = unit, function, scope, body
        self.routines, self.called = routines, set[str]()
        self.positions, self.pending, self.begun = Positions(), list[Part](), False
        parts = [part for stmt, _ in statements(body) for expr in expressions_of(stmt) for part in subexpressions(expr)]
        needed = {(part.place.lane, part.place.offset) for part in parts if isinstance(part, Get)}
        self.binder = Binder(unit, function, scope, needed)
        self.exact: dict[int, int] = {}
        self.limits: dict[Expr, int] = {}

    def line(self, text: str) -> None:
        self.function.line(text)

    # --- statements ------------------------------------------------------------------------------------------------------------------

    def block(self, block: Block) -> None:
        for stmt in block:
            self._statement(stmt)

    def _statement(self, stmt: Stmt) -> None:
        match stmt:
            case Let():
                self._let(stmt)
            case Var(name, value) | Assign(name, value):
                if name in self.function.read:
                    self.flush()
                    print_statement(self.function, stmt)
                self.positions.variable(name, value)
            case Expect(condition, _):
                self._note(condition)
                print_statement(self.function, stmt)
            case Store(at, value, order):
                self._store(at, value, order)
            case Copy(Wire(at), Place() as source, size):
                self._copy(at, source, size)
            case Fill(Wire(at), size, byte):
                text = bare(expression(self.scope, size))
                self.pending.append(Part("", "", (f"bytes({text})" if byte == 0 else f"bytes([{byte}]) * ({text})",)))
                self.positions.written(at, self.positions.sum(size))
            case Call():
                self._call(stmt)
            case HostCall(inputs=(), target=None):
                print_statement(self.function, stmt)
            case Return(position, registers):
                self._return(stmt, position, registers)
            case If():
                self._if(stmt)
            case Switch(value, cases, default):
                self._branches(f"match {self.function.text(value)}:", [(f"case {number}:", each) for number, each in cases], default)
            case For():
                self._for(stmt)
            case While():
                self._while(stmt)
            case _:
                raise NotInParts

    def _let(self, stmt: Let) -> None:
        match stmt.value:
            case Get(_, place) if (lane := self.scope.start(place)) is not None:
                self.scope.starts[stmt.name] = lane
                return
            case Get(_, place) if (lane := self.scope.start(place, 8)) is not None:
                self.scope.counts[stmt.name] = lane
            case _:
                pass
        self.positions.constant(stmt.name, stmt.value)
        if stmt.name in self.function.read:
            print_statement(self.function, stmt)

    def _note(self, condition: Expr) -> None:
        """How many elements an array has, where that is checked."""
        match condition:
            case Compare("eq", Local(_, name), Const(_, count)) if name in self.scope.counts:
                self.exact[self.scope.counts[name]] = int(count)
            case Compare("lt", value, Const(_, most)) if self._is_count(value):
                self.limits[value] = int(most)
            case _:
                pass

    def _is_count(self, value: Expr) -> bool:
        """Whether an integer is a number of elements, or one and some more."""
        match value:
            case Local(_, name) | Binary("add", Local(_, name), Const(_, 0 | 1)):
                return name in self.scope.counts
            case _:
                return False

    # --- bytes -----------------------------------------------------------------------------------------------------------------------

    def _store(self, at: Expr, value: Expr, order: str) -> None:
        type_ = type_of(value)
        match value:
            case Get(_, place) if not self.scope.has(place):
                text = self.scope.element_of(place, type_)
            case Get(_, place):
                text = bare(self.scope.objects[place.lane, place.row][place.offset])
            case Convert(_, count) if self.limits.get(count, 1 << 64) <= 1 << 8 * WIDTH[type_] - (type_[0] == "i"):
                text = bare(expression(self.scope, count))
            case _:
                text = bare(expression(self.scope, value))
        self._add(order if WIDTH[type_] > 1 else "", CODES[type_], (f"1 if {text} else 0" if type_ == "bool" else text,))
        self.positions.written(at, Sum(WIDTH[type_]))

    def _add(self, order: str, codes: str, texts: tuple[str, ...]) -> None:
        """Numbers behind the parts so far."""
        self.pending = with_numbers(self.pending, order, codes, texts)

    def _copy(self, at: Expr, source: Place, size: Expr) -> None:
        """A sequence as a whole."""
        sequence, start = self.scope.sequences.get(source.lane), self.scope.behind(source)
        if sequence is None or start != index(0) or source.offset:
            raise NotInParts
        stride = self.unit.layout.lanes[source.lane].stride
        size_sum = self.positions.sum(size)
        counts = [self.positions.values[name] for name, lane in self.scope.counts.items() if lane == source.lane]
        exact = self.exact.get(source.lane)
        if not any(size_sum == Sum().plus(count, stride) for count in counts) and size_sum != Sum(
            stride * exact if exact is not None else -1
        ):
            raise NotInParts
        codes = numbers_of(sequence.slot, stride)
        if sequence.element is None:
            self.pending.append(Part("", "", (sequence.local,)))
        elif isinstance(sequence.slot, Number):
            self._numbers(sequence, "<", exact)
        elif codes:
            self._each(sequence, codes)
        else:
            raise NotInParts
        self.positions.written(at, size_sum)

    def _numbers(self, sequence: Listed, order: str, exact: int | None) -> None:
        assert isinstance(sequence.slot, Number)
        code, own = CODES[sequence.slot.scalar], sequence.local
        if exact is not None and 0 < exact <= (FEW_STARRED if self.unit.numpy else MOST_STARRED):
            self._add(order if WIDTH[sequence.slot.scalar] > 1 else "", code * exact, (f"*{own}",))
        elif self.unit.numpy:
            dtype, is_bool = self.scope.dtype(sequence.slot.scalar, order), sequence.slot.scalar == "bool"
            self.pending.append(Part("", "", (f"_raw({dtype}, {own}{', is_bool=True' if is_bool else ''})",)))
        elif sequence.slot.scalar == "u8":
            self.pending.append(Part("", "", (f"bytes({own})",)))
        else:
            names = [name for name, lane in self.scope.counts.items() if lane == sequence.lane and name in self.function.read]
            count = self.scope.locals.identifier(names[0]) if names else f"len({own})"
            self.pending.append(Part("", "", (f'Struct(f"{order.replace("<", "")}{{{count}}}{code}").pack(*{own})',)))

    def _each(self, sequence: Listed, codes: tuple[str, ...]) -> None:
        """Rows that are numbers."""
        assert sequence.element is not None
        self.flush()
        self.begun = True
        element, lane = self.binder.local("element"), sequence.lane
        with self.function.writer.indented(f"for {element} in {sequence.local}:"):
            found: dict[int, str] = {}
            needed = {(lane, each.offset) for each in slots_of(sequence.slot)}
            Binder(self.unit, self.function, self.scope, needed).value(lane, element, sequence.element, sequence.slot, found)
            texts = tuple(text for _, text in sorted(found.items()))
            self.pending.append(Part("<", "".join(CODES[each] for each in codes), texts))
            self.flush()

    def flush(self) -> None:
        """Write the parts that are pending."""
        texts = [part_text(each, self.scope, self.exact) for each in self.pending]
        self.pending = []
        if texts:
            self.begun = True
            self.line(f"parts.append({texts[0]})" if len(texts) == 1 else f"parts += {', '.join(texts)}")

    def _call(self, call: Call) -> None:
        """A routine that writes from its first argument on, and gives the position behind."""
        if call.routine not in self.routines or call.results[0].name in self.function.read:
            raise NotInParts
        given = ", ".join(self.function.text(each) for each in call.arguments[1:])
        self.pending.append(Part("", "", (f"{self.routines[call.routine]}({given})",)))
        behind = self.positions.new()
        self.positions.written(call.arguments[0], behind.plus(self.positions.at, -1))
        self.positions.values[call.results[0].name] = behind
        self.called.add(call.routine)

    def _return(self, stmt: Return, position: Expr, registers: Sequence[tuple[int, Expr]]) -> None:
        if self.positions.sum(position) != self.positions.at or self.function.writer.depth != 2:
            raise NotInParts
        if not registers:
            self.end("")
            return
        self.end("message")
        print_statement(self.function, Return(index(0), stmt.registers))

    def end(self, name: str) -> None:
        """Join the parts: that is the result, or has a name."""
        if self.begun:
            self.flush()
        texts = [part_text(each, self.scope, self.exact) for each in self.pending]
        if len(texts) == 1 and not self.pending[0].codes:
            texts = [f"bytes({texts[0]})"]
        made = 'b"".join(parts)' if self.begun else texts[0] if len(texts) == 1 else f'b"".join(({", ".join(texts)}))' if texts else 'b""'
        self.line(f"{name} = {made}" if name else f"return {made}")

    # --- branches and loops ----------------------------------------------------------------------------------------------------------

    def _if(self, stmt: If) -> None:
        match stmt:
            case If(Compare("gt", _, Const(_, 0)), (Copy(Wire(at), Place() as source, size),), ()):
                self._copy(at, source, size)  # a copy of nothing does nothing
            case If(condition, (), otherwise):
                self._branches(f"if {self.function.text(folded(Unary('not', condition)))}:", [("", otherwise)], ())
            case If(condition, then, otherwise):
                self._branches(f"if {self.function.text(condition)}:", [("", then)], otherwise)

    def _branches(self, head: str, cases: list[tuple[str, Block]], default: Block) -> None:
        self.flush()
        before, ends = self.positions, list[Positions]()
        writer = self.function.writer
        is_match = bool(cases[0][0]) if cases else True

        def inside(block: Block) -> None:
            lines, exact = len(writer.lines), dict(self.exact)
            self.positions = before.branch()
            self.block(block)
            self.flush()
            self.exact = exact
            if len(writer.lines) == lines:
                self.line("pass")
            if not (block and isinstance(block[-1], Expect) and block[-1].condition == FALSE):
                ends.append(self.positions)

        if is_match:
            with writer.indented(head):
                for line, block in (*cases, ("case _:", default)):
                    with writer.indented(line):
                        inside(block)
        else:
            with writer.indented(head):
                inside(cases[0][1])
            if default:
                with writer.indented("else:"):
                    inside(default)
            else:
                ends.append(before.branch())
        before.join(ends)
        self.positions = before

    def _for(self, loop: For) -> None:
        if (found := turned(loop)) is not None and isinstance(loop.body[-1], Store):
            self._turned(loop, *found)
            return
        width = sum(WIDTH[type_of(each.value)] for each in loop.body if isinstance(each, Store))
        self.flush()
        outer = self.positions.at
        holds = self.positions.loop(stmt.name for stmt, _ in statements(loop.body) if isinstance(stmt, Assign))
        self.positions.values[loop.variable] = self.positions.new()
        if holds is None:
            self.positions.at = outer.plus(self.positions.values[loop.variable], width)
        begin = self.positions.at
        exact = dict(self.exact)
        with self.function.writer.indented(self._head(loop)):
            self._rows(loop)
            self.block(loop.body)
            self.flush()
        self.exact = exact
        self._end(holds, begin, width)
        if holds is None:
            self.positions.at = outer.plus(self.positions.sum(loop.count), width)

    def _end(self, holds: str | None, begin: Sum, width: int) -> None:
        now = self.positions.at
        if (begin.plus(Sum(width)) if holds is None else self.positions.values[holds]) != now:
            raise NotInParts
        if holds is not None:
            self.positions.at = self.positions.values[holds] = self.positions.new()

    def _sequence_of(self, loop: For) -> Listed | None:
        """What a loop over rows goes through."""
        parts = [part for stmt, _ in statements(loop.body) for expr in expressions_of(stmt) for part in subexpressions(expr)]
        round_ = Local("i64", loop.variable)
        found = {part.place.lane for part in parts if isinstance(part, Get) and self.scope.behind(part.place) == round_}
        rows = [self.scope.sequences[lane] for lane in found if not isinstance(self.scope.sequences[lane].slot, Number)]
        if len(rows) > 1 or (rows and not self._is_count_of(rows[0].lane, loop.count)):
            raise NotInParts
        return rows[0] if rows else None

    def _is_count_of(self, lane: int, count: Expr) -> bool:
        """Whether a number is that of all elements of a sequence."""
        match count:
            case Local(_, name):
                return self.scope.counts.get(name) == lane
            case Const(_, number):
                return self.exact.get(lane) == number
            case _:
                return False

    def _head(self, loop: For) -> str:
        sequence, own = self._sequence_of(loop), self.scope.locals.identifier(loop.variable)
        if sequence is None:
            return f"for {own} in range({self.function.text(loop.count)}):"
        element = self.scope.locals.identifier(f"element\0{loop.variable}")
        return f"for {own}, {element} in enumerate({sequence.local}):"

    def _rows(self, loop: For) -> None:
        sequence = self._sequence_of(loop)
        if sequence is None:
            return
        assert sequence.element is not None
        start = next(name for name, lane in self.scope.starts.items() if lane == sequence.lane)
        row = Binary("add", Local("i64", start), Local("i64", loop.variable))
        element = self.scope.locals.identifier(f"element\0{loop.variable}")
        self.binder.bind(sequence.lane, row, element, sequence.element, sequence.slot)

    def _turned(self, loop: For, place: Place, base: Expr, type_: str) -> None:
        sequence = self.scope.sequences.get(place.lane)
        if sequence is None or self.scope.behind(place) != index(0) or not self._is_count_of(place.lane, loop.count):
            raise NotInParts
        self._numbers(sequence, ">", self.exact.get(place.lane))
        self.positions.written(base, Sum().plus(self.positions.sum(loop.count), WIDTH[type_]))

    def _while(self, loop: While) -> None:
        self.flush()
        holds = self.positions.loop(stmt.name for stmt, _ in statements(loop.body) if isinstance(stmt, Assign))
        begin, exact = self.positions.at, dict(self.exact)
        with self.function.writer.indented(f"while {self.function.text(loop.condition)}:"):
            self.block(loop.body)
            self.flush()
            if not loop.body:
                self.line("pass")
        self.exact = exact
        self._end(holds, begin, 0)
