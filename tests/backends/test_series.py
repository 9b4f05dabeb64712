"""Large messages of fields that are alike: printed for LLVM once, and meaning the same as if each were printed by itself."""

from __future__ import annotations

from collections import Counter
from functools import reduce

import pytest

import rosetta_jit as rj
from rosetta_jit.backends.llvm import twins
from rosetta_jit.backends.llvm.alike import Series
from rosetta_jit.backends.llvm.stretches import found
from rosetta_jit.kernel.nodes import (
    Advance,
    Capacity,
    Compare,
    Const,
    Copy,
    Expect,
    For,
    If,
    Let,
    Load,
    Local,
    Place,
    Require,
    Reserve,
    Return,
    SetField,
    Wire,
)
from rosetta_jit.kernel.proof.verify import verify
from rosetta_jit.kernel.terms import BEGIN, END, ROW, add, index
from rosetta_jit.kernel.walk import flat
from rosetta_jit.pipeline.build import Build
from rosetta_jit.pipeline.request import Request
from tests.backends.engines import outcome
from tests.backends.holders import rows
from tests.backends.kernels import failure, kernel


def ros1(count):
    """Strings, then numbers, strings and arrays by turns."""
    strings = [f"string text{number}" for number in range(count)]
    mixed = [f"string name{number}\nint64 number{number}\nuint32[] places{number}" for number in range(count)]
    return {"encoding": "ros1", "schema": {"a/msg/All.msg": "\n".join((*strings, *mixed))}, "framework": "ros1"}


def protobuf(count):
    numbers = [f"  int64 number{number} = {number + 1};" for number in range(count)]
    texts = [f"  string text{number} = {number + 1 + count};" for number in range(count)]
    fields = "\n".join((*numbers, *texts))
    return {"encoding": "protobuf", "schema": {"a.proto": f'syntax = "proto3"; package a;\nmessage All {{\n{fields}\n}}'}}


COUNTS = {"ros1": 20, "protobuf": 32}
TYPES = {"ros1": ("a/All", ros1(COUNTS["ros1"])), "protobuf": ("a.All", protobuf(COUNTS["protobuf"]))}


def filled(holder, step):
    """A holder whose every field is set, or each of a ``step``."""
    for number in range(0, COUNTS["ros1" if hasattr(holder, "name0") else "protobuf"], step):
        setattr(holder, f"text{number}", f"text {number} é" * (number % 3))
        if hasattr(holder, "name0"):
            setattr(holder, f"name{number}", f"name {number}")
            setattr(holder, f"places{number}", range(number % 5))
        setattr(holder, f"number{number}", (1 << 3 * number % 60) + number if step > 1 else number + 1)
    return holder


@pytest.fixture(scope="module", params=TYPES)
def programs(request):
    """Decoder and encoder as they are compiled, and as the interpreter runs them."""
    type_, options = TYPES[request.param]
    return [
        (rj.Decoder.of(type_, **options, backend=backend), rj.Encoder.of(type_, **options, backend=backend))
        for backend in ("llvm", "interpreter")
    ]


@pytest.mark.parametrize("step", [1, 3, 20])
def test_messages_mean_the_same(programs, step):
    (decode, encode), (reference, written) = programs
    message = bytes(encode(filled(encode.new(), step)))
    assert message == bytes(written(filled(written.new(), step)))
    assert decode(message) == reference(message)
    assert bytes(encode(decode(message))) == message


def test_what_is_broken_is_told_in_the_same_words(programs):
    (decode, encode), (reference, _) = programs
    whole = bytes(encode(filled(encode.new(), 1)))
    broken = [whole[:size] for size in range(1, len(whole), 37)] + [whole.replace("é".encode(), b"\xff\xff", 1)]
    for message in broken:
        told = []
        for each in (decode, reference):
            try:
                told.append(each(message))
            except rj.DecodeError as error:
                told.append(str(error))
        assert told[0] == told[1]


def test_many_messages_at_once(programs):
    (decode, encode), _ = programs
    messages = [bytes(encode(filled(encode.new(), step))) for step in (1, 2, 5)]
    batch = decode.many(messages)
    for row, message in zip(batch, messages, strict=True):
        assert row == decode(message)


WITHIN = 44
"""Fields of a type that is within itself: with 24 of each kind it is not large enough to have series."""


def within_itself(count):
    """A type that is within itself by two of its fields, one of them in another message."""
    numbers = [f"  optional int64 number{number} = {number + 1};" for number in range(count)]
    texts = [f"  repeated string texts{number} = {number + 1 + count};" for number in range(count)]
    ends = ("  required int32 needed = 999;", "  optional All left = 1000;", "  optional Other other = 1001;")
    fields = "\n".join((*numbers, *texts, *ends))
    text = f'syntax = "proto2"; package a;\nmessage Other {{ optional All right = 1; }}\nmessage All {{\n{fields}\n}}'
    return "a.All", {"encoding": "protobuf", "schema": {"a.proto": text}}


def tree(holder, depth):
    """A holder whose messages within it differ from one another."""
    holder.needed = depth
    for number in range(depth, WITHIN, 7):
        setattr(holder, f"number{number}", (number + depth) ** (depth + 2))
        getattr(holder, f"texts{number}").extend([f"{number} at {depth}"] * (number % 3))
    if depth:
        tree(holder.left, depth - 1)
        tree(holder.other.right, depth - 1)
    return holder


def test_a_type_in_itself_in_two_ways_is_printed_once():
    """A lane may stand for the row itself in one way, and for what is within it in both."""
    type_, options = within_itself(WITHIN)
    (name, text), *_ = options["schema"].items()
    request = Request("encode", type=type_, files=((name, text),), encoding="protobuf")
    for made in Build(request).kernels:
        shared = [place.shared for _, place in twins.places(made, made.bodies[0], ())]
        largest = max(shared, key=lambda each: len(flat(each.series.body)))
        assert len(flat(largest.series.body)) > 3 * 120
        assert sum(each is largest for each in shared) == 2
    encode, reference = (rj.Encoder.of(type_, **options, backend=backend) for backend in ("llvm", "interpreter"))
    message = bytes(encode(tree(encode.new(), 3)))
    assert message == bytes(reference(tree(reference.new(), 3)))
    decode = rj.Decoder.of(type_, **options)
    assert bytes(encode(decode(message))) == message


@pytest.mark.parametrize("where", [(), ("left",), ("other", "right"), ("left", "other", "right"), ("other", "right", "left")])
def test_what_is_missing_in_it_is_told_in_the_same_words(where):
    type_, options = within_itself(WITHIN)
    told = []
    for backend in ("llvm", "interpreter"):
        encode = rj.Encoder.of(type_, **options, backend=backend)
        holder = tree(encode.new(), 2)
        reduce(getattr, where, holder).ClearField("needed")
        with pytest.raises(rj.EncodeError, match="required") as error:
            encode(holder)
        told.append(str(error.value))
    assert told[0] == told[1]


def with_parts(where):
    """A message type that is a field of several others, in a list and singly, and what asks for it."""
    numbers = " ".join(f"optional int64 number{number} = {number + 1};" for number in range(12))
    part = f"message Part {{ {numbers} repeated string texts = 20; required int32 needed = 21; }}"
    uses = " ".join(f"{label} Part {name} = {number};" for number, (label, name) in enumerate(where, 1))
    every = "message All { repeated Outer outer = 1; optional Outer other = 2; }"
    text = f'syntax = "proto2"; package a;\n{part}\nmessage Outer {{ {uses} }}\n{every}'
    return "a.All", {"encoding": "protobuf", "schema": {"a.proto": text}}


PARTS = (("optional", "left"), ("optional", "right"), ("optional", "middle"), ("repeated", "parts"), ("repeated", "more"))


def parted(holder):
    """A holder with parts of which each has other values."""
    for number in range(3):
        outer = holder.outer.add() if number else holder.other
        for at, part in enumerate((outer.left, outer.middle, outer.parts.add(), outer.parts.add(), outer.more.add())):
            part.needed = at
            part.number3, part.number11 = 300 * at + number, -at
            part.texts.extend([f"{number} {at}"] * at)
    return holder


def shared_blocks(direction, type_, options):
    (name, text), *_ = options["schema"].items()
    made = Build(Request(direction, type=type_, files=((name, text),), encoding="protobuf"))
    for each in made.kernels:
        places = [place for _, place in twins.places(each, each.bodies[0], ())]
        yield Counter(id(place.shared) for place in places)


def test_a_message_type_in_several_fields_is_printed_once():
    type_, options = with_parts(PARTS)
    for direction in ("decode", "encode"):
        for places in shared_blocks(direction, type_, options):
            assert max(places.values()) >= 2
    (decode, encode), (reference, written) = (
        [make.of(type_, **options, backend=backend) for make in (rj.Decoder, rj.Encoder)] for backend in ("llvm", "interpreter")
    )
    message = bytes(encode(parted(encode.new())))
    assert message == bytes(written(parted(written.new())))
    for size in range(0, len(message), 5):
        told = []
        for each in (decode, reference):
            try:
                told.append(each(message[:size]))
            except rj.DecodeError as error:
                told.append(str(error))
        assert told[0] == told[1]
    assert bytes(encode(decode(message))) == message


@pytest.mark.parametrize("direction", ["decode", "encode"])
def test_no_block_that_is_alike_looks_otherwise_at_first_sight(direction, monkeypatch):
    type_, options = with_parts(PARTS)
    found = [dict(each) for each in shared_blocks(direction, type_, options)]
    monkeypatch.setattr(twins, "_look", lambda stmt, _: type(stmt))
    anyway = [dict(each) for each in shared_blocks(direction, type_, options)]
    assert [sorted(each.values()) for each in found] == [sorted(each.values()) for each in anyway]


def test_lanes_of_shared_blocks_grow():
    type_, options = with_parts(PARTS)
    decode, encode = (make.of(type_, **options) for make in (rj.Decoder, rj.Encoder))
    made = parted(encode.new())
    for outer in made.outer:
        outer.more[0].texts.extend(f"text {number}" * 9 for number in range(500))
        outer.left.texts.extend(f"text {number}" for number in range(300))
    message = bytes(encode(made))
    assert decode(message) == made
    for row in decode.many([message, bytes(encode(parted(encode.new()))), message]):
        assert row.outer[0].left.needed == 0


def test_what_is_missing_in_a_shared_block_is_told_where_it_is():
    type_, options = with_parts(PARTS)
    decode, encode = (make.of(type_, **options) for make in (rj.Decoder, rj.Encoder))
    made = parted(encode.new())
    made.outer[1].parts[1].ClearField("needed")
    with pytest.raises(rj.EncodeError, match=r"outer\[1\]\.parts\[1\]"):
        encode(made)
    assert decode(bytes(encode(parted(encode.new())))) == parted(encode.new())


def test_two_large_messages_that_differ_are_no_series():
    """Their cases have the same kinds of statements, and other numbers within them."""
    messages = "".join(
        f"message {name} {{ {' '.join(f'{kind} f{number} = {number + 1};' for number in range(150))} }}\n"
        for name, kind in (("Whole", "int64"), ("Real", "double"))
    )
    text = f'syntax = "proto3"; package a;\n{messages}message Both {{ Whole whole = 1; Real real = 2; }}'
    decode, encode = (make.of("a.Both", encoding="protobuf", schema={"a.proto": text}) for make in (rj.Decoder, rj.Encoder))
    made = encode.new()
    made.whole.f149, made.real.f149 = 2**40, 0.5
    assert decode(encode(made)) == made


def kernel_of(name):
    type_, options = TYPES[name]
    files = tuple(options["schema"].items())
    request = Request("decode", type=type_, files=files, encoding=options["encoding"], framework=options.get("framework"))
    return Build(request).kernels[0]


def test_stretches_of_a_block_are_found():
    made = kernel_of("ros1")
    (body,) = made.bodies
    parts = found(made, body).parts(body)
    series = [each for each in parts if isinstance(each, Series)]
    assert len(series) == 2
    assert all(len(each.rows) >= COUNTS["ros1"] - 1 for each in series)  # the first string has another place
    assert len(parts) < 60
    assert all(len(each.carried) == 1 for each in series)


def test_cases_of_a_switch_are_found():
    made = kernel_of("protobuf")
    series = found(made, made.bodies[0])
    ((numbers, texts),) = series.switches.values()
    assert len(numbers.numbers) == COUNTS["protobuf"]
    assert len(texts.numbers) == COUNTS["protobuf"]


@pytest.mark.parametrize(("count", "words"), [(128, 0), (1000, 16)])
def test_cases_of_large_kernels_are_found_for_each_word_that_notes_what_is_there(count, words):
    """Of 64 optional fields each; few of them are quicker, each printed by itself."""
    fields = "\n".join(f"  optional int64 number{number} = {number + 1};" for number in range(count))
    options = {"encoding": "protobuf", "schema": {"a.proto": f'syntax = "proto2"; package a;\nmessage All {{\n{fields}\n}}'}}
    (made,) = Build(Request("decode", type="a.All", files=tuple(options["schema"].items()), encoding="protobuf")).kernels
    assert [len(cases.numbers) for each in found(made, made.bodies[0]).switches.values() for cases in each] == [64] * (words - 1) + [
        count % 64
    ] * (words > 0)
    values = {f"number{number}": number * 37 % 5000 for number in range(0, count, 3)}
    decoded = rj.Decoder.of("a.All", **options)(rj.Encoder.of("a.All", **options)(values))
    assert {name: getattr(decoded, name) for name in (f"number{number}" for number in range(count)) if decoded.has(name)} == values


@pytest.mark.parametrize(("count", "is_one"), [(100, False), (260, True)])
def test_branches_of_large_kernels_are_a_series(count, is_one):
    """LLVM takes more than twice as long for twice as many; few of them are quicker, each printed by itself."""
    members = "".join(f"  @optional long number{number};\n" for number in range(count))
    options = {"encoding": "cdr2", "schema": {"a.idl": f"struct All {{\n{members}}};\n"}}
    (made,) = Build(Request("decode", type="All", files=tuple(options["schema"].items()), encoding="cdr2")).kernels
    parts = found(made, made.bodies[0]).parts(made.bodies[0])
    assert [len(each.rows) >= count // 2 - 1 for each in parts if isinstance(each, Series)] == [True] * is_one
    values = {f"number{number}": number * 37 for number in range(0, count, 3)}
    assert rj.Decoder.of("All", **options)(rj.Encoder.of("All", **options)(values)).to_dict() == values


def repeated(*, last, inside=False):
    """A kernel that reads forty numbers in as many stretches; in the end it uses the name of one of them again, perhaps inside a branch."""
    one = Const("i64", 1)
    body = [Require(BEGIN, Const("i64", 8 * 40), failure(1))]
    for number in range(40):
        read, place = Local("i64", f"read{number}"), Place(1, Const("i64", number))
        body += [Reserve(1, one), Let(read.name, Load("i64", add(BEGIN, 8 * number))), Expect(Compare("ge", read, one), failure(2))]
        body += [*[SetField(place, read)] * 12, Advance(1, one)]
    use = SetField(Place(0, ROW), Local("i64", f"read{last}"))
    body += [If(Compare("eq", ROW, index(0)), (use,)) if inside else use, Return(END)]
    return kernel(tuple(body), strides=(8, 8), name="repeated")


@pytest.mark.parametrize("inside", [False, True])
@pytest.mark.parametrize(("last", "count"), [(39, 1), (7, 0)])
def test_names_that_others_use_belong_to_no_series(last, count, inside):
    made = repeated(last=last, inside=inside)
    assert sum(isinstance(each, Series) for each in found(made, made.bodies[0]).parts(made.bodies[0])) == count


AROUND, INSIDE = 20, 32


def nested():
    """Loops of one round that are alike but for the field that they set, each around copies that are alike but for row and source."""
    body = [
        Expect(Compare("lt", ROW, Capacity(0)), failure(2)),
        Require(BEGIN, index(8 * INSIDE), failure(1)),
        Reserve(1, index(INSIDE)),
        Advance(1, index(INSIDE)),
    ]
    sources = [(number, add(BEGIN, 8 + number * number % 31)) for number in range(INSIDE)]
    for outer in range(AROUND):
        moves = (Copy(Place(1, index(number), 8 * outer), Wire(source), index(8)) for number, source in sources)
        body.append(For(f"round{outer}", Const("i64", 1), tuple(moves)))
    return kernel((*body, Return(END)), strides=(8, 8 * AROUND), name="nested")


@pytest.mark.parametrize("name", ["llvm", "numba"])
def test_series_within_series_use_their_own_numbers(name):
    made = nested()
    verify(made)
    series = found(made, made.bodies[0])
    assert sum(isinstance(part, Series) for parts in series.blocks.values() for part in parts) > 1, "some stand within others"
    message = bytes(number % 251 for number in range(8 * INSIDE))
    assert outcome(name, made, message, rows(made)) == outcome("interpreter", made, message, rows(made))
