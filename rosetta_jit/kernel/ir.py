r"""The kernel: one small typed function from a message to a holder, or back. This page is its grammar and its meaning.

    Kernel = name, direction, strides of the lanes, how many are hidden, Routine*, Body+, Site*, how many registers, kept lanes,
             whether another kernel goes on
    Body   = Stmt*                                        an attempt; the first that succeeds is the result
    Stmt   = Require(at, size) | Expect(condition) | Let(name, value) | Var(name, value) | Assign(name, value)
           | Store(at, value) | SetField(place, value) | Reserve(lane, count) | Advance(lane, count)
           | Copy(target, source, size) | Fill(target, size, byte)
           | For(variable, count, Stmt*) | While(condition, Stmt*, invariant, measure)
           | If(condition, Stmt*, Stmt*)
           | Switch(value, {int: Stmt*}, Stmt*) | Return(position, {register: value})
           | Call(routine, arguments, results) | HostCall(function, arguments, inputs, target, result)
    Routine = name, parameters, results, Stmt*, requires, ensures, Site*
    Expr   = Const | Local | Load(at) | Get(place) | Used(lane) | Capacity(lane) | HostValue(what)
           | Register(number) | Unary | Binary | Compare | Fits | Convert | Bits | Select
           | IsText(address, size) | Nearest(address, size, exponent) | Digits(value) | Scale(value) | Lookup(values, index)
    Place  = lane, row, offset                            a typed field of a row of a lane
    Address = Wire(at) | Place

**Memory.** A kernel sees the message (bytes `begin` to `end` of a buffer, by int64 offset from the buffer's start) and the lanes
of one holder, each an array of rows of `stride` bytes with a capacity and a used length, both in rows. Nothing else can be
addressed, nothing is allocated. Used lengths are what the state says, but a kernel that decodes into row 0 starts with all lanes
behind lane 0 empty, unless it keeps them. The last lanes may be **hidden**: the holder has no fields there, a kernel always starts with
them empty, and what it leaves there is gone, but for what a size kernel leaves: the encoder runs on the same lanes, and finds lengths in
their rows. Scalars in lanes are native and aligned as the layout says; scalars in the message have
the byte order that the access names, and no alignment.

**Parameters** are the locals `begin`, `end` and `row`, all i64: where the message begins and ends in the buffer (0 <= begin <=
end), and the row of lane 0 that stands for the message (0 <= row). To encode, `begin` is where to write and `end` the end of the
space.

**Locals.** Every name is bound once in a kernel's text, by Let (immutable), Var (changed by Assign) or For. A local is visible
until the end of the block that binds it.

**Routines** are statements that many places share. A routine sees `begin`, `end` and its parameters; its results are locals of its
body, read at the end of it. It holds no Return, Reserve, Advance, HostCall, Used, HostValue or Register, and calls only routines before it.
Calling it demands what it `requires` of its parameters, and gives what it `ensures` of them and its results. Where it fails, the body of
the caller fails, at the site that the call names for the routine's own, and with the call's indices.

**The host** is what the kernel runs in. It tells two things that are the same wherever they are asked for a message: `now`, the time
in ns since 1970, and `number`, how many messages its program made before. And it has functions by name: a HostCall runs one on
numbers and on bytes, which it only reads, lets it fill the bytes of ``target``, and binds what it gives, of which nothing is known. A
function that refuses fails the statement. It may run again for the same message, or for one that fails. A dot in its name says that
it is ours (`image.size`), no dot that it is the user's.

**Registers** are i64 words that a program keeps from one message to the next. `Register(number)` is what one holds when the kernel starts,
wherever it stands: nothing is known of it. A Return says what some of them hold from the next message on; the others stay as they are. A
kernel that does not get to a Return changes none.

**Arithmetic.** `add sub mul` of integers must not wrap, `div rem` must not divide by zero or overflow, shifts stay below the
width: these are obligations that `verify` proves, like the bounds of every access. `Fits(op, a, b)` asks at run time whether an
i64 operation stays in range. `wrapping_add` is the sum of unsigned integers, its carry dropped. `div` and `rem` truncate toward zero.
Float arithmetic is IEEE 754, round to nearest. `and or xor` of integers are bitwise, of bools logical and strict. Convert between
integers keeps the low bits; from float to integer it truncates and saturates (NaN gives 0); everything else rounds to nearest. Which
NaN arithmetic gives is not said.

`shr` is arithmetic for signed, logical for unsigned integers; `shl` drops high bits. `neg` and `abs` of integers must not wrap.
`rem` of floats is C's fmod; `min(a, b)` of floats is `a` where `a < b`, else `b` (`max` with `>`). Comparisons with NaN are
false, `ne` true. A bool in memory is true where its byte is not 0, and is written as 0 or 1; Convert to bool asks `!= 0`.

**Given**, without proof: `begin` and `end` are at most 2**60, capacities at most 2**48, 0 <= Used <= Capacity. **Memory is read
once**: to the verifier each Load and Get is a new value, even of the same place, so that nothing proven depends on memory that
others may change. **Places** name a field of one row: 0 <= row < Capacity, 0 <= offset, offset + width <= stride, offset and
stride multiples of the width. Copy, Fill and IsText may run on from a place into the rows after it, up to Capacity. Reserve and
Advance take a count that is proven >= 0. A Failure is evaluated on the failing path only, under the same obligations.
Expressions nest at most 100 deep, blocks 100.

**Failing.** Require, Expect, HostCall, Reserve and what a Call runs are the only statements that can fail. A failing Require, Expect or
HostCall ends the body: the next body starts afresh, with used lengths as they were at the start; after the last one the kernel returns
`-(1 + site)` of that failure, among those of all bodies, whose offset is greatest (the earliest of equals), and leaves its offset and
indices in the holder's state. A failing Reserve returns -1 at once, having left lane and missing rows there: the runtime grows the lane
and calls again. Return ends the kernel with a position >= 0; only then do used lengths count.

**Used lengths** at the start are those of the holder's state, but a decode into row 0 starts with every used length 0: the
message replaces what the holder held. The rows themselves are as they were, and all of them are when a lane has grown. Later rows
of a batch are added to the rows before. A kernel for one of several wires fills a part of what the holder holds: the lanes that
it **keeps**, lane 0 first of all, have the used lengths of the state then, too.
"""

from __future__ import annotations

from rosetta_jit.kernel.nodes import Block, Direction, Expr, Local
from rosetta_jit.startup.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class Part:
    """A stretch of a merged `Require`: bytes ``offset`` to ``offset + size`` after its `at` belong to ``path``.

    With a ``step`` the stretch stands for one element of a loop, again every ``step`` bytes, and the last ``{}`` of the path is
    the element's index.
    """

    offset: int
    size: int
    path: str
    step: int = 0


@dataclass(frozen=True, slots=True)
class Site:
    """One place where a message can fail: what the static table turns ``-(1 + number)`` into.

    ``path`` has a ``{}`` for each index. ``line`` is the rule of the mapping (``file:line:column``) where one is to blame. With a
    ``detail_lane`` the detail is what bytes of that hidden lane say: two more indices are their first row and how many they are.
    """

    kind: str
    path: str
    detail: str
    line: str = ""
    parts: tuple[Part, ...] = ()
    detail_lane: int | None = None


@dataclass(frozen=True, slots=True)
class Routine:
    """Statements that many calls share. Results are integers of 64 bits; ``sites`` count from 1 as a kernel's do."""

    name: str
    parameters: tuple[Local, ...]
    results: tuple[Local, ...]
    body: Block
    requires: tuple[Expr, ...]
    ensures: tuple[Expr, ...]
    sites: tuple[Site, ...]


@dataclass(frozen=True, slots=True)
class Kernel:
    """``sites[0]`` stands for a lane that must grow, so that real sites count from 1. The last ``hidden`` lanes are hidden ones.

    ``registers`` is how many its program has at least. ``kept`` are the lanes whose rows stay when a message is decoded into row 0; none
    unless the message is one of several that fill the holder, and then lane 0 is one of them. Where all bodies of a kernel that ``goes_on``
    have failed, another kernel may handle the message.
    """

    name: str
    direction: Direction
    strides: tuple[int, ...]
    bodies: tuple[Block, ...]
    sites: tuple[Site, ...]
    routines: tuple[Routine, ...] = ()
    hidden: int = 0
    registers: int = 0
    kept: tuple[int, ...] = ()
    goes_on: bool = False

    @property
    def lanes(self) -> int:
        """How many lanes are the holder's."""
        return len(self.strides) - self.hidden
