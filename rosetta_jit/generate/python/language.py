"""A unit as Python: one module, `NAME.py`."""

from __future__ import annotations

import re

from rosetta_jit.backends.printing import Writer
from rosetta_jit.generate.c.holder.lanes import Lanes
from rosetta_jit.generate.c.holder.unit_lanes import named_lanes
from rosetta_jit.generate.python.decoding.decoder import print_decoder, taken_lanes
from rosetta_jit.generate.python.decoding.empty_messages import print_empty_message
from rosetta_jit.generate.python.decoding.late_objects import Late, late_objects
from rosetta_jit.generate.python.decoding.making import Make
from rosetta_jit.generate.python.encoding.collecting import Collect
from rosetta_jit.generate.python.encoding.encoder import encoder_in_parts
from rosetta_jit.generate.python.passes.positions import NotInParts
from rosetta_jit.generate.python.printing.classes import WORDS, classes, names_of
from rosetta_jit.generate.python.printing.definitions import definition
from rosetta_jit.generate.python.printing.functions import Attempt, beside_lanes, is_flat, print_kernel
from rosetta_jit.generate.python.printing.printed import Objects
from rosetta_jit.generate.python.printing.scope import CODES, Scope, view_name
from rosetta_jit.generate.python.support import mentioned, needed, support
from rosetta_jit.generate.python.wires import decoder, filling, rows_at_first, staying, wires_of
from rosetta_jit.generate.unit import MADE, Role, Unit, wire_of
from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import Const, Direction, Return
from rosetta_jit.kernel.traits import asks_host
from rosetta_jit.model.types import Ref
from rosetta_jit.startup.dataclass import replace

REGISTERS: dict[Direction, str] = {"decode": "_UNPACK", "encode": "_PACK"}
"""The lists of the registers of each direction, in the module."""

LENIENT = "reportArgumentType reportOperatorIssue reportOptionalMemberAccess reportPossiblyUnboundVariable"
TYPES = f"""# Whoever imports this finds types. Type checkers leave the statements of the module itself alone.
# mypy: ignore-errors
# pyright: basic, {", ".join(f"{rule}=false" for rule in LENIENT.split())}
"""

NO_MEMORY = "the message asks for more memory than its size allows"


def files(unit: Unit) -> dict[str, str]:
    """The text of the module by its name."""
    return {f"{unit.name}.py": _Module(unit).text()}


class _Module:
    """Prints the module of a unit."""

    def __init__(self, unit: Unit) -> None:
        self.unit, self.names = unit, names_of(unit)
        reserved = WORDS | frozenset(self.names.values())
        self.lanes = named_lanes(unit, reserved | beside_lanes(named_lanes(unit, reserved)(())))
        self.paths = tuple(f".{each.name}" if each.name else "" for each in unit.layout.lanes)
        self.loads, self.structs = set[str](), dict[str, str]()
        self.root, self.guesses, self.late = self.names[unit.type], False, Late()

    def text(self) -> str:
        """All of it."""
        parts = [self._decoder()] if "borrow" in self.unit.kernels else []
        parts += [self._decoder_of(wire, role) for wire, role in wires_of(self.unit).items()]
        parts += [self._encoder()] if "encode" in self.unit.kernels else []
        parts += [self._reset()] if self.unit.state else []
        made = "\n".join(f"# {ascii(' '.join(line.split()))[1:-1]}" for line in (MADE, *self.unit.made_from))
        printed, declared = "\n\n\n".join(parts), classes(self.unit).rstrip()
        named = mentioned(f"{declared}\n{printed}")
        constants = needed(self._constants(), named)
        before = support(named | mentioned(constants))
        text = f"{made}\n{TYPES}from __future__ import annotations\n\n{before}\n\n{declared}\n\n\n{constants}\n\n\n{printed}"
        return re.sub(r"\n{4,}", "\n\n\n", text).rstrip() + "\n"

    def _constants(self) -> str:
        """Views of nothing, and functions of the struct module."""
        lines = [*map(definition, sorted(self.loads))]
        lines += [f'{name} = Struct("{code}").pack_into' for code, name in self.structs.items()]
        if self.guesses:
            lines += ["_room = [256]", '"""The room that messages took."""']
        if any(asks_host([kernel]) for kernel in self.unit.kernels.values()):
            lines.append("_numbers = _count()")
        lines += self.late.lines
        if self.unit.state:
            words = "".join(f"    {word},  # {name}\n" for name, word in self.unit.state)
            lines += [
                f"_INITIAL = (\n{words})",
                '"""What is kept from one message to the next: integers as they are, floats by their bits."""',
            ]
            lines += [f"{each} = list(_INITIAL)" for each in REGISTERS.values()]
        if wires_of(self.unit):
            lines.append(rows_at_first(self.unit, self.lanes([each.stride for each in self.unit.layout.lanes])))
        return "\n".join(lines)

    def _reset(self) -> str:
        writer = Writer()
        with writer.indented("def reset() -> None:"):
            writer.line('"""Forget all messages: state is what the mapping says that it is at first."""')
            writer.line(" = ".join(f"{each}[:]" for each in REGISTERS.values()) + " = _INITIAL")
            if wires_of(self.unit):
                writer.line("_rows.update(_ROWS_AT_FIRST)")
        return writer.text()

    def _lanes(self, kernel: Kernel) -> Lanes:
        """Those of the unit, with the hidden ones of a kernel."""
        return self.lanes(kernel.strides)

    def _sites(self, role: Role) -> str:
        lines = [f"_{role if wire_of(role) else role.upper()}_SITES = ("]
        for number, site in enumerate(self.unit.kernels[role].sites):
            kind, detail = ("count", NO_MEMORY) if number == 0 else (site.kind, site.detail)
            inner = "".join(f"({each.offset}, {each.size}, {each.step}, {each.path!a}), " for each in site.parts).rstrip()
            lines.append(f"    ({kind!a}, {site.path!a}, {detail!a}, {site.line!a}, ({inner})),")
        return "\n".join([*lines, ")"])

    # --- decoding --------------------------------------------------------------------------------------------------------------------

    def _decoder(self) -> str:
        text, attempts = print_decoder(self.unit, self.names, self.lanes, self.loads, self.paths)
        self.late = late_objects(self.unit, self.names, text)
        return "\n\n".join([self._sites("borrow"), text, f"\n{self._decode(attempts)}"])

    def _decoder_of(self, wire: str, role: Role) -> str:
        """The decoder of one of several wires."""
        kernel = replace(self.unit.kernels[role], kept=tuple({*self.unit.kernels[role].kept} & {*staying(self.unit)}))

        def inner(scope: Scope) -> list[str]:
            make = Make(self.unit, scope, self.names, taken_lanes(kernel))
            return filling(make, kernel, self.unit.shares[role])

        objects = Objects(lambda _, __: "filled()", inner=inner, numpy=self.unit.numpy, classes=frozenset(self.names.values()))
        origins, lanes = self.unit.origins.get(role, ()), self._lanes(kernel)
        text, attempts = print_kernel(kernel, lanes, role, self.loads, origins, objects, self.paths, flat=False)
        lines = Writer()
        self._from_call(lines, {each for attempt in attempts for each in attempt.needs}, "decode")
        called = decoder(self.root, wire, attempts, lines.lines, self.unit.arrivals[wire])
        return "\n\n".join([self._sites(role), f"\n{text.rstrip()}", f"\n{called}"])

    def _decode(self, attempts: tuple[Attempt, ...]) -> str:
        writer = Writer()
        copies = any("call_copy" in attempt.needs for attempt in attempts)
        has_arrays = any(name.startswith("_dtype_") for name in self.loads)
        option = ", *, copy: bool = True" if has_arrays else ""
        writer.line(f"def decode(data: bytes | bytearray | memoryview{option}) -> {self.root}:")
        writer.depth = 1
        said = "; without ``copy`` arrays are views of it, where they can be, which nothing writes to. Raises"
        never = "; no array can be a view of it, whatever ``copy`` says. Raises"
        writer.line(f'"""Read a message{said if copies else never if has_arrays else "; raises"} `DecodeError`."""')
        with writer.indented("if type(data) is not bytes:"):
            writer.line("data = bytes(data)")
        writer.line("end = len(data)")
        for line in print_empty_message(self.unit, self.root):
            writer.line(line)
        if any(attempt.is_bounded for attempt in attempts):
            writer.line("most = 1048576 + 64 * end")
        self._from_call(writer, {each for attempt in attempts for each in attempt.needs}, "decode")
        for number, attempt in enumerate(attempts):
            writer.line("try:")
            writer.line(f"    return {attempt.name}({attempt.arguments()})")
            writer.line("except _Failed as failed:")
            if number == 0:
                writer.line("    farthest = failed")
            else:
                writer.line("    if failed.site == 0 or failed.at > farthest.at:")
                writer.line("        farthest = failed")
        writer.line("raise _error(_BORROW_SITES, farthest, end)")
        return writer.text()

    def _from_call(self, writer: Writer, needs: set[str], direction: Direction) -> None:
        if "call_registers" in needs:
            writer.line(f"call_registers = {REGISTERS[direction]}")
        if "call_copy" in needs:
            writer.line("call_copy = _copied if copy else _as_it_is")
        if "call_now" in needs:
            writer.line("call_now = now()")
        if "call_number" in needs:
            writer.line("call_number = next(_numbers)")

    # --- encoding --------------------------------------------------------------------------------------------------------------------

    def _encoder_in_parts(self) -> str:
        kernel = self.unit.kernels["encode"]
        made = encoder_in_parts(self.unit, kernel, self._lanes(kernel), self.paths, self.late.lists)
        self.loads |= made.loads
        writer = Writer()
        writer.line(f"def encode(target: {self.root}) -> bytes:")
        writer.line('    """The message; raises `EncodeError`."""')
        writer.line("    try:")
        writer.depth = 2
        self._from_call(writer, {f"call_{what}" for what in made.from_call}, "encode")
        writer.lines += made.lines
        writer.depth = 1
        fails = any("raise _Failed(" in line for line in (*made.routines, *made.lines))
        if fails:
            writer.line("except _Failed as failed:")
            writer.line("    raise _error(_ENCODE_SITES, failed, None) from None")
        writer.line("except (AttributeError, TypeError, ValueError, OverflowError, _StructError) as error:")
        writer.line('    raise EncodeError("range", "", str(error)) from error')
        return "\n\n\n".join([*([self._sites("encode")] if fails else []), *made.routines, writer.text()])

    def _encoder(self) -> str:
        try:
            return self._encoder_in_parts()
        except NotInParts:
            self.guesses = True
        roles: tuple[Role, ...] = ("size", "encode")
        kernels: dict[Role, Kernel] = {role: self.unit.kernels[role] for role in roles}
        flat = all(is_flat(kernel, self._lanes(kernel)) for kernel in kernels.values())
        texts, attempts = list[str](), dict["Role", "Attempt"]()
        measured = range(len(self.unit.layout.lanes), min(len(kernel.strides) for kernel in kernels.values()))
        for role, kernel in kernels.items():
            lanes = self._lanes(kernel)

            def result(scope: Scope, position: str, role: str = role) -> str:
                if role == "encode":
                    return position
                return ", ".join([position, *(scope.view(lane, "") for lane in measured)]) + ("" if measured else ",")

            origins, shared = self.unit.origins.get(role, ()), measured if role == "encode" else range(0)
            text, (attempts[role], *_) = print_kernel(
                kernel, lanes, role, self.loads, origins, Objects(result), self.paths, flat=flat, measured=shared
            )
            texts += [self._sites(role), f"\n{text.rstrip()}"]
        texts.append(f"\n{self._encode(self._lanes(kernels['encode']), attempts, flat, measured)}")
        return "\n\n".join(texts)

    def _measured(self, size: Attempt, measured: range) -> str:
        """The call that measures a message, or the size that all have."""
        match self.unit.kernels["size"].bodies[0]:
            case (Return(Const(_, value)),):
                return f"{int(value)}," + " bytearray()," * len(measured)
            case _:
                return f"{size.name}({', '.join(['None', 'math.inf', '1 << 60', *size.needs])})"

    def _encode(self, lanes: Lanes, attempts: dict[Role, Attempt], flat: bool, measured: range) -> str:
        needs = {each for attempt in attempts.values() for each in attempt.needs}
        collect = Collect(self.unit, lanes, self.structs, Writer(depth=2))
        writer = collect.writer
        for lane in range(1, lanes.own):
            writer.line(f"{lanes.rows(lane)} = bytearray()")
        for lane, struct in self.unit.layout.recursive:
            with writer.indented(f"def collect_{lanes.rows(lane)}(at, element):"):
                found: dict[int, tuple[str, str]] = {}
                collect.value(Ref(struct), self.unit.layout.lanes[lane].element, "element", found)
                collect.pack(lane, "at", found)
        collect.root(needs, flat=flat)
        for lane in range(lanes.own):
            name, stride = lanes.rows(lane), lanes.stride(lane)
            for code in sorted(set(CODES.values())):
                if view_name(lanes, lane, code) in needs:
                    writer.line(f'{name}_{code} = memoryview({name}).cast("{code}")')
            if lane and f"{name}_used" in needs | {each.replace("_room", "_used") for each in needs}:
                writer.line(f"{name}_used = {name}_room = len({name}){f' // {stride}' if stride > 1 else ''}")
        self._from_call(writer, needs, "encode")
        writer.lines = [line for line in writer.lines if line not in collect.replaced]
        self.loads |= collect.wholes
        bound = ", ".join(["needed", *map(lanes.rows, measured)]) + ("" if measured else ",")
        return "\n".join(
            [
                f"def encode(target: {self.root}) -> bytes:",
                '    """The message; raises `EncodeError`."""',
                "    sites = _SIZE_SITES",
                "    try:",
                *writer.lines,
                *self._written(f"{bound} = {self._measured(attempts['size'], measured)}", attempts["encode"], lanes),
                "    except _Failed as failed:",
                "        raise _error(sites, failed, None) from None",
                "    except (AttributeError, TypeError, ValueError, OverflowError, _StructError) as error:",
                '        raise EncodeError("range", "", str(error)) from error',
                "    return bytes(data) if written == len(data) else bytes(memoryview(data)[:written])",
            ]
        )

    def _written(self, measure: str, encode: Attempt, lanes: Lanes) -> list[str]:
        """Statements that write the message: measured first, where its size is known or the encoder needs what measuring finds.

        Else a guess is tried, the room that other messages took: most fit, and what fails there is measured, and fails again with a reason.
        """

        def written(room: str) -> str:
            return f"written = {encode.name}({', '.join(['data', room, '1 << 60', *encode.needs])})"

        known = isinstance(self.unit.kernels["size"].bodies[0][0], Return)
        if known or any(lanes.rows(lane) in encode.needs for lane in range(lanes.own, len(lanes.all))):
            lines = [measure, "sites, data = _ENCODE_SITES, bytearray(needed)", written("needed")]
            return [f"        {line}" for line in lines]
        lines = [
            "data = bytearray(_room[0])",
            "try:",
            f"    {written('len(data)')}",
            "except _Failed:",
            f"    {measure}",
            "    sites, data = _ENCODE_SITES, bytearray(needed)",
            f"    {written('needed')}",
            "    _room[0] = needed",
            "if len(data) > 4096 + 16 * written:",
            "    _room[0] = written",
        ]
        return [f"        {line}" for line in lines]
