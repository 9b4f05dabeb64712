"""Object code: what it exports and wants, that it vectorises, and that it is exact."""

from __future__ import annotations

import platform
import re
import struct
import time
from dataclasses import replace

import pytest
from llvmlite import ir

from rosetta_jit.backends.entry.link import assembly, compile_program, llvm_text, object_file
from rosetta_jit.backends.entry.program import LONG, Program
from rosetta_jit.backends.llvm import function as llvm
from rosetta_jit.kernel.entries import SYMBOLS
from rosetta_jit.kernel.nodes import Binary, Const, Convert, For, If, Let, Load, Local, Place, SetField
from rosetta_jit.kernel.terms import BEGIN, ROW, add
from rosetta_jit.kernel.traits import are_straight_and_compute, has_loops_for_vectors, leaves_something
from rosetta_jit.pipeline.build import Build
from rosetta_jit.pipeline.request import Request
from rosetta_jit.runtime.code import native
from rosetta_jit.runtime.code.allowed import ALLOWED
from rosetta_jit.runtime.code.object_file import undefined_symbols
from tests.backends import kernels
from tests.backends.engines import outcome
from tests.backends.holders import rows

PROGRAMS = [("decode", (kernels.counted(),)), ("borrow", (kernels.tagged(),)), ("encode", kernels.encoder())]


@pytest.mark.parametrize(("entry", "program"), PROGRAMS)
@pytest.mark.parametrize("with_numba", [False, True])
def test_programs_link_with_nothing_but_what_is_allowed(entry, program, with_numba):
    image = object_file(program, entry, with_numba=with_numba)
    wanted = undefined_symbols(image)
    assert wanted <= ALLOWED
    assert "PyObject_Vectorcall" in wanted
    for each in (image, compile_program(program, entry, with_numba=with_numba)):
        library = native.load(each, SYMBOLS[entry])
        assert all(library[symbol] for symbol in SYMBOLS[entry])


@pytest.mark.parametrize("with_numba", [False, True])
def test_the_same_bytes_every_time(with_numba):
    images = {compile_program([kernels.fixed(3)], "decode", with_numba=with_numba) for _ in range(2)}
    assert len(images) == 1 or with_numba  # numba counts its functions, and their mangled names reach the string table


@pytest.mark.parametrize("with_numba", [False, True])
def test_loops_vectorise(with_numba):
    text = llvm_text([kernels.specialised()], "decode", with_numba=with_numba)
    assert re.search(r"fmul <\d+ x double>", text)
    assert re.search(r"fptrunc <\d+ x double>", text)
    assert re.search(r"shufflevector <\d+ x i8>", llvm_text([kernels.swapped()], "decode", with_numba=with_numba))


@pytest.mark.parametrize("with_numba", [False, True])
def test_no_arithmetic_is_relaxed(with_numba):
    text = llvm_text([kernels.specialised()], "decode", with_numba=with_numba)
    assert not re.search(r"\b(fast|contract|reassoc|nnan|ninf|nsz|arcp|afn)\b", text)
    assert "fma" not in assembly([kernels.specialised()], "decode", with_numba=with_numba)


def test_long_kernels_without_loops_have_vectors_too():
    """Fewer of LLVM's passes run for them."""
    long = _scaled(300)
    assert are_straight_and_compute([long])
    for other in (kernels.specialised(), kernels.text()):
        assert not are_straight_and_compute([long, other])
    assert re.search(r"fmul <\d+ x double>", llvm_text([long], "decode", with_numba=False))


def _scaled(count):
    """So many doubles, each of which is scaled and stored as a float."""
    (body,) = kernels.fixed(count).bodies
    read = tuple(Let(f"value{each}", Load("f64", add(BEGIN, 8 * each))) for each in range(count))
    scaled = [Convert("f32", Binary("mul", Local("f64", f"value{each}"), Const("f64", 0.1))) for each in range(count)]
    written = tuple(SetField(Place(0, ROW, 4 * each), value) for each, value in enumerate(scaled))
    return replace(kernels.fixed(count), bodies=((*body[:2], *read, *written, body[-1]),))


def test_values_loaded_where_they_are_needed_are_the_same():
    made = _scaled(300)
    message = struct.pack("<450d", *range(450))  # as many bytes as 300 tagged ones
    for data in (message, message[:-1]):
        assert outcome("llvm", made, data, rows(made)) == outcome("interpreter", made, data, rows(made))


def test_statements_that_compute_take_time_in_proportion():
    few, many = (_took_to_compile([_scaled(count)]) for count in (200, 1600))
    assert many < 12 * few  # 23 times as long where all is loaded before anything is stored


def test_loops_over_elements_are_worth_more_passes_in_kernels_of_some_size():
    assert has_loops_for_vectors(kernels.specialised())
    assert not has_loops_for_vectors(kernels.fixed(3))


def test_short_kernels_are_part_of_the_call():
    def is_called(kernel):
        code = assembly([kernel], "decode", with_numba=False)
        entry = code[code.index("\ncall:") :].partition(".cfi_endproc")[0]
        return re.search(r"\bkernel\b(?!\.)", entry) is not None

    assert not is_called(kernels.fixed(10))
    assert not is_called(kernels.attempts())
    assert is_called(kernels.fixed(300))


@pytest.mark.parametrize(
    ("type_", "encoding", "leaves"),
    [
        ("tf2_msgs/msg/TFMessage", "cdr", False),
        ("rst.kinematics.JointAngles", "protobuf", False),
        ("rst.vision.HeadObjects", "protobuf", True),
    ],
)
def test_messages_are_measured_before_they_are_written_where_that_leaves_something(type_, encoding, leaves):
    """Lengths of nested messages; else only where the size is asked for."""
    writes, size = Build(Request("encode", type=type_, encoding=encoding)).kernels
    assert leaves_something(size) is leaves
    text = llvm_text((writes, size), "encode", with_numba=False)
    loop = text[text.index("@many(") :].partition("\n}")[0]
    assert ("@size(" in loop) is leaves


def test_a_later_form_of_a_message_is_another_function():
    """Three forms: each but the first is reached from the one before."""
    text = llvm_text([kernels.attempts()], "decode", with_numba=False)
    found = re.findall(r"define (?:internal )?(preserve_mostcc )?[^@]*@(kernel\.next[.next]*)\(", text)
    assert found == [("", "kernel.next"), ("preserve_mostcc ", "kernel.next.next")]


@pytest.mark.parametrize("has_loop", [False, True])
def test_llvm_hurries_with_a_later_form_that_has_no_loop(has_loop):
    kernel, module = kernels.attempts(), ir.Module()
    first, second, *others = kernel.bodies
    second = (For("i", Const("i64", 2), (Let("twice", Const("i64", 2)),)), *second) if has_loop else second
    llvm.emit(module, replace(kernel, bodies=(first, second, *others)), "kernel")
    assert ("optnone" in module.get_global("kernel.next").attributes) is not has_loop


@pytest.mark.parametrize(("depth", "lines"), [(1, LONG), (3, LONG // 2)])
def test_code_is_made_in_a_hurry_where_it_would_take_long(depth, lines):
    """Statements in one, two and three blocks stand in two on average."""
    block = (Let("one", Const("i64", 1)),)
    for _ in range(depth - 1):
        block = (If(Const("bool", value=True), block),)
    program = Program([replace(kernels.fixed(1), bodies=(block,))], "decode", {"with_numba": False})
    assert [program.would_take_long(each) for each in (lines, lines + 1)] == [False, True]


def test_code_of_many_arrays_takes_time_in_proportion():
    few, many = (_took(count) for count in (8, 32))
    assert many < 12 * few  # 64 times as long where LLVM sees a place as the sum of all sizes before it


def _took(count):
    """The CPU time to compile a decoder of arrays whose numbers have their high byte first, each array behind the one before."""
    text = "\n".join(f"float64[] numbers{number}" for number in range(count))
    request = Request("decode", type="a/msg/Arrays", files=(("a/msg/Arrays.msg", text),), encoding="cdr", byte_order="big")
    return _took_to_compile(Build(request).kernels)


def _took_to_compile(kernels):
    started = time.process_time()
    object_file(kernels, "decode", with_numba=False)
    return time.process_time() - started


@pytest.mark.skipif(platform.machine() != "x86_64", reason="reads the assembler text of one processor")
def test_what_unusual_messages_need_is_no_part_of_the_usual_call():
    """Up to its first return the call saves no register, and calls nothing."""
    text = assembly([kernels.attempts()], "decode", with_numba=False)
    usual = re.search(r"^call:\n(.*?)\tretq\n", text, re.DOTALL | re.MULTILINE)
    assert usual is not None
    assert not re.search(r"\t(push|pop|call|sub)", usual[1])
    assert "kernel.next" in text
