"""Random rules for both directions: what they unpack is what plain Python makes of it, and what their laws say comes back, does."""

from __future__ import annotations

import random
from typing import Any

import numpy as np
import pytest

import rosetta_jit as rj
from tests.language.test_random_laws import is_near
from tests.random_mappings.blocks import Relations
from tests.random_mappings.conditional import conditional
from tests.random_mappings.defaults import defaulted, demanded
from tests.random_mappings.digits import digits, divided, moment, taken_apart
from tests.random_mappings.fields import plain, written
from tests.random_mappings.flags import flags, joined
from tests.random_mappings.meaning import Refused
from tests.random_mappings.message_types import Kind, Message
from tests.random_mappings.nested import date, listed, parameter, unit, via, widened
from tests.random_mappings.octets import octets
from tests.random_mappings.orders import chosen_element, elementwise_digits, flagged, members, ordered, padded, sliced
from tests.random_mappings.refusals import of_elements, rejected, same, same_arrays, within_blocks
from tests.random_mappings.relations import Part, below_all, body
from tests.random_mappings.searches import maps, searched, separated
from tests.random_mappings.sums import sums
from tests.random_mappings.test_wires import Side, counted, without_cases
from tests.random_mappings.views import triangle, viewed
from tests.random_mappings.wires import WIRES, package
from tests.random_mappings.wrapped import held, repeated, united

MESSAGES = 15
FORMS = (parameter, date, unit, digits, taken_apart, flags, joined, sums, divided, moment, rejected, demanded, within_blocks, same)
ARRAY_FORMS = (listed, widened, octets, searched, maps, separated, of_elements, same_arrays, defaulted, conditional)
VIEWS = (viewed, triangle)
WRAPPED = (held, repeated, united)
ORDERS = (ordered, padded, flagged, sliced, members, chosen_element, elementwise_digits)


def relations(rng: random.Random, names: tuple[str, str]) -> tuple[Side, Side, list[Part]]:
    """The types of both sides, and the relations between them."""
    wire, holder = (WIRES[name] for name in names)
    dst = Message("Dst", {})
    made = Relations(rng, wire, holder, Side(holder, dst).constant, more=FORMS + WRAPPED, more_arrays=ARRAY_FORMS + ORDERS + VIEWS)
    if "yarp" not in "".join(names):  # whose inner structs have no names
        made.more += (via,)
    parts = [made.part() for _ in range(rng.randrange(1, 7))]
    return *sides(rng, names, parts), parts


def sides(rng: random.Random, names: tuple[str, str], parts: list[Part]) -> tuple[Side, Side]:
    """The types that have the fields of all relations, in any order."""
    kinds: list[dict[str, Kind]] = [{}, {}]
    for part in parts:
        kinds[0] |= part.wire
        kinds[1] |= part.holder
    src, dst = (
        Message(name, {each: fields[each] for each in rng.sample(list(fields), len(fields))})
        for name, fields in zip(["Src", "Dst"], kinds, strict=True)
    )
    return Side(WIRES[names[0]], src), Side(WIRES[names[1]], dst)


def mappings(src: Side, dst: Side, parts: list[Part]) -> dict[str, str]:
    """The mapping, those that it uses, and the file of units."""
    sides = {"Src": src, "Dst": dst}

    def typed(name: str) -> str:
        side = sides[name[:3]]
        return side.wire.path.format(name=name, package=package(side.message))

    units = [each.partition(".") for part in parts for each in part.units]
    files = {"all.units": "".join(f'"{typed(type_)}":\n  .{rest}\n' for type_, _, rest in units)} if units else {}
    head = "".join(f'import "{name}"\n' for name in (*src.files, *dst.files, *files))
    all_of = {"m.mapping": (src.message, dst.message, body(parts)), **below_all(part.mappings for part in parts)}
    for name, (wire, holder, text) in all_of.items():
        files[name] = f'{head}data-holder: "{typed(holder.name)}"\nwire-schema: "{typed(wire.name)}"\n{text}'
    return files


def unpacked(parts: list[Part], values: dict[str, Any]) -> dict[str, Any] | set[str]:
    """What the holder has, or the kinds of what is refused."""
    found: dict[str, Any] = {}
    refused: set[str] = set()
    for part in parts:
        try:
            with np.errstate(all="ignore"):
                found |= part.unpack(part.own(values))
        except Refused as error:
            refused |= set(error.kind.split("/"))
    return refused or found


def said(function: Any, argument: Any) -> Any:
    """What a program makes, or how it refuses."""
    try:
        return function(argument)
    except rj.MessageError as error:
        return error.kind, error.path


def broken_law(law: Any, values: dict[str, Any], back: dict[str, Any]) -> list[Any]:
    """The fields that do not come back as the law says."""
    lost = {loss.place.split("[")[0] for loss in law.losses}
    rounded = {place.split("[")[0]: rounding for place, rounding in law.rounded}
    if "" in lost:
        return []
    found = []
    for name in {*values, *back}:
        place, pair = f".{name}", (values.get(name), back.get(name))
        inner = (f"{place}.", f"{place}[].")
        if place in lost or any(each.startswith(inner) for each in (*lost, *dict(law.rounded))):
            continue
        if place in rounded:
            numbers = pair if isinstance(pair[0], list) else ([pair[0]], [pair[1]])
            is_right = all(is_same(left, right, rounded[place]) for left, right in zip(*numbers, strict=True))
        else:
            is_right = comes_back(*pair)
        if not is_right:
            found.append((name, *pair, rounded.get(place)))
    return found


def comes_back(value: Any, back: Any) -> bool:
    """Whether a value is what it was, float by float to the bit; an integer has no sign of zero, wherever it stands for a float."""
    if isinstance(value, list) and isinstance(back, list) and len(value) == len(back):
        return all(
            comes_back(*pair) if type(pair[0]) is int else plain(pair[0]) == plain(pair[1]) for pair in zip(value, back, strict=True)
        )
    return plain(value) == plain(back) or (value, back) == (0, 0)


def is_same(value: float, back: float, rounding: Any) -> bool:
    return plain(value) == plain(back) or (np.isnan(value) and np.isnan(back)) or is_near(back, value, rounding)


def check_relations(seed: int, names: tuple[str, str], backends: list[str]) -> None:
    rng = random.Random(seed)
    src, dst, parts = relations(rng, names)
    files = {**src.files, **dst.files}
    given = {name: value for part in parts for name, (_, value) in part.parameters.items()}
    files |= mappings(src, dst, parts)
    own = {"schema": files, "imports": list(src.files), "backend": "interpreter"}
    read = rj.Decoder.of(src.type_name, **own, **src.wire.options)
    write = rj.Encoder.of(src.type_name, **own, **src.wire.options, **src.wire.written)
    decoders = [rj.Decoder("m.mapping", schema=files, backend=backend, parameters=given, **src.wire.options) for backend in backends]
    options = {**src.wire.options, **src.wire.written}
    encoders = [rj.Encoder("m.mapping", schema=files, backend=backend, parameters=given, **options) for backend in backends]
    laws = decoders[0].mapping.laws

    def decoded(data: bytes) -> Any:
        found = [said(lambda data, decode=decode: without_cases(decode(data).to_dict()), data) for decode in decoders]
        assert all(plain(each) == plain(found[0]) for each in found), (seed, names, backends, found, files)
        return found[0]

    def encoded(values: dict[str, Any]) -> Any:
        found = [said(lambda values, encode=encode: written(encode, values), values) for encode in encoders]
        assert all(each == found[0] or shown(each) == shown(found[0]) for each in found), (seed, names, backends, found, files)
        return found[0]

    def shown(message: Any) -> Any:
        """The values of a message: a NaN that was computed may have any bits."""
        return plain(read(message).to_dict()) if isinstance(message, bytes) else message

    for _ in range(MESSAGES):
        values = {name: value for part in parts for name, value in part.some_wire(rng).items()}
        wanted = unpacked(parts, values)
        found = decoded(bytes(write(write.holder_type.from_dict(counted(src, values)))))
        about = seed, names, files, values, found, wanted
        if isinstance(wanted, set):
            assert isinstance(found, tuple), about
            assert found[0] in wanted, about
            continue
        assert plain(found) == plain(wanted), about
        message = encoded(found)
        if isinstance(message, bytes):
            back = without_cases(read(message).to_dict())
            broken = broken_law(laws.messages, {**values}, back)
            assert not broken, (*about, broken, str(laws))
        else:
            assert laws.messages.kind != "exact", (*about, message, str(laws))
    for _ in range(MESSAGES):
        values = {name: value for part in parts for name, value in part.some_holder(rng).items()}
        message = encoded(values)
        if isinstance(message, bytes):
            found = decoded(message)
            about = seed, names, files, values, found, str(laws)
            if isinstance(found, dict):
                broken = broken_law(laws.holders, values, found)
                assert not broken, (*about, broken)
            else:
                assert laws.holders.kind != "exact", about


def pair_of(seed: int) -> tuple[str, str]:
    rng = random.Random(f"relations {seed}")
    return rng.choice(list(WIRES)), rng.choice(list(WIRES))


@pytest.mark.parametrize("seed", range(6))
def test_relations(seed):
    check_relations(seed, pair_of(seed), ["python", "llvm"])


@pytest.mark.campaign
@pytest.mark.parametrize("block", range(20))
def test_campaign(block):
    for seed in range(100 * block + 1000, 100 * block + 1100):
        check_relations(seed, pair_of(seed), ["python", "llvm"] if seed % 10 else ["python", "interpreter", "llvm", "numba"])
