"""Functions that read, write or measure messages within others: one for each lane of such messages, which call each other.

    int64 encode_kids(holder, bytes, end, failure, object, at, depth)       where the message ends, or -1 - site

One that writes collects the fields of its object in a row of its own, a local, and the start of the span of further messages is their
address. One that reads sets the fields of its object, whose lists have these messages.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from rosetta_jit.backends.printing import Writer
from rosetta_jit.generate.c.printing.calls import shared_by_visits, visiting
from rosetta_jit.generate.c.printing.function import Function
from rosetta_jit.generate.c.printing.heads import declared, head
from rosetta_jit.generate.c.printing.statements import print_block
from rosetta_jit.generate.passes.aligned import as_printed
from rosetta_jit.generate.passes.decided import decided
from rosetta_jit.generate.passes.descents import Descents, Visit
from rosetta_jit.generate.passes.positions import said_by
from rosetta_jit.generate.passes.reachable import reached, read_names
from rosetta_jit.kernel.nodes import Block, Compare, Direction, Local
from rosetta_jit.kernel.terms import END, index


def print_visited(writer: Writer, descents: Descents, functions: Mapping[int, Function], direction: Direction) -> None:
    """The functions of all lanes, which are declared before."""
    heads = {lane: _head(function, lane, descents, direction) for lane, function in functions.items()}
    if writer.lines:
        writer.line()
    writer.lines += [f"{text};" for text in heads.values()]
    for lane, function in functions.items():
        _print(writer, heads[lane], descents, descents.rows[lane], function, direction)


def starts_of(visits: Mapping[str, Visit]) -> Iterable[str]:
    """The locals that say where the messages of arrays begin."""
    return (each.start.name for each in visits.values() if isinstance(each.start, Local))


def _head(function: Function, lane: int, descents: Descents, direction: Direction) -> str:
    lanes, name = function.scope.lanes, function.scope.locals.identifier
    shared = shared_by_visits(function)
    given = declared((*shared, "given_object"), direction, lanes) if direction == "decode" else declared(shared, direction, lanes)
    given += [] if direction == "decode" else [f"const {lanes.objects(lane)}::type &object"]
    own = [f"int64_t {name(each.name)}" for each in descents.given]
    own += [] if descents.lengths is None else [f"int64_t &{name(descents.lengths.name)}"]
    return f"static inline int64_t {visiting(function, lane)}({', '.join((*given, *own))})"


def _print(writer: Writer, text: str, descents: Descents, block: Block, function: Function, direction: Direction) -> None:
    scope, body = function.scope, reached(decided(block))
    lanes, lane = scope.lanes, scope.lanes.subject
    function.read = read_names(as_printed(body), starts_of(function.visits))
    function.known = said_by((Compare("ge", descents.at, index(0)), Compare("le", descents.at, END)))
    print_block(function, body)
    collected = (f"{lanes.type(lane)} given_row;", f"collect_{lanes.rows(lane)}(object, *holder, given_row.value);")
    head(writer, text, scope, direction, () if direction == "decode" else collected)
    writer.lines += [f"    int64_t {lanes.used(each)} = 0;" for each in sorted(scope.counted)]
    writer.lines += [*function.kept_lines(), "}"]
