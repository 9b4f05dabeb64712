"""Bodies for messages that hardly ever come, such as CDR of the other byte order: compiled in a hurry, to the same meaning."""

from __future__ import annotations

import struct

import numpy as np
import pytest
from llvmlite import ir

import rosetta_jit as rj
from rosetta_jit.backends.llvm import function as llvm
from rosetta_jit.pipeline.build import Build
from rosetta_jit.pipeline.request import Request

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


@pytest.fixture(scope="module")
def decoders():
    """The decoder as it is compiled, and as the interpreter runs it."""
    options = {"encoding": "cdr", "schema": FILES, "framework": "ros2"}
    return rj.Decoder.of("a/msg/All", **options), rj.Decoder.of("a/msg/All", **options, backend="interpreter")


@pytest.mark.parametrize("counts", [(0,) * 8, (1,) * 8, (40, 33, 17, 9, 5, 3, 4, 10)])
def test_both_byte_orders_mean_the_same(decoders, counts):
    compiled, _ = decoders
    little, big = (compiled(message(order, counts)) for order in "<>")
    assert little == big
    assert [len(getattr(big, name)) for name in (*NUMBERS, *STRUCTS, "texts", "bytes")] == list(counts)
    assert np.array_equal(big.doubles, np.arange(counts[2]) + 258)


def test_what_is_broken_is_told_in_the_same_words(decoders):
    whole = message(">", (3, 2, 1, 2, 1, 1, 2, 3))
    for broken in [whole[:size] for size in range(len(whole))] + [whole.replace("é".encode(), b"\xff\xff")]:
        told = []
        for decode in decoders:
            with pytest.raises(rj.DecodeError) as error:
                decode(broken)
            told.append(str(error.value))
        assert told[0] == told[1]


def test_numbers_of_one_kind_in_a_row_are_swapped_by_what_is_compiled_once():
    request = Request("decode", type="a/msg/All", files=tuple(FILES.items()), encoding="cdr", framework="ros2")
    (kernel,) = Build(request).kernels
    main, rare = texts_of(kernel)
    assert [rare.count(f'call void @"rosetta_swap{width}"') for width in (2, 4, 8)] == [1, 3, 2]
    assert "bswap" in rare  # two fields of four bytes, one of eight, and the members of Odd, whose rows have padding
    assert "rosetta_swap" not in main
    assert main.count("define") == rare.count("define") == 1


def texts_of(kernel):
    main, rare = ir.Module("main"), ir.Module("rare")
    llvm.emit(main, kernel, "kernel", whole=False, rare=rare)
    return str(main), str(rare)
