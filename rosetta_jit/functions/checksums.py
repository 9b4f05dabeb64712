"""Checksums of bytes: cyclic redundancy codes by the names of the usual catalogues. Sums and exclusive ors of bytes are reductions."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Literal

from rosetta_jit.catalogue import checksums as words
from rosetta_jit.kernel.nodes import Binary, Const, Convert, Expr, Local, Lookup
from rosetta_jit.language import typed
from rosetta_jit.language.function import NOT_FOLLOWED, SEVERAL, Function, Row
from rosetta_jit.language.functions.texts import argument
from rosetta_jit.language.scope import Scope
from rosetta_jit.lowering.codec.fields import scalar_name
from rosetta_jit.lowering.evaluation import Evaluation
from rosetta_jit.lowering.texts.values import placed_of, quoted
from rosetta_jit.lowering.texts.views import View, parameters, scanning
from rosetta_jit.lowering.writer import MESSAGE, Contract, Writer
from rosetta_jit.model import expr as model
from rosetta_jit.model.layout import scalar_of
from rosetta_jit.model.types import Int
from rosetta_jit.startup.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class Code:
    """A cyclic redundancy code: ``polynomial`` without its highest term, the register at first, and what it is combined with at last.

    One that is ``reflected`` takes the lowest bit of each byte first.
    """

    bits: Literal[8, 16, 32]
    polynomial: int
    first: int
    last: int
    reflected: bool

    def of_byte(self, byte: int) -> int:
        """What a byte in an empty register becomes: the remainder of its bits."""
        if self.reflected:
            register, mirrored = byte, int(f"{self.polynomial:0{self.bits}b}"[::-1], 2)
            for _ in range(8):
                register = register >> 1 ^ (mirrored if register & 1 else 0)
            return register
        register, top = byte << self.bits - 8, 1 << self.bits - 1
        for _ in range(8):
            register = register << 1 ^ (self.polynomial if register & top else 0)
            register &= 2 * top - 1
        return register


CODES: Mapping[str, Code] = MappingProxyType(
    {
        "CRC-8": Code(8, 0x07, 0, 0, reflected=False),
        "CRC-8/AUTOSAR": Code(8, 0x2F, 0xFF, 0xFF, reflected=False),
        "CRC-8/MAXIM-DOW": Code(8, 0x31, 0, 0, reflected=True),
        "CRC-8/SAE-J1850": Code(8, 0x1D, 0xFF, 0xFF, reflected=False),
        "CRC-16/ARC": Code(16, 0x8005, 0, 0, reflected=True),
        "CRC-16/CCITT-FALSE": Code(16, 0x1021, 0xFFFF, 0, reflected=False),
        "CRC-16/KERMIT": Code(16, 0x1021, 0, 0, reflected=True),
        "CRC-16/MODBUS": Code(16, 0x8005, 0xFFFF, 0, reflected=True),
        "CRC-16/X-25": Code(16, 0x1021, 0xFFFF, 0xFFFF, reflected=True),
        "CRC-16/XMODEM": Code(16, 0x1021, 0, 0, reflected=False),
        "CRC-32": Code(32, 0x04C11DB7, 0xFFFFFFFF, 0xFFFFFFFF, reflected=True),
        "CRC-32/BZIP2": Code(32, 0x04C11DB7, 0xFFFFFFFF, 0xFFFFFFFF, reflected=False),
        "CRC-32/MPEG-2": Code(32, 0x04C11DB7, 0xFFFFFFFF, 0, reflected=False),
        "CRC-32C": Code(32, 0x1EDC6F41, 0xFFFFFFFF, 0xFFFFFFFF, reflected=True),
    }
)


# --- types ---------------------------------------------------------------------------------------------------------------


def _type_code(call: model.Call, arguments: list[typed.Expr], scope: Scope) -> typed.Expr | None:
    if len(arguments) != 2:
        scope.problems.append(words.arguments(call.span, len(arguments)))
        return None
    data, name = argument("crc", "text", arguments[0], scope), arguments[1]
    known = name.value if isinstance(name, typed.Const) and isinstance(name.value, str) else None
    if known is None or known not in CODES:
        scope.problems.append(words.unknown_code(name.span, known, tuple(CODES)))
        return None
    return None if data is None else typed.Call("crc", (data, name), Int(CODES[known].bits, signed=False), call.span)


# --- kernels -------------------------------------------------------------------------------------------------------------


def _lower_code(call: typed.Call, values: Evaluation) -> Expr:
    name = quoted(call.arguments[1]).decode()
    found = _routine(values.writer, placed_of(call.arguments[0], values), name, CODES[name])
    return Convert(scalar_name(scalar_of(Int(CODES[name].bits, signed=False))), found)


def _routine(writer: Writer, view: View, name: str, code: Code) -> Expr:
    """The code of bytes, byte by byte."""

    def make(inner: Writer) -> Contract:
        first, after, known = parameters(inner, view.lane)
        register = inner.var("register", _number(code.first))
        with scanning(inner, view.lane, first, after) as scan:
            _take(inner, register, Convert("u32", scan.byte), code)
        found = inner.let("code", Convert("i64", Binary("xor", register, _number(code.last))))
        return Contract((first, after), (found,), known, ())

    word = "".join(each if each.isalnum() else "_" for each in name.lower())
    (found,) = writer.call(f"{word}_{view.memory}", make, (view.first, view.after), MESSAGE)
    return found


def _take(writer: Writer, register: Local, byte: Expr, code: Code) -> None:
    """One more byte."""
    if code.reflected:
        shifted: Expr = Binary("shr", register, _number(8))
        mixed = Binary("xor", register, byte)
    else:
        shifted = Binary("and", Binary("shl", register, _number(8)), _number((1 << code.bits) - 1))
        mixed = Binary("xor", Binary("shr", register, _number(code.bits - 8)), byte)
    taken = writer.let("taken", Convert("i64", Convert("u8", mixed)))
    table = tuple(code.of_byte(number) for number in range(256))
    writer.assign(register, Binary("xor", shifted, Lookup("u32", table, taken)))


def _number(value: int) -> Const:
    return Const("u32", value)


ROW = Row(
    "bytes",
    '`crc(b, "CRC-32")`',
    (
        "uint8, uint16 or uint32: the checksum of bytes, also of `slice(b, 2, 10)`, by the code of that name: "
        + ", ".join(f"`{name}`" for name in CODES),
        "",
    ),
)

FUNCTIONS = (Function("crc", _type_code, _lower_code, SEVERAL, NOT_FOLLOWED, (ROW,), kept=False),)
