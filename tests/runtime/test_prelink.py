"""Prelinked code against the same code from LLVM's linker, and what is left to that one."""

from __future__ import annotations

import ctypes
import os
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest
from llvmlite import binding

from rosetta_jit.backends.entry.link import compile_program, object_file
from rosetta_jit.kernel.entries import SYMBOLS
from rosetta_jit.runtime import code
from rosetta_jit.runtime.code import linker, native
from rosetta_jit.runtime.code.allowed import ALLOWED, ForeignCodeError
from rosetta_jit.runtime.code.assembler import target_machine
from rosetta_jit.runtime.code.prelink import prelinked
from rosetta_jit.runtime.code.prelinked import from_bytes, place, to_bytes
from tests.backends import kernels
from tests.backends.holders import KERNEL, rows
from tests.backends.messages import hostile

pytestmark = pytest.mark.skipif(sys.platform != "linux" or os.uname().machine != "x86_64", reason="x86-64 Linux alone has prelinked code")
PROGRAMS = [("decode", (kernels.counted(),)), ("borrow", (kernels.tagged(),)), ("encode", kernels.encoder())]
KERNELS = {
    "fixed": kernels.fixed(10),
    "specialised": kernels.specialised(),
    "counted": kernels.counted(),
    "varints": kernels.varints(),
    "tagged": kernels.tagged(),
    "text": kernels.text(),
}
COUNTER = """
@n = internal global i64 5
@many = internal global [9000 x i8] zeroinitializer
define i64 @next() {
  %old = load i64, ptr @n
  %new = add i64 %old, 1
  store i64 %new, ptr @n
  %last = getelementptr i8, ptr @many, i64 8999
  store volatile i8 1, ptr %last
  ret i64 %new
}
"""
TWICE_THE_SINE = """
declare double @sin(double)
define double @twice(double %x) {
  %y = call double @sin(double %x)
  %z = fadd double %y, %y
  ret double %z
}
"""
NUMBER = ctypes.CFUNCTYPE(ctypes.c_int64)


def compiled(text):
    return target_machine().emit_object(binding.parse_assembly(text))


def kernel_at(address):
    code = KERNEL(address)

    def run(message, holder):
        memory = ctypes.create_string_buffer(message, len(message) or 1)
        return holder.seen(code(ctypes.addressof(memory), 0, len(message), holder.state.ctypes.data, 0), 4)

    return run


@pytest.mark.parametrize(("entry", "program"), PROGRAMS)
@pytest.mark.parametrize("with_numba", [False, True])
def test_what_a_program_wants_and_gives(entry, program, with_numba):
    code = from_bytes(compile_program(program, entry, with_numba=with_numba))
    assert set(code.gives) == set(SYMBOLS[entry])
    assert "PyObject_Vectorcall" in code.wants
    assert set(code.wants) <= ALLOWED


@pytest.mark.parametrize("name", KERNELS)
def test_it_does_what_linked_code_does(name):
    kernel = KERNELS[name]
    image = object_file([kernel], "decode", with_numba=False)
    (linked, free_linked), (placed, free_placed) = linker.link(image, ("kernel",)), place(prelinked(image), ("kernel",))
    for message in hostile(name):
        assert kernel_at(placed["kernel"])(message, rows(kernel)) == kernel_at(linked["kernel"])(message, rows(kernel))
    free_linked()
    free_placed()


def test_what_is_written_is_each_loads_own():
    image = prelinked(compiled(COUNTER))
    (first, free_first), (second, free_second) = place(image, ("next",)), place(image, ("next",))
    assert [NUMBER(first["next"])() for _ in range(3)] == [6, 7, 8]
    assert NUMBER(second["next"])() == 6
    free_first()
    assert NUMBER(second["next"])() == 7
    free_second()


def test_no_memory_is_both_written_and_executed():
    text = "@n = dso_local global i64 5\ndefine i64 @next() {\n  store i64 6, ptr @n\n  ret i64 6\n}"
    addresses, free = place(prelinked(compiled(text)), ("next", "n"))
    assert {name: permissions(address) for name, address in addresses.items()} == {"next": "r-xp", "n": "rw-p"}
    free()


def permissions(address):
    for line in Path("/proc/self/maps").read_text().splitlines():
        extent, allowed = line.split()[:2]
        begin, end = (int(each, 16) for each in extent.split("-"))
        if begin <= address < end:
            return allowed
    return None


def test_a_system_that_executes_no_memory_is_told(monkeypatch):
    image = prelinked(compiled(COUNTER))
    given_up, real = [], code.prelinked._system()
    refusing = SimpleNamespace(mmap=real.mmap, mprotect=lambda *_: -1, munmap=lambda *extent: given_up.append(real.munmap(*extent)))
    monkeypatch.setattr(code.prelinked, "_system", lambda: refusing)
    with pytest.raises(ForeignCodeError, match='backend="python"'):
        place(image, ("next",))
    assert given_up == [0]


def test_functions_of_the_process_are_called():
    addresses, free = place(prelinked(compiled(TWICE_THE_SINE)), ("twice",))
    assert ctypes.CFUNCTYPE(ctypes.c_double, ctypes.c_double)(addresses["twice"])(0.5) == pytest.approx(0.958851077208406, abs=1e-15)
    free()


@pytest.mark.parametrize(
    "text",
    [
        "@n = global i64 5\ndefine i64 @next() {\n  %n = load i64, ptr @n\n  ret i64 %n\n}",
        "@n = thread_local global i64 5\ndefine i64 @next() {\n  %n = load i64, ptr @n\n  ret i64 %n\n}",
        "@at = global ptr @next\ndefine i64 @next() {\n  ret i64 6\n}",
        "@n = dso_local global i64 5, align 8192\ndefine i64 @next() {\n  %n = load i64, ptr @n\n  ret i64 %n\n}",
        "@n = common dso_local global i64 0\ndefine i64 @next() {\n  %n = load i64, ptr @n\n  ret i64 %n\n}",
    ],
)
def test_what_it_does_not_know_is_left_to_a_linker(text):
    image = compiled(text)
    assert prelinked(image) is None
    if "thread_local" not in text:
        library = native.load(image, ("next",))
        assert NUMBER(library["next"])() in (0, 5, 6)


def test_other_processors_and_systems_are_left_to_a_linker():
    image = object_file([kernels.fixed(2)], "decode", with_numba=False)
    assert prelinked(image[:0x12] + b"\xb7\x00" + image[0x14:]) is None  # AArch64
    assert prelinked(b"\xcf\xfa\xed\xfe" + image[4:]) is None  # Mach-O


def test_it_is_kept_as_bytes():
    code = from_bytes(compile_program([kernels.fixed(2)], "decode", with_numba=False))
    assert from_bytes(to_bytes(code)) == code


def test_prelinked_code_that_is_cut_is_damaged():
    image = prelinked(compiled(COUNTER))
    for size in range(len(image)):
        with pytest.raises(ForeignCodeError, match="damaged"):
            from_bytes(image[:size])
