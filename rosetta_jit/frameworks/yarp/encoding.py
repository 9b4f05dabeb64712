"""How YARP writes a type: bottles in one of three dialects, or in whichever a message is.

A bottle of fields is a list with a place for each. Where all its elements have one scalar type, YARP specialises it: the type is told
once, in the list's code. Thrift's writer never does, so a reader takes both forms. (os/impl/BottleImpl.cpp, os/idl/WireWriter.cpp)

What is written always has the form that YARP's own writer chooses, so the common case of reading is a message of known shape: it is the
first attempt, and the general one comes after it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import bottle as catalogue
from rosetta_jit.catalogue.thrift import endless
from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.yarp.tags import DIALECTS, DICT, LIST, YARP3, YARP4, YARP2012, Dialect
from rosetta_jit.frameworks.yarp.thrift_encoding import Thrift
from rosetta_jit.model import expr
from rosetta_jit.model.layout import map_entry, recursive_structs
from rosetta_jit.model.types import Array, Bool, Bytes, Enum, Float, Int, Map, Optional, Ref, Schema, String, Struct, Union
from rosetta_jit.wire.codec import Blob, Choice, Codec, Computed, Constant, Count, Encoding, Number, Padding, Path, Repeat, Seq, Table

if TYPE_CHECKING:
    from rosetta_jit.frameworks.base import Choices
    from rosetta_jit.model.types import Field, Type

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
}


def encode_type(struct: Struct, schema: Schema, dialect: str, choices: Choices) -> Encoding:
    """The encoding of a bottle schema's type: of one dialect by name, or ``yarp`` for any.

    Raises
    ------
    SchemaError
        If the dialect has no tag for a type of the schema.
    """
    if dialect != "yarp":
        return Encoding(dialect, _forms(struct, schema, DIALECTS[dialect]), _message(struct, schema, DIALECTS[dialect]))
    usable = [each for each in (YARP2012, YARP3, YARP4) if not _missing(struct, schema, each)]
    if not usable:
        return encode_type(struct, schema, "yarp4", choices)
    if not _has_text(struct, schema) and len(usable) > 1:
        usable = [each for each in usable if each is not YARP2012]
    forms = [_forms(struct, schema, each) for each in usable]
    ordered = [form[0] for form in forms] + [each for form in forms for each in form[1:]]
    return Encoding("yarp", tuple(dict.fromkeys(ordered)), None)


def _forms(struct: Struct, schema: Schema, dialect: Dialect) -> tuple[Codec, ...]:
    """The form that YARP writes, then whatever it reads."""
    if struct.option("thrift"):
        return (_message(struct, schema, dialect),)
    expected = _Bottles(schema, dialect, exact=True).message(struct)
    general = _Bottles(schema, dialect).message(struct)
    return (expected, general) if expected != general else (general,)


def _message(struct: Struct, schema: Schema, dialect: Dialect) -> Codec:
    if not struct.option("thrift"):
        return _Bottles(schema, dialect).message(struct)
    for name in sorted(recursive_structs(Ref(struct.name), schema)):
        raise SchemaError((endless(schema.types[name].span, name),))
    return Thrift(schema, dialect).message(struct)


def _missing(struct: Struct, schema: Schema, dialect: Dialect) -> bool:
    try:
        _message(struct, schema, dialect)
    except SchemaError:
        return True
    return False


def _has_text(type_: Type, schema: Schema) -> bool:
    match schema.resolve(type_):
        case String() | Map():
            return True
        case Array(element, _):
            return _has_text(element, schema)
        case Struct(_, fields):
            return any(each.option("key") is not None or _has_text(each.type, schema) for each in fields)
        case _:
            return False


@dataclass(frozen=True, slots=True)
class _Bottles:
    """Codecs of one dialect. ``exact`` ones describe only the form that YARP's writer chooses for lists that are not empty."""

    schema: Schema
    dialect: Dialect
    exact: bool = False
    declared: Struct | None = None
    base: Path = ()

    def message(self, struct: Struct) -> Codec:
        return self.within(struct, ()).top(struct)

    def within(self, struct: Struct, path: Path) -> _Bottles:
        """Codecs below a declaration: computed values of its fields name fields of it."""
        return replace(self, declared=struct, base=path)

    def top(self, struct: Struct) -> Codec:
        return self.coded((), self.list_forms(struct, ()), _rest_path(struct, ()))

    def coded(self, path: Path, forms: tuple[tuple[int, Codec], ...], may_be_empty: Path | None) -> Codec:
        """The code of a list, and the body that it announces."""
        if self.exact or len(forms) == 1:
            code, body = forms[0]
            return Seq((Constant(path, code, "i32", kind="tag"), body))
        return Choice(path if may_be_empty is None else may_be_empty, "i32", forms, when_empty=0 if may_be_empty is None else 1)

    def list_forms(self, struct: Struct, path: Path) -> tuple[tuple[int, Codec], ...]:
        """The codes that a list of these fields may have, each with the body: the written one first."""
        units = {self.unit(_element(each)) for each in struct.fields}
        general = (LIST, self.body(struct, path, tagged=True))
        unit = units.pop() if len(units) == 1 else None
        if unit is None:
            return (general,)
        return (LIST | self.tag(unit, struct.fields[0]), self.body(struct, path, tagged=False)), general

    def body(self, struct: Struct, path: Path, *, tagged: bool) -> Codec:
        keyed = bool(struct.fields) and struct.fields[0].option("key") is not None
        fixed = [each for each in struct.fields if not each.option("rest")]
        head = tuple(self.entry(each, path) if keyed else self.place(each, path, tagged=tagged) for each in fixed)
        rest = next((each for each in struct.fields if each.option("rest")), None)
        if rest is None:
            return Seq((Constant(path, len(head), "i32", kind="count"), *head))
        return self.elements(rest, (*path, rest.name), tagged=tagged, head=head)

    def place(self, field: Field, path: Path, *, tagged: bool) -> Codec:
        """One field of a list, with the code of its type where the list does not say it for all."""
        here = (*path, field.name)
        return self.element(field, field.type, here) if tagged else self.scalar(field, field.type, here)

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
        special = (LIST | self.dialect.tags["string"], Seq((count, text, self.scalar(field, field.type, here))))
        return self.coded(here, (special, general), None)

    def element(self, field: Field, type_: Type, path: Path) -> Codec:
        """A value after the code of its type."""
        resolved = self.schema.resolve(type_)
        if isinstance(type_, Ref) and isinstance(resolved, Struct):
            return self.within(resolved, path).element(field, resolved, path)
        match resolved:
            case Struct() if resolved.fields and resolved.fields[0].option("key") is not None:
                inner = self.coded(path, self.list_forms(resolved, path), None)
                return Seq((Constant(path, DICT, "i32", kind="tag"), inner))
            case Struct():
                return self.coded(path, self.list_forms(resolved, path), _rest_path(resolved, path))
            case Map(key, value):
                entries = replace(field, type=Array(map_entry(key, value)), options=(), length=None)
                return Seq(
                    (
                        Constant(path, DICT, "i32", kind="tag"),
                        Constant(path, LIST, "i32", kind="tag"),
                        self.elements(entries, path, tagged=True),
                    )
                )
            case Array(element, _):
                return self.array(field, replace(field, type=resolved), path, self.unit(element))
            case _:
                return Seq(
                    (Constant(path, self.tag(self.unit(resolved) or "", field), "i32", kind="tag"), self.scalar(field, resolved, path))
                )

    def array(self, field: Field, resolved: Field, path: Path, unit: str | None) -> Codec:
        general = (LIST, self.elements(resolved, path, tagged=True))
        if unit is None:
            return self.coded(path, (general,), None)
        special = (LIST | self.tag(unit, field), self.elements(resolved, path, tagged=False))
        length = resolved.type.fixed if isinstance(resolved.type, Array) else None
        forms = (general, special) if length == 0 else (special, general)
        return self.coded(path, forms, path if length is None and not field.option("vector") else None)

    def elements(self, field: Field, path: Path, *, tagged: bool, head: tuple[Codec, ...] = ()) -> Codec:
        """Count and elements of an array field; ``head`` are fields of the same list before them."""
        array = self.schema.resolve(field.type)
        assert isinstance(array, Array)
        fixed = None if array.fixed is None else array.fixed + len(head)
        count = Count("i32", value=fixed if fixed is not None else self.computed(field.length))
        inner = replace(field, constant=None, length=None, options=())
        item = self.element(inner, array.element, ()) if tagged else self.scalar(inner, array.element, ())
        return Repeat(path, count, item, head, len(head))

    def scalar(self, field: Field, type_: Type, path: Path) -> Codec:
        """A value without the code of its type."""
        match type_, field.constant:
            case _, expr.Literal(value) if not isinstance(type_, Array):
                return self.constant(type_, path, value)
            case Int(spelling="quantum"), None if self.dialect.flagged_quantum:
                return Seq((Number(path, "i16"), Padding("i16", 1)))
            case Int() | Float(), None:
                return Number(path, SCALARS[self.unit(type_) or ""])
            case Int(), computed:
                return Computed(path, SCALARS[self.unit(type_) or ""], self.computed(computed) or computed)
            case Bool(), _:
                return Table(path, "i32", BOOLEANS)
            case String(), _:
                return Blob(path, Count("i32", value=self.computed(field.length)), terminated=self.dialect.nul_terminated)
            case Bytes(), _:
                return Blob(path, Count("i32", value=self.computed(field.length)))
            case _:
                raise AssertionError(type_)

    def constant(self, type_: Type, path: Path, value: bool | float | str) -> Codec:
        match type_:
            case String() | Bytes():
                text = str(value).encode()
                end = b"\0" * self.dialect.nul_terminated if isinstance(type_, String) else b""
                return Seq((Constant((), len(text) + len(end), "i32"), Constant(path, text), *([Constant((), end)] if end else [])))
            case Bool():
                return Constant(path, 49 if value else 0, "i32")
            case _:
                assert not isinstance(value, str)
                return Constant(path, value, SCALARS[self.unit(type_) or ""])

    def computed(self, value: expr.Expr | None) -> expr.Expr | None:
        """A computed value with its paths from the message on, and put in for them what the schema itself fixes or computes."""
        match value:
            case expr.Path(side, steps):
                names = tuple(step.name for step in steps if isinstance(step, expr.Member))
                scope, field = self.field_at(names)
                known = None if field is None else scope.computed(field.constant)
                return known or expr.Path(side, tuple(expr.Member(name) for name in (*self.base, *names)))
            case expr.Unary(operator, operand):
                return expr.Unary(operator, self.computed(operand) or operand)
            case expr.Binary(operator, left, right):
                return expr.Binary(operator, self.computed(left) or left, self.computed(right) or right)
            case expr.Call(function, arguments):
                return expr.Call(function, tuple(self.computed(each) or each for each in arguments))
            case _:
                return value

    def field_at(self, names: tuple[str, ...]) -> tuple[_Bottles, Field | None]:
        """A field of the declaration, and the codecs of the one that it stands in: the paths of its own value start there."""
        scope, owner, found = self, self.declared, None
        for number, name in enumerate(names):
            found = next((each for each in owner.fields if each.name == name), None) if owner is not None else None
            inner = self.schema.resolve(found.type) if found is not None else None
            owner = inner if isinstance(inner, Struct) else None
            if found is not None and isinstance(found.type, Ref) and owner is not None and number < len(names) - 1:
                scope = scope.within(owner, (*self.base, *names[: number + 1]))
        return scope, found

    def unit(self, type_: Type) -> str | None:
        """The spelling of the tag of a scalar; None for lists and dicts."""
        match self.schema.resolve(type_):
            case Int(spelling="quantum"):
                return "int32"
            case Int(_, _, spelling) | Float(_, spelling):
                return spelling
            case Bool():
                return "vocab32"
            case String():
                return "string"
            case Bytes():
                return "blob"
            case Struct() | Array() | Map() | Enum() | Optional() | Union() | Ref():
                return None

    def tag(self, unit: str, field: Field) -> int:
        if unit not in self.dialect.tags:
            raise SchemaError((catalogue.no_such_tag(field.span, unit or "list", self.dialect.name),))
        return self.dialect.tags[unit]


def _element(field: Field) -> Type:
    return field.type.element if field.option("rest") and isinstance(field.type, Array) else field.type


def _rest_path(struct: Struct, path: Path) -> Path | None:
    """The array that alone makes up a list, whose form therefore depends on whether it is empty."""
    if len(struct.fields) == 1 and struct.fields[0].option("rest"):
        array = struct.fields[0].type
        if struct.fields[0].option("vector"):
            return None
        return (*path, struct.fields[0].name) if isinstance(array, Array) and array.length is None else None
    return None
