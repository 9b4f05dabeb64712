"""A message whose fields have many types, each of which contains itself."""

from __future__ import annotations

import rosetta_jit as rj


def test_many_types_that_contain_themselves():
    """Each has two lanes, whose rows are looked at together."""
    types = "".join(f"message T{each} {{ int32 x = 1; repeated T{each} n = 2; }}\n" for each in range(60))
    fields = " ".join(f"T{each} f{each} = {each + 1};" for each in range(60))
    options = {
        "encoding": "protobuf",
        "backend": "python",
        "schema": {"t.proto": f'syntax = "proto3"; package t;\n{types}message M {{ {fields} }}\n'},
    }
    decode, encode = rj.Decoder.of("t.M", **options), rj.Encoder.of("t.M", **options)
    values = {f"f{each}": {"x": each, "n": [{"x": 1, "n": []}, {"x": 2, "n": [{"x": each, "n": []}]}]} for each in (0, 31, 59)}
    message = encode(encode.holder_type.from_dict(values))
    found = decode(message)
    assert [found.f59.n[1].n[0].x, found.f31.n[0].x, found.f1.x] == [59, 1, 0]
    assert encode(found) == message
