"""More random relations: by other mappings, with parameters, of dates, and between units."""

from __future__ import annotations

import calendar
import re
import time
from typing import TYPE_CHECKING, Any

import numpy as np

from tests.random_mappings.meaning import INTEGERS, Refused, fits
from tests.random_mappings.message_types import Array, Kind, Maybe, Message, Scalar, some
from tests.random_mappings.relations import Part, Values, below_all, body

if TYPE_CHECKING:
    import random
    from collections.abc import Callable

    from tests.random_mappings.blocks import Relations

UNITS = {("km", "m"): 1000.0, ("m", "mm"): 1000.0, ("minute", "s"): 60.0, ("hour", "s"): 3600.0, ("kg", "g"): 1000.0, ("m", "m"): 1.0}
"""Units that become each other by one product."""

# --- other mappings ------------------------------------------------------------------------------------------------------


def via(relations: Relations, name: str) -> Part:
    """A message, one that may be absent, or an array of messages, by the rules of another mapping."""
    rng = relations.rng
    relations.depth += 1
    parts = [relations.part() for _ in range(rng.randrange(1, 4))]
    relations.depth -= 1
    src = Message(f"Src{name.upper()}", below_all(part.wire for part in parts))
    dst = Message(f"Dst{name.upper()}", below_all(part.holder for part in parts))
    rules = f'.{name} <-> .{name} via "{name}.mapping"\n'

    def unpack_one(values: Values) -> Values:
        return unpacked_in_order(parts, values)

    def some_of(kind: str) -> Callable[[random.Random], Values]:
        def of(rng: random.Random) -> Values:
            return {each: value for part in parts for each, value in getattr(part, f"some_{kind}")(rng).items()}

        return of

    how = rng.choice(["message", "array", "optional"])
    has_arrays = not relations.is_counted
    is_optional = relations.wire.has_optional and relations.holder.has_optional
    common: dict[str, Any] = {
        "mappings": {f"{name}.mapping": (src, dst, body(parts)), **below_all(part.mappings for part in parts)},
        "parameters": below_all(part.parameters for part in parts),
        "units": tuple(re.sub("^(Src|Dst)[.]", rf"\1{name.upper()}.", each) for part in parts for each in part.units),
    }
    wires, holders = some_of("wire"), some_of("holder")
    if how == "array" and has_arrays:
        return Part(
            {name: Array(src)},
            {name: Array(dst)},
            rules,
            lambda fields: {name: [unpack_one(each) for each in fields[name]]},
            lambda rng: {name: [wires(rng) for _ in range(rng.choice([0, 1, 3]))]},
            lambda rng: {name: [holders(rng) for _ in range(rng.choice([0, 1, 3]))]},
            **common,
        )
    if how == "optional" and is_optional:
        return Part(
            {name: Maybe(src)},
            {name: Maybe(dst)},
            rules,
            lambda fields: {name: unpack_one(fields[name])} if name in fields else {},
            lambda rng: {name: wires(rng)} if rng.random() < 0.7 else {},
            lambda rng: {name: holders(rng)} if rng.random() < 0.7 else {},
            **common,
        )
    return Part(
        {name: src},
        {name: dst},
        rules,
        lambda fields: {name: unpack_one(fields[name])},
        lambda rng: {name: wires(rng)},
        lambda rng: {name: holders(rng)},
        **common,
    )


def unpacked_in_order(parts: list[Part], values: Values) -> Values:
    """What all parts unpack; all kinds that are refused are told by the first."""
    found: Values = {}
    kinds: list[str] = []
    for part in parts:
        try:
            found |= part.unpack(part.own(values))
        except Refused as refused:
            kinds.append(refused.kind)
    if kinds:
        raise Refused("/".join(kinds))
    return found


# --- parameters ----------------------------------------------------------------------------------------------------------


def parameter(relations: Relations, name: str) -> Part:
    """A constant, an addend or a condition that is given when the program is made."""
    rng = relations.rng
    number = rng.choice([0, 1, -7, 2**40])
    given = f"p_{name}"
    match rng.randrange(3):
        case 0:
            kinds: dict[str, Kind] = {name: Scalar("int64")}
            return Part(
                kinds,
                kinds,
                f".{name} <-> .{name} + {given}\n",
                lambda fields: {name: fits(fields[name] + number)},
                parameters={given: ("int64", number)},
            )
        case 1:
            kinds = {name: Scalar("int64")}
            rules = f"when {given} > 0\n.{name} <-> -.{name}\nelse\n.{name} <-> .{name}\nend\n"
            return Part(
                kinds,
                kinds,
                rules,
                lambda fields: {name: fits(-fields[name]) if number > 0 else fields[name]},
                parameters={given: ("int64", number)},
            )
        case _:
            text = rng.choice(["", "é", "map/b"])
            return Part(
                {name: Scalar("string")},
                {name: Scalar("string"), f"{name}b": Scalar("string")},
                f".{name} <-> {given} + .{name}\n.{name}b <-> {given}\n",
                lambda fields: {name: text + fields[name], f"{name}b": text},
                holders=lambda rng: {name: text + rng.choice(["", "é", "a/b"]), f"{name}b": text},
                parameters={given: ("string", text)},
            )


def listed(relations: Relations, name: str) -> Part:
    """Offsets from a list, element by element; and the list itself."""
    rng = relations.rng
    given, numbers = f"p_{name}", [float(rng.randrange(-5, 5)) for _ in range(rng.choice([1, 2, 4]))]
    size = len(numbers)
    texts = (
        f'reject "other length" when len(.{name}) != {size}\n'
        f"len(.{name}) <-> {size}\nfor i from 0 to {size}\n.{name}[i] <-> .{name}[i] + {given}[i]\nend\n"
    )

    def unpack(fields: Values) -> Values:
        if len(fields[name]) != size:
            raise Refused("rejected")
        return {name: [x + c for x, c in zip(fields[name], numbers, strict=True)], f"{name}b": [np.float64(c) for c in numbers]}

    def floats(rng: random.Random) -> list[Any]:
        return [some(rng, Scalar("float64")) for _ in range(size)]

    return Part(
        {name: Array(Scalar("float64"))},
        {name: Array(Scalar("float64")), f"{name}b": Array(Scalar("float64"))},
        f"{texts}.{name}b <-> {given}\n",
        unpack,
        lambda rng: {name: floats(rng)},
        lambda rng: {name: floats(rng), f"{name}b": [np.float64(c) for c in numbers]},
        parameters={given: ("list of float64", numbers)},
        pack=f"len(.{name}) = {size}\n",
    )


# --- dates ---------------------------------------------------------------------------------------------------------------


def shown(seconds: int, nanoseconds: int) -> str:
    """An instant in ISO 8601, by the C library's calendar, moved by cycles of 400 years to where it knows dates."""
    if not (-62167219200 <= seconds <= 253402300799 and 0 <= nanoseconds < 10**9):
        raise Refused("range")
    cycle = 146097 * 86400
    cycles = (seconds - 10**9) // cycle
    at = time.gmtime(seconds - cycles * cycle)
    year = at.tm_year + 400 * cycles
    digits = f"{nanoseconds:09}"
    while digits.endswith("000"):
        digits = digits[:-3]
    text = f"{year:04}-{at.tm_mon:02}-{at.tm_mday:02}T{at.tm_hour:02}:{at.tm_min:02}:{at.tm_sec:02}"
    return f"{text}.{digits}Z" if digits else f"{text}Z"


DATE = re.compile(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d([.]\d{1,9})?Z")


def told(text: str) -> tuple[int, int]:
    """Seconds and nanoseconds of a text that `shown` made."""
    if not DATE.fullmatch(text):
        raise Refused("text")
    begin, _, digits = text.rstrip("Z").partition(".")
    year = int(begin[:4])
    at = time.strptime(f"{year % 400 + 2000:04}{begin[4:]}", "%Y-%m-%dT%H:%M:%S")
    return calendar.timegm(at) + (year - year % 400 - 2000) // 400 * 146097 * 86400, int(digits.ljust(9, "0")) if digits else 0


def some_nanoseconds(rng: random.Random) -> int:
    return rng.choice([0, -1, rng.randrange(-(2**63), 2**63), rng.randrange(2**61) // 1000 * 1000, rng.randrange(-(10**9), 10**9) * 10**9])


def some_date(rng: random.Random) -> str:
    return shown(rng.randrange(-62167219200, 253402300800), rng.choice([0, 1, 500_000_000, rng.randrange(10**6) * 1000]))


def date(relations: Relations, name: str) -> Part:
    rng = relations.rng
    number: dict[str, Kind] = {name: Scalar("int64")}
    text: dict[str, Kind] = {name: Scalar("string")}
    match rng.randrange(4):
        case 0:
            return Part(
                number,
                text,
                f".{name} <-> iso8601(.{name})\n",
                lambda fields: {name: shown(*divmod(fields[name], 10**9))},
                lambda rng: {name: some_nanoseconds(rng)},
                lambda rng: {name: some_date(rng)},
            )
        case 1:
            return Part(
                text,
                number,
                f".{name} <-> nanoseconds(.{name})\n",
                lambda fields: {name: fits(told(fields[name])[0] * 10**9 + told(fields[name])[1])},
                lambda rng: {name: some_date(rng)},
                lambda rng: {name: some_nanoseconds(rng)},
                is_sure=True,
            )
        case 2:
            return Part(
                text,
                number,
                f".{name} <-> seconds(.{name})\n",
                lambda fields: {name: told(fields[name])[0]},
                lambda rng: {name: some_date(rng)},
                lambda rng: {name: rng.choice([0, -1, rng.randrange(-62167219200, 253402300800), rng.randrange(-(2**63), 2**63)])},
                is_sure=True,
            )
        case _:
            a, b = f"{name}a", f"{name}b"
            return Part(
                text,
                {a: Scalar("int64"), b: Scalar("int64"), name: Scalar("string")},
                f".{a} <-> seconds(.{name})\n.{b} <-> fraction(.{name})\n.{name} <-> .{name}\n",
                lambda fields: {a: told(fields[name])[0], b: told(fields[name])[1], name: fields[name]},
                lambda rng: {name: some_date(rng)},
                is_sure=True,
            )


# --- units ---------------------------------------------------------------------------------------------------------------


def unit(relations: Relations, name: str) -> Part:
    """Numbers, or an array of them, whose units a side file tells."""
    rng = relations.rng
    (origin, aim), factor = rng.choice(list(UNITS.items()))
    is_array = not relations.is_counted and rng.random() < 0.4
    kind: Kind = Array(Scalar("float64")) if is_array else Scalar("float64")
    units = (f"Src.{name}: {origin}", f"Dst.{name}: {aim}")
    if not is_array and rng.random() < 0.5:
        return integer_units(relations, name, units, int(factor))
    function = (lambda a: [x * factor for x in a]) if is_array else (lambda x: x * factor)
    return Part({name: kind}, {name: kind}, f".{name} <-> .{name}\n", lambda fields: {name: function(fields[name])}, units=units)


def integer_units(relations: Relations, name: str, units: tuple[str, ...], factor: int) -> Part:
    """An integer that becomes a float, or another integer, by a whole factor."""
    rng = relations.rng
    kinds = {name: Scalar("int32")}
    if rng.random() < 0.5:
        scaled = Scalar("float64")
        return Part(kinds, {name: scaled}, f".{name} <-> .{name}\n", lambda fields: {name: np.float64(fields[name]) * factor}, units=units)
    return Part(kinds, kinds, f".{name} <-> .{name}\n", lambda fields: {name: fits(fields[name] * factor, "int32")}, units=units)


def widened(relations: Relations, name: str) -> Part:
    """An array whose elements become wider, or narrower where it is said."""
    rng = relations.rng
    types = [each for each in INTEGERS if each not in ("uint8", "uint64")]  # arrays of uint8 are bytes
    origin, aim = (rng.choice([each for each in types if each in wire.scalars]) for wire in (relations.wire, relations.holder))
    kinds = {name: Array(Scalar(origin))}, {name: Array(Scalar(aim))}
    low, high = INTEGERS[origin]
    is_free = INTEGERS[aim][0] <= low and high <= INTEGERS[aim][1]
    free = rng.choice([f".{name}[] <-> .{name}[]\n", f".{name} <-> .{name}\n"])
    text = free if is_free else f".{name}[] <-> {aim}(.{name}[])\n"
    return Part(*kinds, text, lambda fields: {name: [fits(x, aim) for x in fields[name]]})
