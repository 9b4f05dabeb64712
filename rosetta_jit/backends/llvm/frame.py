"""What the printers of one kernel body share: its parameters, lanes, locals and the two ways out.

A lane's address, capacity and used length are loaded in the function's entry block, at the first mention, and never again: nothing that a
kernel stores can then make LLVM load them a second time. In a function of very many lanes they stay in memory instead: no machine has
so many registers, and LLVM would spend minutes on finding that out.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from llvmlite import ir

from rosetta_jit.backends.llvm.alike import NOTHING, Found, Number
from rosetta_jit.backends.llvm.exits import Exit, StoredExit
from rosetta_jit.backends.llvm.values import I8, I64, POINTER, constant, state_word
from rosetta_jit.kernel.ir import Routine
from rosetta_jit.kernel.nodes import Call
from rosetta_jit.kernel.state import ADDRESS, CAPACITY, HIDDEN, LANES, NOW, NUMBER, REGISTERS, USED, lane_word
from rosetta_jit.startup.dataclass import dataclass, field

MESSAGE = (-1, 0)
"""Among what is loaded at the start, by lane and word, the address of the message."""

REGISTER = -2
"""In the place of a lane, the registers, which are loaded at the start, too."""

LIMIT = -3
"""The same for where bytes of a size can begin."""

CROWDED, CROWDED_DECODER = 64, 24
"""Lanes from which on an encoder, and a decoder, keeps what it knows of them in memory. A decoder has their used lengths to keep, too."""

ESCAPED = ir.FunctionType(ir.VoidType(), [POINTER])
"""The type of an instruction that does nothing with a slot, but takes its address: LLVM leaves the slot in memory."""


@dataclass(frozen=True, slots=True)
class Parameters:
    """The parameters of a kernel function."""

    buffer: ir.Value
    begin: ir.Value
    end: ir.Value
    state: ir.Value
    row: ir.Value


@dataclass(frozen=True, slots=True)
class Variable:
    """The stack slot of a Var; optimisation turns it into a register."""

    slot: ir.Value
    type: ir.Type


@dataclass(frozen=True, slots=True)
class Stretch:
    """What stands for the lanes and offsets of the last stretch of a series in the one that is being printed: ``columns`` of its row.

    ``words`` are the places in the state where the words of a lane of that number lie. The numbers of ``sites`` are looked up, by
    ``number``, where something has failed. The function of a shared block ``is_whole``: all in it has these numbers.
    """

    lanes: Mapping[int, Number]
    offsets: Mapping[tuple[int, int], Number]
    columns: Mapping[int, ir.Value]
    words: Mapping[int, ir.Value]
    sites: Mapping[int, Number]
    number: Callable[[ir.IRBuilder, Number], ir.Value]
    is_whole: bool = False


@dataclass(slots=True)
class Frame:
    """One body being printed. ``entry`` prints into the function's entry block, ``builder`` where the body has got to.

    A routine that is printed where it is called has a frame with locals of its own, which knows its ``caller``.
    ``indices`` are the locals that grow with the rounds of a loop. Of a body with series (`alike`),
    ``rows`` is an array of the used lengths of the holder's lanes, and ``stretch`` has the numbers of the stretch that is being printed.
    ``bases`` are addresses of rows and places in the message, by the block that has computed them. A body that is no ``counting`` one
    leaves the used lengths of the holder's lanes as they are. ``functions`` are those of shared blocks, by these; in such a function
    ``outcome`` is what it gives.
    """

    module: ir.Module
    entry: ir.IRBuilder
    builder: ir.IRBuilder
    parameters: Parameters
    strides: tuple[int, ...]
    own_lanes: int
    loaded: dict[tuple[int, int], ir.Value]
    done: Exit
    failed: Exit | StoredExit
    emptied: frozenset[int]
    routines: Mapping[str, ir.Function | Routine]
    caller: tuple[Frame, Call] | None = None
    alike: Found = NOTHING
    stretch: Stretch | None = None
    rows: ir.Value | None = None
    locals: dict[str, ir.Value | Variable] = field(default_factory=dict[str, "ir.Value | Variable"])
    used: dict[int, ir.Value] = field(default_factory=dict[int, ir.Value])
    counting: bool = True
    indices: set[str] = field(default_factory=set[str])
    bases: dict[tuple[object, ...], ir.Value] = field(default_factory=dict[tuple[object, ...], ir.Value])
    functions: dict[int, ir.Function] = field(default_factory=dict[int, "ir.Function"])
    outcome: ir.LiteralStructType | None = None

    @property
    def has_one_stretch(self) -> bool:
        """Whether the numbers are the same wherever the body has got to."""
        return self.stretch is None or self.stretch.is_whole

    def leave(self, status: ir.Value, values: Sequence[ir.Value] = ()) -> None:
        """End the function with a status, and the values of variables that a shared block gives back."""
        if self.outcome is None:
            self.builder.ret(status)
            return
        whole: ir.Value = ir.Constant(self.outcome, None)
        for number, value in enumerate((status, *values)):
            whole = self.builder.insert_value(whole, value, number)
        self.builder.ret(whole)

    def message(self) -> ir.Value:
        """Where the message begins."""
        if MESSAGE not in self.loaded:
            self.loaded[MESSAGE] = self.entry.gep(self.parameters.buffer, [self.parameters.begin], source_etype=I8, name="message")
        return self.loaded[MESSAGE]

    def limit(self, size: int) -> ir.Value:
        """What the places stay below from which on the message has so many bytes, without a sign: 0 where it has not as many at all."""
        if size == 1:
            return self.parameters.end
        key = (LIMIT, size)
        if key not in self.loaded:
            limit = self.entry.sub(self.parameters.end, constant(size - 1))
            has_any = self.entry.icmp_signed(">", limit, constant(0))
            self.loaded[key] = self.entry.select(has_any, limit, constant(0))
        return self.loaded[key]

    def based(self, what: tuple[object, ...], made: Callable[[], ir.Value]) -> ir.Value:
        """An address that depends on a value: made once in a block for a value of which there is but one."""
        key = (self.builder.block, self.stretch is None, *what)
        if key not in self.bases:
            self.bases[key] = made()
        return self.bases[key]

    def address(self, lane: int) -> ir.Value:
        """Where the lane's rows start."""
        return self._word(lane, ADDRESS, POINTER, f"lane{lane}")

    def capacity(self, lane: int) -> ir.Value:
        """How many rows the lane has room for."""
        return self._word(lane, CAPACITY, I64, f"capacity{lane}")

    def host_value(self, what: str) -> ir.Value:
        """What the host tells of the message; messages of one call are numbered by their rows."""
        word = NOW if what == "now" else NUMBER
        value = self.builder.load(state_word(self.builder, self.parameters.state, word), typ=I64, align=8, name=what)
        return value if what == "now" else self.builder.add(value, self.parameters.row)

    def register(self, number: int) -> ir.Value:
        """What a register holds when the kernel starts: loaded there, before anything changes it."""
        key = (REGISTER, number)
        if key not in self.loaded:
            word = self.register_word(self.entry, number)
            self.loaded[key] = self.entry.load(word, typ=I64, align=8, name=f"register{number}")
        return self.loaded[key]

    def register_word(self, builder: ir.IRBuilder, number: int) -> ir.Value:
        """The address of a register."""
        registers = builder.load(state_word(builder, self.parameters.state, REGISTERS), typ=POINTER, align=8, name="registers")
        return state_word(builder, registers, number)

    def lane_number(self, lane: int) -> ir.Value:
        """The lane's number while the kernel runs: in a series it is another one for each stretch."""
        found = None if self.stretch is None else self.stretch.lanes.get(lane)
        if self.stretch is None or found is None:
            return constant(lane)
        number = self.stretch.columns[found.column]
        return self.builder.add(number, constant(found.further)) if found.further else number

    def used_slot(self, lane: int) -> ir.Value:
        """Where the lane's used length is: in the state if it stays there, else in a stack slot."""
        if not self.is_hidden(lane):
            if self.rows is not None:
                return state_word(self.builder, self.rows, self.lane_number(lane))
            if not self.counting and (self.is_crowded or self.stretch is not None):
                return self._state_place(lane, USED)
        if lane not in self.used:
            start = constant(0) if self.is_hidden(lane) else self._used_before(self.entry, lane)
            self.used[lane] = self.entry.alloca(I64, name=f"rows{lane}")
            self.entry.store(start, self.used[lane])
            if self.is_crowded:
                self.entry.asm(ESCAPED, "", "r", [self.used[lane]], side_effect=True)
        return self.used[lane]

    def used_in_the_end(self, builder: ir.IRBuilder, lane: int) -> ir.Value:
        """The used length of a lane of the holder, loaded where the builder is, for those that the body had nothing to do with."""
        if self.rows is not None:
            return builder.load(state_word(builder, self.rows, lane), typ=I64)
        return builder.load(self.used[lane], typ=I64) if lane in self.used else self._used_before(builder, lane)

    def _used_before(self, builder: ir.IRBuilder, lane: int) -> ir.Value:
        """Each body starts with the used length that the state says, and decoding into row 0 with nothing in the lanes that it empties."""
        start = self._load(builder, lane, USED, I64, f"used{lane}")
        if lane not in self.emptied:
            return start
        return builder.select(builder.icmp_signed("==", self.parameters.row, constant(0)), constant(0), start)

    def is_hidden(self, lane: int) -> bool:
        """Whether the lane is not the holder's."""
        return lane >= self.own_lanes

    @property
    def is_crowded(self) -> bool:
        return len(self.strides) >= (CROWDED_DECODER if self.emptied else CROWDED)

    def variable(self, name: str, type_: ir.Type) -> Variable:
        """A stack slot in the entry block, so that a loop does not take more of them."""
        variable = Variable(self.entry.alloca(type_, name=name), type_)
        self.locals[name] = variable
        return variable

    def block(self, name: str) -> ir.Block:
        return self.builder.append_basic_block(name)

    def _word(self, lane: int, word: int, type_: ir.Type, name: str) -> ir.Value:
        if self.stretch is not None and lane in self.stretch.lanes:
            return self.builder.load(self._state_place(lane, word), typ=type_, align=8, name="word")
        if self.is_crowded:
            return self._load(self.builder, lane, word, type_, name)
        key = (lane, word)
        if key not in self.loaded:
            self.loaded[key] = self._load(self.entry, lane, word, type_, name)
        return self.loaded[key]

    def _state_place(self, lane: int, word: int) -> ir.Value:
        """The address of a word of one of the holder's lanes while the kernel runs."""
        found = None if self.stretch is None else self.stretch.lanes.get(lane)
        if self.stretch is None or found is None:
            return state_word(self.builder, self.parameters.state, lane_word(lane, word))
        return state_word(self.builder, self.stretch.words[found.column], lane_word(found.further, word))

    def _load(self, builder: ir.IRBuilder, lane: int, word: int, type_: ir.Type, name: str) -> ir.Value:
        if self.is_hidden(lane):
            hidden = builder.load(state_word(builder, self.parameters.state, HIDDEN), typ=POINTER, align=8, name="hidden")
            value = builder.load(state_word(builder, hidden, lane_word(lane - self.own_lanes, word) - LANES), typ=type_, align=8, name=name)
            return value if word == ADDRESS else builder.udiv(value, constant(self.strides[lane]))
        return builder.load(state_word(builder, self.parameters.state, lane_word(lane, word)), typ=type_, align=8, name=name)


def new_function(module: ir.Module, signature: ir.FunctionType, name: str, arguments: Sequence[str]) -> ir.Function:
    """An empty function whose first arguments are the message and the holder's state."""
    function = ir.Function(module, signature, name)
    function.attributes.add("nounwind")
    function.args[0].add_attribute("noalias")  # the message and the lanes never overlap
    function.args[3].add_attribute("noalias")
    for argument, each in zip(function.args, arguments, strict=True):
        argument.name = each
    return function


def leave_copies(function: ir.Function) -> None:
    """Have LLVM leave copies in the loops of an empty function: what is nothing but a copy is one already (`kernel.passes.bulk`)."""
    set[str].add(function.attributes, '"no-builtin-memcpy"')  # llvmlite's own `add` does not know it
