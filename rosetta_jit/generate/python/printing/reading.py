"""Arrays and texts that a decoder reads where they lie in the message (see `direct`), as Python expressions."""

from __future__ import annotations

from collections.abc import Callable

from rosetta_jit.generate.parentheses import bare
from rosetta_jit.generate.passes.cleared import slots_of
from rosetta_jit.generate.python.passes.nested_arrays import MANY
from rosetta_jit.generate.python.printing.expressions import expression, slice_of
from rosetta_jit.generate.python.printing.scope import CODES, Scope
from rosetta_jit.kernel.nodes import WIDTH, Binary, Const, Copy, Expr, For, IsText, Let, Load, Local, Place, SetField, Stmt, Wire
from rosetta_jit.kernel.rewrite import locals_in
from rosetta_jit.kernel.terms import add, index, mul
from rosetta_jit.model.layout import Number, Row, Slot
from rosetta_jit.startup.dataclass import replace

SOME = 160
"""Numbers of an array from which on a view of them is quicker than the struct module."""


def takes_text(scope: Scope, condition: Expr) -> str | None:
    """The line that decodes a text, where a check is that of one which is taken where it is checked."""
    match condition:
        case IsText(Wire(at), size) if (span := scope.direct.text_at(at, size)) is not None:
            decoded = f"{slice_of(scope, at, size)}.decode()"
            if span[0] in scope.direct.listed:
                return f"{scope.lanes.rows(span[0])}.append({decoded})"
            text = f"{scope.placed(*span)}[{bare(expression(scope, at))}]" if span in scope.direct.placed else scope.text(*span)
            return f"{text} = {decoded}"
        case _:
            return None


def numbers_read(scope: Scope, lane: int, slot: Slot, row: Callable[[], str], at: Expr, size: Expr, order: str) -> str:
    """The list of numbers that lie in the message, or of rows that are numbers, of which ``row`` makes objects."""
    begin, stride = bare(expression(scope, at)), scope.lanes.stride(lane)
    part = f"data[{begin} : {begin} + {expression(scope, size)}]"
    view = part.replace("data", "memoryview(data)", 1)
    if isinstance(slot, Number) and scope.numpy:
        count = Const("i64", int(size.value) // stride) if isinstance(size, Const) else _divided(size, stride)
        dtype, number = scope.bool_dtype() if slot.scalar == "bool" else scope.dtype(slot.scalar, order), bare(expression(scope, count))
        if order == ">" and stride > 1:
            turned = f"_numbers_in(data, {dtype}, {number}, {begin}).astype({scope.dtype(slot.scalar)})"
            return turned if isinstance(count, Const) else f"{turned} if {number} else {scope.no_numbers(slot.scalar)}"
        return scope.numbers_in_message(dtype, number, begin)
    if isinstance(slot, Number):
        if slot.scalar == "u8":
            return f"[*{part}]"
        count = Const("i64", int(size.value) // stride) if isinstance(size, Const) else _divided(size, stride)
        code, order = "?" if slot.scalar == "bool" else CODES[slot.scalar], order or "<"
        many = f'[*{view}.cast("?")]' if code == "?" else f'_many{"_turned" if order == ">" else ""}({view}, "{code}")'
        if isinstance(count, Const):
            return many if count.value > SOME else f"[*{scope.struct(order, code * int(count.value), 'load')}(data, {begin})]"
        few = f"[*{scope.by_count(order, code, 'reads')}[{bare(expression(scope, count))}](data, {begin})]"
        return f"{few} if {expression(scope, count)} < {SOME} else {many}"
    numbers = sorted((each.offset, each.scalar) for each in slots_of(slot) if isinstance(each, Number))
    each = scope.struct(order or "<", "".join(CODES[scalar] for _, scalar in numbers), "each")
    names = _targets([scope.own(lane, offset, scalar) for offset, scalar in numbers])
    found = f"[{row()} for {names} in {each}({part})]"
    return found if isinstance(size, Const) else f"{found} if {expression(scope, _divided(size, stride))} else []"


def rows_read(scope: Scope, loop: For, slot_of: Callable[[int], Slot], row: Callable[[Scope, int], str]) -> tuple[str, int] | None:
    """The rows, of as many bytes or numbers each, that a loop takes from the message one behind the other: a list of them.

    The number is that of rows from which on the loop takes longer. A row of a lane has the slot that ``slot_of`` gives, and is a struct or
    an array; ``row`` makes the struct.
    """
    lane, round_ = scope.direct.loops.get(loop.variable), Local("i64", loop.variable)
    match loop.body:
        case (Let(item, Binary("add", one, other)), *fills) if lane is not None:
            size = _size_of_bytes(scope, lane, item, fills) or _size_of_numbers(scope, item, fills) or _size_of_array(scope, item, fills)
            steps = [each.right for each in (one, other) if isinstance(each, Binary) and (each.op, each.left) == ("mul", round_)]
            bases = [each for each in (one, other) if loop.variable not in locals_in(each)]
            if size is None or len(bases) != 1 or steps != [index(size)]:
                return None
            is_made = any(isinstance(slot_of(each), Row) for each in (lane, *_filled(fills[0])))
            made: Callable[[Scope], str] | None = (lambda within: row(within, lane)) if is_made else None
            table = _table(scope, fills[0], slot_of, bases[0], loop.count, size, made) if scope.numpy else None
            return (_rows(scope, fills[0], bases[0], loop.count, size, made), 0) if table is None else (table, MANY)
        case _:
            return None


def _filled(fill: Stmt) -> tuple[int, ...]:
    """The lane of which a statement sets a number."""
    return (fill.place.lane,) if isinstance(fill, SetField) and isinstance(fill.value, Load) else ()


def _size_of_bytes(scope: Scope, lane: int, item: str, fills: list[Stmt]) -> int | None:
    """How many bytes rows have that are bytes."""
    match fills, scope.direct.pieces.get((lane, 0)):
        case [SetField(Place(of, _, 0))], (Local(_, name), Const(_, size)) if (of, name) == (lane, item) and size > 0:
            return int(size)
        case _:
            return None


def _size_of_numbers(scope: Scope, item: str, fills: list[Stmt]) -> int | None:
    """How many bytes rows have that are numbers of one type."""
    match fills[0] if fills else None:
        case SetField(Place(lane), Load(type_) as load) if type_ != "bool":
            width, places = WIDTH[type_], scope.direct.elements.get(lane, [])
            loads = (replace(load, at=add(Local("i64", item), number * width)) for number in range(len(places)))
            wanted = [SetField(place, each) for place, each in zip(places, loads, strict=True)]
            return len(places) * width if fills == wanted else None
        case _:
            return None


def _size_of_array(scope: Scope, item: str, fills: list[Stmt]) -> int | None:
    """How many bytes rows have that are arrays of numpy, and lie in the message as in memory."""
    match fills:
        case [Copy(Place(lane), Wire(Local(_, name)), Const(_, size))] if scope.numpy and lane in scope.direct.whole and name == item:
            return int(size) or None
        case _:
            return None


def _table(
    scope: Scope, fill: Stmt, slot_of: Callable[[int], Slot], base: Expr, count: Expr, size: int, made: Callable[[Scope], str] | None
) -> str | None:
    """A list of rows that are arrays of numpy, of which a statement fills one: numpy reads all of them, as rows of one array."""
    begin, lane = bare(expression(scope, base)), 0
    match fill:
        case SetField(Place(lane), Load(type_, _, order)) if isinstance(slot_of(lane), Number):
            numbers = bare(expression(scope, mul(count, size // WIDTH[type_])))
            dtype = scope.dtype(type_, "<" if WIDTH[type_] == 1 else order)
            found = f"_numbers_in(data, {dtype}, {numbers}, {begin}).astype({scope.dtype(type_)})"
        case Copy(Place(lane)) if isinstance(slot := slot_of(lane), Number):
            type_ = slot.scalar
            numbers = bare(expression(scope, mul(count, size // WIDTH[type_])))
            found = scope.numbers_in_message(scope.dtype(type_), numbers, begin)
        case _:
            return None
    found += f".reshape(-1, {size // WIDTH[type_]})"
    if made is None:
        return f"[*{found}]"
    within = replace(scope, direct=replace(scope.direct, whole=scope.direct.whole | {lane}))
    return f"[{made(within)} for {scope.lanes.rows(lane)} in {found}]"


def _rows(scope: Scope, first: Stmt, base: Expr, count: Expr, size: int, made: Callable[[Scope], str] | None) -> str:
    """A list of rows, by the statement that fills the first field of one; ``made`` are those that are structs."""
    begin, rounds = bare(expression(scope, base)), expression(scope, count)
    part = f"data[{begin} : {expression(scope, base)} + {expression(scope, mul(count, size))}]"
    match first:
        case SetField(Place(lane), Load(type_, _, order)):
            number = size // WIDTH[type_]
            each = f"{scope.struct('<' if WIDTH[type_] == 1 else order, CODES[type_] * number, 'each')}({part})"
            names = [scope.element(lane, place) for place in range(number)]
            found = f"[[*each] for each in {each}]" if made is None else f"[{made(scope)} for {_targets(names)} in {each}]"
        case SetField(Place(lane)) if made is not None:
            each = scope.struct("<", f"{size}s", "each")
            found = f"[{made(scope)} for {_targets([scope.piece(lane, 0)])} in {each}({part})]"
        case _:
            few = f"[*{scope.by_count('<', f'{size}s', 'pieces')}[{bare(rounds)}](data, {begin})]"
            many = f"_pieces(data, {begin}, {size}, {bare(rounds)})"
            is_few = isinstance(count, Const) and count.value < SOME
            return few if is_few else f"{few} if {rounds} < {SOME} else {many}"
    return found if isinstance(count, Const) else f"{found} if {rounds} else []"


def _targets(names: list[str]) -> str:
    """The locals that get what one call of the struct module gives."""
    return f"{names[0]}," if len(names) == 1 else ", ".join(names)


def _divided(size: Expr, stride: int) -> Expr:
    """What was multiplied by the size of a row."""
    match size:
        case Binary("mul", count, Const(_, value)) | Binary("mul", Const(_, value), count) if value == stride:
            return count
        case _:
            return size
