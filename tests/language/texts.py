"""Expressions of texts in every backend: from a bottle to a message, and from a message to a bottle."""

from __future__ import annotations

import rosetta_jit as rj

BACKENDS = ["llvm", "python", "interpreter"]
SCHEMAS = {
    "w.bottle-schema": '"w" (("s" :string) ("t" :string) ("b" :blob) ("i" :int64) ("j" :int64) ("x" :double) ("f" :float32))',
    "h.proto": """syntax = "proto2";
message H { required string s = 1; required bytes b = 2; required int64 n = 3; required double x = 4; required bool ok = 5; }""",
}
HEAD = 'import "w.bottle-schema"\nimport "h.proto"\ndata-holder: H\nwire-schema: w\n'
DEFAULTS = {"s": '""', "b": '""', "n": "0", "x": "0", "ok": "true"}
WIRE = {"s": "", "t": "", "b": b"", "i": 0, "j": 0, "x": 0.0, "f": 0.0}


def decoder(rules, backend, encoding="yarp3"):
    """``run(s=…, t=…)``: the message that rules for some of its fields make of a bottle."""
    lines = {**DEFAULTS, **rules}
    text = HEAD + "unpack-rules:\n" + "".join(f"  .{name} = {value}\n" for name, value in lines.items())
    schema = {**SCHEMAS, "m.mapping": text}
    decode = rj.Decoder("m.mapping", schema=schema, encoding=encoding, backend=backend)
    write = rj.Encoder.of("w", schema=SCHEMAS, imports=["w.bottle-schema"], encoding="yarp3", backend="interpreter")

    def run(**values):
        return decode(write(write.holder_type.from_dict({**WIRE, **values}))).to_dict()

    return run


def encoder(rules, backend):
    """``run(s=…, b=…)``: the bottle that rules make of a message."""
    lines = {"s": '""', "t": '""', "b": '""', "i": "0", "j": "0", "x": "0", "f": "0", **rules}
    text = HEAD + "pack-rules:\n" + "".join(f"  .{name} = {value}\n" for name, value in lines.items())
    encode = rj.Encoder("m.mapping", schema={**SCHEMAS, "m.mapping": text}, encoding="yarp3", backend=backend)
    read = rj.Decoder.of("w", schema=SCHEMAS, imports=["w.bottle-schema"], encoding="yarp3", backend="interpreter")

    def run(**values):
        given = {"s": "", "b": b"", "n": 0, "x": 0.0, "ok": True, **values}
        return read(encode(encode.holder_type.from_dict(given))).to_dict()

    return run
