"""Loading object code: only what is ours, without the compiler, and gone when dropped."""

from __future__ import annotations

import subprocess
import sys
from contextlib import suppress
from pathlib import Path

import pytest
from llvmlite import binding

from rosetta_jit.backends.entry.link import compile_program, object_file
from rosetta_jit.kernel.entries import SYMBOLS
from rosetta_jit.runtime.code import native
from rosetta_jit.runtime.code.allowed import ForeignCodeError
from rosetta_jit.runtime.code.assembler import target_machine
from rosetta_jit.runtime.code.object_file import undefined_symbols
from rosetta_jit.runtime.code.prelink import prelinked
from rosetta_jit.runtime.code.prelinked import MAGIC, from_bytes
from tests.backends import kernels

LINUX = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="ELF alone is examined")


@pytest.fixture(scope="module", params=["prelinked", "object file"])
def image(request):
    """What is loaded with and without LLVM; on systems that have no prelinked code, twice the same."""
    compiled = compile_program if request.param == "prelinked" else object_file
    return compiled([kernels.fixed(2)], "decode", with_numba=False)


def test_the_same_code_is_loaded_once(image):
    library = native.load(image, SYMBOLS["decode"])
    assert all(library[symbol] for symbol in SYMBOLS["decode"])
    assert native.load(image, SYMBOLS["decode"]) is library
    assert native.load(image, ["kernel"]) is not library


@LINUX
def test_foreign_symbols_are_refused_before_linking():
    text = "declare i32 @system(ptr)\ndefine i32 @kernel(ptr %a) {\n  %b = call i32 @system(ptr %a)\n  ret i32 %b\n}"
    foreign = target_machine().emit_object(binding.parse_assembly(text))
    assert undefined_symbols(foreign) == {"system"}
    for image in (foreign, prelinked(foreign) or foreign):
        with pytest.raises(ForeignCodeError, match="system"):
            native.load(image, ["kernel"])


def test_a_missing_symbol_is_an_error(image, capfd):
    with pytest.raises(ForeignCodeError, match="absent"):
        native.load(image, ["absent"])
    assert not capfd.readouterr().err


@LINUX
@pytest.mark.parametrize("data", [b"", b"MZ", b"\x7fELF", b"\x7fELF" + bytes(100), MAGIC, MAGIC + bytes(100)])
def test_what_is_no_object_file_is_refused(data):
    with pytest.raises(ForeignCodeError):
        native.load(data, ["kernel"])


@LINUX
def test_damaged_headers_raise_nothing_else(image):
    read = from_bytes if image.startswith(MAGIC) else undefined_symbols
    for length in range(0, len(image), 7):
        with suppress(ForeignCodeError):
            read(image[:length])
    for position in range(200):
        for byte in (0, 1, 34, 57, 127, 255):
            with suppress(ForeignCodeError):
                read(image[:position] + bytes([byte]) + image[position + 1 :])


def test_loading_imports_no_compiler(image, tmp_path):
    file = tmp_path / "image.o"
    file.write_bytes(image)
    script = (
        "import sys, pathlib; from rosetta_jit.runtime.code import native\n"
        f"native.load(pathlib.Path({str(file)!r}).read_bytes(), ('kernel',))\n"
        "print([name for name in ('numba', 'lark', 'rosetta_jit.backends.entry.link', 'rosetta_jit.kernel.ir') if name in sys.modules])"
    )
    answer = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert answer.stdout.strip() == "[]"


def test_prelinked_code_needs_no_linker(tmp_path):
    file = tmp_path / "image"
    file.write_bytes(compile_program([kernels.fixed(2)], "decode", with_numba=False))
    if not file.read_bytes().startswith(MAGIC):
        pytest.skip("this system has no prelinked code")
    script = (
        "import sys, pathlib; from rosetta_jit.runtime.code import native\n"
        f"native.load(pathlib.Path({str(file)!r}).read_bytes(), ('kernel',))\n"
        "print('llvmlite' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout.strip() == "False"


@LINUX
def test_dropped_libraries_leave_nothing(image):
    def resident():
        return int(Path("/proc/self/statm").read_text().split()[1]) * 4096

    for _ in range(100):
        native.load(image, SYMBOLS["decode"])
    before = resident()
    for _ in range(500):
        native.load(image, SYMBOLS["decode"])
    assert resident() - before < 500 * 1024
