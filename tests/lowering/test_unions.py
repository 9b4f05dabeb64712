"""Rules for the cases of unions, with a discriminator (OMG IDL) and without (protobuf's oneof)."""

from __future__ import annotations

from typing import Any

import pytest

import rosetta_jit as rj

BACKENDS = ["numba", "python", "interpreter"]
IDL = """module m {
  struct Point { long x; long y; };
  union Un switch (long) { case 1: octet a; case 2: case 5: double n; case 7: Point p; default: string s; };
  @final struct One { Un u; };
  @final struct Many { sequence<Un> us; };
  @final struct Flat { long x; long y; };
};"""
PROTO = 'syntax = "proto3"; package p; message One { oneof kind { int32 a = 1; string s = 2; } }'


def files(rules: str, block: str = "unpack", union: str = "m::One") -> dict[str, str]:
    """Rules that set a message with a union, from a flat one."""
    holder, wire = (union, "m::Flat") if block == "unpack" else ("m::Flat", union)
    imports = "".join(f'import "{name}"\n' for name in ("m.idl", "p.proto") if name[0] in (holder[0], wire[0]))
    return {
        "m.idl": IDL,
        "p.proto": PROTO,
        "m.mapping": f'{imports}data-holder: "{holder}"\nwire-schema: "{wire}"\n{block}-rules:\n{rules}\n',
    }


def made(rules: str, block: str, backend: str, union: str = "m::One", *, encoding: str = "cdr", **values: int) -> dict[str, Any]:
    """What rules make of `x` and `y`: of a holder that is filled, what is written and read again."""
    texts = files(rules, block, union)
    options: dict[str, Any] = {"schema": texts, "encoding": encoding, "byte_order": "little"}
    own: dict[str, Any] = {**options, "imports": ["m.idl"], "backend": "interpreter"}
    if block == "unpack":
        flat = rj.Encoder.of("m::Flat", **own)
        decode = rj.Decoder("m.mapping", **options, backend=backend)
        found = decode(flat(flat.holder_type.from_dict(values)))
        if union[0] == "p":
            return found.to_dict()
        write = rj.Encoder.of(union, **own)
        data = write(write.holder_type.from_dict(found.to_dict()))
    else:
        encode = rj.Encoder("m.mapping", **options, backend=backend)
        data = encode(encode.holder_type.from_dict(values))
    return rj.Decoder.of(union, **own)(data).to_dict()


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(
    ("union", "rules", "path"),
    [
        ("m::One", ".u._d = 1\n.u.a = uint8(.x)", ".u.a"),
        ("m::One", ".u._d = 7\n.u.p.x = .x\n.u.p.y = int32(.x * 100)", ".u.p.y"),
        ("m::Many", "len(.us) = 2\nfor i from 0 to 2\n.us[i]._d = 1\n.us[i].a = uint8(.x * i)\nend", ".us[1].a"),
        ("p.One", ".a = int32(.x * 10)", ".a"),
    ],
)
def test_errors_name_a_case_as_users_do(union, rules, path, backend):
    with pytest.raises(rj.MessageError) as error:
        made(rules + "\nignore .y", "unpack", backend, union, x=2**30, y=0)
    assert (error.value.kind, error.value.path) == ("range", path)


def test_mistakes_name_a_case_as_users_do():
    with pytest.raises(rj.MappingError) as error:
        made(".u._d = 1\n.u.a = 1\n.u.a = 2\n.u.n = 1.0", "unpack", "interpreter")
    assert [each.message for each in error.value.diagnostics if each.severity == "error"] == [
        "`.u.a` is set twice",
        "`.u` can hold `a` or `n`, not both",
    ]


@pytest.mark.parametrize("backend", BACKENDS)
def test_errors_of_own_messages_name_a_case(backend):
    """A case that is cut short, without a mapping."""
    decode = rj.Decoder.of("m::One", schema={"m.idl": IDL}, imports=["m.idl"], encoding="cdr", backend=backend)
    with pytest.raises(rj.DecodeError) as error:
        decode(b"\0\1\0\0\7\0\0\0\1\0\0\0")
    assert error.value.path == ".u.p.y"
