"""Rules for the cases of unions, with a discriminator (OMG IDL) and without (protobuf's oneof)."""

from __future__ import annotations

from typing import Any

import pytest

import rosetta_jit as rj

BACKENDS = ["llvm", "python", "interpreter"]
IDL = """module m {
  struct Point { long x; long y; };
  struct Vec { double a[2]; };
  union Un switch (long) { case 1: octet a; case 2: case 5: double n; case 7: Point p; case 8: Vec v; default: string s; };
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


IMPLIED = [
    (".u.n = .x", {"_d": 2, "n": 7.0}),
    (".u.p.x = .x\n.u.p.y = .y", {"_d": 7, "p": {"x": 7, "y": 5}}),
    ('.u.s = "text"', {"_d": 0, "s": "text"}),
    ("when .x > 3\n.u.n = .x\nelse\n.u.a = 1\nend", {"_d": 2, "n": 7.0}),
    ("when .x < 3\n.u._d = 5\n.u.n = .x\nelse\n.u.a = 1\n.u._d = 1\nend", {"_d": 1, "a": 1}),
    (".u._d = 5\n.u.n = .x", {"_d": 5, "n": 7.0}),
    (".u.n = .x\n.u._d = .y", {"_d": 5, "n": 7.0}),
    (".u.p.y = .y\n.u._d = .x\n.u.p.x = .x", {"_d": 7, "p": {"x": 7, "y": 5}}),
    (".u._d = 1", {"_d": 1, "a": 0}),
    (".u._d = .x", {"_d": 7, "p": {"x": 0, "y": 0}}),
    (".u._d = int32(.x * 100)", {"_d": 700, "s": ""}),
    ("default .u", {"_d": 0, "s": ""}),
    (".u.v.a[0] = .x\n.u.v.a[1] = .y", {"_d": 8, "v": {"a": [7.0, 5.0]}}),
    (".u._d = int32(.x + 1)\n.u.v.a[0] = .x\n.u.v.a[1] = .y", {"_d": 8, "v": {"a": [7.0, 5.0]}}),
    (".u._d = int32(.x + 1)", {"_d": 8, "v": {"a": [0.0, 0.0]}}),
    (".u._d = 8", {"_d": 8, "v": {"a": [0.0, 0.0]}}),
]


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("block", ["unpack", "pack"])
@pytest.mark.parametrize(("rules", "wanted"), IMPLIED)
def test_a_case_and_its_discriminator(rules, wanted, block, backend):
    """A case implies the label that selects it; a discriminator alone gives the case that it selects."""
    ignored = "".join(f"\nignore .{name}" for name in "xy" if f".{name}" not in rules.replace(f".p.{name}", ""))
    found = made(rules + ignored, block, backend, x=7, y=5)
    assert found == {"u": wanted}


THREE = "len(.us) = 3\nfor i from 0 to 3\nwhen i == 1\n.us[i].n = .x\nelse\n.us[i].p.x = int32(i)\n.us[i].p.y = .y\nend\nend\n"
ELEMENTS = [
    THREE,
    f"{THREE}for i from 0 to 3\n.us[i]._d = int32(2 if i == 1 else 7)\nend",
    "len(.us) = 3\n.us[1].n = .x\n.us[0].p.y = .y\n.us[2].p.y = .y\n.us[0].p.x = 0\n.us[2].p.x = 2",
]


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("block", ["unpack", "pack"])
@pytest.mark.parametrize("rules", ELEMENTS)
def test_cases_of_elements(rules, block, backend):
    found = made(rules, block, backend, "m::Many", x=7, y=5)
    points = [{"_d": 7, "p": {"x": number, "y": 5}} for number in (0, 2)]
    assert found == {"us": [points[0], {"_d": 2, "n": 7.0}, points[1]]}


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("block", ["unpack", "pack"])
@pytest.mark.parametrize(
    ("union", "rules", "path"),
    [
        ("m::One", ".u._d = .x\n.u.n = .y", ".u"),
        ("m::One", ".u.n = .y\n.u._d = .x", ".u"),
        ("m::Many", "len(.us) = 2\nfor i from 0 to 2\n.us[i].n = .y\nend\nfor i from 0 to 2\n.us[i]._d = int32(2 + i * .x)\nend", ".us[1]"),
        ("m::Many", "len(.us) = 2\nfor i from 0 to 2\n.us[i].n = .y\n.us[i]._d = int32(i + 1)\nend", ".us[0]"),
    ],
)
def test_computed_discriminators_are_checked(union, rules, path, block, backend):
    with pytest.raises(rj.MessageError) as error:
        made(rules if ".x" in rules else rules + "\nignore .x", block, backend, union, x=7, y=5)
    assert (error.value.kind, error.value.path) == ("union", path)
    assert "another case is set than the discriminator says (m.mapping:" in str(error.value)


@pytest.mark.parametrize("block", ["unpack", "pack"])
@pytest.mark.parametrize(
    ("union", "rules", "message"),
    [
        ("m::One", ".u._d = 1\n.u.n = .x", "`.u._d` is 1, which does not select `n`"),
        ("m::One", '.u.s = "a"\n.u._d = 2', "`.u._d` is 2, which does not select `s`"),
        ("m::One", ".u.n = .x\ndefault .u._d", "`.u._d` is 0, which does not select `n`"),
        ("m::One", "when .x > 3\n.u._d = 5\nend\n.u.n = .x", "`.u._d` of the {} is never set"),
        ("m::One", "default .u.n", "`.u._d` of the {} is never set"),
        ("m::Many", "len(.us) = 2\n.us[0].n = .x", "`.us[]._d[1]` is never set"),
    ],
)
def test_contradictions(union, rules, message, block):
    with pytest.raises(rj.MappingError) as error:
        made(rules, block, "interpreter", union)
    side = "holder" if block == "unpack" else "wire"
    assert [each.message.split(" (")[0] for each in error.value.diagnostics if each.severity == "error"] == [message.format(side)]


LATE = "when .x > 3\nlen(.us) = 1\n.us[0].n = .x\nelse\nlen(.us) = 1\n.us[0].n = .y\nend\n.us[0]._d = 5"


def test_a_discriminator_of_what_is_not_there_yet():
    with pytest.raises(rj.MappingError) as error:
        made(LATE, "unpack", "interpreter", "m::Many")
    assert "`.us._d` is set after cases that it selects" in [each.message for each in error.value.diagnostics]


def test_labels_are_bounded():
    labels = " ".join(f"case {number}:" for number in range(1000, 2000))
    texts = files("len(.us) = 30\n" + "".join(f".us[{number}]._d = .x\n" for number in range(30)) + "ignore .y", union="m::Many")
    texts["m.idl"] = IDL.replace("case 7:", labels)
    with pytest.raises(rj.MappingError) as error:
        rj.Decoder("m.mapping", schema=texts, encoding="cdr", backend="interpreter")
    assert [each.code for each in error.value.diagnostics] == ["too-complex"]


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_union_as_a_whole(backend):
    """Its discriminator needs a rule, and must select the case that comes."""
    head = 'import "m.idl"\ndata-holder: "m::One"\nwire-schema: "m::One"\nunpack-rules:\n'
    texts = {"m.idl": IDL, "m.mapping": f"{head}.u._u = .u._u\n.u._d = .u._d"}
    options: dict[str, Any] = {"schema": texts, "encoding": "cdr", "byte_order": "little"}
    write = rj.Encoder.of("m::One", **options, imports=["m.idl"], backend="interpreter")
    data = write(write.holder_type.from_dict({"u": {"_d": 5, "n": 1.5}}))
    assert rj.Decoder("m.mapping", **options, backend=backend)(data).to_dict() == {"u": {"_d": 5, "n": 1.5}}
    texts["m.mapping"] = f"{head}.u._u = .u._u\n.u._d = 1\nignore .u._d"
    with pytest.raises(rj.DecodeError) as error:
        rj.Decoder("m.mapping", **options, backend=backend)(data)
    assert (error.value.kind, error.value.path) == ("union", ".u")


@pytest.mark.parametrize("block", ["unpack", "pack"])
@pytest.mark.parametrize(
    "rules",
    [
        "len(.us) = 2\n.us[0]._d = 1\n.us[0].n = .x\n.us[1].a = 1\n.us[1]._d = 1",
        "len(.us) = 2\n.us[1].a = 1\n.us[1]._d = 1\n.us[0].p.x = .x\n.us[0].p.y = .x\n.us[0]._d = 8",
        "len(.us) = .x\nfor i from 0 to .x\n.us[i]._d = 1\nend\nfor k from 0 to .x\n.us[k].n = .x\nend",
        "len(.us) = 1\n.us[0].n = .x\ndefault .us[0]._d",
    ],
)
def test_a_constant_discriminator_of_an_element_that_is_of_another_case(rules, block):
    with pytest.raises(rj.MappingError) as error:
        made(f"{rules}\nignore .y", block, "interpreter", "m::Many", x=7, y=5)
    (problem,) = (each for each in error.value.diagnostics if each.severity == "error")
    assert problem.code == "other-case"
    assert "`.us[]._d`" in problem.message


@pytest.mark.parametrize("backend", BACKENDS)
def test_elements_of_which_each_has_its_own_case(backend):
    """Discriminators and cases of other elements contradict nothing."""
    rules = "len(.us) = 2\n.us[0]._d = 1\n.us[1].n = .x\n.us[0].a = 3\n.us[1]._d = 5\nignore .y"
    assert made(rules, "unpack", backend, "m::Many", x=7, y=5) == {"us": [{"_d": 1, "a": 3}, {"_d": 5, "n": 7.0}]}


@pytest.mark.parametrize("backend", ["llvm", "python", "interpreter"])
def test_no_case_in_some_elements(backend):
    idl = """module {0} {{
  @final union Told switch (long) {{ case 1: long long a; case 2: string b; }};
  @final struct Item {{ long n; Told u; }};
  @final struct {0}All {{ sequence<Item> items; }};
}};"""
    text = """import "w.idl"
import "h.idl"
data-holder: h::hAll
wire-schema: w::wAll
rules:
  len(.items) <-> len(.items)
  for i from 0 to len(.items)
    .items[i].n <-> .items[i].n
    when has(.items[i].u.a)
      .items[i].u.a <-> -.items[i].u.a
    else when has(.items[i].u.b)
      .items[i].u.b <-> "b" + .items[i].u.b
    else
      ignore .items[i].u
      default .items[i].u
    end end
  end
"""
    files = {"w.idl": idl.format("w"), "h.idl": idl.format("h"), "m.mapping": text}
    options = {"schema": files, "encoding": "cdr", "backend": backend}
    decode, encode = rj.Decoder("m.mapping", **options), rj.Encoder("m.mapping", **options)
    write = rj.Encoder.of("w::wAll", **options, imports=["w.idl"])
    cases = [{"a": 5}, {}, {"b": "x"}, {"a": -1}]
    wanted = [{"_d": 1, "a": -5}, {"_d": 0}, {"_d": 2, "b": "bx"}, {"_d": 1, "a": 1}]
    for turn in range(4):
        message = write(write.holder_type.from_dict({"items": [{"n": n, "u": cases[(n + turn) % 4]} for n in range(4)]}))
        found = decode(message)
        assert found.to_dict() == {"items": [{"n": n, "u": wanted[(n + turn) % 4]} for n in range(4)]}
        assert encode(found) == message


def test_no_case_in_another_element_is_refused():
    rules = """  len(.us) = 4
  for i from 0 to 4
    when .x > i
      .us[i].a = 1
    else
      default .us[3 - i]
    end
  end
"""
    with pytest.raises(rj.MappingError) as error:
        rj.Decoder("m.mapping", schema=files(rules, union="m::Many"), encoding="cdr", backend="interpreter")
    assert "uneven-rounds" in {problem.code for problem in error.value.diagnostics}
