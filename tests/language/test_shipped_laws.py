"""What the laws of shipped mappings promise, over random messages and holders: nothing that was decoded is refused where a law says so."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import rosetta_jit as rj
from rosetta_jit.model.types import Array, Bool, Bytes, Enum, Float, Int, Map, Optional, Ref, String, Struct, Type, Union
from tests.random_mappings.fields import plain
from tests.random_mappings.test_relations import broken_law

if TYPE_CHECKING:
    from rosetta_jit.model.types import Schema

ROOT = Path(__file__).parents[2] / "mappings"
SHIPPED = [path.relative_to(ROOT).as_posix() for path in sorted(ROOT.rglob("*.mapping")) if path.parent.name != "joined"]
"""But for those of several wires: tests/frameworks/ros/test_joined.py has them."""
ENCODINGS = {"drives": "ros1", "ros1": "ros1", "ros2": "cdr", "packed": "ros1", "yarp": "yarp3"}
SIZES = st.integers(0, 3)


def values_of(type_: Type, schema: Schema, *, finite: bool, depth: int = 4) -> st.SearchStrategy[Any]:
    """Values of a type, as `from_dict` takes them; floats that are ``finite``, and within what laws hold for; messages to a ``depth``."""
    below: dict[str, Any] = {"finite": finite, "depth": depth - 1}
    match schema.resolve(type_):
        case Bool():
            return st.booleans()
        case Int(bits, signed):
            return st.integers(-(1 << bits - 1), (1 << bits - 1) - 1) if signed else st.integers(0, (1 << bits) - 1)
        case Float(bits):
            return st.floats(-1e6, 1e6, width=bits) if finite else st.floats(width=bits)
        case String():
            return st.text(st.characters(codec="utf-8", exclude_characters="\0"), max_size=4)
        case Bytes(length=length):
            return st.binary(min_size=length, max_size=length) if isinstance(length, int) else st.binary(max_size=6)
        case Enum(values=names):
            return st.sampled_from([name for name, _ in names])
        case Array(element, length):
            count = st.just(length) if isinstance(length, int) else SIZES
            if depth <= 0:
                return st.just([])
            one = values_of(element, schema, **below)
            return count.flatmap(lambda size: st.lists(one, min_size=size, max_size=size))
        case Struct(fields=fields):
            own = [each for each in fields if each.constant is None]
            maybe = {each.name: values_of(each.type, schema, **below) for each in own if isinstance(each.type, Optional) and depth > 0}
            always = {each.name: values_of(each.type, schema, **below) for each in own if not isinstance(each.type, Optional)}
            return st.fixed_dictionaries(always, optional=maybe)
        case Optional(value):
            return values_of(value, schema, **below)
        case Map() | Union() | Ref() as other:
            raise AssertionError(other)


def assert_comes_back(law: Any, values: dict[str, Any], back: dict[str, Any]) -> None:
    """That a law holds that says what comes back of each field."""
    if law.kind == "exact":
        assert plain(back) == plain(values)
    elif law.kind == "rounded":
        assert not broken_law(law, flat(values), flat(back)), str(law)


def flat(values: dict[str, Any], path: str = "") -> dict[str, Any]:
    """Values within messages by their paths, as laws name them."""
    found: dict[str, Any] = {}
    for name, value in values.items():
        found |= flat(value, f"{path}{name}.") if isinstance(value, dict) else {f"{path}{name}": value}
    return found


def is_of_wire(path: str, name: str) -> bool:
    """Whether a file may declare the wire's type: a type of ROS 1 and of ROS 2 have one name."""
    return not name.startswith("ros2/") or path.startswith("ros2/")


@pytest.mark.parametrize("name", SHIPPED)
def test_nothing_decoded_is_refused_where_the_law_says_so(name):
    checked = rj.check(name)
    if checked.laws is None or {checked.laws.messages.kind, checked.laws.holders.kind} == {"lossy"}:
        pytest.skip("nothing is promised")
    options: dict[str, Any] = {"encoding": ENCODINGS[name.partition("/")[0]], "backend": "python"}
    decode, encode = rj.Decoder(name, **options), rj.Encoder(name, **options)
    wire, holder = checked.checked.wire, checked.checked.holder
    own: dict[str, Any] = {
        **options,
        "imports": [
            each.path for each in checked.checked.mapping.imports if not each.path.endswith(".units") and is_of_wire(each.path, name)
        ],
    }

    read, write = rj.Decoder.of(wire.root.name, **own), rj.Encoder.of(wire.root.name, **own)

    def goes_back(message: bytes) -> None:
        """A message that is taken comes back as the law of messages says; one that is refused is no concern of it."""
        try:
            held = decode(message)
        except rj.DecodeError:
            return
        if checked.laws.messages.kind != "lossy":
            assert_comes_back(checked.laws.messages, read(message).to_dict(), read(encode(held)).to_dict())

    @settings(max_examples=15, deadline=None, suppress_health_check=list(HealthCheck))
    @given(values=values_of(wire.root, wire.schema, finite=checked.laws.messages.kind == "rounded"))
    def messages(values):
        try:
            message = bytes(write(write.holder_type.from_dict(values)))
        except rj.EncodeError:  # a length that other fields determine
            return
        goes_back(message)

    @settings(max_examples=15, deadline=None, suppress_health_check=list(HealthCheck))
    @given(values=values_of(holder.root, holder.schema, finite=checked.laws.holders.kind == "rounded"))
    def holders(values):
        held = encode.holder_type.from_dict(values)
        try:
            message = bytes(encode(held))
        except rj.EncodeError:
            return
        goes_back(message)
        if checked.laws.holders.kind != "lossy":
            assert_comes_back(checked.laws.holders, held.to_dict(), decode(message).to_dict())

    messages()
    holders()
