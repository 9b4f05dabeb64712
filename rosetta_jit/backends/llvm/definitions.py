"""The bodies of the functions of `support`: in the module that declares them, or in one of their own."""

from __future__ import annotations

from collections.abc import Iterable

from llvmlite import ir

from rosetta_jit.backends.llvm.support import SIGNATURES, declared


def define(module: ir.Module) -> None:
    """Define, for the module alone, those that it declares."""
    while missing := [module.globals[name] for name in SIGNATURES if name in module.globals and not module.globals[name].blocks]:
        for function in missing:
            function.linkage = "internal"
            _define(function)


def text(names: Iterable[str]) -> str:
    """A module that defines some of them for others."""
    module = ir.Module("support")
    exported = [declared(module, name) for name in names]
    define(module)
    for function in exported:
        function.linkage = ""
    return str(module)


def _define(function: ir.Function) -> None:
    """Imported here: few kernels call each of them."""
    if function.name == "rosetta_is_text":
        from rosetta_jit.backends.llvm import utf8

        utf8.define(function)
        return
    from rosetta_jit.backends.llvm import decimals

    decimals.DEFINITIONS[function.name](function)
