"""Programs for messages that hardly ever come, such as CDR of the other byte order: made on demand, to the same meaning."""

from __future__ import annotations

import itertools
import struct
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest

import rosetta_jit as rj
from rosetta_jit.api.programs import program_of
from rosetta_jit.api.warm import warm
from rosetta_jit.pipeline.build import Build
from rosetta_jit.pipeline.request import Request
from rosetta_jit.runtime.cache.kernels import Cache
from rosetta_jit.runtime.cache.names import request_name

FILES = {
    "a/msg/Pair.msg": "float32 x\nfloat32 y\n",
    "a/msg/Mixed.msg": "float32 x\nuint32 y\n",
    "a/msg/Odd.msg": "uint32 x\nuint16 y\n",
    "a/msg/All.msg": "float64 one\nfloat64 two\nfloat64 three\nfloat32 four\nfloat32 five\nint64 six\n"
    "uint16[] words\nfloat32[] singles\nfloat64[] doubles\nPair[] pairs\nMixed[] mixed\nOdd[] odd\n"
    "string[] texts\nuint8[] bytes\n",
}
NUMBERS = {"words": "H", "singles": "f", "doubles": "d"}
STRUCTS = {"pairs": "ff", "mixed": "fI", "odd": "IH"}


def message(order, counts):
    """The message of some counts, the same values in either byte order."""
    data = bytearray(b"\0\1\0\0" if order == "<" else b"\0\0\0\0")

    def pack(form, value):
        size = struct.calcsize(form)
        data.extend(bytes(-(len(data) - 4) % size))
        data.extend(struct.pack(order + form, value))

    for form, value in zip("dddffq", (1.5, -2.5, 3.5, 4.5, -5.5, -6), strict=True):
        pack(form, value)
    for forms, count in zip((*NUMBERS.values(), *STRUCTS.values()), counts, strict=False):
        pack("I", count)
        for number in range(count):
            for form in forms:
                pack(form, number + 258)
    pack("I", counts[-2])
    for number in range(counts[-2]):
        text = f"text {number}é".encode()
        pack("I", len(text) + 1)
        data.extend(text + b"\0")
    pack("I", counts[-1])
    return bytes(data) + bytes(range(counts[-1]))


COUNTS = (3, 2, 1, 2, 1, 1, 2, 3)
NUMBERS_OF_PACKAGES = itertools.count()


def request(package="a", **options):
    files = tuple((name.replace("a/", f"{package}/"), text) for name, text in FILES.items())
    return Request("decode", type=f"{package}/msg/All", files=files, encoding="cdr", framework="ros2", **options)


@pytest.fixture
def package():
    """One whose types have no decoders yet: these would share their code."""
    return f"package{next(NUMBERS_OF_PACKAGES)}"


@pytest.fixture
def decode(package):
    return program_of(request(package))


@pytest.fixture(scope="module")
def decoders():
    """The decoder as it is compiled, and as the interpreter runs it."""
    return program_of(request()), program_of(request(backend="interpreter"))


@pytest.mark.parametrize("counts", [(0,) * 8, (1,) * 8, (40, 33, 17, 9, 5, 3, 4, 10)])
def test_both_byte_orders_mean_the_same(decoders, counts):
    compiled, _ = decoders
    little, big = (compiled(message(order, counts)) for order in "<>")
    assert little == big
    assert [len(getattr(big, name)) for name in (*NUMBERS, *STRUCTS, "texts", "bytes")] == list(counts)
    assert np.array_equal(big.doubles, np.arange(counts[2]) + 258)


def test_what_is_broken_is_told_in_the_same_words(decoders):
    whole = message(">", COUNTS)
    for broken in [whole[:size] for size in range(len(whole))] + [whole.replace("é".encode(), b"\xff\xff")]:
        told = []
        for decode in decoders:
            with pytest.raises(rj.DecodeError) as error:
                decode(broken)
            told.append(str(error.value))
        assert told[0] == told[1]


def test_the_other_program_is_made_when_the_first_message_comes(decode):
    assert not is_made(decode)
    decode(message("<", COUNTS))
    with pytest.raises(rj.DecodeError):
        decode(message("<", COUNTS)[:-1])
    assert not is_made(decode)
    decode(message(">", COUNTS))
    assert is_made(decode)


def test_a_message_that_is_cut_makes_it_too(decode):
    with pytest.raises(rj.DecodeError, match=r"truncated.*`.one`, byte 4"):
        decode(message(">", COUNTS)[:6])
    assert is_made(decode)


def test_no_message_without_its_opening_makes_it(decode):
    for data in (b"", b"\0", b"\7\7\0\0", bytes((0, 1)), bytes((1, 0)) + bytes(100)):
        with pytest.raises(rj.DecodeError):
            decode(data)
    assert not is_made(decode)


def test_many_messages_of_both_orders(decode):
    orders = "<<><>>"
    batch = decode.many([message(order, (number,) * 8) for number, order in enumerate(orders)])
    assert [len(row.doubles) for row in batch] == list(range(len(orders)))
    assert [row.one for row in batch] == [1.5] * len(orders)


def test_broken_messages_of_both_orders_among_many(decode):
    whole = message(">", COUNTS)
    batch = decode.many([whole[:8], message("<", COUNTS)[:8], whole, b"\7\7\0\0"], on_error="mask")
    assert [str(batch.errors[number]) for number in (0, 1)] == [
        f"truncated: the message ends here - at `[{number}].one`, byte 4" for number in (0, 1)
    ]
    assert "constant" in str(batch.errors[3])
    assert batch[2].one == 1.5


def test_threads_meet_the_first_message_at_once(decode):
    whole = message(">", COUNTS)

    def first(_):
        return decode(whole, decode.new()).one

    with ThreadPoolExecutor(4) as pool:
        assert list(pool.map(first, range(32))) == [1.5] * 32


@pytest.mark.parametrize("many", [False, True])
def test_another_thread_makes_it_between_failure_and_retry(decode, package, monkeypatch, many):
    other, made_for = program_of(request(package)), type(decode)._made_for
    whole = message(">", COUNTS)

    def late(decoder, *failed):
        other._complete()
        return made_for(decoder, *failed)

    monkeypatch.setattr(type(decode), "_made_for", late)
    assert (decode.many([whole])[0] if many else decode(whole)).one == 1.5


def test_decoders_of_one_type_share_it(decode, package):
    other = program_of(request(package))
    decode(message(">", COUNTS))
    assert is_made(other)
    assert other(message(">", COUNTS)).one == 1.5


def test_files_that_have_changed_since_are_told(tmp_path):
    file = tmp_path / "own_msgs" / "msg" / "One.msg"
    file.parent.mkdir(parents=True)
    file.write_text("float64 one\n")
    decode = rj.Decoder.of("own_msgs/msg/One", encoding="cdr", search_path=[str(tmp_path)])
    file.write_text("float32 one\n")
    assert decode(b"\0\1\0\0" + struct.pack("<d", 2.5)).one == 2.5
    with pytest.raises(
        rj.SchemaError, match=r"the first big-endian message, and the files that its decoder was made from have changed since"
    ):
        decode(b"\0\0\0\0" + struct.pack(">d", 2.5))
    file.write_text("float64 one\n")
    assert decode(b"\0\0\0\0" + struct.pack(">d", 2.5)).one == 2.5


def test_to_warm_the_cache_compiles_both(package):
    wanted = request(package)
    for order in (None, "big"):
        assert Cache.default().get_manifest(request_name(replace(wanted, byte_order=order).key())) is None
    for usual, known in ((True, (True, False)), (False, (True, True))):
        (((warmed,),)) = warm([wanted], usual=usual)
        assert warmed.error is None
        found = [Cache.default().get_manifest(request_name(replace(wanted, byte_order=order).key())) for order in (None, "big")]
        assert tuple(each is not None for each in found) == known


@pytest.mark.parametrize(("backend", "count"), [("llvm", 1), ("numba", 2), ("python", 2), ("interpreter", 2)])
def test_only_what_is_compiled_at_once_leaves_messages_to_another_program(backend, count):
    (kernel,) = Build(request(backend=backend), leaves_rare=True).kernels
    assert (len(kernel.bodies), kernel.goes_on) == (count, count == 1)


def is_made(decode):
    return decode._loaded.on_demand.place.sites is not None
