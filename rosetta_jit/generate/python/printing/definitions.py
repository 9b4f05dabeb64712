"""Definitions of a module for what its functions name: those of the struct module, types of numpy, views of nothing."""

from __future__ import annotations

from rosetta_jit.generate.python.printing.scope import TRUTH

METHODS = {
    "load": "unpack_from",
    "each": "iter_unpack",
    "store": "pack_into",
    "whole": "pack",
    "reads": "unpack_from",
    "pieces": "unpack_from",
    "writes": "pack",
}
"""The methods of the struct module that read and write; ``reads``, ``pieces`` and ``writes`` are of as many as a message says."""


def definition(name: str) -> str:
    """That of a name of `Scope`, which says what it is: ``_load_Qd_be`` loads an integer and a float with their high bytes first."""
    _, verb, code, *order = name.split("_")
    first, code = ">" if order else "<", code.replace(TRUTH, "?")
    match verb:
        case "dtype":
            value = f'np.dtype("{first}{code}")'
        case "none":
            value = f'np.empty(0, "<{code}").copy'
        case "EMPTY":
            value = f'memoryview(b"").cast("{code}")'
        case "writes" if code in "qQ" and not order:
            value = f'_ByCount(("{{}}" + _{code}).format, "pack")'
        case "pieces":
            value = f'_ByCount("{code}".__mul__, "{METHODS[verb]}")'
        case "reads" | "writes":
            value = f'_ByCount("{first.strip("<")}{{}}{code}".format, "{METHODS[verb]}")'
        case _:
            value = f'Struct("{first}{code}").{METHODS[verb]}'
    return f"{name} = {value}"
