"""State in generated source: what C, C++, Python and Lisp keep from one message to the next is what the library keeps."""

from __future__ import annotations

import sys
import types

import pytest

import rosetta_jit as rj
from rosetta_jit.api.options import request_of
from rosetta_jit.generate.build import generated
from tests.generate import cpp, lisp
from tests.generate.cpp import needs_cpp
from tests.generate.driver import answers, compiled, driver, expected, harmed, needs_gcc, write
from tests.generate.lisp import needs_sbcl
from tests.generate.python import answer, source_of

FILES = {
    "m.bottle-schema": '"m" (("position" :double) ("seq" :int64) ("good" :bool))',
    "m.proto": """syntax = "proto2"; package lab;
message M {
  required double speed = 1; required int64 seen = 2; required bool good = 3; required float smooth = 4; required bool odd = 5;
}""",
    "m.mapping": """import "m.bottle-schema"
import "m.proto"
state last: float64 = -0.5
state smooth: float32 = 0.25
state seen: int32 = -9
state least: int64 = -9223372036854775808
state odd: bool = true
data-holder: lab.M
wire-schema: m
unpack-rules:
  reject "not again" when .seq == least
  .speed = .position - last
  .smooth = smooth
  .seen = seen
  .good = .good
  .odd = odd
  state last = .position
  state smooth = float32(smooth / 2 + float32(.position))
  state least = .seq
  state odd = not odd
  when .good
    state seen = int32(seen + 1)
  end
pack-rules:
  ignore .smooth
  .position = .speed + last
  .seq = .seen + least / 2
  .good = .good == odd
  reject "odd" when .odd and seen > 5
  state last = .speed
  state least = .seen
  state seen = int32(seen + 1, wrap)
  state odd = .odd
""",
}
REQUEST = request_of("decode", {"encoding": "yarp4", "schema": FILES}, mapping="m.mapping")
BOTH = ("decode", "encode")


def programs():
    options = {"schema": FILES, "encoding": "yarp4"}
    return rj.Decoder("m.mapping", **options), rj.Encoder("m.mapping", **options)


def messages():
    """Good ones among broken ones, of which none may leave a trace."""
    write_ = rj.Encoder.of("m", schema=FILES, imports=["m.bottle-schema"], encoding="yarp4")
    values = [(0.5, 3, True), (-1.25, 3, True), (2.0, 4, False), (1e300, -(2**63), True), (float("inf"), 2**63 - 1, True), (0.0, 0, False)]
    good = [write_(write_.holder_type.from_dict({"position": at, "seq": seq, "good": is_good})) for at, seq, is_good in values]
    broken = harmed(good, 6, "state")
    return [each for pair in zip(broken, good * len(broken), strict=False) for each in pair]


def wanted(every):
    decode, encode = programs()
    found = [expected(decode, encode, each) for each in every]
    kinds = {line.split()[0] for line in found}
    assert kinds >= {"ok", "truncated", "rejected"}
    return found


@needs_gcc
@pytest.mark.parametrize("options", [("-O2",), ("-O1", "-fsanitize=undefined,address")])
def test_c_keeps_what_the_library_keeps(tmp_path, options):
    name = write(tmp_path, generated(REQUEST, "c", BOTH, "unit"))
    compiled("gcc", tmp_path, name, "-O2")
    every = messages()
    assert answers(driver(tmp_path, name, options=options), every) == wanted(every)


@needs_cpp
def test_cpp_keeps_what_the_library_keeps(tmp_path):
    name = cpp.write(tmp_path, generated(REQUEST, "cpp", BOTH, "unit"))
    every = messages()
    assert answers(cpp.program(tmp_path, name, main=cpp.encoding_once(tmp_path)), every) == wanted(every)


def test_python_keeps_what_the_library_keeps(monkeypatch):
    made = types.ModuleType("generated_unit")
    monkeypatch.setitem(sys.modules, made.__name__, made)
    exec(compile(source_of(REQUEST), "unit.py", "exec"), made.__dict__)  # noqa: S102 - what is under test
    every = messages()
    for _ in range(2):
        assert [answer(made, each) for each in every] == wanted(every)
        made.reset()


@needs_sbcl
def test_lisp_keeps_what_the_library_keeps(tmp_path):
    """The system's own codec keeps the state, if no other is given: what another has, or `reset` forgets, is as it is at first."""
    every = messages()
    (found,) = lisp.answers(tmp_path, [(REQUEST, every)], lisp.QUICKLY)
    assert [" ".join(line.split()[:2]) if line.startswith("ok ") else line for line in found] == wanted(every)
    octets = f"(coerce '({' '.join(map(str, every[1]))}) 'unit-0:octets)"
    forms = (
        "(require :asdf)",
        '(asdf:load-asd (truename "unit-0.asd"))',
        '(let ((*standard-output* *error-output*)) (asdf:load-system "unit-0"))',
        f"""(flet ((speed (codec) (unit-0:m-speed (unit-0:decode {octets} :codec codec))))
              (let ((codec (unit-0:make-codec)))
                (format t "~{{~A~%~}}" (list (speed unit-0:*codec*) (speed codec)
                                          (unit-0:message-error-kind (nth-value 1 (ignore-errors (speed codec))))
                                          (progn (unit-0:reset codec) (speed codec))))))""",
    )
    assert lisp.run(*forms, cwd=tmp_path).split() == ["1.0d0", "1.0d0", "REJECTED", "1.0d0"]
