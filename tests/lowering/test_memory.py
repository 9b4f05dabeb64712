"""Messages that ask for more than they hold: a mapping may take a length from a number, and the number may be any."""

from __future__ import annotations

import numpy as np
import pytest

import rosetta_jit as rj

FILES = {
    "t/In.msg": "int64 n\n",
    "t/Out.msg": "float64[] a\n",
    "m.mapping": """import "t/In.msg"
import "t/Out.msg"
data-holder: t/Out
wire-schema: t/In
unpack-rules:
  len(.a) = .n
  for i from 0 to .n
    .a[i] = 1.0
  end
""",
}
PACK = FILES["m.mapping"].replace("t/Out\nwire", "t/In\nwire").replace("wire-schema: t/In", "wire-schema: t/Out").replace("unpack", "pack")
TOO_MANY = [2**45, 2**56, 2**62, 2**63 - 1]


@pytest.mark.parametrize("backend", ["llvm", "python", "interpreter"])
@pytest.mark.parametrize("count", [2**26, *TOO_MANY])
def test_more_elements_than_there_is_memory_for(count, backend):
    decode = rj.Decoder("m.mapping", schema=FILES, encoding="ros1", backend=backend)
    write = rj.Encoder.of("t/In", schema=FILES, imports=["t/In.msg"], encoding="ros1", backend="interpreter")
    messages = [write(write.holder_type.from_dict({"n": n})) for n in (2, count)]
    with pytest.raises(rj.DecodeError) as error:
        decode(messages[1])
    assert error.value.kind == "count"
    with pytest.raises(rj.DecodeError) as error:
        decode.many(b"".join(messages), np.array([0, 8, 16]))
    assert error.value.kind == "count"
    assert decode(messages[0]).to_dict() == {"a": [1.0, 1.0]}


@pytest.mark.parametrize("backend", ["llvm", "python"])
@pytest.mark.parametrize("count", TOO_MANY)
def test_a_message_larger_than_memory(count, backend):
    encode = rj.Encoder("m.mapping", schema={**FILES, "m.mapping": PACK}, encoding="ros1", backend=backend)
    with pytest.raises(rj.EncodeError) as error:
        encode(encode.holder_type.from_dict({"n": count}))
    assert (error.value.kind, error.value.path) == ("range", ".a")  # its count has 32 bits
    assert len(encode(encode.holder_type.from_dict({"n": 2}))) == 4 + 16


def test_a_byte_order_mark_before_a_mapping():
    decode = rj.Decoder("m.mapping", schema={**FILES, "m.mapping": "\ufeff" + FILES["m.mapping"]}, encoding="ros1", backend="interpreter")
    assert decode((3).to_bytes(8, "little")).to_dict() == {"a": [1.0] * 3}
