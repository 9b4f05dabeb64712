"""Programs as CPython calls them."""

from __future__ import annotations

import ctypes
import gc
import struct
import sys
from threading import get_ident

import numpy as np
import pytest

from rosetta_jit.backends.entry.link import compile_program
from rosetta_jit.kernel.entries import SYMBOLS
from rosetta_jit.kernel.state import EPOCH, LANES, RESULT, USED, VALID, lane_word
from rosetta_jit.runtime.callable import THREAD, Context, bind_call, bind_state, callable_class, give_own, is_native, message_base
from rosetta_jit.runtime.code import native
from rosetta_jit.runtime.message_spans import MessageSpans
from rosetta_jit.runtime.program import MANY
from tests.backends import kernels
from tests.backends.engines import outcome
from tests.backends.holders import rows
from tests.backends.messages import GOOD, hostile

pytestmark = pytest.mark.skipif(not is_native(), reason="entries know CPython 3.11 to 3.14 alone")
SIZES = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_void_p, ctypes.c_int64, ctypes.c_int64, ctypes.c_void_p)


class Program:
    """Stands for a Decoder or an Encoder."""

    def __init__(self, definition, entry, with_numba=False):
        self.library = native.load(compile_program(definition, entry, with_numba=with_numba), SYMBOLS[entry])
        self.rows, self.cell, self.slow_calls = rows(definition[0]), [None], []
        self.holder = Holder(self.rows)

    def slow(self, *arguments, **named):
        self.slow_calls.append((arguments, named, int(self.rows.state[RESULT])))
        self.rows.state[RESULT] = 0
        return "slow"


class Holder(message_base()):
    def __init__(self, memory):
        self.rows = memory
        bind_state(self, memory.state.ctypes.data)


Native = callable_class(Program)


def program(definition, entry, **options):
    made = Native(definition, entry, **options)
    bind_call(made, made.library["call"], Context(made.slow, Holder))
    give_own(made, made.holder, made.rows.state, made.cell)
    made._context[1][THREAD] = get_ident()
    return made


(FIXED,) = GOOD["fixed"]
EXPECTED = np.deg2rad(np.arange(10.0)).astype(np.float32)


@pytest.mark.parametrize("with_numba", [False, True])
@pytest.mark.parametrize("kind", [bytes, bytearray, memoryview, lambda data: np.frombuffer(data, np.uint8), type("Own", (bytes,), {})])
def test_decodes_anything_with_a_buffer(kind, with_numba):
    decode = program([kernels.fixed(10)], "decode", with_numba=with_numba)
    assert decode(kind(FIXED)) is decode.holder
    assert decode.rows.state[VALID] == 1
    assert decode.rows.lanes[0].view(np.float32)[:10].tolist() == EXPECTED.tolist()


@pytest.mark.parametrize("kernel", kernels.DECODERS, ids=lambda kernel: kernel.name)
@pytest.mark.parametrize("with_numba", [False, True])
def test_a_call_does_what_the_interpreter_does(kernel, with_numba):
    """Also where the kernel is part of the call, and where a later form of the message is tried."""
    decode = program([kernel], "decode", with_numba=with_numba)
    for message in hostile(kernel.name):
        given = decode.rows.copy()
        given.state[:LANES] = 0
        expected = outcome("interpreter", kernel, message, given)
        decode.slow_calls.clear()
        is_good = decode(message) is decode.holder
        assert decode.rows.state[VALID] == is_good
        result = expected[0] if is_good else decode.slow_calls[0][2]
        assert decode.rows.seen(result, 4) == expected, message


def test_references_balance():
    decode, message = program([kernels.fixed(10)], "decode"), bytearray(FIXED)
    before = sys.getrefcount(decode.holder), sys.getrefcount(message)
    for _ in range(100):
        decode(message)
        decode(message, decode.holder)
    assert (sys.getrefcount(decode.holder), sys.getrefcount(message)) == before
    message.append(0)  # no buffer is held


def test_a_failure_goes_the_slow_path_with_the_same_arguments():
    decode = program([kernels.fixed(10)], "decode")
    assert decode(FIXED[:-1]) == "slow"
    assert decode.slow_calls == [((FIXED[:-1],), {}, -2)]
    assert decode.rows.state[VALID] == 0
    assert decode(FIXED) is decode.holder


@pytest.mark.parametrize(("arguments", "named"), [((), {}), ((1, 2, 3), {}), ((FIXED,), {"into": 1}), ((FIXED, object()), {})])
def test_odd_calls_go_the_slow_path(arguments, named):
    decode = program([kernels.fixed(10)], "decode")
    assert decode(*arguments, **named) == "slow"
    assert decode.slow_calls == [(arguments, named, 0)]


@pytest.mark.parametrize("entry", ["decode", "borrow"])
@pytest.mark.parametrize("kind", [bytes, bytearray])
def test_the_own_holder_of_another_thread_goes_the_slow_path(entry, kind):
    decode = program([kernels.fixed(10)], entry)
    decode._context[1][THREAD] += 1
    assert decode(kind(FIXED)) == "slow"
    other = Holder(rows(kernels.fixed(10)))
    assert decode(kind(FIXED), other) == "slow" if entry == "borrow" else decode(kind(FIXED), other) is other


@pytest.mark.parametrize("entry", ["decode", "borrow"])
@pytest.mark.parametrize("kind", [bytes, bytearray])
def test_lanes_in_use_go_the_slow_path_and_stay_as_they_are(entry, kind):
    decode = program([kernels.fixed(10)], entry)
    decode(kind(FIXED))
    assert decode.rows.state[EPOCH] == 1
    decode.rows.state[EPOCH] = ~1
    before = decode.rows.state.copy()
    (source,) = decode.cell
    assert decode(kind(bytes(len(FIXED)))) == "slow"
    assert (decode.rows.state == before).all()
    assert decode.cell[0] is source


def test_what_has_no_buffer_is_named():
    decode = program([kernels.fixed(10)], "decode")
    with pytest.raises(TypeError, match="int"):
        decode(5)
    with pytest.raises(BufferError, match="contiguous"):
        decode(memoryview(FIXED)[::2])


def test_decodes_into_another_holder():
    decode = program([kernels.fixed(10)], "decode")
    other = Holder(rows(kernels.fixed(10)))
    assert decode(FIXED, other) is other
    assert other.rows.lanes[0].view(np.float32)[9] == EXPECTED[9]
    assert not decode.rows.lanes[0].any()


@pytest.mark.parametrize("kind", [bytes, bytearray, lambda data: np.frombuffer(data, np.uint8)])
def test_borrowing_keeps_the_source(kind):
    decode, message = program([kernels.fixed(10)], "borrow"), kind(FIXED)
    references = sys.getrefcount(message)
    assert decode(message) is decode.holder
    (source,) = decode.cell
    assert source is message if isinstance(message, bytes) else source.obj is message
    assert decode(b"short") == "slow"
    assert decode.cell[0] is source
    decode(FIXED)
    del source
    assert sys.getrefcount(message) == references + (message is FIXED)
    with pytest.raises(TypeError):
        decode("text")
    with pytest.raises(BufferError):
        decode(memoryview(FIXED)[::2])


def test_a_borrowed_bytearray_cannot_be_resized():
    decode, message = program([kernels.fixed(10)], "borrow"), bytearray(FIXED)
    decode(message)
    with pytest.raises(BufferError):
        message.append(0)
    decode.cell[0] = None
    message.append(0)


# --- encode ---


def encoder(count=3):
    made = program(kernels.encoder(), "encode")
    made.rows.state[[VALID, lane_word(1, USED)]] = 1, count
    made.rows.lanes[0].view(np.int64)[:2] = 0, count
    made.rows.lanes[1].view(np.float64)[:] = np.arange(40.0)
    return made


@pytest.mark.parametrize("count", [0, 1, 3, 40])
def test_encodes(count):
    encode = encoder(count)
    expected = struct.pack(f"<i{count}d", count, *range(count))
    assert encode(encode.holder) == expected
    space = bytearray(500)
    assert encode(encode.holder, space, 7) == 7 + len(expected)
    assert space == bytes(7) + expected + bytes(493 - len(expected))


def test_the_number_of_the_call_before_is_given_again_and_kept_once():
    encode, space, size = encoder(40), bytearray(2000), 4 + 8 * 40
    first = encode(encode.holder, space, 0)
    assert encode(encode.holder, space, 0) is first
    references = sys.getrefcount(first)
    again = [encode(encode.holder, space, 0) for _ in range(50)]
    assert sys.getrefcount(first) == references + 50
    del again
    assert sys.getrefcount(first) == references
    for start in (500, 0, 7, 500, 500, 1000):
        assert encode(encode.holder, space, start) == start + size
    assert sys.getrefcount(first) == references - 1
    del encode
    gc.collect()
    assert first == size


def test_the_numbers_of_many_ends_leave_nothing_behind():
    encode, space = encoder(40), bytearray(20_000)
    encode(encode.holder, space, 0)
    before = sys.getallocatedblocks()
    for start in range(10_000):
        encode(encode.holder, space, start)
    assert sys.getallocatedblocks() - before < 100


@pytest.mark.parametrize("arguments", [(), (bytearray(100),), (bytearray(100), 0)])
def test_a_holder_in_use_is_not_encoded(arguments):
    encode = encoder()
    assert encode(encode.holder, *arguments) != "slow"
    encode.rows.state[EPOCH] = ~0
    assert encode(encode.holder, *arguments) == "slow"


def test_only_valid_holders_of_the_type_are_encoded():
    encode = encoder()
    assert encode(object()) == encode(5) == encode() == encode(encode.holder, bytearray(100), 0, 5) == "slow"
    encode.rows.state[VALID] = 0
    assert encode(encode.holder) == "slow"
    encode.rows.state[VALID] = 1
    encode.rows.lanes[0].view(np.int64)[1] = 99
    assert encode(encode.holder) == "slow"
    assert [call[2] for call in encode.slow_calls] == [0, 0, 0, 0, 0, -6]


def test_encoding_into_what_does_not_take_it():
    encode = encoder()
    for offset in ((), (0,)):
        with pytest.raises(BufferError, match="writable"):
            encode(encode.holder, bytes(100), *offset)
        with pytest.raises(TypeError):
            encode(encode.holder, 5, *offset)
    with pytest.raises(TypeError):
        encode(encode.holder, bytearray(100), "0")
    with pytest.raises(OverflowError):
        encode(encode.holder, bytearray(100), 2**70)
    for offset in (-1, 101, 100, 73):
        assert encode(encode.holder, bytearray(100), offset) == "slow"
    assert [call[2] for call in encode.slow_calls] == [0, 0, -2, -2]


# --- many ---


def many(made, buffer, offsets, count, first=0):
    spans = MessageSpans.of(offsets).addresses
    return MANY(made.library["many"])(buffer.ctypes.data, buffer.size, *spans, first, count, made.rows.state.ctypes.data)


def test_decodes_many():
    decode = program([kernels.counted()], "decode")
    messages = [struct.pack("<i", n) + struct.pack(f">{n}h", *range(n)) for n in (2, 0, 3)]
    buffer = np.frombuffer(b"".join(messages), np.uint8)
    offsets = np.cumsum([0, *map(len, messages)])
    assert many(decode, buffer, offsets, 3) == 3
    assert decode.rows.lanes[0].view(np.int64).reshape(-1, 2)[:3].tolist() == [[0, 2], [2, 0], [2, 3]]
    assert decode.rows.lanes[1].view(np.float64)[:5].tolist() == [0, 1, 0, 1, 2]


@pytest.mark.parametrize("offsets", [[0, 120, 60], [-1, 120, 240], [0, 120, 241], [0, 2**63 - 1, 240], [-(2**63), 120, 240]])
def test_many_checks_offsets(offsets):
    decode = program([kernels.fixed(10)], "decode")
    decode.rows.state[RESULT] = 5
    assert many(decode, np.frombuffer(FIXED * 2, np.uint8), np.array(offsets), 2) < 2
    assert decode.rows.state[RESULT] == 0


def test_many_stops_at_a_failure_and_goes_on():
    decode = program([kernels.fixed(10)], "decode")
    buffer = np.frombuffer(FIXED + b"\1" + FIXED[1:] + FIXED, np.uint8).copy()
    offsets = np.arange(4) * 120
    assert many(decode, buffer, offsets, 3) == 1
    assert decode.rows.state[RESULT] == -3
    buffer[120] = FIXED[0]
    assert many(decode, buffer, offsets, 3, first=1) == 3


def test_encodes_many():
    encode = encoder(5)
    encode.rows.lanes[0].view(np.int64)[:6] = 0, 2, 2, 3, 5, 0
    offsets = np.zeros(4, np.int64)
    assert SIZES(encode.library["sizes"])(offsets.ctypes.data, 0, 3, encode.rows.state.ctypes.data) == 3
    assert offsets.tolist() == [0, 20, 48, 52]
    buffer = np.zeros(52, np.uint8)
    assert many(encode, buffer, offsets, 3) == 3
    assert buffer.tobytes() == struct.pack("<i2di3di", 2, 0, 1, 3, 2, 3, 4, 0)
    encode.rows.lanes[0].view(np.int64)[3] = 99
    assert SIZES(encode.library["sizes"])(offsets.ctypes.data, 0, 3, encode.rows.state.ctypes.data) == 1
    assert encode.rows.state[RESULT] == -6


def test_a_dropped_program_leaves_nothing():
    gc.collect()
    decode = program([kernels.fixed(10)], "decode")
    alive = [decode.holder]
    count = sys.getrefcount(alive[0])
    del decode
    gc.collect()
    assert sys.getrefcount(alive[0]) < count
