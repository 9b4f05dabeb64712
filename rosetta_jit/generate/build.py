"""From what a user asks for to a unit: the kernels of all its directions, for any machine."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import PurePath

from rosetta_jit.catalogue import generate as words
from rosetta_jit.errors import MappingError, SchemaError
from rosetta_jit.generate.inner_types import with_inner_types
from rosetta_jit.generate.languages import Language, installed, language_named
from rosetta_jit.generate.origins import Origin, origins_of
from rosetta_jit.generate.passes.bounds import bounds_of_type, least, reserved
from rosetta_jit.generate.passes.rounds import with_rounds, with_rounds_of_flags
from rosetta_jit.generate.provenance import line_of_mapping, line_of_type
from rosetta_jit.generate.unit import Role, Unit, UserFunction, wire_of
from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import Digits, Nearest, Scalar, Scale, Unary
from rosetta_jit.kernel.passes import order as passes
from rosetta_jit.kernel.passes.alone import alone
from rosetta_jit.kernel.passes.postpone import postpone
from rosetta_jit.kernel.traits import calls_to_host, our_functions
from rosetta_jit.kernel.walk import expressions_of, statements, subexpressions
from rosetta_jit.lowering.rules.scalars import scalar_type
from rosetta_jit.model.layout import Layout, layout
from rosetta_jit.model.types import Ref, Schema, Type
from rosetta_jit.pipeline.build import Build
from rosetta_jit.pipeline.depth import within_stack
from rosetta_jit.pipeline.request import Request
from rosetta_jit.pipeline.wires import arrival_registers
from rosetta_jit.startup.dataclass import dataclass, replace

MAX_LINES = 200
"""Rules that the head of a file shows."""


class AheadOfTime(Build):
    """A program in the making for a machine that is not known yet."""

    def _layout_of(self, name: str, schema: Schema) -> Layout:
        return layout(Ref(name), schema, padded=True)

    def _passes(self) -> tuple[passes.Pass, ...]:
        return passes.ANY_MACHINE

    def _optimised(self, kernel: Kernel) -> Kernel:
        return postpone(alone(passes.run(kernel, self._passes(), large=self._large)))


class LowByteFirst(AheadOfTime):
    """The same for machines whose numbers lie as most encodings have them: arrays of them are copied as they are."""

    def _passes(self) -> tuple[passes.Pass, ...]:
        return passes.FIELD_BY_FIELD


class IntoObjects(LowByteFirst):
    """The same for code that fills objects at once: texts are copied from the message. Rows that it writes are made of an object."""

    TEXTS_STAY = True
    ROWS_IN_ORDER = True

    def _passes(self) -> tuple[passes.Pass, ...]:
        return with_rounds_of_flags(super()._passes(), self.layout)


class InRounds(LowByteFirst):
    """The same for code that makes an object in each round of a loop."""

    def _passes(self) -> tuple[passes.Pass, ...]:
        return with_rounds(super()._passes(), self.layout)


@dataclass(frozen=True, slots=True)
class Wishes:
    """What a user wants besides: ``freestanding`` source, a ``holder``, the header to ``include`` for it, arrays of ``numpy``."""

    freestanding: bool = False
    holder: str = ""
    include: str = ""
    numpy: bool = False


NO_WISHES = Wishes()


def unit_of(
    request: Request,
    roles: tuple[Role, ...],
    name: str,
    wishes: Wishes = NO_WISHES,
    machine: type[AheadOfTime] = AheadOfTime,
    shown: Callable[[Role], str] = str,
) -> Unit:
    """The unit of a request's mapping or type, for some directions whatever its own is; ``shown`` says what these are to a person.

    Raises
    ------
    MappingError, SchemaError
        The mapping or type has mistakes, or needs what generated source cannot have.
    """
    builds: dict[Role, AheadOfTime] = {role: machine(_for(request, role)) for role in roles}
    kernels = _kernels(builds)
    _check(kernels, freestanding=wishes.freestanding)
    first = next(iter(builds.values()))
    bounds, functions = _bounds(first, kernels), _functions(first, kernels)
    state = tuple((name, word) for name, _, word in first.header["state"]["variables"])
    return Unit(
        name,
        tuple(_made_from(builds, shown)),
        first.layout,
        bounds,
        kernels,
        functions,
        wishes.freestanding,
        first.types.holder.name,
        with_inner_types(first.types.schema, first.types.holder.name),
        wishes.holder,
        wishes.include,
        _origins(builds),
        state,
        wishes.numpy,
        arrival_registers([name for name, _ in state], first.wires),
        {role: share.cleared | share.alone | share.joined for role, build in builds.items() if (share := build.types.share) is not None},
        first.holder_framework.name,
        first.wire_framework.announced(first.types.wire, first.types.schema).get("type", first.types.wire.name),
    )


def _kernels(builds: Mapping[Role, AheadOfTime]) -> dict[Role, Kernel]:
    kernels: dict[Role, Kernel] = {}
    for role, build in builds.items():
        if build.wires and role in ("decode", "borrow"):
            raise MappingError((words.not_of_wires(build.checked.mapping.wire_span),))
        kernels[role] = build.kernels[0]
        if role == "encode":
            kernels["size"] = build.kernels[1]
    return kernels


def _origins(builds: Mapping[Role, AheadOfTime]) -> dict[Role, tuple[Origin, ...]]:
    found: dict[Role, tuple[Origin, ...]] = {role: origins_of(build.types.rules or (), build.layout) for role, build in builds.items()}
    return {**found, "size": found["encode"]} if "encode" in found else found


def _of_wires(request: Request, roles: tuple[Role, ...]) -> tuple[Role, ...]:
    """The roles; instead of decoding, decoding the messages of each wire that is wanted, where the mapping has several."""
    wires = AheadOfTime(request).wires if "decode" in roles else []
    decoders = tuple(f"decode_{wire}" for wire in ([request.wire] if request.wire else wires)) if wires else ("decode",)
    return tuple(each for role in roles for each in (decoders if role == "decode" else (role,)))


def _for(request: Request, role: Role) -> Request:
    direction = "encode" if role == "encode" else "decode"
    return replace(request, direction=direction, borrow=role == "borrow", wire=wire_of(role) or request.wire)


def _bounds(build: Build, kernels: dict[Role, Kernel]) -> tuple[int | None, ...]:
    """What the type allows; where nothing is encoded, no more than what decoders take."""
    bounds = bounds_of_type(Ref(build.types.holder.name), build.types.schema, build.layout)
    decoders = [reserved(kernel)[: len(bounds)] for kernel in kernels.values() if kernel.direction == "decode"]
    taken = tuple(None if None in some else max(some) for some in zip(*decoders, strict=True)) if decoders else bounds
    return least(bounds, (1, *taken[1:]))


def _functions(build: Build, kernels: dict[Role, Kernel]) -> tuple[UserFunction, ...]:
    """The functions that the mapping declares and a kernel calls."""
    called = sorted({call.function for call in calls_to_host(kernels.values())})
    declared = (build.types.functions[name] for name in called)
    return tuple(UserFunction(each.name, _scalars(each.parameters), scalar_type(each.result)) for each in declared)


def _scalars(types: Iterable[Type]) -> tuple[Scalar, ...]:
    found: list[Scalar] = [scalar_type(each) for each in types]
    return tuple(found)


def _check(kernels: dict[Role, Kernel], *, freestanding: bool) -> None:
    for kernel in kernels.values():
        for function in our_functions([kernel]):
            raise SchemaError((words.needs_library(kernel.name, f"calls `{function}`: it compresses or decompresses"),))
        for what in _of_the_library(kernel) if freestanding else ():
            raise SchemaError((words.needs_c_library(kernel.name, what),))


def _of_the_library(kernel: Kernel) -> Iterator[str]:
    """What a kernel needs of a C library."""
    blocks = (*kernel.bodies, *(routine.body for routine in kernel.routines))
    exprs = (part for block in blocks for stmt, _ in statements(block) for expr in expressions_of(stmt) for part in subexpressions(expr))
    for expr in exprs:
        match expr:
            case Nearest() | Digits() | Scale():
                yield "decimal numbers"
            case Unary("sqrt" | "floor" | "ceil" | "trunc" | "rint" | "sin" | "cos" | "tan" | "asin" | "acos" | "atan" as function, _):
                yield f"`{function}`"
            case _:
                pass


def _made_from(builds: dict[Role, AheadOfTime], shown: Callable[[Role], str]) -> Iterator[str]:
    """What a person asks who finds the file."""
    for role, build in builds.items():
        types, encoding = build.types, build.request.encoding or next(iter(build.wire_framework.encodings))
        if types.rules is None:
            yield line_of_type(shown(role), types.wire.name, encoding)
            continue
        file = PurePath(build.checked.mapping.source.name).name
        yield line_of_mapping(shown(role), types.wire.name, encoding, types.holder.name, file)
        yield from _rules(build)


def _rules(build: AheadOfTime) -> Iterator[str]:
    """The lines of the mapping that the rules come from."""
    spans = {span for rule in build.types.rules or () if (span := getattr(rule, "span", None)) is not None}
    lines = sorted({(span.source.name, span.source.line_column(span.start)[0], span.source) for span in spans}, key=lambda each: each[:2])
    for _, number, source in lines[:MAX_LINES]:
        yield f"    {number}: {source.text.splitlines()[number - 1].strip()}"


def object_of(
    request: Request, roles: tuple[Role, ...], name: str, triple: str, cpu: str = "", *, freestanding: bool = False
) -> dict[str, str | bytes]:
    """An object file of LLVM's for a machine, and the header for C; parameters as of `generated`."""
    from rosetta_jit.generate.c.objects import files_for

    with within_stack():
        unit = unit_of(request, roles, name, Wishes(freestanding))
        _check_name(name, language_named("c"))
        return files_for(unit, triple, cpu)


def _check_name(name: str, language: Language | None) -> None:
    """Refuse a name that the files cannot have; once the unit is made, as of what does not exist it is not the name that is wrong."""
    if language is not None and not language.may_name(name):
        raise SchemaError((words.unusable_name(name, language.also_in_names),))


def _machine(language: Language) -> type[AheadOfTime]:
    if language.fills_objects:
        return IntoObjects
    if language.makes_objects:
        return InRounds
    return LowByteFirst if language.low_byte_first else AheadOfTime


def _check_wishes(wishes: Wishes, language: Language) -> None:
    """Refuse what a language cannot do, or has no meaning in it."""

    def of_others(can: Callable[[Language], bool]) -> tuple[str, ...]:
        return () if can(language) else tuple(name for name, each in installed().items() if can(each))

    if wishes.numpy and (others := of_others(lambda each: each.numpy)):
        raise SchemaError((words.no_numpy(language.name, others),))
    if wishes.freestanding and (others := of_others(lambda each: each.freestanding)):
        raise SchemaError((words.needless_in("--freestanding", language.name, others),))
    if wishes.include and (others := of_others(lambda each: each.holders)):
        raise SchemaError((words.needless_in("--include", language.name, others),))
    if wishes.holder not in ("", "own") and (others := of_others(lambda each: each.holders)):
        raise SchemaError((words.needless_in(f"--holder {wishes.holder}", language.name, others),))
    if not wishes.include.isprintable() or ">" in wishes.include:
        raise SchemaError((words.unusable_header(wishes.include),))


def generated(request: Request, language: str, roles: tuple[Role, ...], name: str, wishes: Wishes = NO_WISHES) -> dict[str, str]:
    """The files of a mapping or type in a language, by their names.

    Parameters
    ----------
    request
        The mapping or type; its own direction does not matter.
    language
        The name of one that is installed.
    roles
        ``"decode"``, ``"borrow"``, ``"encode"``.
    name
        Of the files, and what the names in them begin with.
    wishes
        What is wanted besides.

    Raises
    ------
    MappingError, SchemaError
        The mapping or type has mistakes, there is no such language, or it cannot say what the kernels do.
    """
    chosen = language_named(language)
    if chosen is None:
        raise SchemaError((words.unknown_language(language, tuple(installed())),))
    _check_wishes(wishes, chosen)
    with within_stack():
        wanted = _of_wires(request, roles) if chosen.wires else roles
        unit = unit_of(request, chosen.roles(wanted), name, wishes, _machine(chosen), chosen.shown)
        _check_name(name, chosen)
        return chosen.files(unit)
