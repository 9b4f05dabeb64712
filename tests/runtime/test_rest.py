"""The rest of a program's calls, compiled when it is first asked for: until then the slow path answers, and says the same."""

from __future__ import annotations

import gc
import itertools
import mmap
import os
import struct
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from threading import Barrier

import pytest

import rosetta_jit as rj
from rosetta_jit.api.warm import warm
from rosetta_jit.backends.entry.link import compile_rest
from rosetta_jit.backends.entry.texts import EntryText
from rosetta_jit.pipeline.build import Build
from rosetta_jit.pipeline.request import Request
from rosetta_jit.runtime.cache.texts import known
from rosetta_jit.runtime.code.allowed import ForeignCodeError
from rosetta_jit.runtime.code.prelink import is_prelinking
from rosetta_jit.runtime.code.prelinked import from_bytes, place

pytestmark = pytest.mark.skipif(not is_prelinking(), reason="code that a linker loads has the rest from the start")

SIZES = itertools.count(3)


def definition(size):
    return f"uint8[{size}] before\nfloat64 d\nstring s\nuint8[] raw\n"


@pytest.fixture
def size():
    """Of a type that no other test has: programs of the same code share it."""
    return next(SIZES)


@pytest.fixture
def of(size):
    """Makes a program of that type."""

    def make(made, **options):
        return made.of("rest/msg/All", schema={"rest/msg/All.msg": definition(size)}, encoding="ros1", **options)

    return make


@pytest.fixture
def messages(size):
    return [bytes(size) + struct.pack(f"<dI{n}sI{n}s", n / 2, n, b"t" * n, n, bytes(range(n))) for n in range(1, 5)]


def rest_of(program):
    return program._loaded.library.later.__self__


def is_made(program):
    return bool(rest_of(program)._libraries)


def values(holder):
    return holder.d, holder.s, bytes(holder.raw)


@pytest.mark.parametrize("borrow", [False, True])
def test_usual_calls_need_none(of, messages, borrow):
    decode, encode = of(rj.Decoder, borrow=borrow), of(rj.Encoder)
    for number, each in enumerate(messages, start=1):
        assert values(decode(each)) == (number / 2, "t" * number, bytes(range(number)))
        assert encode(decode(each)) == each
        with pytest.raises(rj.DecodeError):
            decode(each[:-1])
    assert not is_made(decode)
    assert not is_made(encode)


OTHERS = ("into a holder", "by `into`", "of a bytearray", "of a part", "many", "into a buffer", "at a place of it", "many encoded")


def others(of, data):
    """A program and calls of it that are not usual, for each of `OTHERS`. A decoder's give values, and an encoder's the bytes again."""
    decode, encode = of(rj.Decoder), of(rj.Encoder)

    def written(holder, *where):
        room = bytearray(100)
        end = encode(holder, room, *where)
        return bytes(room[where[0] if where else 0 : end])

    calls = (
        (decode, lambda: decode(data, decode.new())),
        (decode, lambda: decode.into(data, decode.new())),
        (decode, lambda: decode(bytearray(data))),
        (decode, lambda: decode(memoryview(b"__" + data)[2:], decode.new())),
        (decode, lambda: decode.many([data])[0]),
        (encode, lambda: written(decode(data))),
        (encode, lambda: written(decode(data), 7)),
        (encode, lambda: bytes(encode.many(decode.many([data]))[0])),
    )
    return dict(zip(OTHERS, calls, strict=True))


@pytest.mark.parametrize("call", OTHERS)
def test_other_calls_have_it_made_and_answer_the_same_before_and_behind(of, messages, call):
    program, use = others(of, messages[2])[call]
    assert not is_made(program)
    answers = []
    for _ in range(3):
        found = use()
        answers.append(found if isinstance(found, bytes) else values(found))
        assert is_made(program)
    assert answers == 3 * [messages[2] if isinstance(answers[0], bytes) else (1.5, "ttt", b"\0\1\2")]


def test_a_broken_message_is_told_in_the_same_words_before_and_behind(of, messages):
    decode = of(rj.Decoder)
    holder, told = decode.new(), []
    for _ in range(3):
        with pytest.raises(rj.DecodeError) as error:
            decode(messages[3][:-2], holder)
        told.append(str(error.value))
    assert len(set(told)) == 1


def test_wrong_arguments_are_refused_before_and_behind(of, messages):
    decode = of(rj.Decoder)
    for _ in range(2):
        for wrong in ((), (messages[0], None), (messages[0], decode.new(), 1), (1,), ("text",)):
            with pytest.raises((TypeError, ValueError)):
                decode(*wrong)
        decode(messages[0], decode.new())


def test_objects_of_another_class_are_handed_over_by_it(of, messages, size):
    encode = of(rj.Encoder)
    assert [encode({"before": bytes(size), "d": 0.5, "s": "t", "raw": b"\0"}) for _ in range(3)] == 3 * messages[:1]
    assert is_made(encode)


def test_programs_of_the_same_code_share_it(of, messages):
    one, other = of(rj.Decoder), of(rj.Decoder)
    one(messages[0], one.new())
    assert is_made(other)
    assert other._loaded.library["many"] == one._loaded.library["many"]


def test_programs_of_other_code_have_their_own(of, messages):
    one, other = of(rj.Decoder), rj.Decoder.of("std_msgs/msg/Float64", encoding="ros1")
    one(messages[1], one.new())
    assert other(bytes(8), other.new()).data == 0.0
    assert one._loaded.library["many"] != other._loaded.library["many"]
    assert values(one(messages[1], one.new())) == (1.0, "tt", b"\0\1")


def test_threads_meet_the_first_call_at_once(of, messages):
    decode = of(rj.Decoder)
    with ThreadPoolExecutor(8) as pool:
        found = list(pool.map(lambda number: values(decode(messages[number % 4], decode.new())), range(200)))
    assert found == [values(decode(messages[number % 4], decode.new())) for number in range(200)]


def test_what_threads_have_made_at_once_stays(of, messages):
    """Each would free what the other one runs, if the last one took the place of those before."""
    decode = of(rj.Decoder)
    rest, both = rest_of(decode), Barrier(2)
    compiled = rest._compiled

    def together():
        both.wait(10)
        return compiled()

    rest._compiled = together
    with ThreadPoolExecutor(2) as pool:
        one, other = pool.map(lambda _: rest.made(), range(2))
    assert one is other is rest.made()
    assert len(rest._libraries) == 2
    assert rest._places["any_call"].value == one["any_call"]
    assert values(decode(messages[0], decode.new()))[1] == "t"


def test_it_lives_as_long_as_the_code_that_calls_it(of, messages, size):
    """Code that is freed is memory that is not there: a later mapping may lie at its place."""
    decode = of(rj.Decoder)
    decode(messages[0], decode.new())
    call = decode.into
    del decode
    gc.collect()
    blocks = [mmap.mmap(-1, mmap.PAGESIZE) for _ in range(100)]
    for each in messages:
        assert values(call(each, call.__self__.new()))[0] == (len(each) - size - 16) / 4
    assert all(block[:] == bytes(mmap.PAGESIZE) for block in blocks)


FROM_THE_CACHE = """
import sys
import rosetta_jit as rj
decode, encode = (made.of("std_msgs/msg/String", encoding="ros1") for made in (rj.Decoder, rj.Encoder))
message = encode({"data": "text"})
assert decode(message, decode.new()).data == "text"
assert encode(decode(message), bytearray(100)) == 8
assert len(decode.many([message, message])) == 2
print("llvmlite.binding" in sys.modules)
"""


def test_it_is_kept_and_found_without_the_compiler(tmp_path):
    def run():
        ran = subprocess.run([sys.executable, "-c", FROM_THE_CACHE], capture_output=True, text=True, check=False, env=env)
        assert ran.returncode == 0, ran.stderr
        return ran.stdout.strip()

    env = {**os.environ, "ROSETTA_JIT_CACHE_DIR": str(tmp_path)}
    env.pop("ROSETTA_JIT_CACHE", None)
    assert [run(), run()] == ["True", "False"]


def test_warming_makes_it(monkeypatch, tmp_path, size):
    monkeypatch.setenv("ROSETTA_JIT_CACHE_DIR", str(tmp_path))
    request = Request("decode", type="rest/msg/All", files=(("rest/msg/All.msg", definition(size)),), encoding="ros1")
    ((made,),) = warm([request])
    assert made.error is None
    text = EntryText.of_plain(Build(request).header["rest"]).alone
    assert known(text) is not None


def test_it_wants_nothing_but_the_kernels_besides_what_is_allowed():
    header = Build(Request("encode", type="std_msgs/msg/String", encoding="ros1")).header["rest"]
    code = compile_rest(EntryText.of_plain(header).alone)
    assert set(from_bytes(code).gives) == set(header["symbols"]) == {"any_call", "many", "sizes"}
    with pytest.raises(ForeignCodeError, match="wants kernel, size from the process"):
        place(code, ("any_call",))
    with pytest.raises(ForeignCodeError, match="wants size from the process"):
        place(code, ("any_call",), {"kernel": 1})


@pytest.fixture
def bottles(size):
    """A decoder of doubles in YARP, a message with one tag for all of them, as is usual, one with a tag for each, and the numbers."""
    fields = "".join(f'("d{number}" :double)' for number in range(size))
    decode = rj.Decoder.of("rest", schema={"r.bottle-schema": f'"rest" ({fields})'}, imports=["r.bottle-schema"], encoding="yarp3")
    numbers = [number / 2 for number in range(size)]
    tagged = b"".join(struct.pack("<id", 10, number) for number in numbers)
    return decode, struct.pack(f"<ii{size}d", 266, size, *numbers), struct.pack("<ii", 256, size) + tagged, numbers


def doubles(holder):
    return list(holder.to_dict().values())


def test_what_the_first_body_leaves_has_it_made_and_gives_the_same_before_and_behind(bottles):
    decode, usual, tagged, numbers = bottles
    made = []
    for message in (usual, tagged, usual, tagged, tagged):
        assert doubles(decode(message)) == numbers
        made.append(is_made(decode))
    assert made == [False, True, True, True, True]


def test_what_no_body_takes_is_told_in_the_same_words_and_has_nothing_made(bottles):
    decode, usual, tagged, numbers = bottles
    broken = (b"", usual[:-1], usual + b"\0", tagged[:-1], tagged[:9] + b"\1" + tagged[10:], struct.pack("<ii", 257, 1))

    def told():
        words = []
        for message in broken:
            with pytest.raises(rj.DecodeError) as error:
                decode(message)
            words.append(str(error.value))
            with pytest.raises(rj.InvalidHolder):
                _ = decode._shared.holder.d0
        return words

    assert doubles(decode(usual)) == numbers
    before = told()
    assert not is_made(decode)
    assert doubles(decode(tagged)) == numbers
    assert is_made(decode)
    assert told() == before
    assert doubles(decode(usual)) == numbers


def test_threads_meet_what_the_first_body_leaves_at_once(bottles):
    decode, usual, tagged, numbers = bottles
    with ThreadPoolExecutor(8) as pool:
        found = list(pool.map(lambda number: doubles(decode((usual, tagged)[number % 2])), range(200)))
    assert found == 200 * [numbers]
