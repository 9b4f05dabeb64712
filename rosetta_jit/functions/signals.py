"""Signals within the bytes of a frame, as of a CAN bus: read, and put together. Where their bits lie, `language.signal_bits` says.

signal (bytes, "start|length@order sign")                       the number
signal_bytes (size, "start|length@order sign", number, ...)     the frame; bits of no signal are 0
"""

from __future__ import annotations

from functools import partial, reduce

from rosetta_jit.catalogue import signals as words
from rosetta_jit.kernel.nodes import WIDTH, Binary, Compare, Const, Convert, Expr, Load, Local, Scalar, Wire
from rosetta_jit.kernel.terms import add, index, type_of
from rosetta_jit.language import typed
from rosetta_jit.language.conversions import as_int64, bare, describe, is_bytes
from rosetta_jit.language.function import NOT_FOLLOWED, SEVERAL, Function, Row
from rosetta_jit.language.limits import MAX_SIGNAL_BYTES
from rosetta_jit.language.scope import Scope
from rosetta_jit.language.signal_bits import MOST_BITS, Signal, signal_of
from rosetta_jit.lowering.codec.fields import scalar_name
from rosetta_jit.lowering.evaluation import Evaluation
from rosetta_jit.lowering.texts.views import View, byte_at, kept, put, room
from rosetta_jit.lowering.writer import Writer
from rosetta_jit.model import expr as model
from rosetta_jit.model.layout import scalar_of
from rosetta_jit.model.types import Array, Bytes, Int, String, Type

WORD_BITS = 32
"""Signals of so many bits are put together in words that have no more, of which a vector holds twice as many as of others."""

SIGNED: dict[Scalar, Scalar] = {"u32": "i32", "u64": "i64"}
WORDS: dict[int, Scalar] = {1: "u8", 2: "u16", 4: "u32", 8: "u64"}

# --- types ---------------------------------------------------------------------------------------------------------------


def _type_signal(call: model.Call, arguments: list[typed.Expr], scope: Scope) -> typed.Expr | None:
    if len(arguments) != 2:
        scope.problems.append(words.arguments(call.span, call.function))
        return None
    frame, described = arguments
    if not (isinstance(frame, typed.Access) and is_bytes(frame.type)):
        scope.problems.append(words.no_field(frame.span, describe(frame.type)))
        return None
    signal = _signal(described, _fixed_size(frame.type), scope)
    return None if signal is None else typed.Call("signal", (frame, typed.Const(signal.text, String())), signal.type, call.span)


def _type_frame(call: model.Call, arguments: list[typed.Expr], scope: Scope) -> typed.Expr | None:
    if len(arguments) < 3 or len(arguments) % 2 == 0:
        scope.problems.append(words.arguments(call.span, call.function))
        return None
    size, *rest = arguments
    if not (isinstance(size, typed.Const) and isinstance(size.type, Int) and 1 <= int(size.value) <= MAX_SIGNAL_BYTES):
        scope.problems.append(words.no_size(size.span, MAX_SIGNAL_BYTES))
        return None
    found: list[Signal] = []
    taken: list[typed.Expr] = [size]
    for described, value in zip(rest[::2], rest[1::2], strict=True):
        signal, number = _signal(described, int(size.value), scope), _number(value, scope)
        if signal is None or number is None:
            return None
        other = next((each for each in found if each.bits & signal.bits), None)
        if other is not None:
            scope.problems.append(words.overlapping(described.span, other.text, signal.text))
            return None
        found.append(signal)
        taken += [typed.Const(signal.text, String()), number]
    return typed.Call("signal_bytes", tuple(taken), Bytes(), call.span)


def _signal(described: typed.Expr, size: int | None, scope: Scope) -> Signal | None:
    text = described.value if isinstance(described, typed.Const) and isinstance(described.value, str) else None
    signal = None if text is None else signal_of(text)
    if signal is None:
        scope.problems.append(words.no_signal(described.span, text))
    elif not 1 <= signal.length <= MOST_BITS:
        scope.problems.append(words.too_long(described.span, signal.length, MOST_BITS))
    elif signal.size > (MAX_SIGNAL_BYTES if size is None else size):
        scope.problems.append(words.beyond(described.span, MAX_SIGNAL_BYTES if size is None else size, signal.size))
    else:
        return signal
    return None


def _number(value: typed.Expr, scope: Scope) -> typed.Expr | None:
    """An integer as int64, or a uint64."""
    if isinstance(value.type, Int) and not value.type.signed and value.type.bits == MOST_BITS and not isinstance(value, typed.Const):
        return value
    whole = as_int64(value)
    if whole is None:
        scope.problems.append(words.no_integer(value.span, describe(value.type)))
    return whole


def _fixed_size(type_: Type) -> int | None:
    length = type_.length if isinstance(type_, Array | Bytes) else None
    return length if isinstance(length, int) else None


# --- kernels -------------------------------------------------------------------------------------------------------------


def _lower_signal(call: typed.Call, values: Evaluation) -> Expr:
    """The number: an error of kind ``index`` where the frame is too short."""
    frame, signal = call.arguments[0], _described(call.arguments[1])
    assert isinstance(frame, typed.Access)
    writer = values.writer
    address, count = values.source.address(frame.place, values), values.source.count(frame.place, values)
    writer.expect(Compare("ge", count, index(signal.size)), "index", values.where, f"no {signal.size} bytes", line=values.line)
    lane, first = (None, address.at) if isinstance(address, Wire) else (address.lane, address.row)
    first = writer.let("frame", first)
    if lane is not None:
        return _number_of(_gathered(signal, lane, first), signal, writer)
    size = int(count.value) if isinstance(count, Const) else signal.size
    writer.require(size, values.where, at=first)
    return _number_of(_loaded(signal, first, size) or _gathered(signal, None, first), signal, writer)


def _loaded(signal: Signal, frame: Expr, size: int) -> Expr | None:
    """The bits of a signal in one word of the message; None where none of them lies within so many bytes of the frame."""
    window = signal.window(size)
    if window is None:
        return None
    word: Scalar = WORDS[window.size]
    loaded: Expr = Load(word, add(frame, window.byte), "<" if signal.is_little or window.size == 1 else ">")
    if word not in ("u32", "u64"):
        loaded = Convert("u32", loaded)
    moved = _shifted("shr", loaded, window.shift)
    return moved if window.shift + signal.length == 8 * window.size else _and(moved, (1 << signal.length) - 1)


def _gathered(signal: Signal, lane: int | None, frame: Expr) -> Expr:
    """The bits of a signal, byte by byte."""
    word: Scalar = "u32" if signal.length <= WORD_BITS else "u64"
    found: list[Expr] = []
    for piece in signal.pieces:
        byte = Convert(word, byte_at(lane, add(frame, piece.byte)))
        part = _and(_shifted("shr", byte, piece.bit), piece.mask) if piece.bit or piece.count < 8 else byte
        found.append(_shifted("shl", part, piece.shift))
    return reduce(partial(Binary, "or"), found)


def _number_of(bits: Expr, signal: Signal, writer: Writer) -> Expr:
    """The number whose bits a word has: the highest of a signed one is its sign."""
    bits = writer.let("bits", bits)
    return _signed(bits, signal) if signal.signed else Convert(scalar_name(scalar_of(signal.type)), bits)


def _signed(bits: Local, signal: Signal) -> Expr:
    """The bits of a word, of which the highest of the signal is its sign."""
    scalar, word = scalar_name(scalar_of(signal.type)), SIGNED[bits.type]
    above = 8 * WIDTH[word] - signal.length
    number = Convert(word, bits)
    moved = Binary("shr", Binary("shl", number, Const(word, above)), Const(word, above)) if above else number
    return moved if scalar == word else Convert(scalar, moved)


def _lower_frame(call: typed.Call, values: Evaluation) -> View:
    """The bytes: an error of kind ``range`` where a number does not fit its signal."""
    size, *rest = call.arguments
    assert isinstance(size, typed.Const)
    writer = values.writer
    bytes_: list[Expr] = [Const("u64", 0)] * int(size.value)
    for described, value in zip(rest[::2], rest[1::2], strict=True):
        signal = _described(described)
        number = writer.let("signal", values.of(value))
        scalar = type_of(number)
        least, most = signal.limits
        text = f'the value does not fit the signal "{signal.text}"'
        if scalar == "i64" and least > -(1 << 63):
            writer.expect(Compare("ge", number, Const(scalar, least)), "range", values.where, text, line=values.line)
        if most < (1 << 63 if scalar == "i64" else 1 << 64):
            writer.expect(Compare("lt", number, Const(scalar, most)), "range", values.where, text, line=values.line)
        bits = writer.let("bits", Convert("u64", number))
        for piece in signal.pieces:
            part = _shifted("shl", _and(_shifted("shr", bits, piece.shift), piece.mask), piece.bit)
            before = bytes_[piece.byte]
            bytes_[piece.byte] = part if isinstance(before, Const) else Binary("or", before, part)
    start = room(writer, index(len(bytes_)))
    for number, byte in enumerate(bytes_):
        put(writer, add(start, number), 0 if isinstance(byte, Const) else Convert("u8", byte))
    return kept(writer, start, start, add(start, len(bytes_)), valid=False)


def _described(value: typed.Expr) -> Signal:
    assert isinstance(value, typed.Const)
    signal = signal_of(str(value.value))
    assert signal is not None
    return signal


def _shifted(way: str, value: Expr, distance: int) -> Expr:
    if not distance:
        return value
    return Binary("shl" if way == "shl" else "shr", value, Const(type_of(value), distance))


def _and(value: Expr, mask: int) -> Expr:
    return Binary("and", value, Const(type_of(value), mask))


# --- laws ----------------------------------------------------------------------------------------------------------------


def _number_again(call: typed.Call) -> typed.Expr | None:
    """The number that was put into a frame at this place."""
    match call.arguments:
        case typed.Call("signal_bytes", (_, *signals)), described:
            number = dict(zip(signals[::2], map(bare, signals[1::2]), strict=True)).get(described)
            return number if number is None or number.type == call.type else typed.Convert(number, call.type, "exact", call.span)
        case _:
            return None


def _frame_again(call: typed.Call) -> typed.Expr | None:
    """The frame whose signals are put where they were read, if they are all of its bits."""
    size, *signals = call.arguments
    bits: set[int] = set()
    frames: list[typed.Expr] = []
    for described, number in zip(signals[::2], map(bare, signals[1::2]), strict=True):
        match number:
            case typed.Call("signal", (frame, also)) if also == described:
                bits |= _described(described).bits
                frames.append(frame)
            case _:
                return None
    is_whole = isinstance(size, typed.Const) and len(bits) == 8 * int(size.value) == 8 * (_fixed_size(frames[0].type) or 0)
    return frames[0] if is_whole and all(each == frames[0] for each in frames) else None


# --- records -------------------------------------------------------------------------------------------------------------

SIGNAL = Row(
    "bytes",
    '`signal(b, "7|16@0+")`',
    (
        "the signal of this start bit, length, byte order and sign, written as in DBC files, in bytes or `uint8[]`: an integer",
        "`index`",
    ),
)
FRAME = Row(
    "bytes",
    '`signal_bytes(8, "7|16@0+", x, "24|8@1-", y)`',
    ("so many bytes with these signals, which are integers; bits of no signal are 0", "`range`"),
)

FUNCTIONS = (
    Function("signal", _type_signal, _lower_signal, SEVERAL, NOT_FOLLOWED, (SIGNAL,), undoes=_number_again),
    Function("signal_bytes", _type_frame, _lower_frame, SEVERAL, NOT_FOLLOWED, (FRAME,), undoes=_frame_again, kept=False),
)
