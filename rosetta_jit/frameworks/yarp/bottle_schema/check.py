"""What holds a bottle schema together: names that exist, bounded nesting and size, constants that can be computed."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from graphlib import CycleError, TopologicalSorter
from itertools import islice
from typing import TYPE_CHECKING, assert_never

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.frameworks.yarp import bottle_diagnostics as catalogue
from rosetta_jit.frameworks.yarp.limits import MAX_NESTING, MAX_TERMS
from rosetta_jit.model.expr import Binary, Call, Choice, Coerced, Expr, Given, Item, Len, List, Literal, Member, Name, Nearest, Path, Unary
from rosetta_jit.model.limits import MAX_SLOTS
from rosetta_jit.model.types import Array, Bool, Bytes, Enum, Field, Float, Int, Map, Optional, Ref, String, Struct, Type, Union

if TYPE_CHECKING:
    from rosetta_jit.source import Span

Place = tuple[str, str]
"""A field: the declaration that it stands in, and its path from there."""

Members = dict[int, dict[str, "Type"]]
"""The fields of each struct by name, so that many paths into a large one are found in linear time; keys are identities."""


def check(structs: Mapping[str, Struct], limit: int) -> list[Diagnostic]:
    """What is wrong between the declarations of a schema, ``limit`` problems at most."""
    problems = list(islice(_check_names(structs), limit)) or _check_bounds(structs)
    if problems:
        return problems
    members = {id(struct): {field.name: field.type for field in struct.fields} for struct in _structs(structs)}
    found = (problem for struct in structs.values() for problem in _check_computed(struct, structs, members))
    return list(islice(found, limit)) or list(islice(_check_terms(structs, members), limit))


def _check_names(structs: Mapping[str, Struct]) -> Iterator[Diagnostic]:
    for struct in structs.values():
        for ref in _refs(struct):
            if ref.name not in structs:
                yield catalogue.unknown_type(ref.span, ref.name, structs)
    for inline in _structs(structs):
        declared = structs.get(inline.name, inline)
        if declared is not inline and declared.span is not None:
            yield catalogue.duplicate(declared.span, "type", inline.name, inline.span)


def _structs(structs: Mapping[str, Struct]) -> Iterator[Struct]:
    """The declared structs and those inline in them."""
    pending: list[Type] = list(structs.values())
    while pending:
        match pending.pop():
            case Struct(_, fields) as struct:
                yield struct
                pending += [field.type for field in fields]
            case Union(_, cases):
                pending += [case.type for case in cases]
            case Array(inner) | Map(_, inner):
                pending.append(inner)
            case _:
                pass


def _refs(type_: Type) -> Iterator[Ref]:
    """Every name that a type uses, with inline structs gone through and declared ones not."""
    match type_:
        case Ref():
            yield type_
        case Array(element):
            yield from _refs(element)
        case Map(_, value):
            yield from _refs(value)
        case Optional(value):
            yield from _refs(value)
        case Struct(_, fields) | Union(_, fields):
            for field in fields:
                yield from _refs(field.type)
        case Bool() | Int() | Float() | String() | Bytes() | Enum():
            return
        case _:
            assert_never(type_)


def _check_bounds(structs: Mapping[str, Struct]) -> list[Diagnostic]:
    uses = {name: {ref.name for ref in _refs(struct)} for name, struct in structs.items()}
    try:
        order = list(TopologicalSorter(uses).static_order())
    except CycleError as error:
        names: list[str] = error.args[1]
        return [catalogue.recursive_type(structs[names[0]].span, reversed(names))]
    extents: dict[str, tuple[int, int]] = {}
    for name in order:
        depth, size = extents[name] = _extent(structs[name], extents)
        if depth - 1 > MAX_NESTING:
            return [catalogue.nesting_too_deep(structs[name].span, MAX_NESTING)]
        if size > MAX_SLOTS:
            return [catalogue.too_many_fields(structs[name].span, name, MAX_SLOTS)]
    return []


def _extent(type_: Type, extents: Mapping[str, tuple[int, int]]) -> tuple[int, int]:
    """How deep lists lie within a type, and how many fields it has in all."""
    match type_:
        case Ref(name):
            return extents[name]
        case Array(inner) | Map(_, inner) | Optional(inner):
            depth, size = _extent(inner, extents)
            return depth + 1, size + 1
        case Struct(_, fields) | Union(_, fields):
            parts = [_extent(field.type, extents) for field in fields]
            return 1 + max((depth for depth, _ in parts), default=0), sum((size for _, size in parts), len(parts))
        case Bool() | Int() | Float() | String() | Bytes() | Enum():
            return 0, 0
        case _:
            assert_never(type_)


def _check_computed(root: Struct, structs: Mapping[str, Struct], members: Members) -> Iterator[Diagnostic]:
    needs: dict[str, set[str]] = {}
    places: dict[str, Field] = {}
    for name, field, in_list in _fields(root, "", in_list=False):
        paths, lists = [*_paths(field.constant), *_paths(field.length)], [*_lengths(field.constant), *_lengths(field.length)]
        if (paths or lists) and in_list:
            yield catalogue.computed_in_list(field.span)
        elif paths or lists:
            yield from (found for path in paths if (found := _check_path(path, root, structs, members)) is not None)
            yield from (found for path in lists if (found := _check_path(path, root, structs, members, counted=True)) is not None)
            needs[name] = {_dotted(path) for path in _paths(field.constant)}
            places[name] = field
    try:
        TopologicalSorter(needs).prepare()
    except CycleError as error:
        names: list[str] = error.args[1]
        yield catalogue.computed_cycle(places[names[0]].span, names)


def _check_terms(structs: Mapping[str, Struct], members: Members) -> Iterator[Diagnostic]:
    """What is computed from computed values is bounded: an encoding puts them in."""
    own: dict[Place, int] = {}
    needs: dict[Place, list[Place]] = {}
    spans: dict[Place, Span | None] = {}
    for root in structs.values():
        for name, field, _ in _fields(root, "", in_list=False):
            for place, value in (((root.name, name), field.constant), ((root.name, f"{name}:length"), field.length)):
                own[place], spans[place] = len([*_parts(value)]), field.span
                needs[place] = [_home(path, root, structs, members) for path in _paths(value)]
    for place in TopologicalSorter(needs).static_order():
        own[place] = own.get(place, 1) + sum(own[each] for each in needs.get(place, ()))
        if own[place] > MAX_TERMS:
            yield catalogue.too_many_terms(spans.get(place), MAX_TERMS)
            return


def _home(path: Path, root: Struct, structs: Mapping[str, Struct], members: Members) -> Place:
    """The field that a path leads to, seen from the last declaration on its way."""
    owner, names = root, list[str]()
    for step in path.steps:
        assert isinstance(step, Member)
        type_ = members[id(owner)][step.name]
        names.append(step.name)
        if isinstance(type_, Ref) and step is not path.steps[-1]:
            root, names = structs[type_.name], []
        owner = structs[type_.name] if isinstance(type_, Ref) else type_ if isinstance(type_, Struct) else owner
    return root.name, ".".join(names)


def _fields(type_: Type, prefix: str, *, in_list: bool) -> Iterator[tuple[str, Field, bool]]:
    """The fields of a struct and of those inline in it, by path; those of elements are marked."""
    match type_:
        case Struct(_, fields):
            for field in fields:
                yield prefix + field.name, field, in_list
                yield from _fields(field.type, f"{prefix}{field.name}.", in_list=in_list)
        case Array(inner) | Map(_, inner):
            yield from _fields(inner, prefix, in_list=True)
        case Union(_, cases):
            for case in cases:
                yield prefix + case.name, case, True
                yield from _fields(case.type, f"{prefix}{case.name}.", in_list=True)
        case _:
            return


def _paths(expr: Expr | None) -> Iterator[Path]:
    """The fields whose values an expression uses."""
    return (part for part in _parts(expr) if isinstance(part, Path))


def _lengths(expr: Expr | None) -> Iterator[Path]:
    """The fields whose lengths an expression uses."""
    return (part.path for part in _parts(expr) if isinstance(part, Len))


def _parts(expr: Expr | None) -> Iterator[Expr]:
    """An expression and what it is made of, without the paths of lengths."""
    match expr:
        case None:
            return
        case Literal() | Name() | Path() | Len():
            yield expr
        case Unary(_, operand):
            yield expr
            yield from _parts(operand)
        case Binary(_, left, right):
            yield expr
            yield from _parts(left)
            yield from _parts(right)
        case Call(_, arguments):
            yield expr
            for argument in arguments:
                yield from _parts(argument)
        case Choice(cases, otherwise):
            yield expr
            for part in (*(part for case in cases for part in case), otherwise):
                yield from _parts(part)
        case List() | Item() | Given() | Coerced() | Nearest():
            raise AssertionError(expr)
        case _:
            assert_never(expr)


def _check_path(path: Path, root: Struct, structs: Mapping[str, Struct], members: Members, *, counted: bool = False) -> Diagnostic | None:
    """The path must lead, through structs alone, to an integer, or to what is ``counted``."""
    type_: Type = root
    for step in path.steps:
        type_ = structs[type_.name] if isinstance(type_, Ref) else type_
        match type_, step:
            case Struct() as struct, Member(name):
                known = members[id(struct)]
                if name not in known:
                    return catalogue.unknown_path(path.span, _dotted(path), known)
                type_ = known[name]
            case ((Array() | Map()), _):
                return catalogue.path_through_list(path.span, _dotted(path))
            case _:
                return catalogue.unknown_path(path.span, _dotted(path), ())
    if counted:
        return None if isinstance(type_, Array | String | Bytes) else catalogue.path_not_counted(path.span, _dotted(path))
    return None if isinstance(type_, Int) else catalogue.path_not_integer(path.span, _dotted(path))


def _dotted(path: Path) -> str:
    return ".".join(step.name for step in path.steps if isinstance(step, Member))
