"""Random relations of arrays in other orders: padded rows, matrices, channels, parts of arrays, orders that a flag tells."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from tests.random_mappings.meaning import Refused, fits
from tests.random_mappings.message_types import CONSTANTS, OCTETS, Array, Enum, Kind, Message, Scalar, some
from tests.random_mappings.relations import Part

if TYPE_CHECKING:
    import random
    from collections.abc import Callable

    from tests.random_mappings.blocks import Relations
    from tests.random_mappings.relations import Values

    Order = tuple[str, Callable[[list[Any]], list[Any]]]

INT = Scalar("int32")
NUMBERS = Array(Scalar("float64"))


def chunks(array: list[Any], size: int) -> list[list[Any]]:
    if len(array) % size:
        raise Refused("range/rejected")
    return [array[i : i + size] for i in range(0, len(array), size)]


def flat(groups: Any) -> list[Any]:
    return [each for group in groups for each in group]


def transposed(array: list[Any], rows: int, columns: int, group: int = 1) -> list[Any]:
    if len(array) != rows * columns * group:
        raise Refused("rejected")
    cells = chunks(array, group)
    return flat(cells[row * columns + column] for column in range(columns) for row in range(rows))


def planar(array: list[Any], channels: int, group: int = 1) -> list[Any]:
    cells = chunks(chunks(array, group), channels) if len(array) % (channels * group) == 0 else chunks([0], 2)
    return flat(pixel[channel] for channel in range(channels) for pixel in cells)


def interleaved(array: list[Any], channels: int, group: int = 1) -> list[Any]:
    if len(array) % (channels * group):
        raise Refused("range/rejected")
    count = len(array) // (channels * group)
    cells = chunks(array, group)
    return flat(cells[channel * count + pixel] for pixel in range(count) for channel in range(channels))


def order(rng: random.Random, text: str) -> Order:
    """An order of the elements of an array, that may be one of another order."""
    size, group = rng.choice([2, 3, 4]), rng.choice([1, 1, 2])
    more = f", {group}" if group > 1 else ""
    rows, columns = rng.choice([(2, 3), (3, 2), (1, 6), (4, 3)])
    forms: list[Order] = [
        (f"reversed({text})", lambda a: a[::-1]),
        (f"reversed({text}, {size})", lambda a: flat(g[::-1] for g in chunks(a, size))),
        (f"permuted({text}, [1, 2, 0])", lambda a: flat([g[1], g[2], g[0]] for g in chunks(a, 3))),
        (f"transposed({text}, {rows}, {columns}{more})", lambda a: transposed(a, rows, columns, group)),
        (f"planar({text}, {size}{more})", lambda a: planar(a, size, group)),
        (f"interleaved({text}, {size}{more})", lambda a: interleaved(a, size, group)),
    ]
    return rng.choice(forms)


def ordered(relations: Relations, name: str) -> Part:
    """An array in one order, that may be turned round before or behind it; of bytes or numbers."""
    rng = relations.rng
    is_bytes = rng.random() < 0.4
    is_turned = rng.random() < 0.3
    text, change = order(rng, f"reversed(.{name})" if is_turned else f".{name}")
    function: Callable[[list[Any]], list[Any]] = (lambda a: change(a[::-1])) if is_turned else change
    if not is_turned and rng.random() < 0.3:
        text, function = f"reversed({text})", lambda a: change(a)[::-1]
    kinds: dict[str, Kind] = {name: OCTETS if is_bytes else NUMBERS}
    pack = bytes if is_bytes else list

    def some_of(rng: random.Random) -> Values:
        count = rng.choice([0, 6, 6, 12, 12, 24, 5])
        return {name: rng.randbytes(count) if is_bytes else [some(rng, Scalar("float64")) for _ in range(count)]}

    return Part(kinds, kinds, f".{name} <-> {text}\n", lambda values: {name: pack(function(list(values[name])))}, some_of, some_of)


def padded(relations: Relations, name: str) -> Part:
    """Rows with something behind each, of which both sides tell height and width; perhaps as planes."""
    rng = relations.rng
    relations.blocks += 1
    if relations.blocks > 2:
        return ordered(relations, name)
    width, height = f"{name}w", f"{name}h"
    sizes = (0, 1, 1, 2, 3, 8, 2, 3, 5, -1)
    channels, quantum = rng.choice([1, 3, 4]), rng.choice([1, 4, 8])
    size = f".{width} * {channels}" if channels > 1 else f".{width}"
    stride = rng.choice([f"align({size}, {quantum})", f"{size} + {quantum}"])
    text = f"rows(.{name}, .{height}, {size}, {stride})"
    is_planar = channels > 1 and rng.random() < 0.4
    if is_planar:
        text = f"planar({text}, {channels})"
    lines = [f".{width} <-> .{width}\n", f".{height} <-> .{height}\n", f".{name} <-> {text}\n"]
    rng.shuffle(lines)

    def whole(count: int) -> int:
        return -(-count // quantum) * quantum if stride.startswith("align") else count + quantum

    def unpack(values: Values) -> Values:
        own = values[width] * channels
        if min(values[height], own) < 0 or (own and values[height] and len(values[name]) < (values[height] - 1) * whole(own) + own):
            raise Refused("index/rejected/count/range")
        pixels = flat(values[name][row * whole(own) :][:own] for row in range(values[height]))
        return {width: values[width], height: values[height], name: bytes(planar(pixels, channels) if is_planar else pixels)}

    def wires(rng: random.Random) -> Values:
        values = {width: rng.choice(sizes), height: rng.choice(sizes) or 1}
        count = values[height] * whole(values[width] * channels)
        return {**values, name: rng.randbytes(max(0, count + rng.choice([0, 0, 0, 0, 1, -1])))}

    def holders(rng: random.Random) -> Values:
        values = {width: rng.choice(sizes), height: rng.choice(sizes) or 1}
        return {**values, name: rng.randbytes(max(0, values[height] * values[width] * channels + rng.choice([0, 0, 0, 0, 1, -1])))}

    kinds: dict[str, Kind] = {width: INT, height: INT, name: OCTETS}
    return Part(kinds, kinds, "".join(lines), unpack, wires, holders, is_bounded=True)


def flagged(relations: Relations, name: str) -> Part:
    """An array and the constant that says in which order it is; not of each element of another array."""
    rng = relations.rng
    if not relations.holder.constant or relations.depth:
        return ordered(relations, name)
    flag = f"{name}m"
    text, function = order(rng, f".{name}")
    cases = [(f".{name}", list), (text, function)]
    rng.shuffle(cases)
    flags = rng.sample(CONSTANTS, 2)
    entries = ", ".join(f"{relations.constant(each)} = {shown}" for each, (shown, _) in zip(flags, cases, strict=True))

    def unpack(values: Values) -> Values:
        return {name: cases[0][1](values[name]), flag: flags[0]}

    def some_of(rng: random.Random) -> Values:
        return {name: [some(rng, Scalar("float64")) for _ in range(rng.choice([0, 6, 12, 5]))]}

    return Part(
        {name: NUMBERS},
        {name: NUMBERS, flag: Enum()},
        f".{name} by .{flag} <-> {{ {entries} }}\n",
        unpack,
        some_of,
        lambda rng: {**some_of(rng), flag: rng.choice(flags)},
    )


def sliced(relations: Relations, name: str) -> Part:
    """The parts of one array as arrays and fields of their own."""
    a, b, first = f"{name}a", f"{name}b", f"{name}f"
    start = relations.rng.choice([1, 2, 3])
    lines = [f".{a} <-> .{name}[1 to {start + 1}]\n", f".{b} <-> .{name}[{start + 1} to]\n", f".{first} <-> .{name}[0]\n"]
    relations.rng.shuffle(lines)

    def unpack(values: Values) -> Values:
        whole = values[name]
        if len(whole) < start + 1:
            raise Refused("index/rejected")
        return {first: whole[0], a: whole[1 : start + 1], b: whole[start + 1 :]}

    def numbers(rng: random.Random, count: int) -> list[Any]:
        return [some(rng, Scalar("float64")) for _ in range(count)]

    def holders(rng: random.Random) -> Values:
        count = start if rng.random() < 0.8 else rng.choice([0, 5])
        return {first: some(rng, Scalar("float64")), a: numbers(rng, count), b: numbers(rng, rng.choice([0, 1, 4]))}

    return Part(
        {name: NUMBERS},
        {first: Scalar("float64"), a: NUMBERS, b: NUMBERS},
        "".join(lines),
        unpack,
        lambda rng: {name: numbers(rng, rng.choice([0, start, start + 1, start + 1, start + 4]))},
        holders,
        pack=f"len(.{name}) = {start + 1} + len(.{b})\n",
    )


def members(relations: Relations, name: str) -> Part:
    """Arrays of their own here, an array of messages there."""
    rng = relations.rng
    x, y = f"{name}x", f"{name}y"
    types = {"u": rng.choice(["int32", "int64"]), "v": rng.choice(["float64", "string"])}
    is_apart = rng.random() < 0.5
    structs = {name: Array(Message(f"{'Src' if is_apart else 'Dst'}{name.upper()}", {each: Scalar(t) for each, t in types.items()}))}
    apart: dict[str, Kind] = {x: Array(Scalar(types["u"])), y: Array(Scalar(types["v"]))}
    sign = "-" if rng.random() < 0.5 and types["u"] == "int64" else ""
    turn: Callable[[Any], Any] = (lambda value: fits(-value)) if sign else (lambda value: value)

    def columns(rng: random.Random, *, is_even: bool = False) -> Values:
        counts = [rng.choice([0, 1, 5])] * 2
        if not is_even and rng.random() < 0.1:
            counts[0] += 1
        return {x: [some(rng, Scalar(types["u"])) for _ in range(counts[0])], y: [some(rng, Scalar(types["v"])) for _ in range(counts[1])]}

    def together(values: Values) -> list[dict[str, Any]]:
        if len(values[x]) != len(values[y]):
            raise Refused("rejected/range")
        return [{"u": u, "v": v} for u, v in zip(values[x], values[y], strict=True)]

    def rows(rng: random.Random) -> Values:
        return {name: together(columns(rng, is_even=True))}

    def unpack(values: Values) -> Values:
        return {x: [turn(each["u"]) for each in values[name]], y: [each["v"] for each in values[name]]}

    def pack(values: Values) -> Values:
        made = together(values)
        return {name: [{"u": turn(each["u"]), "v": each["v"]} for each in made]}

    if is_apart:
        return Part(structs, apart, f".{x}[] <-> {sign}.{name}[].u\n.{y}[] <-> .{name}[].v\n", unpack, rows, columns)
    return Part(apart, structs, f".{name}[].u <-> {sign}.{x}[]\n.{name}[].v <-> .{y}[]\n", pack, columns, rows)


def chosen_element(relations: Relations, name: str) -> Part:
    """An element whose number is a field: of a fixed array, or of one whose other elements are mapped, too."""
    i, a = f"{name}i", f"{name}a"
    text = f".{i} <-> .{i}\n.{name} <-> .{name}\n.{a} <-> .{name}[.{i}]\n"

    def unpack(values: Values) -> Values:
        if not 0 <= values[i] < len(values[name]):
            raise Refused("index")
        return {i: values[i], name: values[name], a: values[name][values[i]]}

    def wires(rng: random.Random) -> Values:
        return {i: rng.choice([0, 1, 2, 5, -1]), name: [some(rng, Scalar("float64")) for _ in range(rng.choice([1, 3, 6]))]}

    def holders(rng: random.Random) -> Values:
        values = wires(rng)
        there = 0 <= values[i] < len(values[name])
        return {**values, a: values[name][values[i]] if there and rng.random() < 0.8 else some(rng, Scalar("float64"))}

    return Part({i: INT, name: NUMBERS}, {i: INT, name: NUMBERS, a: Scalar("float64")}, text, unpack, wires, holders)


def elementwise_digits(relations: Relations, name: str) -> Part:
    """Each element of two digits."""
    high, low, factor = f"{name}h", f"{name}l", relations.rng.choice([10, 60, 1000])
    kinds: dict[str, Kind] = {high: Array(INT), low: Array(INT)}

    def unpack(values: Values) -> Values:
        pairs = values[high], values[low]
        if len(pairs[0]) != len(pairs[1]) or any(not 0 <= each < factor for each in pairs[1]):
            raise Refused("rejected")
        return {name: [a * factor + b for a, b in zip(*pairs, strict=True)]}

    def wires(rng: random.Random) -> Values:
        count = rng.choice([0, 1, 4])
        return {
            high: [some(rng, INT) for _ in range(count)],
            low: [rng.choice([0, factor - 1, factor if rng.random() < 0.1 else 1]) for _ in range(count + (rng.random() < 0.1))],
        }

    def holders(rng: random.Random) -> Values:
        return {name: [rng.randrange(-(2**33), 2**33) for _ in range(rng.choice([0, 1, 4]))]}

    text = f".{name}[] <-> .{high}[] * {factor} + .{low}[]\n"
    return Part(kinds, {name: Array(Scalar("int64"))}, text, unpack, wires, holders)
