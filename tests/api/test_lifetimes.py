"""What Python can do to holders, programs and batches besides using them: none of it reaches memory that is not theirs."""

from __future__ import annotations

import copy
import gc
import os
import pickle
import struct
import subprocess
import sys
import threading
import weakref
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress

import numpy as np
import pytest

import rosetta_jit as rj
from rosetta_jit.runtime.callable import is_native
from tests.api.exporters import exporter

SCHEMA = {
    "p/A.msg": "float64[] d\nstring s\n",
    "p/B.msg": "string a\nfloat64[] d\nint32 n\n",
}


def of(program, name="A", **options):
    return program.of(f"p/{name}", schema=SCHEMA, encoding="ros1", imports=[f"p/{name}.msg"], **options)


def message(count, text=b""):
    return struct.pack("<I", count) + b"\x41" * (8 * count) + struct.pack("<I", len(text)) + text


@pytest.fixture(params=["llvm", "python"])
def decode(request):
    return of(rj.Decoder, backend=request.param)


@pytest.fixture
def encode():
    return of(rj.Encoder)


# --- holders ---


def test_a_holder_that_is_made_again_is_emptied_where_it_is(decode):
    own = decode(message(1 << 17))
    view = own.d
    own.__init__()
    assert own.to_dict() == {"d": [], "s": ""}
    gc.collect()
    for count in (1 << 17, 3, 1 << 18):
        assert decode(message(count)) is own
        assert len(own.d) == count
    assert len(view) == 1 << 17


def test_a_message_of_protobuf_that_is_made_again_has_the_new_fields():
    made = rj.Decoder.of("t.M", schema={"a.proto": 'syntax = "proto3"; package t; message M { repeated int32 a = 1; string s = 2; }'}).new()
    made.__init__(a=[1, 2], s="first")
    made.__init__(s="second")
    assert (list(made.a), made.s) == ([], "second")


def test_the_class_of_a_holder_stays():
    holder, other = of(rj.Decoder).new(), of(rj.Decoder, "B")
    for wrong in (other.holder_type, rj.Holder):
        with pytest.raises(TypeError, match="layout"):
            holder.__class__ = wrong
        with pytest.raises(TypeError, match=r"layout|__setattr__"):
            object.__setattr__(holder, "__class__", wrong)


def test_the_class_of_a_program_stays():
    with pytest.raises(TypeError, match="layout"):
        of(rj.Decoder).__class__ = rj.Encoder


CLEARED = """
import faulthandler, gc, sys
faulthandler.enable()
import rosetta_jit as rj
from tests.api.test_lifetimes import message, of

class Values:
    def __init__(self):
        self.d, self.s = [1.0], "text"

decode, encode = of(rj.Decoder), of(rj.Encoder)
encode(Values())
encode(Values())
decode(message(3), decode.new())  # from now on, the compiled call takes holders
programs, calls = [decode, encode], [decode.builtin, encode.builtin, decode.into]
for program in programs:
    if sys.argv[1] == "replaced":
        program.__dict__ = {}
    else:
        vars(program).clear()
gc.collect()
others = [bytearray(1 << 12) for _ in range(1000)]
for _ in range(3):
    for call, given in zip([*programs, *calls], [message(1 << 10, b"text"), Values(), message(3), Values(), message(3)]):
        try:
            call(given)
        except (AttributeError, TypeError, ValueError):
            pass
holder = of(rj.Decoder).new()
assert decode(message(3, b"text"), holder) is holder
assert encode(holder) == message(3, b"text")
assert all(not any(each) for each in others)
del decode, encode, programs, program, calls, call
gc.collect()
print("whole")
"""


@pytest.mark.parametrize("how", ["cleared", "replaced"])
def test_compiled_code_lives_without_the_attributes_of_its_program(how):
    ran = subprocess.run([sys.executable, "-c", CLEARED, how], capture_output=True, text=True, check=False)
    assert (ran.returncode, ran.stdout) == (0, "whole\n"), ran.stderr


NAMES = {"n.proto": 'syntax = "proto3"; package p; message N { repeated string names = 1; repeated N parts = 2; map<string, N> m = 3; }'}


@pytest.mark.skipif(not is_native(), reason="no compiled code reads them")
def test_what_compiled_code_reads_cannot_be_changed():
    """It takes what stands there for what it put there."""
    decode = rj.Decoder.of("p.N", schema=NAMES, encoding="protobuf")
    holder = decode(bytes.fromhex("0a0161" + "1203" + "0a0162"), decode.new())
    methods = [vars(type(holder)).get(name) for name in ("SerializeToString", "ParseFromString", "from_dict")]
    for each in (decode.new, decode.to, decode.builtin, type(holder).FromString, *filter(None, methods), holder.names, holder.parts):
        for name in (name for name in dir(each) if "_" not in (name[0], name[-1])):
            for change in (setattr, object.__setattr__):
                with pytest.raises((AttributeError, TypeError)):
                    change(each, name, decode)
            with pytest.raises((AttributeError, TypeError)):
                delattr(each, name)
    assert not hasattr(decode.new, "room"), "which would take the room of another layout"


def test_a_holder_that_was_never_made_says_so(decode, encode):
    unmade = decode.holder_type.__new__(decode.holder_type)
    for use in (lambda: decode(message(1), unmade), lambda: encode(unmade)):
        with pytest.raises(TypeError, match="never made"):
            use()


def test_copies_have_memory_of_their_own(decode, encode):
    own = decode(message(3, b"text"))
    for each in (copy.copy(own), copy.deepcopy(own), pickle.loads(pickle.dumps(own))):  # noqa: S301 - our own
        decode(message(1000))
        assert encode(each) == message(3, b"text")
        decode(message(3, b"text"))


def test_what_looks_weakly_at_a_holder_sees_it_end(decode):
    holder = decode.new()
    seen = weakref.ref(holder)
    view = decode(message(5), holder).d
    del holder
    gc.collect()
    assert seen() is None
    assert len(view) == 5


# --- programs and batches ---


@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy, lambda program: pickle.loads(pickle.dumps(program))])  # noqa: S301 - our own
def test_copies_of_programs_share_code_and_no_holder(decode, encode, copied):
    again = copied(decode)
    own = decode(message(3))
    assert again(message(2)) is not own
    assert (len(own.d), len(again(message(2)).d)) == (3, 2)
    assert copied(encode)(again(message(2))) == message(2)
    assert copied(decode.builtin)(message(4)).d.size == 4


@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy, lambda batch: pickle.loads(pickle.dumps(batch))])  # noqa: S301 - our own
def test_copies_of_batches_have_memory_of_their_own(decode, encode, copied):
    data = message(3, b"a") + message(0, b"text")
    batch = decode.many(data, np.array([0, 33, 45]))
    again = copied(batch)
    decode.many(message(9), np.array([0, 80]), into=batch)
    assert bytes(encode.many(again)[0]) == data


def test_a_batch_of_another_layout_is_refused(decode, encode):
    batch, other = decode.many(message(3), np.array([0, 32])), of(rj.Decoder, "B").many(b"", np.array([0]))
    other.lanes = batch.lanes
    with pytest.raises(TypeError, match="batch of A"):
        encode.many(other)
    batch.lanes = of(rj.Decoder, "B").many(b"", np.array([0])).lanes
    with pytest.raises(TypeError, match="batch of A"):
        decode.many(message(3), np.array([0, 32]), into=batch)


def test_where_the_elements_of_rows_lie_cannot_be_changed(decode):
    column = decode.many(message(3), np.array([0, 32])).column("d")
    for each in (column.starts, column.counts):
        with pytest.raises(ValueError, match="read-only"):
            each[0] = 1 << 40


# --- threads ---


def test_each_thread_has_an_own_holder_of_a_decoder(decode):
    own = decode(message(1))
    with ThreadPoolExecutor(1) as pool:
        first, second = (pool.submit(decode, message(count)).result() for count in (2, 3))
    assert first is second
    assert first is not own
    assert (len(own.d), len(first.d)) == (1, 3)


def test_who_uses_what_another_uses_is_told_what_to_do(decode, encode):
    holder = decode(message(2, b"text"))
    batch = decode.many(message(2, b"text"), np.array([0, 28]))
    uses = [
        lambda: decode(message(1)),
        lambda: decode(message(1), holder),
        lambda: encode(holder),
        lambda: encode(holder, bytearray(100)),
        lambda: encode.size(holder),
        lambda: setattr(holder, "d", [1]),
        lambda: setattr(holder, "s", "x"),
        lambda: holder.s,
        holder.to_dict,
        lambda: holder == decode.new(),
        lambda: copy.copy(holder),
        lambda: pickle.dumps(holder),
        holder.clear,
        holder.__init__,
        holder.materialise,
    ]
    uses_of_batch = [
        lambda: decode.many(b"", np.array([0]), into=batch),
        lambda: encode.many(batch),
        lambda: batch[0].s,
        lambda: setattr(batch[0], "s", "x"),
        lambda: batch.column("d"),
        lambda: batch.mask("d"),
        lambda: batch.reset(3),
    ]
    with holder.lanes_, batch.lanes:
        for use in uses + uses_of_batch:
            with pytest.raises(rj.InUse, match=r"decoder\.new\(\)"):
                use()
    for use in uses:
        use()


def test_numbers_of_messages_are_taken_once():
    schema = {
        "p/N.msg": "int64 n\n",
        "p/W.msg": "int64 n\n",
        "m.mapping": 'import "p/N.msg"\nimport "p/W.msg"\ndata-holder: p/N\nwire-schema: p/W\npack-rules:\n  .n = counter()\n',
    }
    encode = rj.Encoder("m.mapping", schema=schema, encoding="ros1")
    found = []

    def work():
        holder = encode.new()
        for _ in range(2000):
            found.append(encode(holder))
            found.append(encode.into(holder, bytearray(8)) and None)

    before = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    try:
        threads = [threading.Thread(target=work) for _ in range(3)]
        for each in threads:
            each.start()
        for each in threads:
            each.join()
    finally:
        sys.setswitchinterval(before)
    numbers = [struct.unpack("<q", each)[0] for each in found if each is not None]
    assert len(set(numbers)) == len(numbers) == 6000
    assert max(numbers) < 12_000


# --- code of others in the middle of a call ---


@pytest.mark.parametrize("borrow", [False, True])
def test_a_buffer_may_use_the_decoder_that_asks_for_it(borrow):
    decode = of(rj.Decoder, borrow=borrow)
    holder = decode.new()

    def rude():
        with suppress(rj.InUse):
            decode(message(1 << 16))
            holder.__init__()
            gc.collect()

    sent = message(3, b"text")
    assert len(decode(exporter(sent, rude, rude), holder).d) in (0, 3)
    assert len(decode(exporter(sent, rude, rude)).d) in (3, 1 << 16)
    batch = decode.many(exporter(sent * 5, rude, rude), np.arange(6) * len(sent))
    assert [each.s for each in batch] == ["text"] * 5
    decode(sent)  # gives back the buffer, where it was borrowed
    assert decode(sent).s == "text"


@pytest.mark.parametrize("borrow", [False, True])
def test_a_buffer_may_drop_what_it_is_decoded_with(borrow):
    kept = [of(rj.Decoder, borrow=borrow)]
    kept.append(kept[0].new())
    sent = message(3, b"text")

    def drop():
        kept.clear()
        gc.collect()

    decode = kept[0]
    seen = weakref.ref(kept[1])
    assert decode(exporter(sent, drop), kept[1]).s == "text"
    assert seen() is None
    built_in = [of(rj.Decoder, borrow=borrow).builtin]
    assert built_in[0](exporter(sent, built_in.clear)).s == "text"


def test_a_buffer_may_change_the_holder_that_is_written_to_it(encode):
    holder = of(rj.Decoder)(message(3, b"text"))

    def lengthen():
        holder.s = "a longer text than before"
        holder.d = np.zeros(5000)

    with pytest.raises(BufferError, match="takes 40033 bytes"):
        encode(holder, exporter(100, lengthen), 0)
    assert encode(holder, exporter(50_000, lengthen), 0) == 40_033


# --- the end of a process, and its children ---

DAEMONS = """
import struct, threading
import numpy as np
import rosetta_jit as rj

decode = rj.Decoder("yarp/icub/torso_state.mapping", encoding="yarp3")
encode = rj.Encoder("yarp/icub/torso_state.mapping", encoding="yarp3")
MESSAGE = struct.pack("<ii3d", 266, 3, 1, 2, 3)
data, offsets = MESSAGE * 100_000, np.arange(100_001) * len(MESSAGE)
batch = decode.many(data, offsets)

def work():
    while True:
        try:
            decode.many(data, offsets, into=batch)
            encode.many(batch)
            encode(decode(MESSAGE))
        except rj.InUse:
            pass

for _ in range(3):
    threading.Thread(target=work, daemon=True).start()
threading.Event().wait(0.3)
"""


def test_a_process_may_end_while_its_threads_decode():
    ended = subprocess.run([sys.executable, "-c", DAEMONS], check=False, capture_output=True, text=True, timeout=300)
    assert (ended.returncode, ended.stderr) == (0, "")


FORKS = """
import faulthandler, os, struct, sys, threading, warnings
import numpy as np
import rosetta_jit as rj

warnings.simplefilter("ignore", DeprecationWarning)  # a fork beside threads, of which we show what comes
SCHEMA = {"p/A.msg": "float64[] d\\n"}
decode = rj.Decoder.of("p/A", schema=SCHEMA, encoding="ros1", imports=["p/A.msg"])
MESSAGE = struct.pack("<I3d", 3, 1, 2, 3)
data, offsets = MESSAGE * 200_000, np.arange(200_001) * len(MESSAGE)
batch = decode.many(data, offsets)
over = threading.Event()
rj.Decoder.of("std_msgs/String", encoding="ros1", backend="python")  # imports what is needed: CPython's locks of modules survive no fork

def fill():
    while not over.is_set():
        decode.many(data, offsets, into=batch)

def make():
    number = 0
    while not over.is_set():
        number += 1
        rj.Decoder.of("p/A", schema={"p/A.msg": f"float64[] d{number}\\n"}, encoding="ros1", imports=["p/A.msg"], backend="python")

def child():
    faulthandler.dump_traceback_later(60, exit=True)
    refused = 0
    try:
        decode.many(data[:56], offsets[:3], into=batch)
    except rj.InUse:
        refused = 1
    assert list(decode(MESSAGE).d) == [1, 2, 3]
    files = {"p/A.msg": "float64[] d\\nint32 n\\n"}
    assert rj.Decoder.of("p/A", schema=files, encoding="ros1", imports=["p/A.msg"], backend="python").new().n == 0
    os._exit(10 + refused)

threads = [threading.Thread(target=each) for each in (fill, make)]
for each in threads:
    each.start()
codes = set()
for _ in range(5):
    pid = os.fork()
    if not pid:
        child()
    codes.add(os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]))
over.set()
for each in threads:
    each.join()
print(codes <= {10, 11}, codes)
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="the system has no fork")
def test_the_child_of_a_fork_goes_on():
    ended = subprocess.run([sys.executable, "-c", FORKS], check=False, capture_output=True, text=True, timeout=300)
    assert (ended.returncode, ended.stdout[:4], ended.stderr) == (0, "True", "")
