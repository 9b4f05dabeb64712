"""What annotations say (OMG IDL 4.2, 8.3; DDS-XTypes 1.3, 7.3.1.2). One that is not known says nothing."""

from __future__ import annotations

import json
import re
from ast import literal_eval
from typing import TYPE_CHECKING

from rosetta_jit.frameworks.omg import diagnostics as say
from rosetta_jit.frameworks.omg.constants import Lookup, Value, as_text, evaluate, fit
from rosetta_jit.frameworks.omg.expressions import ScopedName
from rosetta_jit.frameworks.omg.problems import LookupProblem
from rosetta_jit.model.types import Array, Bytes, Constant, Float, String, Type
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import dataclass
from rosetta_jit.startup.md5 import md5

if TYPE_CHECKING:
    from rosetta_jit.frameworks.omg.tree import Annotation

LARGEST_ID = 0x0FFFFFFF
EXTENSIBILITIES = ("final", "appendable", "mutable")
LIST = re.compile(r"\s*[(\[][^()\[\]{}]*[)\]]\s*")
"""How rosidl writes the default of an array: the text ``(1, 2, 3)``."""

Options = tuple[tuple[str, "Constant"], ...]


@dataclass(frozen=True, slots=True)
class Annotations:
    """The annotations of one declaration; of two with one name, the last counts."""

    written: tuple[Annotation, ...]
    lookup: Lookup

    def find(self, name: str) -> Annotation | None:
        return next((each for each in reversed(self.written) if each.name.removeprefix("::") == name), None)

    def value(self, name: str, argument: str = "value") -> Value | None:
        """The value of an annotation's argument; None where it is not there."""
        found = self.find(name)
        if found is None:
            return None
        for key, expr in found.arguments:
            if key in ("", argument):
                return (
                    Value("string", expr.parts[-1])
                    if name in ("autoid", "extensibility") and isinstance(expr, ScopedName)
                    else evaluate(expr, self.lookup)
                )
        return None

    def flag(self, name: str) -> bool:
        """Whether an annotation is there, and does not say FALSE."""
        found = self.find(name)
        if found is None:
            return False
        value = self.value(name)
        if value is not None and value.sort != "boolean":
            raise LookupProblem(say.annotation(found.span, name, "is TRUE or FALSE"))
        return value is None or value.value is True

    def text(self, name: str, argument: str = "value") -> str | None:
        value = self.value(name, argument)
        return value.value if value is not None and isinstance(value.value, str) else None

    def number(self, name: str, highest: int) -> int | None:
        """An annotation's number from 0 to a limit."""
        found, value = self.find(name), self.value(name)
        if found is None:
            return None
        if value is None or value.sort != "integer" or not isinstance(value.value, int) or not 0 <= value.value <= highest:
            raise LookupProblem(say.annotation(found.span, name, f"needs a number from 0 to {highest}"))
        return value.value

    @property
    def doc(self) -> str:
        """The comment that ``@verbatim`` carries."""
        found = self.find("verbatim")
        return (self.text("verbatim", "text") or "") if found and self.text("verbatim", "language") == "comment" else ""

    def hashed_ids(self, *, outer: bool) -> bool:
        """Whether ids are hashes of names (``@autoid``), where the scope around says that they are or are not."""
        if self.find("autoid") is None:
            return outer
        return (self.text("autoid") or "HASH").upper() == "HASH"

    def member_id(self, name: str, following: int, *, hashed: bool) -> int:
        """The id of a member (DDS-XTypes 1.3, 7.3.1.2.1.1)."""
        number = self.number("id", LARGEST_ID)
        if number is not None:
            return number
        if self.find("hashid") is not None:
            return hash_id(self.text("hashid") or name)
        return hash_id(name) if hashed else following

    def of_struct(self) -> Options:
        """The options of a struct or union, sorted."""
        options: dict[str, Constant] = {}
        for word in EXTENSIBILITIES:
            if self.flag(word):
                options["extensibility"] = word
        found, kind = self.find("extensibility"), (self.text("extensibility") or "").lower()
        if found is not None and kind not in EXTENSIBILITIES:
            raise LookupProblem(say.annotation(found.span, "extensibility", "is FINAL, APPENDABLE or MUTABLE"))
        if kind:
            options["extensibility"] = kind
        if self.flag("nested"):
            options["nested"] = True
        return tuple(sorted(options.items()))

    def of_member(self, type_: Type, default: Constant | None) -> tuple[Constant | None, Options]:
        """The default of a member, and its options."""
        options: dict[str, Constant] = {name: True for name in ("external", "key", "must_understand") if self.flag(name)}
        for name, annotation, argument in (
            ("max", "range", "max"),
            ("min", "range", "min"),
            ("max", "max", "value"),
            ("min", "min", "value"),
        ):
            limit = self.value(annotation, argument)
            if limit is not None:
                options[name] = limit.value
        found, value = self.find("default"), self.value("default")
        if found is not None and value is not None:
            default, more = _default(value, type_, found.span)
            options |= more
        return default, tuple(sorted(options.items()))


def hash_id(name: str) -> int:
    """28 bits of the MD5 of a name (DDS-XTypes 1.3, 7.3.1.2.1.1)."""
    return int.from_bytes(md5(name.encode("utf-8", "surrogatepass"), usedforsecurity=False).digest()[:4], "little") & LARGEST_ID


def _default(value: Value, type_: Type, span: Span) -> tuple[Constant | None, dict[str, Constant]]:
    if isinstance(type_, Array | Bytes) and isinstance(value.value, str):
        return _listed(value.value, type_)
    if isinstance(type_, Float) and isinstance(value.value, int) and value.sort == "integer":
        value = Value("floating", float(value.value))
    if isinstance(type_, String):
        value = as_text(value, type_)
    return fit(value, type_, span), {}


def _listed(text: str, type_: Array | Bytes) -> tuple[Constant | None, dict[str, Constant]]:
    """The default of an array: bytes, or a list in JSON as an option."""
    try:
        items = list(literal_eval(text)) if LIST.fullmatch(text) else []
        if isinstance(type_, Bytes):
            return bytes(items), {}
        return None, {"default": json.dumps(items)}
    except (ValueError, SyntaxError, TypeError, MemoryError, RecursionError):
        return None, {}
