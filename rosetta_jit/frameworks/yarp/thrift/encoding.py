"""How YARP writes what its Thrift declares (os/idl/WireWriter.cpp): bottles, but not always the ones that Bottle would write.

Fields of inner structs stand in the list of the outer one, unless they are ``nested``; lists of structs are general ones; a set repeats the
tag that its list announces, and in YARP 3 so does a list of lists, so that neither is a bottle.
"""

from __future__ import annotations

from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.yarp import bottle_diagnostics as catalogue
from rosetta_jit.frameworks.yarp.tags import FIXED_FORMATS, LIST, YARP4, Dialect, vocab
from rosetta_jit.frameworks.yarp.thrift import diagnostics as thrift
from rosetta_jit.model import expr
from rosetta_jit.model.types import Array, Bool, Bytes, Enum, Field, Float, Int, Map, Schema, String, Struct, Type
from rosetta_jit.startup.dataclass import dataclass
from rosetta_jit.wire.codec import Blob, Choice, Codec, Constant, Count, Number, Path, Recursion, Repeat, Seq, Table

BOOLEANS = ((vocab(b"ok"), 1), (vocab(b"fail"), 0))
COUNT = Count("i32")


@dataclass(frozen=True, slots=True)
class Thrift:
    """Codecs of one dialect."""

    schema: Schema
    dialect: Dialect
    recursive: frozenset[str] = frozenset()

    def nested(self) -> dict[str, Codec]:
        """The codecs of structs that contain themselves, as elements of a list."""
        return {name: self.list_of(struct, ()) for name in sorted(self.recursive) if isinstance(struct := self.schema.types[name], Struct)}

    def message(self, struct: Struct) -> Codec:
        """A struct alone, or a call or a reply, which Bottle has written where its elements are all of one type."""
        fields = self.flat(struct, ())
        general = (LIST, Seq((Constant((), len(fields), "i32", kind="count"), *(self.tagged(*each) for each in fields))))
        units = {self.unit(type_) for _, type_, _ in fields}
        unit = units.pop() if len(units) == 1 else None
        if struct.option("call") is None or unit is None:
            return self.coded(general)
        special = (
            LIST | self.tag(unit, fields[0][0]),
            Seq((Constant((), len(fields), "i32", kind="count"), *(self.scalar(*each) for each in fields))),
        )
        return self.coded(special, general)

    def coded(self, *forms: tuple[int, Codec]) -> Codec:
        """The code of a list and its body; the first form is written."""
        if len(forms) == 1:
            return Seq((Constant((), forms[0][0], "i32", kind="tag"), forms[0][1]))
        return Choice((), "i32", forms)

    def flat(self, struct: Struct, path: Path) -> list[tuple[Field, Type, Path]]:
        """The fields of a struct, with those of inner ones in their places."""
        found: list[tuple[Field, Type, Path]] = []
        for each in struct.fields:
            inner = self.schema.resolve(each.type)
            here = (*path, each.name)
            if isinstance(inner, Struct):
                self.refuse_recursion(inner)
            if isinstance(inner, Struct) and not each.option("nested"):
                found += self.flat(inner, here)
            else:
                found.append((each, each.type, here))
        return found

    def tagged(self, field: Field, type_: Type, path: Path) -> Codec:
        """A value behind its code."""
        match self.schema.resolve(type_):
            case Struct() as struct:
                self.refuse_recursion(struct)
                return self.list_of(struct, path)
            case Array(element):
                return self.array(field, element, path)
            case Map(key, value):
                item = Seq((Constant((), 2, "i32", kind="count"), self.tagged(field, key, ("key",)), self.tagged(field, value, ("value",))))
                return self.coded((LIST, Repeat(path, COUNT, Seq((Constant((), LIST, "i32", kind="tag"), item)))))
            case _:
                code = self.tag(self.unit(type_) or "", field)
                return Seq((Constant(path[:0], code, "i32", kind="tag"), self.scalar(field, type_, path)))

    def list_of(self, struct: Struct, path: Path) -> Codec:
        fields = self.flat(struct, path)
        return self.coded((LIST, Seq((Constant((), len(fields), "i32", kind="count"), *(self.tagged(*each) for each in fields)))))

    def refuse_recursion(self, struct: Struct) -> None:
        """A struct that contains itself is read and written in lists alone: elsewhere it would have no end, or no place of its own."""
        if struct.name in self.recursive:
            raise SchemaError((thrift.only_in_lists(struct.span, struct.name),))

    def array(self, field: Field, element: Type, path: Path) -> Codec:
        inner = self.schema.resolve(element)
        if isinstance(inner, Struct) and inner.name in self.recursive and path:
            return self.coded((LIST, Repeat(path, COUNT, Recursion((), inner.name))))
        unit = self.unit(element)
        if unit is None:
            inner = self.innermost(element)
            announced = inner is not None and isinstance(element, Array) and self.dialect is not YARP4
            code = LIST | self.tag(inner or "", field) if announced else LIST
            return self.coded((code, Repeat(path, COUNT, self.tagged(Field("", element), element, ()))))
        item = self.tagged(field, element, ()) if field.option("set") else self.scalar(field, element, ())
        return self.coded((LIST | self.tag(unit, field), Repeat(path, COUNT, item)))

    def innermost(self, type_: Type) -> str | None:
        """The unit of the elements of a list of lists."""
        while isinstance(type_, Array):
            type_ = type_.element
        return self.unit(type_)

    def scalar(self, field: Field, type_: Type, path: Path) -> Codec:
        """A value alone."""
        resolved = self.schema.resolve(type_)
        match resolved, field.constant:
            case String(), expr.Literal(str(text)):
                data = text.encode() + b"\0" * self.dialect.nul_terminated
                return Seq(
                    (Constant((), len(data), "i32"), Constant(path, text.encode()), *([Constant((), b"\0")] * self.dialect.nul_terminated))
                )
            case _, expr.Literal(int(number)):
                return Constant(path, number, "i32")
            case Bool(), _:
                return Table(path, "i32", BOOLEANS)
            case ((Int() | Float()), _):
                return Number(path, _width(self.unit(resolved) or ""))
            case Enum(), _:
                return Number(path, "i32")
            case String(), _:
                return Blob(path, COUNT, terminated=self.dialect.nul_terminated)
            case Bytes(), _:
                return Blob(path, COUNT)
            case _:
                raise AssertionError(type_)

    def unit(self, type_: Type) -> str | None:
        """The word of a scalar's tag; None for lists."""
        match self.schema.resolve(type_):
            case Int(_, _, spelling) | Float(_, spelling) | Bool(spelling) | String(_, spelling) | Bytes(spelling):
                return spelling
            case Enum():
                return "int32"
            case _:
                return None

    def tag(self, unit: str, field: Field) -> int:
        if unit not in self.dialect.tags:
            raise SchemaError((catalogue.no_such_tag(field.span, unit or "list", self.dialect.name),))
        return self.dialect.tags[unit]


def _width(unit: str) -> str:
    letter = FIXED_FORMATS[unit]
    return {"b": "i8", "h": "i16", "i": "i32", "q": "i64", "f": "f32", "d": "f64"}[letter]
