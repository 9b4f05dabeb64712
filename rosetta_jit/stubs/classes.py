"""The text of one class: fields with units and shapes beside them, and what the manners of its framework add.

Methods of a framework are inherited from the class of its manners, which is annotated itself. A name that is no identifier of Python is
left out, or another one takes its place.
"""

from __future__ import annotations

import builtins
import inspect
import keyword
import re
from collections.abc import Iterable, Iterator
from itertools import accumulate, repeat
from typing import Any, cast

from rosetta_jit.model.words import escaped, field_words
from rosetta_jit.runtime.holder import Holder
from rosetta_jit.runtime.holder.classes import HolderFamily
from rosetta_jit.runtime.holder.message import OWN_NAMES
from rosetta_jit.runtime.holder.record import Entry
from rosetta_jit.stubs.fields import Shapes, annotation, path

SIMPLE = (bool, int, float, str, bytes)
OVERRIDE = "  # type: ignore  # pyright: ignore"
"""Behind fields that stand in the way of a method."""


def class_text(family: HolderFamily, shapes: Shapes) -> Iterator[str]:
    """The lines of the class of a struct."""
    base = family.manners.base
    holder = family.holder()
    yield f"class {shapes.classes[family.struct.name]}({path(base)}):"
    yield f'    """A holder of `{_in_docstring(family.struct.name)}`."""'
    fields = {name: list(_field(entry, holder, family, shapes)) for name, entry in family.tree.root.entries.items()}
    lines = [line for each in fields.values() for line in each]
    for name, value in family.manners.members(family).items():
        if name not in fields and is_attribute(name) and not name.endswith("_") and not (name.startswith("_") and hasattr(base, name)):
            lines += _member(name, getattr(type(holder), name, value), value, shapes)
    yield from (f"    {_unhidden(line, shapes, fields.keys() & shapes.names)}" for line in (*lines, *_constructor(family, fields)))
    yield ""


def _unhidden(line: str, shapes: Shapes, hidden: set[str]) -> str:
    """A line whose annotations mean names of the module that fields of the class hide."""
    code, hash_, comment = line.partition("  #")
    for name in hidden:
        code = re.sub(rf"(?<=-> ){name}(?=:)|(?<![\w.]){name}(?![\w:(.])", shapes.beside(name), code)
    return f"{code}{hash_}{comment}"


def _in_docstring(name: str) -> str:
    return escaped(name).replace('"', "'")


def _field(entry: Entry, holder: Holder, family: HolderFamily, shapes: Shapes) -> Iterator[str]:
    """The lines of a field, or the reason why it has none."""
    words = field_words(entry.field, family.schema)
    if not is_attribute(entry.name) or entry.name in OWN_NAMES:
        yield f"# {escaped(entry.name)}: by `getattr` or `to_dict`; {words}"
        return
    found = annotation(entry, holder, family, shapes)
    ignored = OVERRIDE if hasattr(Holder, entry.name) or hasattr(family.manners.base, entry.name) else ""
    if found.takes is None:
        yield f"{entry.name}: {found.gives}{ignored}  # {words}"
        return
    yield "@builtins.property"
    yield f"def {entry.name}(self) -> {found.gives}: ...{ignored}  # {words}"
    if found.takes:
        yield f"@{entry.name}.setter"
        yield f"def {entry.name}(self, value: {found.takes}) -> None: ..."


def _member(name: str, found: Any, declared: Any, shapes: Shapes) -> Iterator[str]:
    """A constant, a nested class or a method that the class of a struct has besides."""
    if isinstance(found, type) and issubclass(found, Holder):
        if found.family_.struct.name in shapes.classes:
            yield f"{name}: typing.ClassVar[type[{shapes.classes[found.family_.struct.name]}]]"
    elif isinstance(declared, SIMPLE):
        yield f"{name}: typing.ClassVar[{type(declared).__name__}]"
    elif isinstance(declared, classmethod):
        yield "@builtins.classmethod"
        yield f"def {name}(cls, *arguments: typing.Any, **named: typing.Any) -> typing.Any: ..."
    elif isinstance(declared, property):
        yield f"{name}: typing.Any"
    elif inspect.isfunction(declared):
        yield f"def {name}(self, *arguments: typing.Any, **named: typing.Any) -> {_returned(declared)}: ..."
    else:
        yield f"{name}: typing.ClassVar[typing.Any]"


def _returned(function: Any) -> str:
    word = cast("dict[str, object]", function.__annotations__).get("return")
    return word if isinstance(word, str) and word in {"bool", "int", "float", "str", "bytes", "None"} else "typing.Any"


def _constructor(family: HolderFamily, fields: dict[str, list[str]]) -> Iterator[str]:
    """The constructor, with its fields by name where the framework's takes them."""
    taken = inspect.signature(family.manners.base.__init__).parameters.values()
    kinds = {each.kind for each in taken}
    if inspect.Parameter.VAR_KEYWORD not in kinds or "__init__" in family.manners.members(family):
        return
    names = [name for name in fields if is_attribute(name) and name != "self"]
    positional = next(other for other in accumulate(repeat("_"), initial="values") if other not in names)
    star = f"*{positional}: typing.Any" if inspect.Parameter.VAR_POSITIONAL in kinds else "*"
    keywords = "".join(f", {name}: typing.Any = ..." for name in names)
    yield f"def __init__(self, {star}{keywords}) -> None: ..." if names or star != "*" else "def __init__(self) -> None: ..."


MODULES = ("builtins", "collections", "numpy", "rosetta_jit", "typing", "typing_extensions")
"""What a stub imports."""

RESERVED = frozenset({*dir(builtins), *keyword.kwlist, "Decoder", "Encoder", "decoder", "encoder", *MODULES})
"""Names that mean something else in the text of a stub."""


def is_attribute(name: str) -> bool:
    """Whether an attribute of that name can be written down, and means itself: names of two underscores are changed inside classes."""
    return name.isascii() and name.isidentifier() and not keyword.iskeyword(name) and not name.startswith("__") and name not in MODULES


def class_names(structs: Iterable[str]) -> dict[str, str]:
    """Identifiers for qualified names: the last part alone where no other has it."""
    parts = {name: [re.sub(r"\W", "_", part, flags=re.ASCII) for part in _parts(name)] for name in structs}
    short = [_safe(each[-1]) for each in parts.values()]
    found: dict[str, str] = {}
    for name, each in parts.items():
        wanted = _safe(each[-1])
        candidate = wanted if short.count(wanted) == 1 else _safe("_".join(each))
        while candidate in found.values():
            candidate += "_"
        found[name] = candidate
    return found


def _parts(name: str) -> list[str]:
    return [part for part in name.replace("::", "/").replace(".", "/").split("/") if part] or ["Message"]


def _safe(name: str) -> str:
    """An identifier that begins with a letter, and means nothing else."""
    name = name if name[:1].isalpha() else f"v{name}"
    return f"{name}_" if name in RESERVED else name
