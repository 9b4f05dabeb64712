"""How the cost of a message grows: with its size, its fields, its depth, with the number of messages, threads and decoders."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from os import cpu_count

import numpy as np
import pytest

import rosetta_jit as rj
from bench import growing
from bench.figures import Series, Spread
from bench.messages import joints_mapping, repeated, specialised

BOTTLE = 16
"""Bytes of a bottle of one double: small, so that ten million fit in memory."""

FIELDS = {
    "ROS 1": (growing.fields, ""),
    "protobuf, optional": (growing.optional_fields, "each field is a jump by its tag, and processors foretell few hundred jumps"),
    "protobuf, required": (growing.required_fields, "the next field is guessed"),
}


def spreads(effort, contenders, rounds=None):
    """What each contender took, measured in turns."""
    taken = effort.in_turns(contenders, rounds=rounds)
    return {name: Spread.of(values) for name, values in taken.items()}


def over(xs, measure):
    """A series a contender, over the x: ``measure`` gives what each of them took at one x."""
    roles = {"memmove": "limit", "len()": "limit"}
    found = {}
    for x in xs:
        for who, took in measure(x).items():
            found.setdefault(who, []).append((x, took))
    return tuple(Series(who, roles.get(who, "ours"), tuple(points)) for who, points in found.items())


def test_message_size(effort, draw):
    sizes = [8 << step for step in range(0, 22, 3 if effort.quick else 1)]

    def measure(size):
        subject = growing.doubles(size)
        decode, encode = subject.decoder(), subject.encoder()
        holder, buffer = decode(subject.message), bytearray(size)
        source, target = np.frombuffer(subject.message, np.uint8), np.empty(size, np.uint8)
        return spreads(
            effort,
            {
                "decode": effort.call(decode, subject.message),
                "encode": effort.call(encode, holder, buffer, 0),
                "memmove": effort.call(np.copyto, target, source),
            },
        )

    draw("message size", "bytes", "ns", over(sizes, measure), note="memory ends each cache, as memmove's line shows")


@pytest.mark.parametrize("what", FIELDS)
def test_fields(what, effort, draw):
    make, note = FIELDS[what]
    counts = [1, 10, 100] if effort.quick else [1, 3, 10, 30, 100, 300, 1000]

    def measure(count):
        subject = make(count)
        decode, encode = subject.decoder(), subject.encoder()
        holder, buffer = decode(subject.message), bytearray(len(subject.message))
        return spreads(
            effort,
            {
                "decode": effort.call(decode, subject.message),
                "encode": effort.call(encode, holder, buffer, 0),
                "len()": effort.call(len, subject.message),
            },
        )

    draw(f"number of fields, {what}", "fields", "ns", over(counts, measure), note=note)


@pytest.mark.parametrize(("what", "make"), [("ROS 1, fixed size", growing.nested), ("protobuf", growing.nested_tagged)])
def test_depth(what, make, effort, draw):
    depths = [1, 4, 16] if effort.quick else [1, 2, 4, 8, 16, 32]

    def measure(depth):
        subject = make(depth)
        decode = subject.decoder()
        return spreads(effort, {"decode": effort.call(decode, subject.message), "len()": effort.call(len, subject.message)})

    draw(f"nesting depth, {what}", "levels", "ns", over(depths, measure), may_grow=0 if what.startswith("ROS") else 1)


def test_length_of_many(tmp_path, effort, draw):
    decoder = rj.Decoder(joints_mapping(1, tmp_path), encoding="yarp3")
    encoder = rj.Encoder(joints_mapping(1, tmp_path), encoding="yarp3")
    counts = [10**power for power in range(7 if effort.quick else 8)]

    def measure(count):
        buffer, offsets = repeated(specialised(1), count)
        rows, target = decoder.many(buffer, offsets), np.empty_like(buffer)
        return spreads(
            effort,
            {
                "decode": effort.call(lambda: decoder.many(buffer, offsets, into=rows)),
                "encode": effort.call(lambda: encoder.many(rows)),
                "memmove": effort.call(np.copyto, target, buffer),
            },
            rounds=5,
        )

    assert len(specialised(1)) == BOTTLE
    draw("length of `many`, messages of 16 bytes", "messages", "ns", over(counts, measure))


def test_threads(tmp_path, effort, draw):
    decoder = rj.Decoder(joints_mapping(24, tmp_path), encoding="yarp3")
    count = 20_000 if effort.quick else 200_000
    buffer, offsets = repeated(specialised(24), count)
    threads = [1, 2, 4] if (cpu_count() or 1) >= 4 else [1, 2]
    with ThreadPoolExecutor(max(threads)) as pool:

        def measure(number):
            shares = [decoder.many(buffer, offsets) for _ in range(number)]
            work = effort.call(
                lambda: list(pool.map(lambda rows: decoder.many(buffer, offsets, into=rows), shares)),
                messages=number * count,
                threaded=True,
            )
            return spreads(effort, {"decode": work}, rounds=7)

        note = f"{cpu_count()} processors; the interpreter lock is free while `many` works"
        draw("threads, each its own rows", "threads", "ns a message", over(threads, measure), may_grow=0, note=note)


def test_live_decoders(tmp_path, effort, draw):
    mapping, message = joints_mapping(24, tmp_path), specialised(24)
    numbers = [1, 10, 100, 1000] if effort.quick else [1, 10, 100, 1000, 10_000]

    def measure(number):
        decoders = [rj.Decoder(mapping, encoding="yarp3") for _ in range(number)]
        turns = decoders * max(1, 1000 // number)
        return spreads(effort, {"decode": effort.call(lambda: [decode(message) for decode in turns], messages=len(turns))})

    note = "each holder has memory of its own, which leaves the caches when they are many"
    draw("live decoders, called one after another", "decoders", "ns a call", over(numbers, measure), may_grow=0, note=note)
