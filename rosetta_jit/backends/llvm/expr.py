"""Kernel expressions as LLVM values.

Nothing is checked here: `verify` has proven that no access leaves its memory and that no arithmetic of int64 wraps, which is why that
arithmetic carries `nsw`. Floats carry no fast-math flag: results are exact to the bit.
"""

from __future__ import annotations

import struct
from math import gcd
from typing import assert_never

from llvmlite import ir

from rosetta_jit.backends.llvm.frame import Frame, Variable
from rosetta_jit.backends.llvm.support import declared
from rosetta_jit.backends.llvm.values import F32, I1, I8, I64, LLVM_TYPES, POINTER, constant, intrinsic, is_float, is_signed
from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.terms import BEGIN, type_of
from rosetta_jit.startup.sha import sha256

PREDICATES = {"eq": "==", "ne": "!=", "lt": "<", "le": "<=", "gt": ">", "ge": ">="}
FLOAT_BINARY = {"add": "fadd", "sub": "fsub", "mul": "fmul", "div": "fdiv", "rem": "frem"}
ANGULAR = frozenset(("sin", "cos", "tan", "asin", "acos", "atan"))
"""Functions of the C library."""

BITWISE = {"and": "and_", "or": "or_", "xor": "xor", "shl": "shl"}


def expression(frame: Frame, expr: nodes.Expr) -> ir.Value:
    """The value of an expression, computed where the frame's builder stands."""
    match expr:
        case nodes.Const(type_, value):
            return scalar_constant(type_, value)
        case nodes.Local(_, name):
            return _local(frame, name)
        case nodes.Load(type_, at, order):
            return load(frame, wire_pointer(frame, at), type_, alignment=1, order=order)
        case nodes.Get(type_, place):
            return load(frame, place_pointer(frame, place), type_, alignment=place_alignment(frame, place, type_))
        case nodes.Used() | nodes.Capacity() | nodes.HostValue() | nodes.Register():
            return _known(frame, expr)
        case nodes.Unary(function, operand):
            return _unary(frame, function, expression(frame, operand), type_of(operand))
        case nodes.Binary(op, left, right):
            return _binary(frame, op, expression(frame, left), expression(frame, right), type_of(left))
        case nodes.Compare(op, left, right):
            return _compare(frame, op, expression(frame, left), expression(frame, right), type_of(left))
        case nodes.Fits(op, left, right):
            return _fits(frame, op, expression(frame, left), expression(frame, right))
        case nodes.Convert(type_, operand) | nodes.Bits(type_, operand):
            value = expression(frame, operand)
            is_bits = isinstance(expr, nodes.Bits)
            return frame.builder.bitcast(value, LLVM_TYPES[type_]) if is_bits else _convert(frame, value, type_of(operand), type_)
        case nodes.Select(condition, then, otherwise):
            values = expression(frame, then), expression(frame, otherwise)
            return frame.builder.select(expression(frame, condition), *values)
        case nodes.IsText(address, size):
            return frame.builder.call(declared(frame.module, "rosetta_is_text"), [pointer(frame, address), expression(frame, size)])
        case nodes.Nearest() | nodes.Digits() | nodes.Scale():
            return _decimal(frame, expr)
        case nodes.Lookup(type_, values, index):
            return _looked_up(frame, type_, values, expression(frame, index))
        case _:
            assert_never(expr)


def _known(frame: Frame, expr: nodes.Known) -> ir.Value:
    match expr:
        case nodes.Used(lane):
            return frame.builder.load(frame.used_slot(lane), typ=I64)
        case nodes.Capacity(lane):
            return frame.capacity(lane)
        case nodes.HostValue(what):
            return frame.host_value(what)
        case nodes.Register(number):
            return frame.register(number)
        case _:
            assert_never(expr)


def _decimal(frame: Frame, expr: nodes.Nearest | nodes.Digits | nodes.Scale) -> ir.Value:
    from rosetta_jit.backends.llvm import decimals as llvm_decimals

    match expr:
        case nodes.Nearest(address, size, exponent):
            text, length, power = pointer(frame, address), expression(frame, size), expression(frame, exponent)
            return llvm_decimals.nearest(frame.module, frame.builder, text, length, power)
        case nodes.Digits(value, places):
            number = expression(frame, value)
            if places is None:
                return llvm_decimals.shortest(frame.module, frame.builder, number, 0)
            return llvm_decimals.fixed(frame.module, frame.builder, number, places)
        case nodes.Scale(value):
            return llvm_decimals.shortest(frame.module, frame.builder, expression(frame, value), 1)
        case _:
            assert_never(expr)


def _looked_up(frame: Frame, type_: nodes.Scalar, values: tuple[int, ...], index: ir.Value) -> ir.Value:
    """A value of a constant of the module; equal tables are one."""
    kind = LLVM_TYPES[type_]
    name = f"rosetta_table_{type_}_{sha256(repr(values).encode()).hexdigest()[:16]}"
    table = frame.module.globals.get(name)
    if table is None:
        array = ir.ArrayType(kind, len(values))
        table = ir.GlobalVariable(frame.module, array, name)
        table.linkage, table.global_constant, table.initializer = "internal", True, ir.Constant(array, list(values))
    builder = frame.builder
    return builder.load(builder.gep(table, [index], inbounds=True, source_etype=kind), typ=kind, align=nodes.WIDTH[type_])


def pointer(frame: Frame, address: nodes.Address) -> ir.Value:
    """The machine address of a place or of a byte of the message."""
    return wire_pointer(frame, address.at) if isinstance(address, nodes.Wire) else place_pointer(frame, address)


def wire_pointer(frame: Frame, at: nodes.Expr) -> ir.Value:
    """The machine address of a byte of the message."""
    base, offset = base_and_offset(at)
    if base == BEGIN:
        return _moved(frame, frame.message(), offset)
    place = expression(frame, base)

    def start() -> ir.Value:
        return frame.builder.gep(frame.parameters.buffer, [place], source_etype=I8)

    return _moved(frame, frame.based(("message", place), start), offset)


def place_pointer(frame: Frame, place: nodes.Place) -> ir.Value:
    """The machine address of a field of a row."""
    builder, stride = frame.builder, frame.strides[place.lane]
    base, rows = base_and_offset(place.row)
    row = expression(frame, base)

    def start() -> ir.Value:
        distance = row if stride == 1 else builder.mul(row, constant(stride), flags=("nsw",))
        return builder.gep(frame.address(place.lane), [distance], source_etype=I8)

    address = frame.based((place.lane, row), start)
    offset = None if frame.stretch is None else frame.stretch.offsets.get((place.lane, place.offset))
    if frame.stretch is None or offset is None:
        return _moved(frame, address, rows * stride + place.offset)
    column = frame.stretch.columns[offset.column]
    moved = frame.based((place.lane, row, offset.column), lambda: builder.gep(address, [column], source_etype=I8))
    return _moved(frame, moved, rows * stride + offset.further)


def base_and_offset(index: nodes.Expr) -> tuple[nodes.Expr, int]:
    """What is computed of an index, and the constant behind it: LLVM would find it with more effort."""
    match index:
        case nodes.Binary("add", base, nodes.Const("i64", offset)):
            return base, int(offset)
        case _:
            return index, 0


def _moved(frame: Frame, address: ir.Value, offset: int) -> ir.Value:
    return frame.builder.gep(address, [constant(offset)], source_etype=I8) if offset else address


def place_alignment(frame: Frame, place: nodes.Place, type_: nodes.Scalar) -> int:
    """What rows and offsets guarantee, at most the width of the scalar."""
    return gcd(nodes.WIDTH[type_], frame.strides[place.lane], place.offset)


def load(frame: Frame, address: ir.Value, type_: nodes.Scalar, *, alignment: int, order: nodes.Order = "<") -> ir.Value:
    """A scalar from memory; a bool is any byte but 0."""
    builder = frame.builder
    if type_ == "bool":
        return builder.icmp_unsigned("!=", builder.load(address, typ=I8, align=1), ir.Constant(I8, 0))
    if order == "<" or nodes.WIDTH[type_] == 1:
        return builder.load(address, typ=LLVM_TYPES[type_], align=alignment)
    bits = ir.IntType(8 * nodes.WIDTH[type_])
    value = builder.bswap(builder.load(address, typ=bits, align=alignment))
    return builder.bitcast(value, LLVM_TYPES[type_]) if is_float(type_) else value


def store(frame: Frame, address: ir.Value, value: ir.Value, type_: nodes.Scalar, *, alignment: int, order: nodes.Order = "<") -> None:
    """A scalar to memory; a bool is the byte 0 or 1."""
    builder = frame.builder
    if type_ == "bool":
        value = builder.zext(value, I8)
    elif order == ">" and nodes.WIDTH[type_] > 1:
        bits = ir.IntType(8 * nodes.WIDTH[type_])
        value = builder.bswap(builder.bitcast(value, bits) if is_float(type_) else value)
    builder.store(value, address, align=alignment)


def scalar_constant(type_: nodes.Scalar, value: float) -> ir.Constant:
    """A constant of a scalar type."""
    if type_ == "i64":
        return constant(int(value))
    if not is_float(type_):
        return ir.Constant(LLVM_TYPES[type_], int(value))
    if type_ == "f32" and value == value:  # noqa: PLR0124 - NaN, whose bits need no rounding
        value = _nearest_single(value)
    return ir.Constant(LLVM_TYPES[type_], float(value))


def _nearest_single(value: float) -> float:
    try:
        return struct.unpack("<f", struct.pack("<f", value))[0]
    except OverflowError:  # IEEE 754, 7.4: beyond the largest number lies infinity
        return float("inf") if value > 0 else float("-inf")


def _local(frame: Frame, name: str) -> ir.Value:
    value = frame.locals[name]
    return frame.builder.load(value.slot, typ=value.type) if isinstance(value, Variable) else value


def _unary(frame: Frame, function: str, value: ir.Value, type_: nodes.Scalar) -> ir.Value:
    builder, kind = frame.builder, LLVM_TYPES[type_]
    if function == "not":
        return builder.not_(value)
    if is_float(type_):
        if function == "neg":
            return builder.fneg(value)
        if function in ANGULAR:
            library = intrinsic(frame.module, function, kind, [kind])
            library.attributes.add("readnone")  # so that the sine and the cosine of an angle are computed together
            return builder.call(library, [value])
        name = {"abs": "fabs"}.get(function, function)
        return builder.call(intrinsic(frame.module, f"llvm.{name}.{type_}", kind, [kind]), [value])
    match function:
        case "neg":
            return builder.neg(value)
        case "abs" if is_signed(type_):
            return builder.call(intrinsic(frame.module, f"llvm.abs.{kind}", kind, [kind, I1]), [value, ir.Constant(I1, 0)])
        case _:
            return value  # an integer is its own floor; an unsigned one its own absolute value


def _binary(frame: Frame, op: str, left: ir.Value, right: ir.Value, type_: nodes.Scalar) -> ir.Value:
    builder = frame.builder
    if op in ("min", "max"):
        return _extremum(frame, op, left, right, type_)
    if op == "atan2":
        return builder.call(intrinsic(frame.module, op, left.type, [left.type] * 2), [left, right])
    if is_float(type_):
        return getattr(builder, FLOAT_BINARY[op])(left, right)
    if op in BITWISE:
        return getattr(builder, BITWISE[op])(left, right)
    if op == "wrapping_add":
        return builder.add(left, right)
    if op in ("add", "sub", "mul"):
        return getattr(builder, op)(left, right, flags=("nsw",) if type_ == "i64" else ())
    match op, is_signed(type_):
        case "shr", signed:
            return builder.ashr(left, right) if signed else builder.lshr(left, right)
        case "div", signed:
            return builder.sdiv(left, right) if signed else builder.udiv(left, right)
        case "rem", signed:
            return builder.srem(left, right) if signed else builder.urem(left, right)
        case _:
            raise AssertionError(op)


def _extremum(frame: Frame, op: str, left: ir.Value, right: ir.Value, type_: nodes.Scalar) -> ir.Value:
    """The left operand where it compares as the smaller (greater) one, else the right one: also if either is NaN."""
    beyond = _compare(frame, "lt" if op == "min" else "gt", left, right, type_)
    return frame.builder.select(beyond, left, right)


def _compare(frame: Frame, op: str, left: ir.Value, right: ir.Value, type_: nodes.Scalar) -> ir.Value:
    builder, predicate = frame.builder, PREDICATES[op]
    if is_float(type_):  # IEEE 754, 5.11: of all comparisons NaN satisfies `ne` alone
        return builder.fcmp_unordered(predicate, left, right) if op == "ne" else builder.fcmp_ordered(predicate, left, right)
    return builder.icmp_signed(predicate, left, right) if is_signed(type_) else builder.icmp_unsigned(predicate, left, right)


def _fits(frame: Frame, op: str, left: ir.Value, right: ir.Value) -> ir.Value:
    builder = frame.builder
    both = getattr(builder, f"s{op}_with_overflow")(left, right)
    return builder.not_(builder.extract_value(both, 1))


def _convert(frame: Frame, value: ir.Value, source: nodes.Scalar, target: nodes.Scalar) -> ir.Value:
    builder, kind = frame.builder, LLVM_TYPES[target]
    if target == "bool":
        return _compare(frame, "ne", value, scalar_constant(source, 0), source)
    match is_float(source), is_float(target):
        case True, True:
            if source == target:
                return value
            return builder.fptrunc(value, F32) if target == "f32" else builder.fpext(value, kind)
        case True, False:
            name = f"llvm.fpto{'s' if is_signed(target) else 'u'}i.sat.{kind}.{source}"
            return builder.call(intrinsic(frame.module, name, kind, [value.type]), [value])
        case False, True:
            return builder.sitofp(value, kind) if is_signed(source) else builder.uitofp(value, kind)
        case _:
            return _resize(frame, value, source, target)


def _resize(frame: Frame, value: ir.Value, source: nodes.Scalar, target: nodes.Scalar) -> ir.Value:
    builder, kind = frame.builder, LLVM_TYPES[target]
    if value.type == kind:
        return value
    if nodes.WIDTH[source] > nodes.WIDTH[target]:
        return builder.trunc(value, kind)
    return builder.sext(value, kind) if is_signed(source) else builder.zext(value, kind)


def copy_memory(frame: Frame, target: ir.Value, source: ir.Value, size: ir.Value) -> None:
    """LLVM's memcpy: the two do not overlap."""
    function = intrinsic(frame.module, "llvm.memcpy.p0.p0.i64", ir.VoidType(), [POINTER, POINTER, I64, I1])
    frame.builder.call(function, [target, source, size, ir.Constant(I1, 0)])


def fill_memory(frame: Frame, target: ir.Value, byte: int, size: ir.Value) -> None:
    """LLVM's memset."""
    function = intrinsic(frame.module, "llvm.memset.p0.i64", ir.VoidType(), [POINTER, I8, I64, I1])
    frame.builder.call(function, [target, ir.Constant(I8, byte), size, ir.Constant(I1, 0)])
