"""Maps that two IDLs spell differently are copied entry by entry, and said to be of what they are."""

from __future__ import annotations

import pytest

import rosetta_jit as rj

BACKENDS = ["llvm", "python", "interpreter"]
FILES = {
    "w.bottle-schema": '"w" (("options" (:dict :double)) ("inner" (:bottle ("more" (:dict :string)))))',
    "h.proto": """syntax = "proto3";
message H { map<string, double> options = 1; message Inner { map<string, string> more = 1; } Inner inner = 2; }""",
    "t/Entries.msg": "t/Entry[] options\n",
    "t/Entry.msg": "string key\nfloat64 value\n",
}


def texts(wire, rules):
    imports = 'import "w.bottle-schema"\n' if wire == "w" else 'import "t/Entries.msg"\nimport "t/Entry.msg"\n'
    return {**FILES, "m.mapping": f'{imports}import "h.proto"\ndata-holder: H\nwire-schema: {wire}\n{rules}'}


@pytest.mark.parametrize("backend", BACKENDS)
def test_maps_of_two_frameworks(backend):
    files = texts("w", "rules:\n  .options <-> .options\n  .inner.more <-> .inner.more\n")
    options = {"schema": files, "encoding": "yarp4", "backend": backend}
    decode, encode = rj.Decoder("m.mapping", **options), rj.Encoder("m.mapping", **options)
    for held in ({"options": {"a": 0.5, "b": -1.0}, "inner": {"more": {"x": "y"}}}, {"options": {}, "inner": {"more": {}}}):
        assert decode(encode(encode.holder_type.from_dict(held))).to_dict() == held


def test_maps_and_arrays_of_entries():
    with pytest.raises(rj.MappingError, match="a map of text to float64 cannot become an array of t/Entry") as error:
        rj.Encoder("m.mapping", schema=texts("t/Entries", "pack-rules:\n  .options = .options\n  ignore .inner\n"), encoding="ros1")
    assert "`.a[].key = .b[].key`" in str(error.value)
    suggested = "pack-rules:\n  .options[].key = .options[].key\n  .options[].value = .options[].value\n  ignore .inner\n"
    encode = rj.Encoder("m.mapping", schema=texts("t/Entries", suggested), encoding="ros1", backend="interpreter")
    read = rj.Decoder.of("t/Entries", schema=FILES, imports=["t/Entries.msg"], encoding="ros1", backend="interpreter")
    data = encode(encode.holder_type.from_dict({"options": {"a": 0.5}, "inner": {"more": {}}}))
    assert read(data).to_dict() == {"options": [{"key": "a", "value": 0.5}]}


def test_an_import_of_what_is_within_is_used():
    rules = "pack-rules:\n  .options[].key = .options[].key\n  .options[].value = .options[].value\n  ignore .inner\n"
    encode = rj.Encoder("m.mapping", schema=texts("t/Entries", rules), encoding="ros1", backend="interpreter")
    assert not encode.mapping.warnings
