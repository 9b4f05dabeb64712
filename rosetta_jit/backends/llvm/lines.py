"""Instructions as lines of text, written when they are made.

llvmlite makes an object of each instruction, with operands, flags and metadata, and prints all of them in the end. A kernel's
instructions are appended, printed, and never looked at again: as lines of text they take half of the time. What is rare, llvmlite makes.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import count

from llvmlite import ir

I1, I32 = ir.IntType(1), ir.IntType(32)
NOTHING = ir.VoidType()
POINTER = ir.PointerType()

ORDERS = {">": "gt", "<": "lt", ">=": "ge", "<=": "le"}
EQUAL = {"==": "eq", "!=": "ne"}
SIGNED = EQUAL | {sign: f"s{name}" for sign, name in ORDERS.items()}
UNSIGNED = EQUAL | {sign: f"u{name}" for sign, name in ORDERS.items()}
ORDERED = {sign: f"o{name}" for sign, name in (EQUAL | ORDERS).items()}
UNORDERED = {sign: f"u{name}" for sign, name in (EQUAL | ORDERS).items()}

# llvmlite fills a table of characters when it first prints bytes, and a second thread would find it half full: so before there is one.
ir.MetaDataString(ir.Module(), "").get_reference()


class Result(ir.Value):
    """What others call the result of an instruction: its text is in its block, and lives longer than whoever asks for the result."""

    def __init__(self, type_: ir.Type, reference: str) -> None:
        self.type, self.reference = type_, reference

    def get_reference(self) -> str:
        """How others name it."""
        return self.reference


NONE = Result(NOTHING, "")
"""That of instructions which have none."""


class Branch(ir.Value):
    """A branch, the last instruction of its block, which may be told how likely its edges are, and of the loop that it ends."""

    type = NOTHING

    def __init__(self, lines: Lines, block: ir.Block) -> None:
        self.lines, self.block = lines, block

    def set_weights(self, weights: Sequence[int]) -> None:
        """How often each edge is taken, in relation to the other."""
        self._append(f", !prof {self.lines.weights(tuple(weights))}")

    def set_metadata(self, name: str, node: ir.Value) -> None:
        """What else is known of it."""
        self._append(f", !{name} {node.get_reference()}")

    def _append(self, text: str) -> None:
        self.block.instructions[-1] = f"{self.block.instructions[-1]}{text}"


class Lines(ir.IRBuilder):
    """Appends instructions to blocks of one function; those `beside` it number their results together with it."""

    def __init__(self, block: ir.Block, numbers: Iterator[int] | None = None) -> None:
        super().__init__(block)
        self._numbers = count(1) if numbers is None else numbers
        self._weights: dict[tuple[int, ...], str] = {}

    def beside(self, block: ir.Block) -> Lines:
        """Another one, for another block of the function."""
        return Lines(block, self._numbers)

    def weights(self, weights: tuple[int, ...]) -> str:
        """The name of branch weights in the module."""
        if weights not in self._weights:
            module = self.module
            named = module.add_metadata([ir.MetaDataString(module, "branch_weights"), *(ir.Constant(I32, each) for each in weights)])
            self._weights[weights] = named.get_reference()
        return self._weights[weights]

    def _insert(self, instr: ir.Value) -> None:
        """What llvmlite makes stands behind what stands here."""
        self._block.instructions.append(instr)

    def _line(self, type_: ir.Type, text: str) -> Result:
        reference = f"%-{next(self._numbers)}"
        self._block.instructions.append(f"{reference} = {text}")
        return Result(type_, reference)

    def _named(self, type_: ir.Type, text: str, name: str) -> Result:
        if not name:
            return self._line(type_, text)
        reference = f'%"{self._block.scope.register(name, deduplicate=True)}"'
        self._block.instructions.append(f"{reference} = {text}")
        return Result(type_, reference)

    def _end(self, text: str) -> Branch:
        """End the block. Its lines are one text from then on, which takes a third of the memory, unless there are others among them."""
        block = self._block
        assert not block.is_terminated
        block.instructions.append(text)
        block.terminator = NONE
        lines = [each for each in block.instructions if isinstance(each, str)]
        if len(lines) == len(block.instructions):
            block.instructions[:] = ["\n  ".join(lines)]
        return Branch(self, block)

    # --- memory and control --------------------------------------------------------------------------------------------------

    def alloca(self, typ: ir.Type, size: ir.Value | int | None = None, name: str = "") -> ir.Value:
        return super().alloca(typ, size, name) if size is not None else self._named(POINTER, f"alloca {typ}", name)

    def load(self, ptr: ir.Value, name: str = "", align: int | None = None, typ: ir.Type | None = None) -> ir.Value:
        assert typ is not None
        aligned = "" if align is None else f", align {align}"
        return self._named(typ, f"load {typ}, ptr {ptr.get_reference()}{aligned}", name)

    def store(self, value: ir.Value, ptr: ir.Value, align: int | None = None) -> ir.Value:
        aligned = "" if align is None else f", align {align}"
        self._block.instructions.append(f"store {value.type} {value.get_reference()}, ptr {ptr.get_reference()}{aligned}")
        return NONE

    def gep(
        self, ptr: ir.Value, indices: Sequence[ir.Value], inbounds: bool = False, name: str = "", source_etype: ir.Type | None = None
    ) -> ir.Value:
        assert source_etype is not None
        kind = "getelementptr inbounds" if inbounds else "getelementptr"
        places = ", ".join([f"{each.type} {each.get_reference()}" for each in indices])
        return self._named(POINTER, f"{kind} {source_etype}, ptr {ptr.get_reference()}, {places}", name)

    def branch(self, target: ir.Block) -> ir.Terminator:
        return self._end(f"br label {target.get_reference()}")

    def cbranch(self, cond: ir.Value, truebr: ir.Block, falsebr: ir.Block) -> ir.Terminator:
        edges = f"label {truebr.get_reference()}, label {falsebr.get_reference()}"
        return self._end(f"br i1 {cond.get_reference()}, {edges}")

    def call(self, fn: ir.Value, args: Iterable[ir.Value], name: str = "") -> ir.Value:
        signature = fn.function_type
        if signature.var_arg:
            return super().call(fn, args, name)
        arguments = ", ".join([f"{each.type} {each.get_reference()}" for each in args])
        convention, result = getattr(fn, "calling_convention", ""), signature.return_type
        text = f"call {convention}{' ' if convention else ''}{result} {fn.get_reference()}({arguments})"
        if result != NOTHING:
            return self._named(result, text, name)
        self._block.instructions.append(text)
        return NONE

    def extract_value(self, agg: ir.Value, idx: int) -> ir.Value:
        whole = agg.type
        assert isinstance(whole, ir.LiteralStructType)
        return self._line(whole.elements[idx], f"extractvalue {whole} {agg.get_reference()}, {idx}")

    def select(self, cond: ir.Value, lhs: ir.Value, rhs: ir.Value) -> ir.Value:
        type_ = lhs.type
        return self._line(type_, f"select i1 {cond.get_reference()}, {type_} {lhs.get_reference()}, {type_} {rhs.get_reference()}")

    # --- comparisons ---------------------------------------------------------------------------------------------------------

    def icmp_signed(self, cmpop: str, lhs: ir.Value, rhs: ir.Value) -> ir.Value:
        return self._line(I1, f"icmp {SIGNED[cmpop]} {lhs.type} {lhs.get_reference()}, {rhs.get_reference()}")

    def icmp_unsigned(self, cmpop: str, lhs: ir.Value, rhs: ir.Value) -> ir.Value:
        return self._line(I1, f"icmp {UNSIGNED[cmpop]} {lhs.type} {lhs.get_reference()}, {rhs.get_reference()}")

    def fcmp_ordered(self, cmpop: str, lhs: ir.Value, rhs: ir.Value) -> ir.Value:
        return self._line(I1, f"fcmp {ORDERED[cmpop]} {lhs.type} {lhs.get_reference()}, {rhs.get_reference()}")

    def fcmp_unordered(self, cmpop: str, lhs: ir.Value, rhs: ir.Value) -> ir.Value:
        return self._line(I1, f"fcmp {UNORDERED[cmpop]} {lhs.type} {lhs.get_reference()}, {rhs.get_reference()}")

    # --- arithmetic ----------------------------------------------------------------------------------------------------------

    def _two(self, operation: str, lhs: ir.Value, rhs: ir.Value, flags: Sequence[str] = ()) -> ir.Value:
        marks = "".join([f" {each}" for each in flags])
        type_ = lhs.type
        return self._line(type_, f"{operation}{marks} {type_} {lhs.get_reference()}, {rhs.get_reference()}")

    def add(self, lhs: ir.Value, rhs: ir.Value, flags: Sequence[str] = ()) -> ir.Value:
        return self._two("add", lhs, rhs, flags)

    def sub(self, lhs: ir.Value, rhs: ir.Value, flags: Sequence[str] = ()) -> ir.Value:
        return self._two("sub", lhs, rhs, flags)

    def mul(self, lhs: ir.Value, rhs: ir.Value, flags: Sequence[str] = ()) -> ir.Value:
        return self._two("mul", lhs, rhs, flags)

    def and_(self, lhs: ir.Value, rhs: ir.Value) -> ir.Value:
        return self._two("and", lhs, rhs)

    def or_(self, lhs: ir.Value, rhs: ir.Value) -> ir.Value:
        return self._two("or", lhs, rhs)

    def xor(self, lhs: ir.Value, rhs: ir.Value) -> ir.Value:
        return self._two("xor", lhs, rhs)

    def shl(self, lhs: ir.Value, rhs: ir.Value) -> ir.Value:
        return self._two("shl", lhs, rhs)

    def lshr(self, lhs: ir.Value, rhs: ir.Value) -> ir.Value:
        return self._two("lshr", lhs, rhs)

    def ashr(self, lhs: ir.Value, rhs: ir.Value) -> ir.Value:
        return self._two("ashr", lhs, rhs)

    def not_(self, value: ir.Value) -> ir.Value:
        return self._two("xor", value, ir.Constant(value.type, -1))

    def neg(self, value: ir.Value) -> ir.Value:
        return self._two("sub", ir.Constant(value.type, 0), value)

    # --- conversions ---------------------------------------------------------------------------------------------------------

    def _cast(self, operation: str, value: ir.Value, typ: ir.Type) -> ir.Value:
        if value.type == typ:
            return value
        return self._line(typ, f"{operation} {value.type} {value.get_reference()} to {typ}")

    def trunc(self, value: ir.Value, typ: ir.Type) -> ir.Value:
        return self._cast("trunc", value, typ)

    def zext(self, value: ir.Value, typ: ir.Type) -> ir.Value:
        return self._cast("zext", value, typ)

    def sext(self, value: ir.Value, typ: ir.Type) -> ir.Value:
        return self._cast("sext", value, typ)

    def bitcast(self, value: ir.Value, typ: ir.Type) -> ir.Value:
        return self._cast("bitcast", value, typ)
