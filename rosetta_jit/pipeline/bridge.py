"""Bridges: two programs that meet at one type, as one. What one decodes the other encodes, from the same lanes.

Bytes that no rule touches are not copied into lanes: their lane *is* the message while it is encoded (`lowering.writer.References`).
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any, assert_never

from rosetta_jit.backends.backend import Backend
from rosetta_jit.catalogue import pipeline as words
from rosetta_jit.catalogue import wires
from rosetta_jit.errors import MappingError
from rosetta_jit.kernel.host import UserFunction
from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import Reserve
from rosetta_jit.kernel.printer import to_text
from rosetta_jit.kernel.rewrite import with_registers_behind
from rosetta_jit.kernel.traits import asks_host, our_functions
from rosetta_jit.kernel.walk import statements
from rosetta_jit.language.uses import Signature
from rosetta_jit.lowering.writer import References
from rosetta_jit.model.layout import Layout, Members, Number, Row, Slot, Span, Variant
from rosetta_jit.model.serial import to_plain
from rosetta_jit.model.types import Ref, same_name
from rosetta_jit.pipeline.build import Build, plain_site
from rosetta_jit.pipeline.kept_state import kept_of
from rosetta_jit.pipeline.request import BridgeRequest, GivenFunction, Request
from rosetta_jit.pipeline.successors import SuccessorBuild, joined
from rosetta_jit.pipeline.user_functions import check_compiled
from rosetta_jit.startup.cached import cached_property
from rosetta_jit.startup.dataclass import replace
from rosetta_jit.startup.garbage import imported


class BridgeBuild:
    """A bridge in the making: `Build` for both halves at once."""

    def __init__(self, request: BridgeRequest) -> None:
        self.request = request

    @cached_property
    def halves(self) -> tuple[Build, Build]:
        """The decoding and the encoding half. Raises MappingError where the holder of one is not that of the other."""
        decode, encode = self.request.decode, self.request.encode
        if is_open(decode) and is_open(encode):
            raise MappingError((words.half_a_bridge(),))
        first, second = Build(closed(decode, encode)), Build(closed(encode, decode))
        if first.wires:
            raise MappingError((wires.not_here(first.checked.mapping.wire_span, "a bridge"),))
        filled, packed = first.types.holder, second.types.holder
        is_same = same_name(filled.name, packed.name)
        if is_same and not have_same_fields(first.layout, second.layout):
            first, second = joined(first, second)
        if not is_same or not have_same_fields(first.layout, second.layout):
            span = second.checked.mapping.holder_span if second.request.mapping is not None else None
            raise MappingError((words.do_not_meet(filled.name, packed.name, span, same_name=is_same),))
        return self._referring(first), second

    @property
    def differences(self) -> tuple[str, ...]:
        """What becomes of fields where one half is of a type that followed the other's, in sentences."""
        pairs = zip(self.halves, (True, False), strict=True)
        return tuple(line for half, is_read in pairs if isinstance(half, SuccessorBuild) for line in half.differences(is_read=is_read))

    def _referring(self, build: Build) -> Build:
        """The decoding half. It leaves bytes in the message where no rule writes other bytes to their lane."""
        references = References()
        referring = build.referring(references)
        written = _written_lanes(referring.lowered)
        if references.found & written:
            references = References(copied=frozenset(written))
            referring = build.referring(references)
        return referring

    @cached_property
    def references(self) -> tuple[int, ...]:
        """The lanes that become the message when it is decoded."""
        decode, _ = self.halves
        assert decode.references is not None
        decode.lowered  # noqa: B018 - what is lowered says which lanes those are
        return tuple(sorted(decode.references.found))

    @cached_property
    def kernels(self) -> tuple[Kernel, ...]:
        """Proven kernels: the decoder, what measures, the encoder."""
        decode, encode = self.halves
        before = decode.types.registers
        every = before + encode.types.registers
        writes, size = (with_registers_behind(kernel, before, every) for kernel in encode.kernels)
        return (*(replace(kernel, registers=every) for kernel in decode.kernels), size, writes)

    @property
    def backend(self) -> Backend:
        """The backend of the decoding half."""
        return self.halves[0].backend

    @cached_property
    def functions(self) -> tuple[UserFunction, ...]:
        """The functions of the user's that the kernels call."""
        found: dict[str, UserFunction] = {}
        for each in (function for half in self.halves for function in half.functions):
            if found.setdefault(each.name, each).function is not each.function:
                raise MappingError((words.two_functions(each.name),))
        return tuple(found.values())

    @cached_property
    def called(self) -> tuple[GivenFunction, ...]:
        """The same as they were given."""
        return tuple(dict.fromkeys(function for half in self.halves for function in half.called))

    @cached_property
    def text(self) -> str:
        """All that the code and its `header` depend on besides this process, if all functions are identified that it calls."""
        kernels = [to_text(kernel) for kernel in self.kernels]
        digests = [f"{function.name} {function.identity.digest}" for function in self.called]
        type_, state = json.dumps(self.header["type"], sort_keys=True), json.dumps(self.header["state"])
        return "\n".join([self.backend.name, "bridge", str(self.references), str(self.halves[0].limit), state, type_, *kernels, *digests])

    @cached_property
    def header(self) -> dict[str, Any]:
        """What a process needs besides the code, as JSON holds it."""
        decode, _ = self.halves
        return {
            "type": to_plain(Ref(decode.types.holder.name), decode.types.schema),
            "entry": "bridge",
            "references": list(self.references),
            "sites": [[plain_site(site) for site in kernel.sites] for kernel in self.kernels],
            "asks_host": asks_host(self.kernels),
            "state": kept_of(self.kernels, dict(zip(("decode.", "encode."), (half.types.state for half in self.halves), strict=True))),
            "host": our_functions(self.kernels),
            "limit": decode.limit,
        }

    def check_functions(self) -> tuple[str, ...]:
        """As of a `Build`."""
        imported("rosetta_jit.backends.entry.link")
        declared: Mapping[str, Signature] = {name: each for half in self.halves for name, each in half.types.functions.items()}
        return check_compiled(self.functions, declared)

    def image(self) -> bytes:
        """The object code."""
        imported("rosetta_jit.backends.entry.link")
        from rosetta_jit.backends.entry.link import compile_program

        return compile_program(self.kernels, "bridge", with_numba=False, functions=self.functions, references=self.references)

    def stage(self, stage: str) -> str:
        """What the halves became, one behind the other, as text; of the compiled code both together."""
        match stage:
            case "llvm" | "asm":
                from rosetta_jit.backends.entry import link

                print_ = link.llvm_text if stage == "llvm" else link.assembly
                return print_(self.kernels, "bridge", with_numba=False, functions=self.functions, references=self.references)
            case _:
                return "\n".join(half.stage(stage) for half in self.halves)

    @property
    def offered(self) -> tuple[str, ...]:
        """As of a `Build`."""
        return tuple(file for half in self.halves for file in half.offered)

    def files(self) -> dict[str, str | None]:
        """As of a `Build`."""
        return {name: digest for half in self.halves for name, digest in half.files().items()}


def is_open(request: Request) -> bool:
    """Whether one side of a bridge is the type at which the other one ends."""
    return request.mapping is None and request.type is None and request.plain is None


def closed(request: Request, other: Request) -> Request:
    """The request itself, or that for the type at which the other one ends."""
    if not is_open(request):
        return request
    build = Build(other)
    plain = json.dumps(to_plain(Ref(build.types.holder.name), build.types.schema))
    return replace(request, plain=plain, framework=request.framework or build.holder_framework.name)


def _written_lanes(kernels: tuple[Kernel, ...]) -> set[int]:
    """The lanes that a decoder takes rows of."""
    return {
        stmt.lane
        for kernel in kernels
        for block in (*kernel.bodies, *(routine.body for routine in kernel.routines))
        for stmt, _ in statements(block)
        if isinstance(stmt, Reserve)
    }


def have_same_fields(one: Layout, other: Layout) -> bool:
    """Whether two layouts differ in the names of structs at most."""
    return _without_names(one) == _without_names(other)


def _without_names(layout: Layout) -> Layout:
    lanes = tuple(replace(lane, element=_slot(lane.element)) for lane in layout.lanes)
    return Layout(lanes, tuple((lane, "") for lane, _ in layout.recursive))


def _slot(slot: Slot) -> Slot:
    match slot:
        case Number() | Span():
            return slot
        case Row():
            return replace(slot, struct="", members=_members(slot.members))
        case Variant():
            return replace(slot, members=_members(slot.members))
        case _:
            assert_never(slot)


def _members(members: Members) -> Members:
    return Members(replace(each, slot=_slot(each.slot)) for each in members)
