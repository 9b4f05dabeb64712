"""Instructions written as lines of text are those that llvmlite makes."""

from __future__ import annotations

import re

import pytest
from llvmlite import binding, ir

from rosetta_jit.backends.llvm.lines import Lines
from rosetta_jit.backends.llvm.values import COLD, F32, F64, I1, I8, I32, I64, POINTER, forgotten

SIGNS = ("==", "!=", "<", "<=", ">", ">=")
PAIR = ir.LiteralStructType([I64, I1])
ARGUMENTS = {"i": I64, "j": I64, "k": I32, "c": I1, "x": F64, "y": F64, "p": POINTER, "s": PAIR}

OPERATIONS = {
    **{name: lambda b, a, name=name: getattr(b, name)(a["i"], a["j"]) for name in ("and_", "or_", "xor", "shl", "lshr", "ashr", "udiv")},
    **{name: lambda b, a, name=name: getattr(b, name)(a["i"], a["j"], flags=("nsw",)) for name in ("add", "sub", "mul")},
    "plain add": lambda b, a: b.add(a["i"], a["j"]),
    "fadd": lambda b, a: b.fadd(a["x"], a["y"]),
    "neg": lambda b, a: b.neg(a["i"]),
    "not": lambda b, a: b.not_(a["c"]),
    **{f"signed {sign}": lambda b, a, sign=sign: b.icmp_signed(sign, a["i"], a["j"]) for sign in SIGNS},
    **{f"unsigned {sign}": lambda b, a, sign=sign: b.icmp_unsigned(sign, a["k"], ir.Constant(I32, 7)) for sign in SIGNS},
    **{f"ordered {sign}": lambda b, a, sign=sign: b.fcmp_ordered(sign, a["x"], a["y"]) for sign in SIGNS},
    **{f"unordered {sign}": lambda b, a, sign=sign: b.fcmp_unordered(sign, a["x"], a["y"]) for sign in SIGNS},
    "select": lambda b, a: b.select(a["c"], a["x"], ir.Constant(F64, 0.5)),
    "load": lambda b, a: b.load(a["p"], typ=F32, align=1),
    "load without alignment": lambda b, a: b.load(a["p"], typ=I64, name="word"),
    "store to a slot": lambda b, a: b.store(a["i"], b.alloca(I64, name="slot")),
    "store": lambda b, a: b.store(a["x"], a["p"], align=4),
    "store of a constant": lambda b, a: b.store(ir.Constant(I8, 1), a["p"]),
    "gep": lambda b, a: b.gep(a["p"], [a["i"]], source_etype=I8),
    "gep in bounds": lambda b, a: b.gep(a["p"], [ir.Constant(I64, 3)], inbounds=True, source_etype=I64, name="word"),
    "casts": lambda b, a: b.trunc(b.zext(a["k"], I64), I8),
    "sext": lambda b, a: b.sext(a["k"], I64),
    "bitcast": lambda b, a: b.bitcast(a["x"], I64),
    "a cast to its own type": lambda b, a: b.add(b.bitcast(a["i"], I64), a["j"]),
    "extract": lambda b, a: b.extract_value(a["s"], 1),
    "insert": lambda b, a: b.insert_value(a["s"], a["i"], 0),
    "call": lambda b, a: b.call(_declared(b, "f", I64, [I64, POINTER]), [a["i"], a["p"]]),
    "call for nothing": lambda b, a: b.call(_declared(b, "f", ir.VoidType(), [F64]), [a["x"]]),
    "call of few registers": lambda b, a: b.call(_declared(b, "f", I64, [I64], "preserve_mostcc"), [a["i"]]),
    "call of any number": lambda b, a: b.call(ir.Function(b.module, ir.FunctionType(I32, [POINTER], var_arg=True), "f"), [a["p"], a["i"]]),
    "overflow": lambda b, a: b.extract_value(b.sadd_with_overflow(a["i"], a["j"]), 0),
    "swap": lambda b, a: b.bswap(a["i"]),
    "assembler": lambda b, a: forgotten(b, a["i"]),
}


@pytest.mark.parametrize("name", OPERATIONS)
def test_operations_are_as_llvmlite_prints_them(name):
    ours, theirs = (text_of(make, lambda b, a: (OPERATIONS[name](b, a), b.ret_void())) for make in (Lines, ir.IRBuilder))
    assert ours == theirs


@pytest.mark.parametrize("weights", [None, COLD])
def test_branches_are_as_llvmlite_prints_them(weights):
    def branches(builder, arguments):
        there, here = builder.append_basic_block("there"), builder.append_basic_block("here")
        branch = builder.cbranch(arguments["c"], there, here)
        if weights is not None:
            branch.set_weights(weights)
        builder.position_at_end(here)
        assert not builder.block.is_terminated
        builder.branch(there)
        assert builder.block.is_terminated
        builder.position_at_end(there)
        index = builder.phi(I64, name="index")
        for block in (builder.function.blocks[0], here):
            index.add_incoming(arguments["i"], block)
        builder.ret_void()

    assert text_of(Lines, branches) == text_of(ir.IRBuilder, branches)


def test_builders_of_one_function_use_no_name_twice():
    def two(builder, arguments):
        behind = builder.append_basic_block("behind")
        beside = builder.beside(behind)
        builder.add(arguments["i"], arguments["j"])
        beside.load(arguments["p"], typ=I64, name="word")
        builder.load(arguments["p"], typ=I64, name="word")
        beside.ret_void()
        builder.branch(behind)

    assert text_of(Lines, two).count("load i64") == 2


def text_of(make, body):
    """A function with one block, as LLVM prints it, with names for all that has none of its own."""
    module = ir.Module("lines")
    function = ir.Function(module, ir.FunctionType(ir.VoidType(), list(ARGUMENTS.values())), "body")
    body(make(function.append_basic_block("entry")), dict(zip(ARGUMENTS, function.args, strict=True)))
    parsed = str(binding.parse_assembly(str(module)))
    numbers = {}
    return re.sub(r'%(?:"[^"]*"|[-\w.]+)', lambda match: numbers.setdefault(match[0], f"%{len(numbers)}"), parsed)


def _declared(builder, name, result, parameters, convention=""):
    function = ir.Function(builder.module, ir.FunctionType(result, parameters), name)
    function.calling_convention = convention
    return function
