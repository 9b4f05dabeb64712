"""What `help` and `inspect` say of holder classes and programs: fields with types, shapes and units; made when somebody asks for it."""

from __future__ import annotations

from collections.abc import Container
from typing import TYPE_CHECKING, Any, cast

if TYPE_CHECKING:
    import inspect

    from rosetta_jit.runtime.holder.message import Family


INTERNAL = frozenset({"_attributes", "_code", "_is_native", "_members", "_is_view", "__annotations__", "__signature__", "__weakref__"})
"""Attributes of classes that are nobody's business but ours, besides those whose names end with an underscore."""


def is_public(name: str, fields: Container[str] = ()) -> bool:
    """Whether an attribute of a holder is listed: all fields, and what is meant to be used."""
    if name in fields or (name.startswith("__") and name not in INTERNAL):
        return True
    return not (name in INTERNAL or name.endswith("_") or name.startswith(("_of_", "_kept_")))


class _Left:
    """The default of a field, in a signature: it is left as it is."""

    def __repr__(self) -> str:
        return "..."


class Constructor:
    """``__signature__`` of a holder class: its fields, where its constructor takes them."""

    def __get__(self, _: object, owner: type[Any]) -> inspect.Signature | None:
        import inspect  # slow, as most of what only people need
        import keyword

        kinds = {each.kind for each in inspect.signature(owner.__init__).parameters.values()}
        if inspect.Parameter.VAR_KEYWORD not in kinds:
            return None
        by_place = inspect.Parameter.VAR_POSITIONAL in kinds
        kind = inspect.Parameter.POSITIONAL_OR_KEYWORD if by_place else inspect.Parameter.KEYWORD_ONLY
        names = (name for name in owner.family_.tree.root.entries if name.isidentifier() and not keyword.iskeyword(name))
        return inspect.Signature([inspect.Parameter(name, kind, default=_Left()) for name in names])


class Described:
    """``__doc__`` of the classes of one family, and of their objects."""

    def __init__(self, family: Family) -> None:
        self._family = family

    def __get__(self, _: object, owner: object = None) -> str:
        from rosetta_jit.model.words import escaped, field_words

        family = self._family
        fields = [f"{escaped(name)}: {field_words(entry.field, family.schema)}" for name, entry in family.tree.root.entries.items()]
        return "\n".join((f"A holder of `{escaped(family.struct.name)}`.", *([""] if fields else []), *fields))


class DescribedProgram:
    """``__doc__`` of a class of programs, and of each of them: the fields of its holders, and the methods and attributes that it has."""

    def __init__(self, text: str | None) -> None:
        self._text = text or ""

    def __get__(self, program: object, owner: object = None) -> str:
        if program is None:
            return self._text
        import inspect  # slow

        names = [name for name in dir(program) if not name.startswith("_")]
        texts = {name: inspect.getdoc(inspect.getattr_static(type(program), name)) or "" for name in names}
        lines = (f"{name}: {' '.join(text.partition(chr(10) * 2)[0].split())}" for name, text in texts.items())
        return "\n".join(
            (self._text.partition("\n")[0], "", str(cast("Any", program).holder_type.__doc__), "", "Methods and attributes:", "", *lines)
        )
