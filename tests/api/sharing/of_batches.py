"""Threads share batches, columns, tables and pictures; a process that shares them forks."""

from __future__ import annotations

import os
import pickle
import signal
import struct
import time
from contextlib import suppress

import numpy as np

import rosetta_jit as rj
from tests.api.sharing.turns import buffer_of, check, kind, messages, of, plain


@kind
def batch(turns):
    """A batch is filled again, and its rows made longer, while another thread encodes it."""
    decode, encode = of(rj.Decoder), of(rj.Encoder)
    sent = messages(40)
    buffers = [(b"".join(sent[:count]) * 20, np.cumsum([0, *([len(each) for each in sent[:count]] * 20)])) for count in (5, 40, 20)]
    shared = decode.many(*buffers[0])

    def refill(rng):
        decode.many(*buffers[rng.randrange(3)], into=shared)

    def lengthen(rng):
        shared[rng.randrange(100)].s = "x" * rng.randrange(100_000)

    def encode_it(rng):
        data, offsets = encode.many(shared)
        assert len(offsets) - 1 in (100, 400, 800)
        assert offsets[-1] == len(data)

    turns.run(refill, lengthen, encode_it, encode_it)


@kind
def columns(turns):
    """Columns and rows of a batch are read while it is filled again."""
    decode = of(rj.Decoder)
    sent = messages(40)
    buffers = [(b"".join(sent[:count]), np.cumsum([0, *(len(each) for each in sent[:count])])) for count in (5, 40)]
    shared = decode.many(*buffers[0])

    def refill(rng):
        decode.many(*buffers[rng.randrange(2)], into=shared)

    def row(rng):
        number = rng.randrange(5)
        check(shared[number].to_dict(), number)

    def column(rng):
        names = shared.column("names")
        assert len(names) in (5, 40)
        assert len(shared.n) in (5, 40)
        assert shared.mask("s").all()

    turns.run(refill, row, column)


@kind
def tables(turns):
    """Tables and parts of a batch are made while it is filled again."""
    decode = of(rj.Decoder)
    sent = messages(40)
    buffers = [(b"".join(sent[:count]), np.cumsum([0, *(len(each) for each in sent[:count])])) for count in (5, 40)]
    shared = decode.many(*buffers[0])

    def refill(rng):
        decode.many(*buffers[rng.randrange(2)], into=shared)

    def table(rng):
        for number, row in enumerate(shared.to_arrow().to_pylist()):
            check(row, number)

    def part(rng):
        for number, message in enumerate(shared[2:5], 2):
            check(message.to_dict(), number)

    def pickled(rng):
        assert len(pickle.loads(pickle.dumps(shared))) in (5, 40)  # noqa: S301 - our own

    turns.run(refill, table, part, pickled)


@kind
def kept_tables(turns):
    """Tables that were made before stay whole, while their batch is filled with longer texts."""
    decode = of(rj.Decoder)
    buffers = [buffer_of(messages(count)) for count in (5, 40, 20)]
    shared = decode.many(*buffers[0])
    kept = [shared.to_arrow()]

    def refill(rng):
        decode.many(*buffers[rng.randrange(3)], into=shared)

    def make(rng):
        kept[0] = shared.to_arrow()
        time.sleep(0.001)

    def read(rng):
        table = kept[0]
        table.validate(full=True)
        assert table.to_pylist() == table.to_pylist()

    turns.run(refill, make, read, read)


@kind
def iterators(turns):
    """Batches, parts of them and lists are gone through while another thread decodes into them; what is gone raises what lists raise."""
    sent, decode = messages(40), of(rj.Decoder)
    buffers = [buffer_of(sent[:count]) for count in (5, 40, 20)]
    rows, one = decode.many(*buffers[0]), decode(sent[7], decode.new())
    words = {plain(number)["s"] for number in range(40)}

    def refill(rng):
        decode.many(*buffers[rng.randrange(3)], into=rows)
        decode(sent[rng.randrange(40)], one)

    def batch_rows(rng):
        with suppress(rj.InvalidHolder, IndexError):
            assert all(row.s in words for row in rows)
            for row in rows[1:4][::-1]:
                assert row.s in words

    def lists(rng):
        with suppress(rj.InvalidHolder, IndexError):
            assert all(name in words for name in reversed(one.names))
            assert all(item.t.isdigit() or not item.t for item in one.items)
            assert one.d.tolist() == [] or len(one.d)

    turns.run(refill, batch_rows, lists, lists)


PICTURE = {
    "p/P.msg": "uint32 width\nuint32 height\nuint8[] pixels\n",
    "p/Q.msg": "uint8[] packed\n",
    "picture.mapping": """import "p/P.msg"
import "p/Q.msg"
data-holder: p/P
wire-schema: p/Q
pack-rules:
  .packed = compress(.pixels, "png", .width, .height, 1)
""",
}


@kind
def pictures(turns):
    """A kernel that calls Python, which lets other threads run, while its holder is changed."""
    encode = rj.Encoder("picture.mapping", schema=PICTURE, encoding="ros1")
    fill = rj.Decoder.of("p/P", schema=PICTURE, encoding="ros1", imports=["p/P.msg"])
    shared = encode.new()
    sizes = [(20, 30), (200, 300), (64, 10)]
    sent = [struct.pack("<III", width, height, width * height) + bytes(width * height) for width, height in sizes]
    fill(sent[0], shared)
    known = {encode(fill(each)) for each in sent}

    def write(rng):
        assert encode(shared) in known

    def change(rng):
        fill(sent[rng.randrange(3)], shared)

    turns.run(write, write, change)


@kind
def forks(turns):
    """A child of a fork beside threads that decode goes on, and what they had begun is in use there."""
    sent, decode, encode = messages(40), of(rj.Decoder), of(rj.Encoder)
    buffers = [buffer_of(sent[:count]) for count in (5, 40)]
    shared, rows = decode.new(), decode.many(*buffers[0])

    def fill(rng):
        decode(sent[rng.randrange(40)], shared)

    def refill(rng):
        decode.many(*buffers[rng.randrange(2)], into=rows)

    def child(rng):
        number = os.fork()
        if number:
            assert os.waitpid(number, 0)[1] == 0
            return
        code = 1
        try:
            signal.alarm(30)
            check(decode(sent[3]).to_dict(), 3)
            assert encode(decode(sent[4], decode.new())) == sent[4]
            assert len(decode.many(*buffers[1])) == 40
            with suppress(rj.InUse):
                decode.many(*buffers[0], into=rows)
            with suppress(rj.InUse):
                shared.to_dict()
            code = 0
        finally:
            os._exit(code)

    turns.run(fill, refill, child)
