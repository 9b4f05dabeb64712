"""The whole text of a stub: the classes of a type and of all in it, and the decoder and the encoder that a module of that name makes."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence

from rosetta_jit.model.words import escaped
from rosetta_jit.runtime.holder.classes import HolderFamily
from rosetta_jit.runtime.holder.record import Child, Items, Node, Pairs, Record
from rosetta_jit.stubs.classes import class_names, class_text
from rosetta_jit.stubs.fields import Shapes, path

HEAD = """\
# Types of `{what}` for type checkers and editors, written by `rosetta-jit stubs`; write it again when the schema changes.
# The module beside it, of the same name, makes the programs:
#
#     import rosetta_jit
#
#     {names} = {made}
"""

STANDARD, OTHERS = ("builtins", "collections.abc", "typing"), ("numpy", "rosetta_jit", "typing_extensions")
"""What may be imported, besides the modules of the classes that the text names."""

PROGRAMS = """\
class Decoder(rosetta_jit.Decoder):
    def __call__(self, message: typing_extensions.Buffer, holder: {name} | None = None, /) -> {name}: ...
    def into(self, message: typing_extensions.Buffer, holder: {name}, /) -> {name}: ...
    def new(self) -> {name}: ...
    @builtins.property
    def holder_type(self) -> type[{name}]: ...

class Encoder(rosetta_jit.Encoder):
    @typing.overload
    def __call__(self, holder: {name}) -> bytes: ...
    @typing.overload
    def __call__(self, holder: {name}, buffer: typing_extensions.Buffer, offset: int = 0) -> int: ...
    @typing.overload
    def __call__(self, holder: {name}, buffer: typing_extensions.Buffer | None = None, offset: int = 0) -> bytes | int: ...
    def into(self, holder: {name}, buffer: typing_extensions.Buffer, offset: int = 0) -> int: ...
    def new(self) -> {name}: ...
    @builtins.property
    def holder_type(self) -> type[{name}]: ...
"""

OF_ONE = """
decoder: Decoder
encoder: Encoder
"""

OF_WIRES = """
class Decoders(rosetta_jit.Decoders):
{decoders}    def __getitem__(self, wire: str) -> Decoder: ...
    def new(self) -> {name}: ...
    @builtins.property
    def holder(self) -> {name}: ...
    @builtins.property
    def holder_type(self) -> type[{name}]: ...

class Encoders(rosetta_jit.Encoders):
{encoders}    def __getitem__(self, wire: str) -> Encoder: ...
    def __call__(self, holder: {name}) -> dict[str, bytes]: ...
    def new(self) -> {name}: ...
    @builtins.property
    def holder_type(self) -> type[{name}]: ...

decoders: Decoders
encoders: Encoders
"""

SEQUENCE = """\
class {name}({base}):
    @typing.overload
    def __getitem__(self, index: int) -> {element}: ...
    @typing.overload
    def __getitem__(self, index: slice) -> list[{element}]: ...
    def __iter__(self) -> collections.abc.Iterator[{element}]: ...
"""
ADD = "    def add(self, **fields: typing.Any) -> {element}: ...\n"

MAPPING = """\
class {name}({base}):
    def __getitem__(self, key: {key}) -> {value}: ...
    def __iter__(self) -> collections.abc.Iterator[{key}]: ...
    def keys(self) -> collections.abc.KeysView[{key}]: ...
    def values(self) -> collections.abc.ValuesView[{value}]: ...
    def items(self) -> collections.abc.ItemsView[{key}, {value}]: ...
"""


def stub(family: HolderFamily, what: str, options: Mapping[str, object], *, is_mapping: bool, wires: Sequence[str] | None = None) -> str:
    """The text of a stub of a holder class; ``what`` is the mapping or the type that was asked for, with these options.

    ``wires`` are those of a mapping of several whose programs are attributes.
    """
    structs = list(dict.fromkeys([family.struct.name, *_structs(family.tree.root, set())]))
    shapes = Shapes(class_names(structs))
    families = [family.of_struct(struct).family_ for struct in structs]
    classes = "\n".join(line for each in families for line in class_text(each, shapes))
    made = ("Decoder", "Encoder") if wires is None else ("Decoders", "Encoders")
    name = shapes.classes[family.struct.name]
    programs = PROGRAMS.format(name=name) + (OF_ONE if wires is None else _of_wires(name, wires))
    aliases = [f"{alias}: typing.TypeAlias = {name}" for name, alias in sorted(shapes.aliases.items())]
    body = "\n".join((*_containers(shapes), classes, programs, *aliases)).rstrip("\n") + "\n"
    head = _head(what, options, made, is_mapping=is_mapping)
    return "\n".join((head, *_imports(body, STANDARD), *_imports(body, (*OTHERS, *sorted(_modules(families, shapes)))), body))


def _imports(body: str, modules: Iterable[str]) -> Iterator[str]:
    """A paragraph that imports those of the modules that the text names: what checkers have to say of the others is not for users."""
    code = "\n".join(line.partition("  #")[0] for line in body.splitlines())
    lines = [f"import {module}\n" for module in modules if re.search(rf"(?<![\w.]){re.escape(module)}\.", code)]
    if lines:
        yield "".join(lines)


def _of_wires(name: str, wires: Sequence[str]) -> str:
    """The programs of all wires, each also as an attribute."""
    decoders, encoders = ("".join(f"    {wire}: {kind}\n" for wire in wires) for kind in ("Decoder", "Encoder"))
    return OF_WIRES.format(name=name, decoders=decoders, encoders=encoders)


def _head(what: str, options: Mapping[str, object], made: tuple[str, str], *, is_mapping: bool) -> str:
    make = "rosetta_jit.{0}({1})" if is_mapping else "rosetta_jit.{0}.of({1})"
    options_text = escaped(", ".join((repr(what), *(f"{name}={value!r}" for name, value in options.items() if value))))
    names, programs = ", ".join(map(str.lower, made)), ", ".join(make.format(program, options_text) for program in made)
    return HEAD.format(what=escaped(what), names=names, made=programs)


def _modules(families: Iterable[HolderFamily], shapes: Shapes) -> set[str]:
    """The modules of the classes that the text names."""
    bases = [*(each.manners.base for each in families), *(key[0] for key in (*shapes.sequences, *shapes.mappings))]
    return {each.__module__ for each in (*bases, *(each.array_type for each in families)) if each.__module__ != "numpy"}


def _containers(shapes: Shapes) -> Iterator[str]:
    for (class_, element), name in shapes.sequences.items():
        text = SEQUENCE.format(name=name, base=path(class_), element=element)
        yield text + (ADD.format(element=element) if hasattr(class_, "add") else "")
    for (class_, key, value), name in shapes.mappings.items():
        yield MAPPING.format(name=name, base=path(class_), key=key, value=value)


def _structs(node: Node, seen: set[int]) -> Iterator[str]:
    """The names of the structs in a node."""
    if id(node) in seen:
        return
    seen.add(id(node))
    match node:
        case Record(struct):
            yield from [struct] if struct else []
            for entry in node.entries.values():
                yield from _structs(entry.node, seen)
        case Items(element=inner) | Child(record=inner):
            yield from _structs(inner, seen)
        case Pairs(value=value):
            yield from _structs(value.node, seen)
        case _:
            pass
