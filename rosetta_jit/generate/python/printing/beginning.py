"""How functions begin lanes, and the lines that stand for several: lanes that grow, fields that begin when they come."""

from __future__ import annotations

from collections.abc import Set

from rosetta_jit.generate.python.printing.late_lists import said_to_come
from rosetta_jit.generate.python.printing.printed import Function
from rosetta_jit.generate.python.printing.scope import Scope, flat_name
from rosetta_jit.generate.shares import moved_lanes
from rosetta_jit.generate.unit import Role, kind_of


def completed(line: str, function: Function) -> list[str]:
    """A line, or what it stands for: all fields of a part of the row, all views of a lane that has grown."""
    scope, text = function.scope, line.strip()
    before = line[: len(line) - len(line.lstrip())]
    if text.startswith("<row "):
        begin, size = map(int, text[5:-1].split())
        if size == scope.lanes.stride(0):
            rows = scope.rows - {flat_name(scope.lanes, *each) for each in function.settled}
            offsets = {*range(size)} - {offset for late in scope.direct.fields for offset in late.offsets}
            rows -= {name for name in rows if scope.offsets.get(name, 0) not in offsets}
        else:
            offsets = {*range(begin, begin + size)}
            rows = {name for name, offset in scope.offsets.items() if offset in offsets}
        return [f"{before}{each}" for each in _cleared(scope, rows, offsets)]
    if text.startswith("<late "):
        late, said = scope.direct.fields[int(text[6:-1])], said_to_come(scope, int(text[6:-1]))
        rows = {name for name, offset in scope.offsets.items() if offset in late.offsets}
        lines = [
            f"{' = '.join(said)} = True",
            *_empty(function, lanes_of_function(function) & late.lanes),
            *_cleared(scope, rows, late.offsets),
        ]
        return [f"{before}if not {said[0]}:", *(f"{before}    {each}" for each in lines)]
    if text.startswith("<views "):
        lane = int(text[7:-1])
        name = scope.lanes.rows(lane)
        codes = sorted(code for number, code in scope.views if number == lane and code)
        return [f'{before}{name}_{code} = memoryview({name}).cast("{code}")' for code in codes]
    return [line]


def _cleared(scope: Scope, rows: Set[str], offsets: Set[int]) -> list[str]:
    """The lines that set some ``rows``, which are locals, to 0, and the texts and bytes at some offsets to nothing."""
    late = [span for span in scope.direct.late if span[1] in offsets and span[1] not in (scope.attributes or ())]
    texts = {scope.text(*span) for span in late if span in scope.direct.texts}
    pieces = {scope.piece(*span) for span in late if span in scope.direct.pieces}
    numbers = rows - scope.floats - scope.bools
    groups = ((numbers, "0"), (rows & scope.floats, "0.0"), (rows & scope.bools, "False"), (texts, '""'), (pieces, 'b""'))
    return [f"{' = '.join(sorted(group))} = {zero}" for group, zero in groups if group]


def lanes_of_function(function: Function) -> set[int]:
    """The lanes that a function has to do with."""
    scope = function.scope
    return {lane for lane, _ in scope.views} | scope.rooms | scope.counted | function.moved


def chained(lines: list[str]) -> list[str]:
    """Assignments, of which those of the same number, view or rows are one."""
    found: dict[str, list[str]] = {}
    for line in lines:
        name, _, value = line.partition(" = ")
        is_constant = value in ("0", "False", "_NOTHING") or value.startswith("_EMPTY_")
        found.setdefault(value if is_constant else line, []).append(name)
    return [f"{' = '.join(names)} = {value}" if " = " not in value else value for value, names in found.items()]


def begin(function: Function, role: Role, without: Set[int] = frozenset(), *, says: bool = True) -> list[str]:
    """Lanes that start empty, or as another message has left them, and views of those that are given; of others than some."""
    kept, moved, kind = function.kernel.kept, moved_lanes(function.kernel), kind_of(role)
    scope, own, lines = function.scope, function.scope.lanes.own, list[str]()
    late = scope.direct.fields
    for lane in sorted(lanes_of_function(function) - {0}.union(without, *(each.lanes for each in late))):
        name = scope.lanes.rows(lane)
        codes = sorted(code for number, code in scope.views if number == lane and code)
        if lane < own and kind in ("encode", "size"):
            continue
        if lane in kept or lane in moved:
            lines.append(f'{name} = bytearray(_rows["{name}"])')
            lines += [f"{name}_room = len({name}) // {scope.lanes.stride(lane)}"] if lane in scope.rooms else []
            lines += [f'{name}_{code} = memoryview({name}).cast("{code}")' for code in codes]
            used = f"len({name}) // {scope.lanes.stride(lane)}" if lane in kept else "0"
            lines += [f"{name}_used = {used}"] if lane in scope.counted else []
            continue
        if lane in function.measured:
            lines += [f"{name}_room = len({name}) // {scope.lanes.stride(lane)}"] if lane in scope.rooms else []
            lines += [f'{name}_{code} = memoryview({name}).cast("{code}")' for code in codes]
            lines += [f"{name}_used = 0"] if lane in scope.counted else []
        else:
            lines += empty_lane(function, lane)
    said = dict.fromkeys(each for number, _ in enumerate(late) for each in said_to_come(scope, number)) if says else ()
    lines = chained([*lines, *(f"{each} = False" for each in said)])
    if not scope.flat and kind in ("decode", "borrow"):
        lines.append('message = bytearray(_rows["message"])' if kept else f"message = bytearray({scope.lanes.stride(0)})")
        lines += [f'message_{code} = memoryview(message).cast("{code}")' for lane, code in sorted(scope.views) if lane == 0 and code]
    return lines


def empty_lane(function: Function, lane: int) -> list[str]:
    """The locals of a lane that has no row yet."""
    scope, name = function.scope, function.scope.lanes.rows(lane)
    codes = sorted(code for number, code in scope.views if number == lane and code)
    scope.loads.update(f"_EMPTY_{code}" for code in codes)
    lines = [f"{name} = {'[]' if lane in scope.direct.gathered else '_NOTHING'}"]
    lines += [f"{name}_room = 0"] if lane in scope.rooms else []
    lines += [f"{name}_{code} = _EMPTY_{code}" for code in codes]
    lines += [f"{scope.placed(*span)} = {{}}" for span in scope.direct.placed if span[0] == lane]
    return [*lines, f"{name}_used = 0"] if lane in scope.counted else lines


def _empty(function: Function, lanes: Set[int]) -> list[str]:
    return chained([line for lane in sorted(lanes) for line in empty_lane(function, lane)])
