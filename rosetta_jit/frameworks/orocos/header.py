"""The front end of C++ headers: what libclang sees in a `.hpp` or `.h` file, to a schema."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.frameworks.orocos.compiler import Places, declarations
from rosetta_jit.frameworks.orocos.declared import declared
from rosetta_jit.frameworks.orocos.includes import gather
from rosetta_jit.model.types import Schema
from rosetta_jit.source import Source

if TYPE_CHECKING:
    from rosetta_jit.parsing.idl import Load


def parse(source: Source, load: Load) -> Schema:
    """All data types that a header and what it includes declare, by their qualified C++ names.

    Members of base classes come first. Besides structs and enums there are, so that a message can be one: every number type
    (``double``), ``std::vector`` of every number type, struct and enum, and what a typedef names; each is a struct of one field, ``data``.

    Parameters
    ----------
    source
        The header.
    load
        Finds what it includes. The standard library's data types are our own declarations, known even where a header forgets to include
        them; nothing is read from the machine.

    Raises
    ------
    SchemaError
        With everything in the header that is no plain data, and with what it needs of included files. Classes of included files that
        no member refers to are left out if they are none.
    """
    texts = gather(source, load)
    return declared(declarations(texts), Places(texts))
