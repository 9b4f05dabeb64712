"""Definitions to declarations of the model, in the order of the text: a name is known once it is declared (OMG IDL 4.2, 7.4.1)."""

from __future__ import annotations

from collections.abc import Callable
from typing import assert_never

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.frameworks.omg import diagnostics as say
from rosetta_jit.frameworks.omg import tree
from rosetta_jit.frameworks.omg.annotations import Annotations
from rosetta_jit.frameworks.omg.constants import Lookup, Value, as_text, evaluate, fit
from rosetta_jit.frameworks.omg.expressions import ScopedName
from rosetta_jit.frameworks.omg.limits import MAX_INHERITED
from rosetta_jit.frameworks.omg.members import MemberMaker
from rosetta_jit.frameworks.omg.problems import LookupProblem
from rosetta_jit.frameworks.omg.scopes import Entry, Scope
from rosetta_jit.frameworks.omg.types import TypeMaker, enum_entry, value_of
from rosetta_jit.model.types import Bool, Declaration, Enum, Field, Float, Int, NamedConstant, Ref, String, Struct, Type
from rosetta_jit.source import Source, Span
from rosetta_jit.startup.dataclass import dataclass, field


@dataclass(slots=True)
class Declarations:
    """What a file declares: types, constants, and by their scopes those that rosidl gives a message."""

    types: dict[str, Declaration] = field(default_factory=dict[str, Declaration])
    constants: dict[str, NamedConstant] = field(default_factory=dict[str, NamedConstant])


def declare(definitions: tuple[tree.Definition, ...], problems: list[Diagnostic]) -> Declarations:
    """Everything that some definitions declare; what is wrong with them are problems."""
    declarer = _Declarer(problems)
    scope = _outermost()
    declarer.definitions(scope, definitions, hashed=False)
    problems += [say.never_defined(entry.span, entry.full) for entry in declarer.ahead.values() if entry.state == "named"]
    return declarer.out


def _outermost() -> Scope:
    """The scope around everything: what CORBA declares without a file, the type of type codes, can be named and not represented."""
    scope = Scope()
    inner = Scope("CORBA", "CORBA", scope)
    nowhere = Span(Source("CORBA", ""), 0, 0)
    for word in ("TypeCode", "Principal"):
        inner.entries[word.lower()] = Entry("native", word, f"CORBA::{word}", nowhere)
    scope.entries["corba"] = Entry("module", "CORBA", "CORBA", nowhere, scope=inner)
    return scope


@dataclass(slots=True)
class _Declarer:
    problems: list[Diagnostic]
    out: Declarations = field(default_factory=Declarations)
    ahead: dict[str, Entry] = field(default_factory=dict[str, Entry])
    inherited: int = 0
    hashed: bool = False

    @property
    def maker(self) -> TypeMaker:
        return TypeMaker(self.on_the_spot)

    @property
    def members(self) -> MemberMaker:
        return MemberMaker(self.maker, self.out.types, self.problems, self.hashed)

    def definitions(self, scope: Scope, definitions: tuple[tree.Definition, ...], *, hashed: bool) -> None:
        """Definitions in a scope, where ids of members are hashes of their names or not."""
        outer, self.hashed = self.hashed, hashed
        for definition in definitions:
            self.guarded(lambda definition=definition: self.definition(scope, definition))
        self.hashed = outer

    def guarded(self, act: Callable[[], object]) -> None:
        try:
            act()
        except LookupProblem as error:
            self.problems.append(error.problem)

    def definition(self, scope: Scope, definition: tree.Definition) -> None:
        match definition:
            case tree.Module():
                self.module(scope, definition)
            case tree.Aggregate() | tree.Enum():
                self.on_the_spot(scope, definition)
            case tree.Typedef(spec, declarators):
                type_ = self.maker.type(scope, spec, free=declarators[0].name.free)
                for declarator in declarators:
                    self.guarded(lambda declarator=declarator: self.typedef(scope, spec, type_, declarator))
            case tree.Constant():
                self.constant(scope, definition)
            case tree.Interface():
                self.interface(scope, definition)
            case tree.Opaque(_, name):
                scope.declare(name, Entry("native", name.text, scope.join(name), name.span))
            case _:
                assert_never(definition)

    # Scopes

    def module(self, scope: Scope, module: tree.Module) -> None:
        name = module.name
        entry = scope.entries.get(name.text.lower())
        if entry is None or entry.kind != "module" or entry.name != name.text or entry.scope is None:
            full = scope.join(name)
            entry = scope.declare(name, Entry("module", name.text, full, name.span, scope=Scope(full, name.text, scope)))
        assert entry.scope is not None
        notes = Annotations(module.annotations, lookup_in(entry.scope, free=name.free))
        self.definitions(entry.scope, module.definitions, hashed=notes.hashed_ids(outer=self.hashed))

    def interface(self, scope: Scope, interface: tree.Interface) -> None:
        name = interface.name
        entry = scope.entries.get(name.text.lower())
        if entry is None or entry.name != name.text or entry.state != "named" or entry.kind != interface.word:
            full = scope.join(name)
            entry = scope.declare(name, Entry(interface.word, name.text, full, name.span, "named", Scope(full, name.text, scope)))
        if interface.definitions is None or entry.scope is None:
            return
        entry.state = "whole"
        for base in interface.bases:
            found = scope.find(base)
            if found.kind not in ("interface", "valuetype") or found.scope is None or found is entry:
                raise LookupProblem(say.wrong_kind(base.span, found.full, found.kind, interface.word))
            entry.scope.bases.append(found.scope)
        self.definitions(entry.scope, interface.definitions, hashed=self.hashed)

    # Types

    def typedef(self, scope: Scope, spec: tree.TypeSpec, type_: Type, declarator: tree.Declarator) -> None:
        name = declarator.name
        made = self.maker.declared(scope, type_, declarator)
        plain = isinstance(spec, ScopedName) and not declarator.dimensions and isinstance(made, Ref)
        target = scope.find(spec, free=True) if plain and isinstance(spec, ScopedName) else None
        first = scope.entries.get(name.text.lower())
        if name.free and first is not None and first.name == name.text and first.type == made:
            return  # rosidl writes the typedefs of a message into each file that needs them
        scope.declare(name, Entry("typedef", name.text, scope.join(name), name.span, type=made, target=target))

    def on_the_spot(self, scope: Scope, definition: tree.Aggregate | tree.Enum) -> Type:
        match definition:
            case tree.Enum():
                return self.enum(scope, definition)
            case tree.Aggregate():
                return self.aggregate(scope, definition)
            case _:
                assert_never(definition)

    def aggregate(self, scope: Scope, definition: tree.Aggregate) -> Type:
        name = definition.name
        full = scope.join(name)
        entry = self.ahead.get(full)
        if entry is None or entry.kind != definition.kind or (definition.members is not None and entry.state != "named"):
            made = Entry(definition.kind, name.text, full, name.span, "named", Scope(full, name.text, scope))
            entry = scope.declare(name, made)
        if definition.members is None:
            self.ahead.setdefault(full, entry)
            return Ref(full, name.span)
        entry.state = "open"
        assert entry.scope is not None
        notes = Annotations(definition.annotations, lookup_in(scope, free=name.free))
        fields: tuple[Field, ...] = ()
        try:
            if definition.kind == "union":
                fields = self.members.union(scope, entry.scope, definition, notes)
            else:
                base = self.base(scope, definition)
                fields = self.members.struct(entry.scope, definition, notes, base)
        finally:
            entry.state = "whole"
        if definition.kind != "exception":
            self.out.types[full] = Struct(full, fields, doc=notes.doc, span=name.span, options=notes.of_struct())
        return Ref(full, name.span)

    def base(self, scope: Scope, definition: tree.Aggregate) -> tuple[Field, ...]:
        if definition.base is None:
            return ()
        entry = scope.find(definition.base, free=definition.name.free)
        while entry.kind == "typedef" and entry.target is not None:
            entry = entry.target
        if entry.kind != "struct":
            raise LookupProblem(say.wrong_kind(definition.base.span, entry.full, entry.kind, "struct"))
        if entry.state != "whole":
            raise LookupProblem(say.incomplete(definition.base.span, entry.full, entry.state))
        base = self.out.types.get(entry.full)
        fields = base.fields if isinstance(base, Struct) else ()
        self.inherited += len(fields)
        if self.inherited > MAX_INHERITED:
            raise LookupProblem(say.too_many_members(definition.name.span, MAX_INHERITED))
        return fields

    def enum(self, scope: Scope, definition: tree.Enum) -> Type:
        name, full = definition.name, scope.join(definition.name)
        entry = scope.declare(name, Entry("enum", name.text, full, name.span))
        notes = Annotations(definition.annotations, lookup_in(scope, free=name.free))
        width = notes.number("bit_bound", 32)
        values: dict[int, str] = {}
        following = 0
        for enumerator in definition.enumerators:
            own = Annotations(enumerator.annotations, lookup_in(scope, free=name.free))
            number = own.value("value")
            ordinal = following if number is None else int(fit(number, Int(32, spelling="long"), enumerator.name.span))
            following = ordinal + 1
            value = Value("enumerator", ordinal, full)
            inner = Entry("enumerator", enumerator.name.text, scope.join(enumerator.name), enumerator.name.span, value=value)
            scope.declare(enumerator.name, inner)
            if ordinal in values:
                raise LookupProblem(say.repeated_ordinal(enumerator.name.span, ordinal, values[ordinal]))
            values[ordinal] = enumerator.name.text
            if own.flag("default_literal"):
                entry.value = value
        pairs = tuple((word, number) for number, word in values.items())
        bits = 32 if width is None or width > 16 else 16 if width > 8 else 8  # DDS-XTypes 1.3, table 21
        self.out.types[full] = Enum(full, pairs, closed=True, span=name.span, bits=bits)
        return Ref(full, name.span)

    # Constants

    def constant(self, scope: Scope, definition: tree.Constant) -> None:
        name, spec = definition.name, definition.type
        type_ = self.maker.type(scope, spec, free=name.free)
        value = evaluate(definition.value, lookup_in(scope, free=name.free))
        enum = enum_entry(scope.find(spec, free=True)) if isinstance(spec, ScopedName) and isinstance(type_, Ref) else None
        if value.sort == "fixed" or (isinstance(type_, Ref) and type_.name in ("fixed", "long double")):
            scope.declare(name, Entry("constant", name.text, scope.join(name), name.span))
            return
        if enum is None and not isinstance(type_, Bool | Int | Float | String):
            raise LookupProblem(say.no_constant_type(name.span if not isinstance(spec, ScopedName) else spec.span))
        value = as_text(value, type_) if name.free else value
        fitted = fit(value, type_, definition.value.span)
        full = scope.join(name)
        kept = value if value.sort in ("character", "wide character") else Value(value.sort, fitted, value.enum)
        scope.declare(name, Entry("constant", name.text, full, name.span, value=kept))
        notes = Annotations(definition.annotations, lookup_in(scope, free=name.free))
        self.out.constants[full] = NamedConstant(full, type_, fitted, doc=notes.doc)


def lookup_in(scope: Scope, *, free: bool) -> Lookup:
    """The values of names, seen from a scope."""
    return lambda name: value_of(scope, name, free=free)
