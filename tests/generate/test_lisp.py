"""Generated Lisp does what the library does."""

from __future__ import annotations

import pytest

import rosetta_jit as rj
from tests.generate import lisp
from tests.generate.corpora import corpora
from tests.generate.driver import harmed
from tests.generate.test_c import SUBJECTS

FEW = ("lcm exlcm.example_t", "corba RTC::TimedWChar little", "protobuf rj.OneOf", "protobuf rj.Tree")


def compare(found: list[str], wanted: list[str], messages: list[bytes]) -> None:
    """All lines are the same; which lane of a message that asks for too much is found first may differ."""
    for line, right, message in zip(found, wanted, messages, strict=True):
        if "memory than its size allows" in line:
            line, right = line.split("[")[0].split()[0], right.split("[")[0].split()[0]  # noqa: PLW2901 - the same lines, shorter
        assert line == right, message.hex()


def subject(name):
    request, good = SUBJECTS[name]
    of = (rj.Decoder, rj.Encoder) if request.mapping else (rj.Decoder.of, rj.Encoder.of)
    programs = [make(request.mapping or request.type, encoding=request.encoding) for make in of]
    return request, programs, harmed(good, 12, name)


@lisp.needs_sbcl
def test_lisp_answers_as_the_library_does(tmp_path):
    """Values, bytes, and what is wrong with messages that are broken: of a mapping, of types, and of peers' messages."""
    asked = [subject(name) for name in SUBJECTS]
    asked += [
        (each.request, each.programs(), harmed(list(each.messages[:4]), 4, each.name)) for each in corpora() if each.name in FEW
    ]
    found = lisp.answers(tmp_path, [(request, messages) for request, _, messages in asked])
    for lines, (request, programs, messages) in zip(found, asked, strict=True):
        compare(lines, lisp.expected(request, *programs, messages), messages)


@pytest.mark.campaign
@lisp.needs_sbcl
@pytest.mark.parametrize("framework", sorted({each.framework for each in corpora()}))
def test_all_messages_of_peers(framework, tmp_path):
    chosen = [each for each in corpora() if each.framework == framework]
    messages = [harmed(list(each.messages), 4, each.name) for each in chosen]
    found = lisp.answers(tmp_path, [(each.request, some) for each, some in zip(chosen, messages, strict=True)])
    for lines, each, some in zip(found, chosen, messages, strict=True):
        compare(lines, lisp.expected(each.request, *each.programs(), some), some)
