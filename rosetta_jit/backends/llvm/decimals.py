"""Floats in decimal as LLVM functions around the C library's `snprintf` and `strtod`, which round correctly.

Neither the point that they write nor the one that they read is looked at: the process may have set any locale.
"""

from __future__ import annotations

from collections.abc import Callable

from llvmlite import ir

from rosetta_jit.backends.llvm.support import BOTH, declared
from rosetta_jit.backends.llvm.values import F32, F64, I8, I32, I64, POINTER, constant, intrinsic
from rosetta_jit.kernel.decimals import FIRST, LAST, LEAST_NORMAL
from rosetta_jit.kernel.limits import MAX_DIGITS

ROOM = 400
"""Bytes of the longest number that is written: a float64 has 309 digits before its point."""

EXPONENT_ROOM = 32
SNPRINTF = ir.FunctionType(I32, [POINTER, I64, POINTER], var_arg=True)


def shortest(module: ir.Module, builder: ir.IRBuilder, value: ir.Value, part: int) -> ir.Value:
    """Digits (part 0) or scale (part 1) of a float, as `kernel.decimals.shortest`."""
    single = value.type == F32
    name = f"rosetta_shortest_f{32 if single else 64}"
    function = declared(module, name)
    wide = builder.fpext(value, F64) if single else value
    return builder.extract_value(builder.call(function, [wide]), part)


def fixed(module: ir.Module, builder: ir.IRBuilder, value: ir.Value, places: int) -> ir.Value:
    """The digits of a float to a number of decimals, as an integer."""
    function = declared(module, "rosetta_fixed")
    wide = builder.fpext(value, F64) if value.type == F32 else value
    return builder.call(function, [wide, ir.Constant(I32, places)])


def nearest(module: ir.Module, builder: ir.IRBuilder, text: ir.Value, size: ir.Value, exponent: ir.Value) -> ir.Value:
    """The float64 nearest to the digits of a text times a power of ten."""
    function = declared(module, "rosetta_nearest")
    return builder.call(function, [text, size, exponent])


def _shortest(function: ir.Function, *, single: bool) -> None:
    """Write the number with one digit more each round, until it reads back."""
    module, type_ = function.module, "f32" if single else "f64"
    names = ("entry", "loop", "done", "other", "above", "more", "nothing")
    entry, loop, done, other, above, more, nothing = (function.append_basic_block(name) for name in names)
    builder = ir.IRBuilder(entry)
    room = builder.alloca(I8, constant(ROOM))
    value = builder.call(intrinsic(module, "llvm.fabs.f64", F64, [F64]), [function.args[0]])
    normal = builder.fcmp_ordered(">=", value, ir.Constant(F64, LEAST_NORMAL[type_]))
    first = builder.select(normal, ir.Constant(I32, FIRST[type_]), ir.Constant(I32, 1))
    zero, infinity = ir.Constant(F64, 0.0), ir.Constant(F64, float("inf"))
    builder.cbranch(builder.and_(builder.fcmp_ordered(">", value, zero), builder.fcmp_ordered("<", value, infinity)), loop, nothing)

    builder.position_at_end(loop)
    count = builder.phi(I32)
    decimals = builder.sub(count, ir.Constant(I32, 1))
    builder.call(_snprintf(module), [room, constant(ROOM), _text(module, "%.*e"), decimals, value])
    found = builder.call(declared(module, "rosetta_digits"), [room])
    digits, power = builder.extract_value(found, 0), builder.sub(builder.extract_value(found, 1), builder.sext(decimals, I64))
    last = builder.icmp_signed("==", count, ir.Constant(I32, LAST[type_]))  # whatever rounding the process has asked for
    builder.cbranch(builder.or_(last, _reads_back(module, builder, room, value, single=single)), done, other)
    builder.position_at_end(other)
    fraction = builder.and_(builder.bitcast(value, I64), constant(2**52 - 1))
    builder.cbranch(builder.icmp_signed("==", fraction, constant(0)), above, more)
    builder.position_at_end(above)
    next_ = builder.add(digits, constant(1))
    builder.call(_snprintf(module), [room, constant(ROOM), _text(module, "%llde%lld"), next_, power])
    builder.cbranch(_reads_back(module, builder, room, value, single=single), done, more)
    builder.position_at_end(more)
    count.add_incoming(first, entry)
    count.add_incoming(builder.add(count, ir.Constant(I32, 1)), more)
    builder.branch(loop)

    builder.position_at_end(done)
    best = builder.phi(I64)
    best.add_incoming(digits, loop)
    best.add_incoming(next_, above)
    builder.ret(builder.insert_value(builder.insert_value(ir.Constant(BOTH, [0, 0]), best, 0), power, 1))
    builder.position_at_end(nothing)
    builder.ret(ir.Constant(BOTH, [0, 0]))


def _reads_back(module: ir.Module, builder: ir.IRBuilder, text: ir.Value, value: ir.Value, *, single: bool) -> ir.Value:
    again = _strtod(module, builder, text)
    if single:
        again = builder.fpext(builder.fptrunc(again, F32), F64)
    return builder.fcmp_ordered("==", again, value)


def _fixed(function: ir.Function) -> None:
    module, (number, places) = function.module, function.args
    entry, finite, nothing = (function.append_basic_block(name) for name in ("entry", "finite", "nothing"))
    builder = ir.IRBuilder(entry)
    room = builder.alloca(I8, constant(ROOM))
    value = builder.call(intrinsic(module, "llvm.fabs.f64", F64, [F64]), [number])
    builder.cbranch(builder.fcmp_ordered("<", value, ir.Constant(F64, float("inf"))), finite, nothing)
    builder.position_at_end(finite)
    builder.call(_snprintf(module), [room, constant(ROOM), _text(module, "%.*f"), places, value])
    builder.ret(builder.extract_value(builder.call(declared(module, "rosetta_digits"), [room]), 0))
    builder.position_at_end(nothing)
    builder.ret(constant(0))


def _nearest(function: ir.Function) -> None:
    """Copy the digits to where a NUL can stand behind them; those beyond the last that matter become one."""
    text, size, exponent = function.args
    builder = ir.IRBuilder(function.append_basic_block("entry"))
    room = builder.alloca(I8, constant(MAX_DIGITS + EXPONENT_ROOM))
    digits, dropped, rest = _copied(builder, text, size, room)
    nothing, number = (function.append_basic_block(name) for name in ("nothing", "number"))
    builder.cbranch(builder.icmp_signed("==", digits, constant(0)), nothing, number)
    builder.position_at_end(nothing)
    builder.ret(ir.Constant(F64, 0.0))
    builder.position_at_end(number)
    _read_digits(builder, room, digits, builder.icmp_signed("!=", rest, constant(0)), builder.add(exponent, dropped))


def _copied(builder: ir.IRBuilder, text: ir.Value, size: ir.Value, room: ir.Value) -> tuple[ir.Value, ir.Value, ir.Value]:
    """Copy digits behind leading zeros, as many as matter: how many were, how many were not, and whether one of these is not 0."""
    names = ("loop", "byte", "digit", "keep", "drop", "next", "done")
    loop, byte, digit, keep, drop, next_, done = (builder.append_basic_block(name) for name in names)
    at, kept, dropped, rest = (builder.alloca(I64) for _ in range(4))
    for slot in (at, kept, dropped, rest):
        builder.store(constant(0), slot)
    builder.branch(loop)

    def get(slot: ir.Value) -> ir.Value:
        return builder.load(slot, typ=I64)

    builder.position_at_end(loop)
    builder.cbranch(builder.icmp_signed("<", get(at), size), byte, done)
    builder.position_at_end(byte)
    value = builder.sub(builder.load(builder.gep(text, [get(at)], source_etype=I8), typ=I8), ir.Constant(I8, ord("0")))
    is_zero = builder.icmp_unsigned("==", value, ir.Constant(I8, 0))
    leading = builder.and_(is_zero, builder.icmp_signed("==", get(kept), constant(0)))
    counts = builder.and_(builder.icmp_unsigned("<", value, ir.Constant(I8, 10)), builder.not_(leading))
    builder.cbranch(counts, digit, next_)
    builder.position_at_end(digit)
    builder.cbranch(builder.icmp_signed("<", get(kept), constant(MAX_DIGITS)), keep, drop)
    builder.position_at_end(keep)
    builder.store(builder.add(value, ir.Constant(I8, ord("0"))), builder.gep(room, [get(kept)], source_etype=I8))
    builder.store(builder.add(get(kept), constant(1)), kept)
    builder.branch(next_)
    builder.position_at_end(drop)
    builder.store(builder.add(get(dropped), constant(1)), dropped)
    builder.store(builder.or_(get(rest), builder.zext(value, I64)), rest)
    builder.branch(next_)
    builder.position_at_end(next_)
    builder.store(builder.add(get(at), constant(1)), at)
    builder.branch(loop)
    builder.position_at_end(done)
    return get(kept), get(dropped), get(rest)


def _read_digits(builder: ir.IRBuilder, room: ir.Value, digits: ir.Value, is_more: ir.Value, exponent: ir.Value) -> None:
    """Return the number of some digits and an exponent; where there was more than 0 behind the digits, they are followed by one more."""
    module, sticky = builder.module, builder.zext(is_more, I64)
    builder.store(ir.Constant(I8, ord("1")), builder.gep(room, [digits], source_etype=I8))
    behind = builder.gep(room, [builder.add(digits, sticky)], source_etype=I8)
    power = builder.sub(exponent, sticky)
    builder.call(_snprintf(module), [behind, constant(EXPONENT_ROOM - 2), _text(module, "e%lld"), power])
    builder.ret(_strtod(module, builder, room))


def _read(function: ir.Function) -> None:
    """Every digit before an `e` counts, whatever stands between."""
    (text,) = function.args
    entry, loop, go_on, ended, power, done = (
        function.append_basic_block(name) for name in ("entry", "loop", "go", "ended", "power", "done")
    )
    builder = ir.IRBuilder(entry)
    builder.branch(loop)
    builder.position_at_end(loop)
    at, total = builder.phi(I64), builder.phi(I64)
    byte = builder.load(builder.gep(text, [at], source_etype=I8), typ=I8)
    is_end = builder.icmp_unsigned("==", byte, ir.Constant(I8, 0))
    builder.cbranch(builder.or_(is_end, builder.icmp_unsigned("==", byte, ir.Constant(I8, ord("e")))), ended, go_on)
    builder.position_at_end(go_on)
    digit = builder.sub(byte, ir.Constant(I8, ord("0")))
    longer = builder.add(builder.mul(total, constant(10)), builder.zext(digit, I64))
    for phi, first, later in (
        (at, constant(0), builder.add(at, constant(1))),
        (total, constant(0), builder.select(builder.icmp_unsigned("<", digit, ir.Constant(I8, 10)), longer, total)),
    ):
        phi.add_incoming(first, entry)
        phi.add_incoming(later, go_on)
    builder.branch(loop)
    builder.position_at_end(ended)
    builder.cbranch(is_end, done, power)
    builder.position_at_end(power)
    behind = builder.gep(text, [builder.add(at, constant(1))], source_etype=I8)
    strtoll = intrinsic(function.module, "strtoll", I64, [POINTER, POINTER, I32])
    exponent = builder.call(strtoll, [behind, ir.Constant(POINTER, None), ir.Constant(I32, 10)])
    builder.branch(done)
    builder.position_at_end(done)
    found = builder.phi(I64)
    found.add_incoming(constant(0), ended)
    found.add_incoming(exponent, power)
    builder.ret(builder.insert_value(builder.insert_value(ir.Constant(BOTH, [0, 0]), total, 0), found, 1))


def _strtod(module: ir.Module, builder: ir.IRBuilder, text: ir.Value) -> ir.Value:
    return builder.call(intrinsic(module, "strtod", F64, [POINTER, POINTER]), [text, ir.Constant(POINTER, None)])


def _snprintf(module: ir.Module) -> ir.Function:
    return module.globals["snprintf"] if "snprintf" in module.globals else ir.Function(module, SNPRINTF, "snprintf")


def _text(module: ir.Module, text: str) -> ir.Value:
    """A private constant, with a NUL."""
    name = "rosetta_format_" + "".join(each if each.isalnum() else "_" for each in text)
    if name in module.globals:
        return module.globals[name]
    data = bytearray(text.encode() + b"\0")
    type_ = ir.ArrayType(I8, len(data))
    known = ir.GlobalVariable(module, type_, name)
    known.linkage, known.global_constant, known.initializer = "internal", True, ir.Constant(type_, data)
    return known


DEFINITIONS: dict[str, Callable[[ir.Function], None]] = {
    "rosetta_shortest_f64": lambda function: _shortest(function, single=False),
    "rosetta_shortest_f32": lambda function: _shortest(function, single=True),
    "rosetta_fixed": _fixed,
    "rosetta_nearest": _nearest,
    "rosetta_digits": _read,
}
"""What gives each of the functions of `support` that belong here its body."""
