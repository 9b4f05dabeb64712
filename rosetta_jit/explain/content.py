"""All that is told about a mapping, as data: `text`, `page` and JSON show the same.

Explanation = Side of the wire, Side of the holder, Direction*        what a person asks about a mapping
Side        = type, framework, Row*
Direction   = Line*, Loss*, Refusal*, cost                            unpack: wire to holder; pack: holder to wire
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable
from itertools import islice
from typing import Literal

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.errors import ReportError
from rosetta_jit.explain.cost import Cost, cost_of
from rosetta_jit.explain.limits import MAX_RULES
from rosetta_jit.explain.lines import Line, Lines
from rosetta_jit.explain.rows import Row, rows
from rosetta_jit.explain.walk import nodes
from rosetta_jit.frameworks.installed import Readers, installed
from rosetta_jit.language import typed
from rosetta_jit.language.check.mapping import Checked, check
from rosetta_jit.language.parse.mapping import parse
from rosetta_jit.language.places import rules_within, shown_fields, shown_names
from rosetta_jit.language.scope import Message
from rosetta_jit.language.typed import Rule
from rosetta_jit.language.untouched import unread, unset
from rosetta_jit.model.expr import Side as SideName
from rosetta_jit.model.mapping import Mapping
from rosetta_jit.parsing.search import SearchPath
from rosetta_jit.pipeline.build import Build
from rosetta_jit.pipeline.request import Request
from rosetta_jit.startup.dataclass import dataclass, replace


@dataclass(frozen=True, slots=True)
class Side:
    """One of the two types."""

    side: SideName
    type: str
    framework: str
    rows: tuple[Row, ...]
    more: bool


@dataclass(frozen=True, slots=True)
class Loss:
    """Something that a direction does not carry, and whether the mapping says that it is meant."""

    what: str
    why: str
    meant: bool


@dataclass(frozen=True, slots=True)
class KernelCost:
    """What the kernel of a direction costs, for messages of one encoding, and how many other forms of a message it tries after that."""

    encoding: str
    cost: Cost
    attempts: int


@dataclass(frozen=True, slots=True)
class Direction:
    """One direction. ``refusals`` are the texts of its rejections; the cost is a reason where there is no kernel."""

    name: Literal["unpack", "pack"]
    lines: tuple[Line, ...]
    losses: tuple[Loss, ...]
    refusals: tuple[str, ...]
    cost: KernelCost | str


@dataclass(frozen=True, slots=True)
class Explanation:
    """A mapping, explained; a direction that it does not have is missing."""

    mapping: str
    wire: Side
    holder: Side
    directions: tuple[Direction, ...]
    warnings: tuple[Diagnostic, ...]


def explanation(mapping: str, *, encoding: str | None = None, folders: Iterable[str] = (), wire: str | None = None) -> Explanation:
    """Explain a mapping; where it has several wires, with what the kernels of one ``wire`` cost.

    Raises
    ------
    MappingError
        It is wrong; all that is wrong with it.
    """
    folders = tuple(folders)
    search, readers = SearchPath.of(folders), Readers(installed(), None, encoding)
    written = parse(search.open(mapping))
    checked = check(written, readers, search)
    request = Request("decode", mapping, encoding=encoding, folders=folders, wire=wire)
    found = (_direction("unpack", written, checked, request), _direction("pack", written, checked, request))
    return Explanation(
        mapping,
        _side("wire", checked.wire, readers),
        _side("holder", checked.holder, readers),
        tuple(each for each in found if each is not None),
        checked.warnings,
    )


def _side(name: SideName, message: Message, readers: Readers) -> Side:
    found, more = rows(message)
    owner = readers.owner(message.root.span.source.name) if message.root.span is not None else None
    return Side(name, message.root.name, owner.name if owner is not None else "", found, more)


def _direction(name: Literal["unpack", "pack"], written: Mapping, checked: Checked, request: Request) -> Direction | None:
    rules, derived = (checked.unpack, checked.mapping.unpack_rules) if name == "unpack" else (checked.pack, checked.mapping.pack_rules)
    if not rules or not derived:
        return None
    source, target = (checked.wire, checked.holder) if name == "unpack" else (checked.holder, checked.wire)
    lines = tuple(islice(Lines.of(written, name, rules, checked.uses).lines(derived), MAX_RULES))
    refusals = [rule.text for rule in rules_within(rules) if isinstance(rule, typed.Reject)]
    refusals += [node.reason for node in nodes(rules) if isinstance(node, typed.Choice) and node.otherwise is None]
    losses = tuple(_losses(rules, lines, source, target))
    return Direction(name, lines, losses, tuple(dict.fromkeys(refusals)), _cost_in(checked, name, request))


def _cost_in(checked: Checked, name: str, request: Request) -> KernelCost | str:
    """The cost of the kernel; of several wires, that of the one that is named."""
    wires = [each.name for each in checked.mapping.wires]
    if wires and request.wire is None:
        return f"each wire has one of its own: `--wire {wires[0]}` shows what it costs"
    return _cost(name, request, _field_names(checked))


def _losses(rules: tuple[Rule, ...], lines: tuple[Line, ...], source: Message, target: Message) -> list[Loss]:
    ignored = [shown_fields(rule.place.steps) for rule in rules_within(rules) if isinstance(rule, typed.Ignore)]
    left = [shown_fields(rule.place.steps) for rule in rules_within(rules) if isinstance(rule, typed.Default)]
    changed: dict[str, list[str]] = defaultdict(list)
    for line in lines:
        for note in (note for note in line.notes if note.lossy):
            changed[note.text].append(shown_names(line.sets[0], target) if line.sets else f"line {line.line}")
    return [
        *(Loss(path, "is not read", meant=True) for path in dict.fromkeys(ignored)),
        *(Loss(shown_names(names, source), "is never read", meant=False) for names in unread(rules, source)),
        *(Loss(path, "is left at its default", meant=True) for path in dict.fromkeys(left)),
        *(Loss(shown_names(names, target), "is never set", meant=False) for names in unset(rules, target)),
        *(Loss(", ".join(dict.fromkeys(paths)), text, meant=True) for text, paths in changed.items()),
    ]


def _field_names(checked: Checked) -> dict[str, str]:
    """Paths by what a kernel calls the values of their fields."""
    every = [row for message in (checked.holder, checked.wire) for row in rows(message)[0]]
    return {"_".join(row.names): row.path for row in every}


def _cost(name: str, request: Request, names: dict[str, str]) -> KernelCost | str:
    """The cost of the kernel; where it must be said which dialect is written, of the first that can be."""
    request = replace(request, direction="decode" if name == "unpack" else "encode", backend="python")
    framework = Build(request).wire_framework
    alternatives = tuple(framework.encodings)[1:] if request.encoding is None else ()
    reason = ""
    for encoding in (request.encoding, *alternatives):
        build = Build(replace(request, encoding=encoding))
        try:
            kernel = build.kernels[0]
        except ReportError as error:
            reason = reason or error.diagnostics[0].message
        else:
            return KernelCost(build.encoding.name, cost_of(kernel, names), len(kernel.bodies))
    return reason
