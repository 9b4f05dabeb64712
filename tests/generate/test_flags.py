"""Arrays of bools, of which generated C++ reads many at once: of any length, and with a byte that is neither 0 nor 1 at any place."""

from __future__ import annotations

import pytest

import rosetta_jit as rj
from rosetta_jit.api.options import type_request
from rosetta_jit.generate.build import generated
from tests.generate import cpp
from tests.generate.driver import answers, harmed
from tests.generate.test_cpp import BOTH, CAREFUL, same

SCHEMA = {"rj/msg/Message.msg": f"bool[] flags\nRow[] rows\nuint8 last\n{'=' * 80}\nMSG: rj/Row\nbool[] flags\nint16 number\n"}
COUNTS = (0, 1, 7, 8, 9, 15, 31, 32, 33, 40, 71)


@cpp.needs_cpp
@pytest.mark.parametrize("encoding", ["ros1", "cdr"])
def test_flags_come_out_the_same(encoding, tmp_path):
    options = {"encoding": encoding, "schema": SCHEMA}
    texts = generated(type_request("decode", "rj/Message", options), "cpp", BOTH, "unit")
    assert all(texts["unit.cpp"].count(f"rosetta_jit::detail::{each}_flags(") >= 2 for each in ("read", "copy"))
    encode = rj.Encoder.of("rj/Message", **options)
    flags = {count: [each % 3 == 0 for each in range(count)] for count in COUNTS}
    values = [{"flags": each, "rows": [{"flags": flags[9], "number": count}] * (count % 3), "last": 7} for count, each in flags.items()]
    good = [bytes(encode(each)) for each in values]
    messages = [message[:end] for message in good for end in range(len(message) + 1)]
    messages += [message[:at] + b"\2" + message[at + 1 :] for message in good for at in range(len(message))]
    messages += [each for message in good for each in harmed([message], 5, encoding)]
    name = cpp.write(tmp_path, texts)
    same(answers(cpp.program(tmp_path, name, options=CAREFUL), messages), rj.Decoder.of("rj/Message", **options), encode, messages)
