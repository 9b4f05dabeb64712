"""LLVM's linker, for object files: neither numba nor the compiler is imported, but LLVM is. Code that is prelinked does without."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from llvmlite import binding

from rosetta_jit.runtime.code.allowed import ForeignCodeError, check_wanted
from rosetta_jit.runtime.code.object_file import undefined_symbols


def link(image: bytes, symbols: Sequence[str]) -> tuple[dict[str, int], Callable[[], object]]:
    """The addresses of an object file's symbols, and the function that frees its memory.

    It gets a linker of its own, because one that is shared keeps something of every library that it ever had.

    Raises
    ------
    ForeignCodeError
        If it is no object file for this machine, wants a symbol that is not allowed, or lacks one of ``symbols``.
    """
    check_wanted(undefined_symbols(image))
    binding.initialize_native_target()
    binding.initialize_native_asmprinter()
    linker = binding.create_lljit_compiler(suppress_errors=True)
    builder = binding.JITLibraryBuilder().add_object_img(image).add_current_process()
    for symbol in symbols:
        builder.export_symbol(symbol)
    try:
        code = builder.link(linker, "program")
    except RuntimeError as error:
        linker.close()
        raise ForeignCodeError(str(error)) from error

    def free() -> None:
        code.close()
        linker.close()

    return {symbol: code[symbol] for symbol in symbols}, free
