"""Whatever a text or file holds, a schema, a program or a RosettaError comes out, and soon: random mutations of the tree's own texts."""

from __future__ import annotations

import random
import struct
import time
from contextlib import suppress
from importlib.util import find_spec
from typing import TYPE_CHECKING

import pytest

import rosetta_jit as rj
from rosetta_jit.cli import main
from rosetta_jit.frameworks.installed import Readers, installed
from rosetta_jit.frameworks.protobuf.descriptors import from_file_descriptor_set
from rosetta_jit.frameworks.protobuf.proto import syntax
from rosetta_jit.frameworks.yarp.bottle_schema import sexpr
from rosetta_jit.language.check.mapping import check
from rosetta_jit.language.parse import templates
from rosetta_jit.language.parse.mapping import parse as parse_mapping
from rosetta_jit.model.types import Struct
from rosetta_jit.parsing.search import Reading, SearchPath
from rosetta_jit.recording import read_messages
from tests.parsing.mutations import Derivation, corpus, mutated, mutated_bytes

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

SECONDS = 30
"""Of the processor, for one text; most take milliseconds."""
ROUNDS, CAMPAIGN = 25, 20_000
SLOW = {".hpp": 5}
"""Rounds where each text is another program's work."""
COMPILED = 8
"""One text in so many becomes a program."""
SUFFIXES = {
    ".msg": ("ros1", "p/A.msg", "ros1"),
    ".srv": ("ros2", "p/srv/A.srv", "cdr"),
    ".action": ("ros2", "p/action/A.action", "cdr"),
    ".idl": ("corba", "A.idl", "cdr-giop"),
    ".proto": ("protobuf", "a.proto", "protobuf"),
    ".lcm": ("lcm", "A.lcm", "lcm"),
    ".thrift": ("yarp", "A.thrift", "yarp4"),
    ".bottle-schema": ("yarp", "A.bottle-schema", "yarp4"),
    ".hpp": ("orocos", "A.hpp", None),
    ".tlb": ("orocos", "A.tlb", None),
}
GRAMMARS = {
    ".mapping": (templates.GRAMMAR, "start"),
    ".proto": (syntax.GRAMMAR, syntax.START),
    ".bottle-schema": (sexpr.GRAMMAR, "start"),
}


def bounded(make: Callable[[], object], shown: object) -> None:
    """Run what may raise a RosettaError and nothing else."""
    start = time.process_time()
    try:
        with suppress(rj.RosettaError):
            make()
    except BaseException as error:
        raise AssertionError(f"{type(error).__name__} of {shown!r:.3000}") from error
    assert time.process_time() - start < SECONDS, f"{shown!r:.3000}"


def read(suffix: str, text: str, random_: random.Random) -> None:
    """Parse a text; of some, make a program of one of its types."""
    framework, name, encoding = SUFFIXES[suffix]
    search, reading = SearchPath.of(files={name: text}), Reading()
    source = search.find(name)
    assert source is not None
    schema = installed()[framework].front_end(name)(source, search.loader(reading, source))
    structs = [each for each, declared in schema.types.items() if isinstance(declared, Struct)]
    if structs and not random_.randrange(COMPILED):
        options = {"schema": {name: text}, "framework": framework, "encoding": encoding}
        program = random_.choice([rj.Decoder, rj.Encoder])
        program.of(random_.choice(structs), backend=random_.choice(["interpreter", "interpreter", "llvm"]), **options)


def rule(text: str, random_: random.Random) -> None:
    """Check a mapping; of some, make a program."""
    search = SearchPath.of(files={"m.mapping": text})
    if random_.randrange(COMPILED):
        check(parse_mapping(search.open("m.mapping")), Readers(installed()), search)
    else:
        random_.choice([rj.Decoder, rj.Encoder])("m.mapping", schema={"m.mapping": text}, backend="interpreter")


def test_lists_of_nothing():
    """A rule that matches nothing has no token to stand at."""
    text = "extend . enum { optional map < . group , group > option = 0f [ extend = { } , edition = { } ] ; }"
    one(".proto", text, random.Random(0))


def test_digits_that_are_no_number():
    """A run of digits is looked at once, not once for each place where it could end."""
    start = time.process_time()
    with pytest.raises(rj.SchemaError):
        rj.Decoder.of("A", schema={"A.bottle-schema": '"A" (("a" ' + ("9" * 100_000 + ":") * 10 + "))"})
    assert time.process_time() - start < SECONDS


def one(suffix: str, text: str, random_: random.Random) -> None:
    make = (lambda: rule(text, random_)) if suffix == ".mapping" else (lambda: read(suffix, text, random_))
    bounded(make, text)


def usable(suffix: str) -> None:
    if suffix == ".hpp" and find_spec("clang") is None:
        pytest.skip("needs libclang")


def mutate_tokens(suffix: str, rounds: int, seed: int) -> None:
    usable(suffix)
    random_ = random.Random(seed)
    for _ in range(rounds):
        one(suffix, mutated(suffix, random_), random_)


def derive(suffix: str, rounds: int, seed: int) -> None:
    grammar, start = GRAMMARS[suffix]
    random_, derivation = random.Random(seed), Derivation(grammar, suffix, start)
    for _ in range(rounds):
        one(suffix, derivation.text(random_, random_.choice([20, 100, 400])), random_)


def mutate_files(suffix: str, rounds: int, seed: int, folder: Path) -> None:
    """Bytes of a file, which need be no text."""
    usable(suffix)
    random_ = random.Random(seed)
    name = "m.mapping" if suffix == ".mapping" else SUFFIXES[suffix][1]
    path = folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    for _ in range(rounds):
        data = mutated_bytes(random_.choice(corpus(suffix)).encode(), random_)
        path.write_bytes(data)
        if suffix == ".mapping":
            bounded(lambda: rj.check(str(path)), data)
        else:
            options = {"framework": SUFFIXES[suffix][0], "imports": [name], "search_path": [folder], "backend": "interpreter"}
            bounded(lambda options=options: rj.Decoder.of("p/A", **options), data)


def mutate_descriptors(rounds: int, seed: int) -> None:
    from google.protobuf import any_pb2, api_pb2, descriptor_pb2, struct_pb2

    random_ = random.Random(seed)
    files = [module.DESCRIPTOR for module in (any_pb2, struct_pb2, descriptor_pb2, api_pb2)]
    sets = [
        descriptor_pb2.FileDescriptorSet(file=[descriptor_pb2.FileDescriptorProto.FromString(file.serialized_pb)]) for file in files[:3]
    ]
    for _ in range(rounds):
        data = mutated_bytes(random_.choice(sets).SerializeToString(), random_)
        bounded(lambda data=data: from_file_descriptor_set(data), data)
        name = random_.choice(["google.protobuf.Any", "google.protobuf.Value", "google.protobuf.FieldOptions"])
        if not random_.randrange(COMPILED):
            bounded(lambda data=data, name=name: rj.Decoder.of(name, schema=data, backend="interpreter"), data)


BOTTLE = struct.pack("<ii3d", 266, 3, 10.0, -20.0, 30.0)
LIST = struct.pack("<iiiiii", 256, 2, 1, 7, 5, 2) + b"ab"


def mutate_messages(rounds: int, seed: int, folder: Path) -> None:
    """Messages to draft a schema from, and recordings."""
    random_ = random.Random(seed)
    recording = folder / "a.rec"
    for _ in range(rounds):
        messages = [mutated_bytes(random_.choice([BOTTLE, LIST]), random_) for _ in range(random_.randrange(1, 4))]
        for encoding in ("yarp", "yarp2012", "yarp3", "yarp4"):
            bounded(lambda messages=messages, encoding=encoding: rj.infer(messages, name="a", encoding=encoding), messages)
        whole = b"".join(struct.pack("<dI", 0.0, len(each)) + each for each in messages)
        recording.write_bytes(mutated_bytes(whole, random_))
        bounded(lambda: list(read_messages(recording)), whole)


WORDS = [
    "check",
    "explain",
    "operations",
    "decode",
    "encode",
    "dump",
    "infer",
    "frameworks",
    "cache",
    "info",
    "compile",
    "--json",
    "--strict",
]
WORDS += [
    "yarp/icub/torso_state.mapping",
    "none.mapping",
    "/dev/null",
    ".",
    "",
    "a.rec",
    "--encoding",
    "yarp4",
    "cdr",
    "--parameter",
    "a=1",
]
WORDS += [
    "a=[",
    "=",
    "--stage",
    "model",
    "kernel",
    "--direction",
    "encode",
    "--features",
    "--name",
    "\ud800",
    "x" * 5_000,
    "--output",
    "-o",
    "-",
]


def command_lines(rounds: int, seed: int, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """0, 1 or 2, and never a traceback."""
    random_ = random.Random(seed)
    monkeypatch.chdir(folder)
    for number in range(rounds):
        arguments = [random_.choice(WORDS[:8]), *random_.choices(WORDS, k=random_.randrange(1, 6))]
        (folder / "a.rec").write_bytes(mutated_bytes(struct.pack("<dI", 0.0, 32) + BOTTLE, random_))
        try:
            code = main(arguments)
        except SystemExit as left:
            code = left.code
        assert code in (0, 1, 2), (number, arguments)


@pytest.mark.parametrize("suffix", [*SUFFIXES, ".mapping"])
def test_changed_tokens(suffix):
    mutate_tokens(suffix, SLOW.get(suffix, ROUNDS), 1)


@pytest.mark.parametrize("suffix", GRAMMARS)
def test_texts_of_a_grammar(suffix):
    derive(suffix, ROUNDS, 2)


@pytest.mark.parametrize("suffix", [*SUFFIXES, ".mapping"])
def test_changed_files(suffix, tmp_path):
    mutate_files(suffix, SLOW.get(suffix, ROUNDS), 3, tmp_path)


def test_changed_descriptors():
    mutate_descriptors(ROUNDS, 4)


def test_changed_messages(tmp_path):
    mutate_messages(ROUNDS, 5, tmp_path)


def test_command_lines(tmp_path, monkeypatch, capsys):
    command_lines(ROUNDS, 6, tmp_path, monkeypatch)


@pytest.mark.campaign
@pytest.mark.parametrize("seed", range(10))
@pytest.mark.parametrize("suffix", [*SUFFIXES, ".mapping"])
def test_many_texts(suffix, seed, tmp_path):
    mutate_tokens(suffix, CAMPAIGN // 10, 100 + seed)
    mutate_files(suffix, CAMPAIGN // 10, 200 + seed, tmp_path)
    if suffix in GRAMMARS:
        derive(suffix, CAMPAIGN // 10, 300 + seed)


@pytest.mark.campaign
def test_many_others(tmp_path, monkeypatch, capsys):
    mutate_descriptors(CAMPAIGN, 400)
    mutate_messages(CAMPAIGN, 500, tmp_path)
    command_lines(CAMPAIGN // 20, 600, tmp_path, monkeypatch)
