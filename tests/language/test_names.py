"""Fields called as the words of the language, and as the variables of kernels."""

from __future__ import annotations

import pytest

import rosetta_jit as rj

WORDS = ["begin", "end", "row", "position", "message", "for", "when", "list", "names", "of", "len", "to", "rules", "true", "not"]


@pytest.mark.parametrize("backend", ["llvm", "python", "interpreter"])
def test_fields_have_any_names(backend):
    wire = " ".join(f'("{name}" :int)' for name in WORDS)
    holder = " ".join(f"required int32 {name} = {number};" for number, name in enumerate(WORDS, 1))
    files = {
        "w.bottle-schema": f'"w" ({wire})',
        "h.proto": f'syntax = "proto2"; message H {{ {holder} }}',
        "m.mapping": 'import "w.bottle-schema"\nimport "h.proto"\ndata-holder: H\nwire-schema: w\nrules:\n'
        + "".join(f"  .{name} <-> int32(1 - .{name})\n" for name in WORDS),
    }
    decode = rj.Decoder("m.mapping", schema=files, encoding="yarp4", backend=backend)
    encode = rj.Encoder("m.mapping", schema=files, encoding="yarp4", backend=backend)
    write = rj.Encoder.of("w", schema=files, imports=["w.bottle-schema"], encoding="yarp4", backend=backend)
    message = write(write.holder_type.from_dict({name: number for number, name in enumerate(WORDS)}))
    assert decode(message).to_dict() == {name: 1 - number for number, name in enumerate(WORDS)}
    assert encode(decode(message)) == message
