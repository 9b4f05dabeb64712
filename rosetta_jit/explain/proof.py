"""The proof of a mapping's kernels, as data and as text: what each owes, who proved it, and what z3 says of it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from itertools import groupby, repeat
from typing import TYPE_CHECKING, Literal

from rosetta_jit.errors import ReportError
from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import SetField
from rosetta_jit.kernel.printer import statement_text
from rosetta_jit.kernel.proof.prove import Procedure
from rosetta_jit.kernel.proof.record import Obligation, Record
from rosetta_jit.kernel.proof.verify import VerificationError, verify
from rosetta_jit.model.layout import Layout, Row, Slot, Variant
from rosetta_jit.pipeline.build import Build
from rosetta_jit.pipeline.request import Request, plain_parameters
from rosetta_jit.startup.dataclass import dataclass, replace
from rosetta_jit.terminal import columns, printable

if TYPE_CHECKING:
    from rosetta_jit.kernel.proof.opinion import Opinion

    Judge = Callable[[Iterable[Obligation]], Iterator[Opinion]]
    Known = dict[Kernel, tuple[tuple["Owed", ...], str]]

Direction = Literal["decode", "encode"]
Purpose = Literal["decode", "borrow", "encode", "size"]
DIRECTIONS: tuple[Direction, ...] = ("decode", "encode")
PURPOSES: dict[Direction, tuple[Purpose, ...]] = {"decode": ("decode",), "encode": ("encode", "size")}
UNPROVEN = "unproven"
"""The code of the report that a kernel could not be proven."""

ABSENT = frozenset(("no-rules", "ambiguous-encoding"))
"""Mistakes that say no more than that a mapping has no kernel of a direction, or of an encoding."""


@dataclass(frozen=True, slots=True)
class Owed:
    """One obligation: where it lies, what it claims of which field, who proved it, and the second opinion, if one was asked for."""

    part: str
    statement: str
    path: str
    claim: str
    procedure: Procedure | None
    opinion: Opinion | None = None

    @property
    def is_proved(self) -> bool:
        """Whether it is proven, and z3 agrees where it was asked."""
        return self.procedure is not None and (self.opinion is None or self.opinion.verdict == "proved")


@dataclass(frozen=True, slots=True)
class KernelProof:
    """What one kernel owes. ``refusal`` is why it could not be proven, if it could not."""

    purpose: Purpose
    encoding: str
    owed: tuple[Owed, ...]
    refusal: str = ""

    @property
    def is_proved(self) -> bool:
        """Whether all of it is."""
        return not self.refusal and all(each.is_proved for each in self.owed)

    def procedures(self) -> Counter[str]:
        """How many obligations each procedure proved."""
        return Counter(each.procedure or "nobody" for each in self.owed)


@dataclass(frozen=True, slots=True)
class MappingProof:
    """A mapping's kernels; ``absent`` says which kernels it does not have, and why."""

    mapping: str
    kernels: tuple[KernelProof, ...]
    absent: tuple[str, ...]

    @property
    def is_proved(self) -> bool:
        """Whether there is something to prove, and all of it is."""
        return bool(self.kernels) and all(each.is_proved for each in self.kernels)


def proof(
    mapping: str, *, encoding: str | None = None, parameters: Mapping[str, object] | None = None, judge: Judge | None = None
) -> MappingProof:
    """The proof of all kernels of a mapping: of both directions, and of all encodings of its wire or the one that is named.

    Parameters
    ----------
    judge
        Who gives a second opinion: `rosetta_jit.kernel.proof.opinion.opinions`.

    Raises
    ------
    MappingError
        The mapping is wrong; all that is wrong with it.
    """
    plain = plain_parameters(parameters or {})
    kernels: list[KernelProof] = []
    absent: dict[str, None] = {}
    known: dict[Kernel, tuple[tuple[Owed, ...], str]] = {}
    for direction in DIRECTIONS:
        request = Request(direction, mapping, encoding=encoding, parameters=plain, backend="python")
        try:
            for each in _of_wires(request):
                encodings = (encoding,) if encoding is not None else tuple(Build(each).wire_framework.encodings)
                for name in encodings:
                    kernels += _of_encoding(replace(each, encoding=name), absent, known, judge)
        except ReportError as error:
            absent[_reason(error)] = None
    return MappingProof(mapping, tuple(kernels), tuple(absent))


def _of_wires(request: Request) -> list[Request]:
    """The request for each wire of the mapping."""
    wires = Build(request).checked.mapping.wires
    return [replace(request, wire=each.name) for each in wires] or [request]


def _of_encoding(request: Request, absent: dict[str, None], known: Known, judge: Judge | None) -> Iterator[KernelProof]:
    """The proofs of a direction's kernels in an encoding. A decoder that borrows is shown where it differs from the one that copies."""
    assert request.encoding is not None
    shown = request.encoding if request.wire is None else f"{request.wire}, {request.encoding}"
    try:
        made = dict(zip(PURPOSES[request.direction], _kernels(request), strict=True))
        if request.direction == "decode" and request.wire is None:
            (borrowing,) = _kernels(replace(request, borrow=True))
            if borrowing != made["decode"]:
                made["borrow"] = borrowing
    except ReportError as error:
        first = error.diagnostics[0]
        if first.code == UNPROVEN:
            yield KernelProof(PURPOSES[request.direction][0], shown, (), "\n".join(first.notes))
        else:
            absent[f"{shown}: {_reason(error)}"] = None
        return
    for purpose, kernel in made.items():
        if kernel not in known:
            known[kernel] = _proven(kernel, Build(request).layout, judge)
        yield KernelProof(purpose, shown, *known[kernel])


def _kernels(request: Request) -> tuple[Kernel, ...]:
    return Build(request).kernels


def _reason(error: ReportError) -> str:
    """Why there is no such kernel; every other mistake is the user's to see."""
    first = error.diagnostics[0]
    if first.code not in ABSENT:
        raise error
    return first.message


def _proven(kernel: Kernel, layout: Layout, judge: Judge | None) -> tuple[tuple[Owed, ...], str]:
    record, refusal = Record(), ""
    try:
        verify(kernel, record)
    except VerificationError as error:
        refusal = str(error)
    paths = slot_paths(layout)
    opinions = repeat(None) if judge is None else judge(record.obligations)
    return tuple(_owed(each, opinion, paths) for each, opinion in zip(record.obligations, opinions, strict=False)), refusal


def _owed(obligation: Obligation, opinion: Opinion | None, paths: Mapping[tuple[int, int], str]) -> Owed:
    statement = "" if obligation.stmt is None else statement_text(obligation.stmt)
    path = obligation.path
    if isinstance(obligation.stmt, SetField):
        path = paths.get((obligation.stmt.place.lane, obligation.stmt.place.offset), path)
    return Owed(obligation.part, printable(statement), printable(path), obligation.claim.holds, obligation.procedure, opinion)


def slot_paths(layout: Layout) -> dict[tuple[int, int], str]:
    """The path of each field of a layout. Of several fields at one place, as the cases of a union are, the first."""
    found: dict[tuple[int, int], str] = {}
    for number, lane in enumerate(layout.lanes):
        for offset, path in _paths(lane.element, f"{lane.name}[]" if number else ""):
            found.setdefault((number, offset), path)
    return found


def _paths(slot: Slot, path: str) -> Iterator[tuple[int, str]]:
    match slot:
        case Row(members=members) | Variant(members=members):
            for member in members:
                yield from _paths(member.slot, f"{path}.{member.name}")
        case _:
            pass
    yield slot.offset, path


def as_text(found: MappingProof) -> str:
    """All obligations of a mapping's kernels, and a summary."""
    return "\n\n".join([*("\n".join(_kernel(each, found.mapping)) for each in found.kernels), summary(found)])


def summary(found: MappingProof) -> str:
    """One line: how many kernels and obligations there are, who proved them, and what z3 says; more only where something is wrong."""
    owed = [each for kernel in found.kernels for each in kernel.owed]
    procedures = sum((kernel.procedures() for kernel in found.kernels), Counter[str]())
    parts = [_plural(len(found.kernels), "kernel"), _plural(len(owed), "obligation"), _counted(procedures)]
    verdicts = Counter(each.opinion.verdict for each in owed if each.opinion is not None)
    parts += [f"z3: {_counted(verdicts)}"] if verdicts else []
    verdict = "proved" if found.is_proved else "NOT PROVED"
    lines = [f"{printable(found.mapping)}: {verdict} - {'; '.join(filter(None, parts))}"]
    for kernel in found.kernels:
        lines += [f"  {kernel.purpose}, {kernel.encoding}: {printable(line)}" for line in kernel.refusal.splitlines()]
        lines += [f"  {kernel.purpose}, {kernel.encoding}: {_line(each)}" for each in kernel.owed if not each.is_proved]
    return "\n".join([*lines, *(f"  left out: {reason}" for reason in found.absent)])


def _kernel(kernel: KernelProof, mapping: str) -> Iterator[str]:
    yield f"{printable(mapping)}: {kernel.purpose}, {kernel.encoding}"
    part = ""
    for (where, statement), owed in groupby(kernel.owed, lambda each: (each.part, each.statement)):
        if where != part:
            yield f"  {where}:"
            part = where
        yield f"  {statement or 'at the begin'}"
        rows = [(each.claim, each.path, each.procedure or "NOBODY", _opinion(each)) for each in owed]
        yield from (f"    {line}" for line in columns([(*row, _times(count)) for row, count in Counter(rows).items()]))


def _line(owed: Owed) -> str:
    """An obligation by itself."""
    return "  ".join(filter(None, (owed.statement, owed.claim, owed.path, owed.procedure or "NOBODY", _opinion(owed))))


def _opinion(owed: Owed) -> str:
    if owed.opinion is None:
        return ""
    values = ", ".join(f"{name} = {value}" for name, value in owed.opinion.counterexample)
    return f"z3: {owed.opinion.verdict}{f' by {values}' if values else ''}"


def _times(count: int) -> str:
    return f"x {count}" if count > 1 else ""


def _plural(count: int, noun: str) -> str:
    return f"{count} {noun}{'' if count == 1 else 's'}"


def _counted(counts: Counter[str]) -> str:
    return ", ".join(f"{count} {what}" for what, count in sorted(counts.items()))
