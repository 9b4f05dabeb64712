"""Texts in units of 16 bits (`wstring` of OMG IDL): assigned as a whole, unit by unit, in place and staged."""

from __future__ import annotations

import pytest

import rosetta_jit as rj

WIRE = "module a { struct W { wstring name; sequence<wstring> names; string narrow; }; };"
FILES = {"a.idl": WIRE, "b.idl": WIRE.replace("module a", "module b").replace("struct W", "struct V")}
HEAD = 'import "a.idl" import "b.idl" data-holder: b::V wire-schema: a::W\n'
TEXTS = ["", "wheel", "Räder ♥", "\U0001f916"]


def made(kind, rules, **options):
    return kind("m.mapping", schema={**FILES, "m.mapping": HEAD + rules}, **options)


@pytest.mark.parametrize("rules", [".name <-> .name ignore rest default rest", ".name <-> .name .names <-> .names .narrow <-> .narrow"])
@pytest.mark.parametrize(("encoding", "order"), [("cdr", "little"), ("cdr", "big"), ("cdr-giop", None)])
def test_as_a_whole(encoding, order, rules):
    options = {"encoding": encoding, "byte_order": order, "backend": "interpreter"}
    decode, encode = (made(kind, f"rules: {rules}", **options) for kind in (rj.Decoder, rj.Encoder))
    write = rj.Encoder.of("a::W", schema=FILES, imports=["a.idl"], **options)
    for name in TEXTS:
        values = {"name": name, "names": [name, "x"] if ".names" in rules else [], "narrow": "n" if ".narrow" in rules else ""}
        message = write(write.holder_type.from_dict(values))
        assert decode(message).to_dict() == values
        assert encode(decode(message)) == message


@pytest.mark.parametrize("encoding", ["cdr", "cdr-giop"])
def test_written_down(encoding):
    rules = 'pack-rules: .narrow = .narrow .name = "Räder ♥" ignore rest default rest'
    encode = made(rj.Encoder, rules, encoding=encoding, backend="interpreter")
    read = rj.Decoder.of("a::W", schema=FILES, imports=["a.idl"], encoding=encoding, backend="interpreter")
    assert read(encode(encode.holder_type.from_dict({"narrow": "n"}))).to_dict() == {"name": "Räder ♥", "names": [], "narrow": "n"}


@pytest.mark.parametrize(
    ("rule", "said"),
    [
        (".name = .narrow", "text cannot become text of 16-bit units"),
        (".narrow = .name", "text of 16-bit units cannot become text"),
        ('.narrow = "a" if .name == "b" else "c"', "does not compare text of 16-bit units with text"),
    ],
)
def test_other_texts_are_refused(rule, said):
    with pytest.raises(rj.MappingError, match=said):
        made(rj.Decoder, f"unpack-rules: {rule} ignore rest default rest", encoding="cdr")
