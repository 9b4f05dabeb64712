"""What YARP writes for the types of a bottle schema, in one dialect.

    element = code, value          in a list that does not say one type for all its elements
    value   = a scalar's bytes | count, element* | ...

A struct is a list with a place for each field. A packed one is the values of its fields alone; a bare one has the code and the count of a
list, and then such values. A union is an element whose code says which of its cases it is.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.yarp import bottle_diagnostics as catalogue
from rosetta_jit.frameworks.yarp.forms import is_dict, is_packed, union_of
from rosetta_jit.frameworks.yarp.tags import DIALECTS, DICT, LIST, Dialect
from rosetta_jit.model import expr
from rosetta_jit.model.layout import map_entry
from rosetta_jit.model.types import Array, Bool, Bytes, Enum, Field, Float, Int, Map, Optional, Ref, Schema, String, Struct, Type, Union
from rosetta_jit.startup.dataclass import dataclass, replace
from rosetta_jit.startup.late import Late
from rosetta_jit.wire.codec import Blob, Cases, Choice, Codec, Computed, Constant, Count, Number, Padding, Path, Repeat, Seq, Table
from rosetta_jit.wire.size import fixed_size

if TYPE_CHECKING:
    from rosetta_jit.frameworks.yarp import computed
    from rosetta_jit.frameworks.yarp.computed import Scope
else:
    computed = Late("rosetta_jit.frameworks.yarp.computed")

BOOLEANS = ((49, 1), (0, 0))
"""True is the vocab '1', false is 0; YARP has no tag for them. (os/impl/BottleImpl.cpp, smartAdd)"""

SCALARS = {
    "int8": "i8",
    "int16": "i16",
    "int32": "i32",
    "int64": "i64",
    "float32": "f32",
    "float64": "f64",
    "vocab32": "i32",
    "vocab64": "i64",
    "quantum": "i32",
    "blob-size": "i32",
}

TAGGED_AS = {"quantum": "int32", "blob-size": "blob"}
"""Words for parts of an image's header, and the scalars whose tags they have."""

Form = tuple[int, Codec]
"""The code of a list, and the body that it announces."""


@dataclass(frozen=True, slots=True)
class Bottles:
    """Codecs of one dialect. ``exact`` ones describe only the form that YARP's writer chooses for lists that are not empty."""

    schema: Schema
    dialect: Dialect
    exact: bool = False
    scope: Scope | None = None

    def message(self, struct: Struct) -> Codec:
        """The codec of a whole message."""
        return self.within(struct, ()).struct(struct, ())

    def within(self, struct: Struct, path: Path) -> Bottles:
        """Codecs below a declaration: computed values of its fields name fields of it."""
        return replace(self, scope=computed.Scope(self.schema, struct, path))

    # --- structs -----------------------------------------------------------------------------------------------------

    def struct(self, struct: Struct, path: Path) -> Codec:
        """A struct with whatever says that it is one."""
        match struct.option("form"):
            case "packed":
                return self.values(struct, path)
            case "bare":
                count = Constant(path, len(struct.fields), "i32", kind="count")
                return Seq((Constant(path, LIST, "i32", kind="tag"), count, self.values(struct, path)))
            case _ if (union := self.last_union(struct)) is not None:
                return self.with_union(struct, union, path)
            case _:
                return self.coded(path, self.list_forms(struct, path), _rest_path(struct, path))

    def coded(self, path: Path, forms: tuple[Form, ...], may_be_empty: Path | None) -> Codec:
        """The code of a list, and the body that it announces."""
        if self.exact or len(forms) == 1:
            code, body = forms[0]
            return Seq((Constant(path, code, "i32", kind="tag"), body))
        return Choice(path if may_be_empty is None else may_be_empty, "i32", forms, when_empty=0 if may_be_empty is None else 1)

    def list_forms(self, struct: Struct, path: Path) -> tuple[Form, ...]:
        """The codes that a list of these fields may have, each with the body: the written one first."""
        units = self.units(struct.fields)
        general = (LIST, self.body(struct, path, tagged=True))
        unit = units.pop() if len(units) == 1 else None
        if unit is None:
            return (general,)
        return (LIST | self.tag(unit, struct.fields[0]), self.body(struct, path, tagged=False)), general

    def body(self, struct: Struct, path: Path, *, tagged: bool) -> Codec:
        """The count of a list and its elements."""
        keyed = is_dict(struct)
        fixed = [each for each in struct.fields if self.has(each) and not each.option("rest")]
        head = tuple(self.entry(each, path) if keyed else self.place(each, path, tagged=tagged) for each in fixed)
        rest = next((each for each in struct.fields if each.option("rest")), None)
        if rest is None:
            return Seq((Constant(path, len(head), "i32", kind="count"), *head, *self.absent(struct, path)))
        listed = self.elements(rest, (*path, rest.name), tagged=tagged, head=head)
        return Seq((listed, *absent)) if (absent := self.absent(struct, path)) else listed

    def absent(self, struct: Struct, path: Path) -> tuple[Codec, ...]:
        """The lists that the dialect does not have: they have no elements, and no bytes."""
        return tuple(Repeat((*path, each.name), Count(None, value=0), Seq(())) for each in struct.fields if not self.has(each))

    def has(self, field: Field) -> bool:
        """Whether the dialect is one of those that write a field."""
        known = [*DIALECTS]
        return known.index(str(field.option("since") or known[0])) <= known.index(self.dialect.name)

    def place(self, field: Field, path: Path, *, tagged: bool) -> Codec:
        """One field of a list, with the code of its type where the list does not say it for all."""
        here = (*path, field.name)
        return self.element(field, field.type, here) if tagged else self.value(field, field.type, here)

    def entry(self, field: Field, path: Path) -> Codec:
        """One key of a dict and its value: a list of both."""
        key = str(field.option("key")).encode()
        text = Seq((Constant((), len(key) + self.dialect.nul_terminated, "i32"), Constant((), key + b"\0" * self.dialect.nul_terminated)))
        text_tag = Constant((), self.dialect.tags["string"], "i32", kind="tag")
        count = Constant((), 2, "i32", kind="count")
        here = (*path, field.name)
        general = (LIST, Seq((count, text_tag, text, self.element(field, field.type, here))))
        if self.unit(field.type) != "string":
            return self.coded(here, (general,), None)
        special = (LIST | self.dialect.tags["string"], Seq((count, text, self.value(field, field.type, here))))
        return self.coded(here, (special, general), None)

    # --- elements ----------------------------------------------------------------------------------------------------

    def element(self, field: Field, type_: Type, path: Path) -> Codec:
        """A value after the code of its type."""
        resolved = self.schema.resolve(type_)
        if isinstance(type_, Ref) and isinstance(resolved, Struct):
            return self.within(resolved, path).element(field, resolved, path)
        match resolved:
            case Struct() if field.option("blob"):
                return Seq((Constant(path, self.dialect.tags["blob"], "i32", kind="tag"), self.blob(field, resolved, path)))
            case Struct() if is_packed(resolved):
                raise SchemaError((catalogue.packed_element(field.span, field.name),))
            case Struct() if union_of(resolved) is not None:
                raise SchemaError((catalogue.misplaced_union(field.span, field.name),))
            case Struct() if not is_dict(resolved):
                return self.struct(resolved, path)
            case Struct() | Map() | Array():
                return self.coded(path, self.forms(field, resolved, path), _free_path(field, resolved, path))
            case _:
                code = self.tag(self.unit(resolved) or "", field)
                return Seq((Constant(path, code, "i32", kind="tag"), self.scalar(field, resolved, path)))

    def forms(self, field: Field, type_: Struct | Map | Array, path: Path) -> tuple[Form, ...]:
        """The codes that a list or dict may have, each with the body: the written one first."""
        match type_:
            case Array():
                return self.array_forms(field, type_, path)
            case Map(key, value):
                entries = replace(field, type=Array(map_entry(key, value)), options=(), length=None)
                return ((DICT, Seq((Constant(path, LIST, "i32", kind="tag"), self.elements(entries, path, tagged=True)))),)
            case Struct() if is_dict(type_):
                return ((DICT, self.struct(type_, path)),)
            case Struct() if type_.option("form") or self.last_union(type_) is not None:
                raise SchemaError((catalogue.misplaced_union(field.span, field.name),))
            case Struct():
                return self.list_forms(type_, path)

    def array_forms(self, field: Field, array: Array, path: Path) -> tuple[Form, ...]:
        resolved, announced = replace(field, type=array), field.option("code")
        if announced is not None:
            return ((LIST | self.tag(str(announced), field), self.elements(resolved, path, tagged=False)),)
        general = (LIST, self.elements(resolved, path, tagged=True))
        unit = self.unit(array.element)
        if unit is None:
            return (general,)
        special = (LIST | self.tag(unit, field), self.elements(resolved, path, tagged=False))
        return (general, special) if array.fixed == 0 else (special, general)

    def elements(self, field: Field, path: Path, *, tagged: bool, head: tuple[Codec, ...] = ()) -> Codec:
        """Count and elements of an array field; ``head`` are fields of the same list before them."""
        array = self.schema.resolve(field.type)
        assert isinstance(array, Array)
        fixed = None if array.fixed is None else array.fixed + len(head)
        count = Count("i32", value=fixed if fixed is not None else self.computed(field.length))
        inner = replace(field, constant=None, length=None, options=())
        spread = self.spread(field)
        if field.option("spread") and (spread is None or not _is_plain(spread)):
            raise SchemaError((catalogue.not_spread(field.span, field.name),))
        if spread is not None:
            below = self.within(spread, ()) if isinstance(array.element, Ref) else self
            item: Codec = Seq(tuple(below.place(each, (), tagged=tagged) for each in spread.fields))
            return Repeat(path, replace(count, unit=len(spread.fields)), item, head, len(head))
        item = self.element(inner, array.element, ()) if tagged else self.value(inner, array.element, ())
        return Repeat(path, count, item, head, len(head))

    def spread(self, field: Field) -> Struct | None:
        """The struct whose fields lie in the list itself, if the list is one of such."""
        array = self.schema.resolve(field.type)
        element = self.schema.resolve(array.element) if isinstance(array, Array) and field.option("spread") else None
        return element if isinstance(element, Struct) else None

    def blob(self, field: Field, struct: Struct, path: Path) -> Codec:
        """The length of a blob, and its bytes, which are a struct."""
        content = replace(self, exact=True).struct(struct, path)
        size = fixed_size(content)
        if size is None:
            raise SchemaError((catalogue.blob_of_any_size(field.span, field.name),))
        return Seq((Constant(path, size, "i32", kind="count"), content))

    # --- values without a code ---------------------------------------------------------------------------------------

    def values(self, struct: Struct, path: Path) -> Codec:
        """The values of fields, one behind the other."""
        return Seq(tuple(self.value(each, each.type, (*path, each.name)) for each in struct.fields))

    def value(self, field: Field, type_: Type, path: Path) -> Codec:
        """A value where nothing says its type; lists always do themselves."""
        resolved = self.schema.resolve(type_)
        words, octets = divmod(int(field.option("padding") or 0), 4)
        behind = (*[Padding("u32", 0)] * words, *[Padding("u8", 0)] * octets)
        match resolved:
            case Struct() if field.option("blob") or is_packed(resolved):
                below = self.within(resolved, path) if isinstance(type_, Ref) else self
                found = below.blob(field, resolved, path) if field.option("blob") else below.values(resolved, path)
            case Struct() | Array() | Map():
                found = self.element(field, type_, path)
            case _:
                found = self.scalar(field, resolved, path)
        return Seq((found, *behind)) if behind else found

    def scalar(self, field: Field, type_: Type, path: Path) -> Codec:
        """A scalar without the code of its type."""
        match type_, field.constant:
            case _, expr.Literal(value):
                return self.constant(type_, path, value)
            case Int(spelling="quantum"), None if self.dialect.flagged_quantum:
                return Seq((Number(path, "i16"), Padding("i16", 1)))
            case Int(_, False, spelling), None:
                return Number(path, SCALARS[spelling].replace("i", "u"))
            case ((Int(_, _, spelling) | Float(_, spelling)), None):
                return Number(path, SCALARS[spelling])
            case Int(_, _, spelling), computed:
                return Computed(path, SCALARS[spelling], self.computed(computed) or computed)
            case Bool(), _:
                return Table(path, "i32", BOOLEANS)
            case String(), _:
                return Blob(path, Count("i32", value=self.computed(field.length)), terminated=self.dialect.nul_terminated)
            case Bytes(), _:
                return Blob(path, Count("i32", value=self.computed(field.length)))
            case _:
                raise AssertionError(type_)

    def constant(self, type_: Type, path: Path, value: bool | float | str) -> Codec:
        """A scalar that is always the same."""
        match type_:
            case String() | Bytes():
                text = str(value).encode()
                end = b"\0" * self.dialect.nul_terminated if isinstance(type_, String) else b""
                return Seq((Constant((), len(text) + len(end), "i32"), Constant(path, text), *([Constant((), end)] if end else [])))
            case Bool():
                return Constant(path, 49 if value else 0, "i32")
            case Int(_, signed, spelling):
                return Constant(path, int(value), SCALARS[spelling] if signed else SCALARS[spelling].replace("i", "u"))
            case _:
                assert not isinstance(value, str)
                return Constant(path, value, SCALARS[self.unit(type_) or ""])

    def computed(self, value: expr.Expr | None) -> expr.Expr | None:
        """A computed value of the declaration around."""
        return None if self.scope is None else self.scope.value(value)

    # --- unions ------------------------------------------------------------------------------------------------------

    def with_union(self, struct: Struct, union: Union, path: Path) -> Codec:
        """A list that ends with a union. Where its case makes all elements of one type, YARP's writer says that type once."""
        *head, last = (each for each in struct.fields if self.has(each))
        teller, cases = (*path, last.name, "_d"), (*path, last.name, "_u")
        count = Constant(path, len(head) + 1, "i32", kind="count")
        bodies = [self.case_form(each, (*cases, each.name)) for each in union.cases]
        if len({code for code, _ in bodies}) < len(bodies):
            raise SchemaError((catalogue.like_cases(last.span, last.name),))
        special: dict[int, Form] = {}
        for label, case in enumerate(union.cases):
            (unit,) = self.units([case])
            if unit is not None and self.units(head) <= {unit}:
                places = (self.place(each, path, tagged=False) for each in head)
                special[label] = LIST | self.tag(unit, case), Seq((count, *places, Table(teller, None, ((0, label),))))
        code = Table(teller, "i32", tuple((code, label) for label, (code, _) in enumerate(bodies)))
        general = (LIST, Seq((count, *(self.place(each, path, tagged=True) for each in head), code)))
        form = Choice(teller, "i32", (*special.values(), general), labels=tuple(special))
        chosen = Cases(cases, form, tuple(((label,), body) for label, (_, body) in enumerate(bodies)))
        return Seq((chosen, *absent)) if (absent := self.absent(struct, path)) else chosen

    def case_form(self, case: Field, path: Path) -> Form:
        """The code that announces a case of a union, and what follows it."""
        match self.schema.resolve(case.type):
            case Struct() if case.option("blob"):
                return self.dialect.tags["blob"], self.value(case, case.type, path)
            case (Struct() | Map() | Array()) as group:
                below = self.within(group, path) if isinstance(case.type, Ref) and isinstance(group, Struct) else self
                return below.forms(case, group, path)[0]
            case scalar:
                return self.tag(self.unit(scalar) or "", case), self.scalar(case, scalar, path)

    def last_union(self, struct: Struct) -> Union | None:
        """The union with which a struct ends, if it does."""
        return union_of(self.schema.resolve(struct.fields[-1].type)) if struct.fields else None

    # --- tags --------------------------------------------------------------------------------------------------------

    def units(self, fields: Iterable[Field]) -> set[str | None]:
        """The spellings of the tags of what fields put into the list around them."""
        found: set[str | None] = set()
        for field in fields:
            spread, array = self.spread(field), self.schema.resolve(field.type)
            if not self.has(field):
                continue
            if spread is not None:
                found |= self.units(spread.fields)
            elif field.option("blob"):
                found.add("blob")
            else:
                found.add(self.unit(array.element if field.option("rest") and isinstance(array, Array) else field.type))
        return found

    def unit(self, type_: Type) -> str | None:
        """The spelling of the tag of a scalar; None for lists and dicts."""
        match self.schema.resolve(type_):
            case Int(_, _, spelling) | Float(_, spelling):
                return TAGGED_AS.get(spelling, spelling)
            case Bool():
                return "vocab32"
            case String():
                return "string"
            case Bytes():
                return "blob"
            case Struct() | Array() | Map() | Enum() | Optional() | Union() | Ref():
                return None

    def tag(self, unit: str, field: Field) -> int:
        """The code of a type, which the dialect must have."""
        if unit not in self.dialect.tags:
            raise SchemaError((catalogue.no_such_tag(field.span, unit or "list", self.dialect.name),))
        return self.dialect.tags[unit]


def _is_plain(struct: Struct) -> bool:
    """Whether a struct is a list with a place for each field, none of which depends on others or on the dialect."""
    odd = any(each.option("rest") or each.option("since") for each in struct.fields)
    return bool(struct.fields) and not struct.options and not is_dict(struct) and not odd


def _free_path(field: Field, type_: Struct | Map | Array, path: Path) -> Path | None:
    """The list itself, if its form depends on whether it is empty."""
    free = isinstance(type_, Array) and type_.length is None and not field.option("vector")
    return path if free else None


def _rest_path(struct: Struct, path: Path) -> Path | None:
    """The array that alone makes up a list, whose form therefore depends on whether it is empty."""
    if len(struct.fields) == 1 and struct.fields[0].option("rest"):
        array = struct.fields[0].type
        if struct.fields[0].option("vector"):
            return None
        return (*path, struct.fields[0].name) if isinstance(array, Array) and array.length is None else None
    return None
