"""Users' own compiled functions: they call a decoder's kernel and read what it filled by name."""

from __future__ import annotations

import gc
import sys

import numpy as np
import pytest
from numba import njit, prange
from numba.core.errors import NumbaTypeError, TypingError

import rosetta_jit as rj

SCHEMA = {
    "t.proto": """
    syntax = "proto3"; package t;
    enum Color { RED = 0; BLUE = 7; }
    message Inner { double a = 1; string s = 2; repeated float many = 3; }
    message Node { int32 v = 1; Node left = 2; Node right = 3; }
    message M {
      optional int32 n = 1; string text = 2; bytes raw = 3; repeated string names = 4; repeated Inner inners = 5;
      oneof pick { double number = 6; Inner inner = 7; string word = 8; }
      Color color = 9; map<string, int32> table = 10; bool flag = 11; Node tree = 12; repeated bool flags = 13; optional Inner other = 14;
    }
    """
}


@pytest.fixture(scope="module")
def decoder():
    return rj.Decoder.of("t.M", schema=SCHEMA)


@pytest.fixture(scope="module")
def kernel(decoder):
    return decoder.kernel


@pytest.fixture(scope="module")
def message(decoder):
    holder = decoder.new()
    holder.text, holder.raw, holder.color, holder.flag = "häy", b"abc", 7, True
    holder.names.extend(["one", "three", "five"])
    for number in range(5):
        holder.inners.add(a=number, s="s" * number, many=[1.5] * number)
    holder.inner.a = 4
    holder.tree.v, holder.tree.left.v = 3, 5
    holder.flags.extend([True, False])
    return holder.SerializeToString()


@pytest.fixture(scope="module")
def refill(kernel):
    """Decodes messages into one holder; how many bytes their names have."""

    @njit(nogil=True)
    def run(messages, offsets, holder):
        size = 0
        for index in range(len(offsets) - 1):
            kernel(messages, holder, offsets[index], offsets[index + 1])
            for name in holder.names:
                size += len(name)
        return size

    return run


def test_a_loop_over_a_recording_with_a_fresh_holder(decoder, refill):
    """Later messages are longer: a fresh holder has room for none of them."""
    names = [["n" * number] * (number % 50) for number in range(2000)]
    messages = []
    for each in names:
        holder = decoder.new()
        holder.names.extend(each)
        messages.append(holder.SerializeToString())
    offsets = np.cumsum([0, *map(len, messages)])
    holder = decoder.new()
    assert refill(b"".join(messages), offsets, holder) == sum(len(name) for each in names for name in each)
    assert list(holder.names) == names[-1]


def test_every_kind_of_field_by_name(decoder, kernel, message):
    @njit
    def read(message, holder):
        kernel(message, holder)
        total, length = 0.0, 0
        for inner in holder.inners:
            total += inner.a + inner.many.sum()
            length += len(inner.s)
        texts = (holder.text[1], holder.raw[2], len(holder.names), holder.names[-1][0], len(holder.word))
        there = (
            holder.has("n"),
            holder.has("text"),
            holder.has("inner"),
            holder.has("word"),
            holder.tree.has("right"),
            holder.has("other"),
        )
        numbers = (holder.n, holder.number, holder.color, holder.flag, holder.flags[0])
        nested = (holder.tree.left.v, holder.inner.a, holder.other.a)
        return total, length, texts, there, numbers, nested

    total, length, texts, there, numbers, nested = read(message, decoder.new())
    assert (total, length) == (25.0, 10)
    assert texts == ("ä".encode()[0], ord("c"), 3, ord("f"), 0)
    assert there == (False, True, True, False, False, False)
    assert numbers == (0, 0.0, 7, True, True)
    assert nested == (5, 4.0, 0.0)


def test_a_broken_message_raises_with_its_place(decoder, refill, message):
    holder = decoder.new()
    with pytest.raises(rj.DecodeError, match="truncated") as caught:
        refill(message[:-1], np.array([0, len(message) - 1]), holder)
    with pytest.raises(rj.DecodeError) as expected:
        decoder(message[:-1])
    assert (caught.value.kind, caught.value.path, caught.value.offset) == (expected.value.kind, expected.value.path, expected.value.offset)
    assert type(caught.value.__reduce__()[0](*caught.value.__reduce__()[1])) is rj.DecodeError
    with pytest.raises(rj.InvalidHolder):
        holder.names.__len__()
    assert refill(message, np.array([0, len(message)]), holder) == 12


@pytest.mark.parametrize("offsets", [[0, 1 << 40], [5, 2], [-3, 2]])
def test_places_outside_of_the_buffer_are_refused(decoder, refill, message, offsets):
    with pytest.raises(ValueError, match="leave the buffer"):
        refill(message, np.array(offsets), decoder.new())


def test_a_message_that_asks_for_far_too_much_is_refused():
    schema = {"b.msg": "uint8[] data"}
    greedy = rj.Decoder.of("b", encoding="ros1", schema=schema)
    kernel = greedy.kernel

    @njit
    def run(message, holder):
        kernel(message, holder)

    with pytest.raises(rj.DecodeError) as caught:
        run(b"\xff\xff\xff\x7f1234", greedy.new())
    with pytest.raises(rj.DecodeError) as expected:
        greedy(b"\xff\xff\xff\x7f1234")
    assert str(caught.value) == str(expected.value)


@pytest.fixture(scope="module")
def attempt(kernel):
    @njit
    def run(messages, holder):
        """How many messages are broken, and whether the holder can be read behind the last."""
        broken = 0
        for index in range(len(messages)):
            try:
                kernel(messages[index], holder)
            except Exception:  # noqa: BLE001 - numba knows no other
                broken += 1
        return broken, holder.flag

    return run


def test_a_loop_goes_on_behind_broken_messages(decoder, attempt, message):
    messages = np.frombuffer(message * 3, np.uint8).reshape(3, -1).copy()
    messages[1, :4] = 255
    assert attempt(messages, decoder.new()) == (1, True)
    messages[2, :4] = 255
    with pytest.raises(rj.InvalidHolder, match="decode again"):
        attempt(messages, decoder.new())


@pytest.fixture(scope="module")
def peek():
    @njit
    def run(holder, other, index):
        return holder.inners[index].many, holder

    return run


def test_arrays_outlive_the_lanes_they_lie_in(decoder, message, peek):
    holder = decoder.new()
    decoder(message, holder)
    array, same = peek(holder, decoder.new(), -1)
    assert same is holder
    for _ in range(20):
        holder.inners[-1].many.extend([9.0] * 1000)
    array_after = array.tolist()
    del holder, same
    gc.collect()
    assert array_after == array.tolist() == [1.5] * 4


def test_a_holder_is_taken_once_and_given_back(decoder, message, peek):
    holder = decoder.new()
    decoder(message, holder)
    count = sys.getrefcount(holder)
    with pytest.raises(rj.InUse):
        peek(holder, holder, 0)
    for _ in range(10):
        peek(holder, decoder.new(), 0)
    assert sys.getrefcount(holder) == count
    assert holder.color == 7
    with pytest.raises(IndexError):
        peek(holder, decoder.new(), 5)
    assert holder.color == 7


def test_borrowed_bytes_become_the_holders_own():
    schema = {"b.msg": "uint8[] data"}
    borrowing = rj.Decoder.of("b", encoding="ros1", schema=schema, borrow=True)
    kernel = borrowing.kernel

    @njit
    def read(message, holder):
        before = len(holder.data)
        kernel(message, holder)
        return before, holder.data.sum()

    holder = borrowing.new()
    borrowing(b"\3\0\0\0abc", holder)
    assert read(b"\2\0\0\0\1\2", holder) == (3, 3)


@pytest.mark.parametrize("use", ["decode", "read", "nested", "elements"])
def test_a_prange_takes_no_holder(decoder, kernel, message, use):
    """Neither where its loop names a field, nor where it calls a function that does."""

    @njit
    def one(message, holder):
        kernel(message, holder)
        return holder.color

    @njit(parallel=True)
    def decode(messages, holder):
        total = 0
        for index in prange(len(messages)):
            total += one(messages[index], holder)
        return total

    @njit(parallel=True)
    def read(messages, holder):
        total = 0
        for index in prange(len(messages)):
            total += messages[index, 0] + holder.color
        return total

    @njit(parallel=True)
    def nested(messages, holder):
        inner, total = holder.inner, 0.0
        for index in prange(len(messages)):
            total += messages[index, 0] + inner.a
        return total

    @njit(parallel=True)
    def elements(messages, holder):
        inners, total = holder.inners, 0.0
        for index in prange(len(inners)):
            total += messages[index, 0] + inners[index].a
        return total

    messages = np.frombuffer(message * 3, np.uint8).reshape(3, -1).copy()
    holder = decoder.new()
    with pytest.raises(NumbaTypeError, match="take the arrays that it reads out of the holder"):
        locals()[use](messages, holder)
    assert holder.color == 0


def test_a_prange_reads_arrays_of_a_holder(decoder, kernel, message):
    @njit(parallel=True)
    def count(message, holder):
        kernel(message, holder)
        flags, total = holder.flags, 0
        for index in prange(len(flags)):
            total += flags[index]
        return total

    assert count(message, decoder.new()) == 1


def test_what_cannot_be_compiled_is_said(decoder, kernel, message):
    @njit
    def fill(message, holder):
        kernel(message, holder)

    with pytest.raises(TypingError, match=r"fills holders of `t\.M`"):
        fill(message, rj.Decoder.of("t.Inner", schema=SCHEMA).new())
    with pytest.raises(TypingError, match="a message is bytes"):
        fill(np.zeros(3), decoder.new())
    with pytest.raises(TypingError, match="has no field 'nothing'"):
        njit(lambda holder: holder.has("nothing"))(decoder.new())
    with pytest.raises(NumbaTypeError, match="hand over the holder"):
        njit(lambda inner: inner.a)(decoder.new().inner)
    with pytest.raises(NumbaTypeError, match="return the holder"):
        njit(lambda holder: holder.inner)(decoder.new())


def test_messages_are_numbered_as_outside():
    schema = {"n.bottle-schema": '"n" (("value" :int))', "w.bottle-schema": '"w" (("value" :int))'}
    head = 'import "n.bottle-schema"\nimport "w.bottle-schema"\ndata-holder: n\nwire-schema: w\n'
    mapping = f"{head}unpack-rules:\n  .value = int32(counter() + .value)\n"
    counting = rj.Decoder("m.mapping", schema={**schema, "m.mapping": mapping}, encoding="yarp3")
    kernel = counting.kernel
    message = np.array([257, 1, 100], np.int32).tobytes()

    @njit
    def second(message, holder):
        kernel(message, holder)
        first = holder.value
        kernel(message, holder)
        return first, holder.value

    assert counting(message).value == 100
    assert second(message, counting.new()) == (101, 102)
    with pytest.raises(rj.DecodeError):
        second(message[:-1], counting.new())
    assert counting(message).value == 103


def test_a_short_kernel_is_part_of_the_loop():
    """A call with all that numba knows of a holder and a message takes as long as such a kernel."""
    short = rj.Decoder.of("t.S", schema={"s.proto": 'syntax = "proto3"; package t; message S { fixed64 a = 1; }'})
    kernel = short.kernel

    @njit(nogil=True)
    def run(message, holder):
        kernel(message, holder)
        return holder.a

    assert run(b"\x09" + bytes([7] + [0] * 7), short.new()) == 7
    (text,) = run.inspect_llvm().values()
    assert not [line for line in text.splitlines() if " call " in line and "callable_kernel" in line]
