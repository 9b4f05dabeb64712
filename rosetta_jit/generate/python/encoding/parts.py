"""An encoder as one function that joins parts: for messages that are written from front to back, straight from the objects.

    parts += _whole_4I(header.seq, stamp.secs, stamp.nsecs, count), frame_id, ...
    return b"".join(parts)

`NotInParts` ends the attempt to print one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from rosetta_jit.generate.parentheses import bare
from rosetta_jit.generate.passes.work_lists import is_hidden
from rosetta_jit.generate.python.encoding.loops_in_parts import Loops
from rosetta_jit.generate.python.encoding.object_rows import Asked, Listed, Maybe, ObjectScope
from rosetta_jit.generate.python.encoding.packed import Part
from rosetta_jit.generate.python.passes.asked import asked_count, taken_late
from rosetta_jit.generate.python.passes.defaults import asked_first, reads_of
from rosetta_jit.generate.python.passes.positions import NotInParts, Positions
from rosetta_jit.generate.python.passes.presence import bit_tested, case_tested, places_read, words_tested
from rosetta_jit.generate.python.passes.slots import lanes_within
from rosetta_jit.generate.python.passes.stored import stored_as_read
from rosetta_jit.generate.python.printing.expressions import expression
from rosetta_jit.generate.python.printing.failures import fail
from rosetta_jit.generate.python.printing.late_lists import LACKS, runs_of_lists
from rosetta_jit.generate.python.printing.printed import Function
from rosetta_jit.generate.python.printing.statements import print_statement
from rosetta_jit.generate.unit import Unit
from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.passes.fold import FALSE, folded
from rosetta_jit.kernel.terms import index
from rosetta_jit.kernel.walk import expressions_of, statements
from rosetta_jit.model.layout import Number


class Parts(Loops):
    """Prints a body.

    ``routines`` are the functions that give the bytes which routines write, ``called`` those of them that are. ``lengths`` are the locals
    of the kernel for the lengths of messages within others, ``words`` those for fields which say what an object has: ``tested`` are
    those of them of which nothing but single bits is asked for. ``lists`` are the groups of the fields for the numbers of elements of
    lists that an object may lack, by lane and offset.
    """

    def __init__(self, unit: Unit, function: Function, scope: ObjectScope, body: nodes.Block, routines: Mapping[str, str]) -> None:
        self.tested = words_tested(body)
        lets = (stmt for stmt, _ in statements(body) if not (isinstance(stmt, nodes.Let) and stmt.name in self.tested))
        exprs = (expr for stmt in lets for expr in expressions_of(stmt))
        needed = {(place.lane, place.offset) for expr in exprs for place in places_read(expr)}
        super().__init__(unit, function, scope, needed)
        self.body, self.routines, self.called, self.depth = body, routines, set[str](), function.writer.depth
        self.lengths, self.words = set[str](), dict[str, nodes.Place]()
        self.reads, self.stored = reads_of(body), stored_as_read(body)
        self.binder.late = taken_late(body)
        self.lists: Mapping[tuple[int, int], int] = {}

    # --- statements ------------------------------------------------------------------------------------------------------------------

    def block(self, block: nodes.Block) -> None:
        stmts = asked_first(block, self.reads, self.scope.is_number)
        lacks = dict[str, str]()
        for of, run in runs_of_lists(tuple(stmts), self.lists, self.function.read):
            holder = self.scope.holders.get((of[0].lane, of[0].row)) if of is not None else None
            if of is None or holder is None:
                self._statements(run)
                continue
            self.flush()
            if holder not in lacks:
                lacks[holder] = self.binder.local(LACKS)
                self.line(f"{lacks[holder]} = _lacking.get(type({holder}), 0)")
            with self.function.writer.indented(f"if not {lacks[holder]} & {1 << of[1]}:"):
                self._statements(run)

    def _statements(self, run: nodes.Block) -> None:
        for stmt in run:
            self._numbered(stmt)
            self._statement(stmt)

    def _numbered(self, stmt: nodes.Stmt) -> None:
        """Take apart the rows of an array of which a statement names the number, as one does of a loop that is written out."""
        for place in [place for expr in expressions_of(stmt) for place in places_read(expr)]:
            match self.scope.behind(place), self.scope.sequences.get(place.lane):
                case nodes.Const(_, number), Listed(own, lane, element, slot, is_map=False) if element is not None:
                    is_bound = (lane, place.row) in self.scope.objects or isinstance(slot, Number)
                    if not is_bound and number < self.exact.get(lane, 0) and self.unit.layout.lanes[lane].links is None:
                        self._leave(lane, lanes_within(slot, self.unit.layout))
                        self.binder.bind(lane, place.row, f"{own}[{int(number)}]", element, slot)
                case _:
                    pass

    def _leave(self, lane: int, inner: set[int]) -> None:
        """Forget the row of an array that was taken apart, and what that has: another one comes."""
        scope = self.scope
        scope.objects = {key: fields for key, fields in scope.objects.items() if key[0] != lane and key[0] not in inner}
        scope.starts = {name: each for name, each in scope.starts.items() if each not in inner}
        scope.counts = {name: each for name, each in scope.counts.items() if each not in inner}
        self.exact = {each: count for each, count in self.exact.items() if each not in inner}

    def _statement(self, stmt: nodes.Stmt) -> None:
        match stmt:
            case nodes.Let():
                self._let(stmt)
            case nodes.Var(name, value) | nodes.Assign(name, value):
                if name in self.function.read:
                    self.flush()
                    print_statement(self.function, stmt)
                self.positions.variable(name, value)
            case nodes.Expect():
                self._expect(stmt)
            case nodes.Store(at, value, order):
                self._store(at, value, order)
            case nodes.Copy(nodes.Wire(at), nodes.Place() as source, size):
                self._copy(at, source, size)
            case nodes.Fill(nodes.Wire(at), size, byte):
                text = bare(expression(self.scope, size))
                self.pending.append(Part("", "", (f"bytes({text})" if byte == 0 else f"bytes([{byte}]) * ({text})",)))
                self.positions.written(at, self.positions.sum(size))
            case nodes.Call():
                self._call(stmt)
            case nodes.SetField(place, at) if is_hidden(place, self.unit.layout):
                size = self.sizes[place.row]
                self.pending.append(Part("", "", (self.bodies[size],)))
                self.positions.written(at, self.positions.values[size])
            case nodes.HostCall(inputs=(), target=None):
                print_statement(self.function, stmt)
            case nodes.Return(position, registers):
                self._return(stmt, position, registers)
            case nodes.If():
                self._if(stmt)
            case nodes.Switch(value, cases, default):
                tested = [(f"case {number}:", each, self._maybe(nodes.Compare("eq", value, index(number)))) for number, each in cases]
                self._branches(f"match {self.function.text(value)}:", tested, default)
            case nodes.For():
                self._for(stmt)
            case nodes.While():
                self._while(stmt)
            case _:
                raise NotInParts

    def _expect(self, stmt: nodes.Expect) -> None:
        match stmt.condition:
            case nodes.Compare("eq", nodes.Local(_, name), nodes.Local(_, same)) if name == same and name in self.around:
                self.finish(name)
            case condition if (maybe := self._maybe(condition)) is not None and not maybe.case:
                with self.function.writer.indented(f"if {maybe.local} is None:"):
                    fail(self.function, stmt.failure)
                self.binder.there(maybe)
            case condition:
                self._note(condition)
                print_statement(self.function, stmt)

    def _maybe(self, condition: nodes.Expr) -> Maybe | None:
        """What an object has if a condition holds: a field that may be absent, or the case of a union."""
        tested = bit_tested(condition, self.words) or case_tested(condition, self.words)
        return None if tested is None else self.scope.maybe.get(tested)

    def _asked(self, condition: nodes.Expr) -> Asked | None:
        """The sequence that has elements if a condition holds."""
        place = asked_count(condition)
        return None if place is None else self.scope.asked.get(place)

    def _let(self, stmt: nodes.Let) -> None:
        if isinstance(stmt.value, nodes.Get) and stmt.value.place.lane >= self.scope.lanes.own:
            self.lengths.add(stmt.name)
            return
        if isinstance(stmt.value, nodes.Get) and stmt.value.type in ("u64", "i64"):
            self.words[stmt.name] = stmt.value.place
        match stmt.value:
            case nodes.Get(_, place) if is_hidden(place, self.unit.layout):
                self._message(stmt.name, place)
                return
            case nodes.Get(_, place) if (lane := self.scope.start(place)) is not None:
                self.scope.starts[stmt.name] = lane
                return
            case nodes.Get(_, place) if (lane := self.scope.start(place, 8)) is not None:
                self.scope.counts[stmt.name] = lane
            case _:
                pass
        self.positions.constant(stmt.name, stmt.value)
        if stmt.name in self.stored and isinstance(stmt.value, nodes.Get) and self.scope.is_number(stmt.value.place):
            self.line(f"{self.scope.locals.identifier(stmt.name)} = {self.scope.given(stmt.value.place)}")
        elif stmt.name in self.function.read and stmt.name not in self.tested:
            print_statement(self.function, stmt)

    def _note(self, condition: nodes.Expr) -> None:
        """How many elements an array has, where that is checked."""
        match condition:
            case nodes.Compare("eq", nodes.Local(_, name), nodes.Const(_, count)) if name in self.scope.counts:
                self.exact[self.scope.counts[name]] = int(count)
            case nodes.Compare("lt", value, nodes.Const(_, most)) if self._is_count(value):
                self.limits[value] = int(most)
            case _:
                pass

    def _is_count(self, value: nodes.Expr) -> bool:
        """Whether an integer is a number of elements, or one and some more."""
        match value:
            case nodes.Local(_, name) | nodes.Binary("add", nodes.Local(_, name), nodes.Const(_, 0 | 1)):
                return name in self.scope.counts
            case _:
                return False

    def _call(self, call: nodes.Call) -> None:
        """A routine that writes from its first argument on, and gives the position behind."""
        if (visit := self.visits.get(call.routine)) is not None:
            self._visit(call, visit)
            return
        if call.routine not in self.routines or call.results[0].name in self.function.read:
            raise NotInParts
        match call.arguments[1:]:
            case (nodes.Convert(_, nodes.Local(_, name)),) if name in self.lengths:
                self.begin(name, self.routines[call.routine])
            case arguments:
                texts = ", ".join(self._argument(each) for each in arguments)
                self.pending.append(Part("", "", (f"{self.routines[call.routine]}({texts})",)))
        behind = self.positions.new()
        self.positions.written(call.arguments[0], behind.plus(self.positions.at, -1))
        self.positions.values[call.results[0].name] = behind
        self.called.add(call.routine)

    def _argument(self, value: nodes.Expr) -> str:
        """A number that a routine gets; the length of a sequence is no negative one."""
        match value:
            case nodes.Convert("u64", nodes.Local(_, name)) if name in self.bodies:
                return f"len({self.bodies[name]})"
            case nodes.Convert("u64", nodes.Local(_, name) as count) if name in self.scope.counts:
                return self.function.text(count)
            case _:
                return self.function.text(value)

    def _return(self, stmt: nodes.Return, position: nodes.Expr, registers: Sequence[tuple[int, nodes.Expr]]) -> None:
        if self.positions.sum(position) != self.positions.at or self.function.writer.depth != self.depth:
            raise NotInParts
        if not registers:
            self.end("")
            return
        self.end("message")
        print_statement(self.function, nodes.Return(index(0), stmt.registers))

    # --- branches ------------------------------------------------------------------------------------------------------------------

    def _if(self, stmt: nodes.If) -> None:
        match stmt:
            case nodes.If(nodes.Compare("gt", _, nodes.Const(_, 0)), (nodes.Copy(nodes.Wire(at), nodes.Place() as source, size),), ()):
                self._copy(at, source, size)  # a copy of nothing does nothing
            case nodes.If(condition, (), otherwise):
                self._branches(f"if {self.function.text(folded(nodes.Unary('not', condition)))}:", [("", otherwise, None)], ())
            case nodes.If(condition, then, otherwise):
                maybe = self._maybe(condition)
                text = self._condition(condition) if maybe is None or maybe.case else f"{maybe.local} is not None"
                self._branches(f"if {text}:", [("", then, maybe or self._asked(condition))], otherwise)

    def _condition(self, condition: nodes.Expr) -> str:
        match condition:
            case nodes.Compare("ne", nodes.Get(_, place), nodes.Const(_, 0)) if self.scope.is_number(place):
                return self.scope.is_not_zero(place)
            case _ if (asked := self._asked(condition)) is not None:
                return asked.condition
            case _:
                return self.function.text(condition)

    def _branches(self, head: str, cases: Sequence[tuple[str, nodes.Block, Maybe | Asked | None]], default: nodes.Block) -> None:
        self.flush()
        before, ends = self.positions, list[Positions]()
        writer = self.function.writer
        is_match = bool(cases[0][0]) if cases else True

        def inside(block: nodes.Block, has: Maybe | Asked | None = None) -> None:
            lines, exact, objects = len(writer.lines), dict(self.exact), dict(self.scope.objects)
            self.positions = before.branch()
            if isinstance(has, Maybe):
                self.binder.there(has)
            elif has is not None:
                self.line(has.line)
            self.block(block)
            self.flush()
            self.exact, self.scope.objects = exact, objects
            if len(writer.lines) == lines:
                self.line("pass")
            if not (block and isinstance(block[-1], nodes.Expect) and block[-1].condition == FALSE):
                ends.append(self.positions)

        if is_match:
            with writer.indented(head):
                for line, block, has in (*cases, ("case _:", default, None)):
                    with writer.indented(line):
                        inside(block, has)
        else:
            with writer.indented(head):
                inside(*cases[0][1:])
            if default:
                with writer.indented("else:"):
                    inside(default)
            else:
                ends.append(before.branch())
        before.join(ends)
        self.positions = before
