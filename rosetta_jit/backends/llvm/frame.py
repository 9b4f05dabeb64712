"""What the printers of one kernel body share: its parameters, lanes, locals and the two ways out.

A lane's address, capacity and used length are loaded in the function's entry block, at the first mention, and never again: nothing that a
kernel stores can then make LLVM load them a second time. In a function of very many lanes they stay in memory instead: no machine has
so many registers, and LLVM would spend minutes on finding that out.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache

from llvmlite import ir

from rosetta_jit.backends.llvm.alike import NOTHING, Found, Number
from rosetta_jit.kernel.ir import Routine
from rosetta_jit.kernel.nodes import Call, Scalar
from rosetta_jit.kernel.state import ADDRESS, CAPACITY, HIDDEN, LANES, NOW, NUMBER, REGISTERS, USED, lane_word
from rosetta_jit.startup.dataclass import dataclass, field

I1, I8, I16, I32, I64 = (ir.IntType(bits) for bits in (1, 8, 16, 32, 64))
F32, F64, POINTER = ir.FloatType(), ir.DoubleType(), ir.PointerType()

LLVM_TYPES: dict[str, ir.Type] = {
    "bool": I1,
    "i8": I8,
    "u8": I8,
    "i16": I16,
    "u16": I16,
    "i32": I32,
    "u32": I32,
    "i64": I64,
    "u64": I64,
    "f32": F32,
    "f64": F64,
}

MESSAGE = (-1, 0)
"""Among what is loaded at the start, by lane and word, the address of the message."""

REGISTER = -2
"""In the place of a lane, the registers, which are loaded at the start, too."""

LIMIT = -3
"""The same for where bytes of a size can begin."""

CROWDED, CROWDED_DECODER = 64, 24
"""Lanes from which on an encoder, and a decoder, keeps what it knows of them in memory. A decoder has their used lengths to keep, too."""

COLD = (1 << 20, 1)
"""Branch weights where the second edge is taken for a broken message only."""


INDICES = 2
"""Which of the words of a failure is its first index: before it stand the site and the offset."""

ESCAPED = ir.FunctionType(ir.VoidType(), [POINTER])
"""The type of an instruction that does nothing with a slot, but takes its address: LLVM leaves the slot in memory."""


def forgotten(builder: ir.IRBuilder, number: ir.Value) -> ir.Value:
    """The same integer, of which LLVM knows nothing: an instruction that does nothing, but may do anything for all that it can tell."""
    return builder.asm(ir.FunctionType(number.type, [number.type]), "", "=r,0", [number], side_effect=False)


def is_float(scalar: Scalar) -> bool:
    """Whether a scalar is one of IEEE 754."""
    return scalar in ("f32", "f64")


def is_signed(scalar: Scalar) -> bool:
    """Whether a scalar is a signed integer."""
    return scalar in ("i8", "i16", "i32", "i64")


@lru_cache(maxsize=1024)
def constant(value: int) -> ir.Constant:
    """An int64 constant. One object prints its text once."""
    return ir.Constant(I64, value)


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


@dataclass(slots=True)
class Exit:
    """A block that several edges lead to, with the values that they bring."""

    block: ir.Block
    phis: tuple[ir.PhiInstr, ...]

    @staticmethod
    def new(entry: ir.IRBuilder, name: str, values: int) -> Exit:
        """An empty one, for so many values."""
        block = entry.function.append_basic_block(name)
        builder = ir.IRBuilder(block)
        return Exit(block, tuple(builder.phi(I64) for _ in range(values)))

    def drop(self) -> None:
        """No edge leads here: a block without edges cannot have phis."""
        for phi in self.phis:
            self.block.instructions.remove(phi)
        ir.IRBuilder(self.block).unreachable()

    def enter(self, builder: ir.IRBuilder, values: Sequence[ir.Value]) -> None:
        """End the builder's block with a jump here; values that are not given are 0."""
        for phi, value in zip(self.phis, (*values, *[constant(0)] * (len(self.phis) - len(values))), strict=True):
            phi.add_incoming(value, builder.block)
        builder.branch(self.block)

    @property
    def is_reached(self) -> bool:
        return bool(self.phis[0].incomings)


@dataclass(slots=True)
class StoredExit:
    """A block that very many edges lead to: each stores its values in words of the state, whose addresses are computed once.

    LLVM looks through all edges of a phi for each edge that it moves, which takes quadratic time. So it does with blocks whose last
    instructions are the same; theirs stores the site, in which they differ. ``shared`` are blocks on the way that store the same indices
    for many edges, by these and by the values that they are computed from. ``numbers`` are those of the words.
    """

    block: ir.Block
    words: tuple[ir.Value, ...]
    numbers: tuple[int, ...]
    is_reached: bool = False
    shared: dict[tuple[object, ...], ir.Block] = field(default_factory=dict[tuple[object, ...], "ir.Block"])

    def enter(self, builder: ir.IRBuilder, values: Sequence[ir.Value], through: ir.Block) -> None:
        """End the builder's block with a jump to a block on the way, or to this; words whose values are not given stay as they are."""
        self._store(builder, self.words, values)
        builder.branch(through)
        self.is_reached = True

    def drop(self) -> None:
        """No edge leads here."""
        ir.IRBuilder(self.block).unreachable()

    def enter_with_indices(self, builder: ir.IRBuilder, indices: Sequence[ir.Value]) -> None:
        """The same where the site and the offset are stored before."""
        self._store(builder, self.words[INDICES:], indices)
        builder.branch(self.block)

    def _store(self, builder: ir.IRBuilder, words: Sequence[ir.Value], values: Sequence[ir.Value]) -> None:
        for word, value in reversed(tuple(zip(words, values, strict=False))):
            builder.store(value, word, align=8)


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


def state_word(builder: ir.IRBuilder, state: ir.Value, word: int | ir.Value) -> ir.Value:
    """The address of a word of the holder's state."""
    number = constant(word) if isinstance(word, int) else word
    return builder.gep(state, [number], inbounds=True, source_etype=I64)


def intrinsic(module: ir.Module, name: str, result: ir.Type, parameters: Sequence[ir.Type]) -> ir.Function:
    """A function of LLVM or of a module, declared once."""
    if name in module.globals:
        return module.globals[name]
    return ir.Function(module, ir.FunctionType(result, parameters), name)
