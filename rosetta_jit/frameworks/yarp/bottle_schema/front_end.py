"""The front end of bottle schemas: `.bottle-schema` files into the meta-model.

    File     = { Import | "type.name" ( Body ) }        Import = (:import "path")
    Body     = [:packed | :bare] [(:documentation "...")] Field*
    Field    = ("name" Type [Constant] Option*)
    Type     = :int8 :uint8 :int16 :int32 (:int) :int64 :float32 :float64 (:double) :vocab32 (:vocab) :vocab64 :string :blob :bool
             | :quantum                       the quantum word of an image, whose bytes differ by dialect
             | :blob-size                     the length of a blob whose bytes are elsewhere
             | (:vocab :|set|)                a vocab32 that is always this one
             | (:list Type [(:length 16)])    elements of one type
             | (:bottle Body)                 a nested list with a place for each field
             | (:blob (:bottle Body))         a blob whose bytes are that, or a declared type: (:blob "type.name")
             | (:dict Type) | (:dict Field*)  a dict element: any keys with values of one type, or these keys
             | (:union Field*)                the last element of a bottle, whose code says which of these it is
             | "type.name"                    a nested list of a declared type
    Constant = number | "text" | :|set| | true | false | Expr
    Expr     = integer | field.field | (+ Expr Expr) and - * / | (align Expr Expr) | (length field.field)
    Option   = (:unit :degree) | (:documentation "...") | (:default 0) | (:length Expr) | :rest | :spread | :vector | (:key "...")
             | (:code :double) | (:padding 4) | (:since :yarp4)

YARP writes some types by hand, and not as bottles. The fields of a `:packed` struct are values without codes, one behind the other, and
nothing says how many; a `:bare` one has the code and the count of a list before such values. A list in one is complete, with its code: that
of its elements, or what `(:code :double)` says. `(:padding 4)` are bytes behind a value that mean nothing. A field that is there
`(:since :yarp4)` is an empty list for older dialects.

How it becomes the model: scalars carry their spelling as in `tags`; a string is `String("octets", "string")`. A field marked
`:rest` has the option ``rest``: the elements of its list lie in the enclosing bottle itself, after the fields before it; with
`:spread`, so do the fields of each element. One marked `:vector` keeps the type of its elements when it has none, as sig::Vector writes it
and a Bottle does not. A `(:dict Type)` is a `Map`; a `(:dict Field*)` is a `Struct` all of whose fields have the option ``key``, the key on
the wire. A `(:union Field*)` is a struct of its own (`forms`). An anonymous struct is named ``type.field``. Paths of computed constants
start at the declaration that they stand in.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from types import MappingProxyType
from typing import TYPE_CHECKING

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.yarp import bottle_diagnostics as catalogue
from rosetta_jit.frameworks.yarp.bottle_schema.check import check
from rosetta_jit.frameworks.yarp.bottle_schema.sexpr import Form, Node, Text, Word, head, read_forms
from rosetta_jit.frameworks.yarp.bottle_schema.types import read_struct
from rosetta_jit.frameworks.yarp.limits import MAX_PROBLEMS
from rosetta_jit.frameworks.yarp.names import TYPE_NAME
from rosetta_jit.model.types import Schema, Struct
from rosetta_jit.source import Source

if TYPE_CHECKING:
    from rosetta_jit.parsing.idl import Load


def parse(source: Source, load: Load) -> Schema:
    """All types that a bottle schema declares or imports.

    Raises
    ------
    SchemaError
        With everything that is wrong in the file and in those that it imports, up to `MAX_PROBLEMS`.
    """
    problems: list[Diagnostic] = []
    structs: dict[str, Struct] = {}
    sources = {source.name: source}
    unread = [source]
    while unread and len(problems) < MAX_PROBLEMS:
        for imported in _read_file(unread.pop(), load, structs, problems):
            if imported.name not in sources:
                sources[imported.name] = imported
                unread.append(imported)
    if not problems:
        problems += check(structs, MAX_PROBLEMS)
    if problems:
        raise SchemaError(tuple(problems[:MAX_PROBLEMS]))
    return Schema(MappingProxyType(structs), tuple(sources))


def _read_file(source: Source, load: Load, structs: dict[str, Struct], problems: list[Diagnostic]) -> list[Source]:
    """Adds the file's declarations to ``structs``; the result is what it imports."""
    try:
        nodes = deque(read_forms(source))
    except SchemaError as error:
        problems += error.diagnostics
        return []
    imports: list[Source] = []
    while nodes and len(problems) < MAX_PROBLEMS:
        match nodes.popleft():
            case Form((Word(":import"), Text(path, span))):
                imports += _import(load(path), catalogue.import_not_found(span, path), problems)
            case Text(name, span) as named:
                match nodes[0] if nodes else named:
                    case Form(fields) if head(nodes[0]) != ":import":
                        nodes.popleft()
                        _declare(named, fields, structs, problems)
                    case _:
                        problems.append(catalogue.no_fields(span, name))
            case node:
                problems.append(catalogue.not_a_declaration(node.span))
    return imports


def _import(found: Source | None, otherwise: Diagnostic, problems: list[Diagnostic]) -> list[Source]:
    if found is None:
        problems.append(otherwise)
        return []
    return [found]


def _declare(name: Text, body: Sequence[Node], structs: dict[str, Struct], problems: list[Diagnostic]) -> None:
    if not TYPE_NAME.fullmatch(name.value):
        problems.append(catalogue.invalid_name(name.span, name.value))
    elif name.value in structs:
        problems.append(catalogue.duplicate(name.span, "type", name.value, structs[name.value].span))
    else:
        structs[name.value] = read_struct(name.value, body, problems, span=name.span)
