"""A unit as Common Lisp: an ASDF system of two files, the runtime and what is the unit's own."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from string import Template

from rosetta_jit.generate.c.holder.unit_lanes import named_lanes
from rosetta_jit.generate.lisp.classes import classes_of, definitions, function_symbols, wire_symbols
from rosetta_jit.generate.lisp.functions import About, Printed, computes_with_floats, print_kernel
from rosetta_jit.generate.lisp.lanes import Lanes, lanes_of
from rosetta_jit.generate.lisp.lines import Lines
from rosetta_jit.generate.lisp.putting import Put
from rosetta_jit.generate.lisp.taking import Take
from rosetta_jit.generate.lisp.texts import comment, literal
from rosetta_jit.generate.lisp.words import API, package_of, runtime_text
from rosetta_jit.generate.shares import changed_lanes
from rosetta_jit.generate.unit import MADE, Role, Unit, wire_of
from rosetta_jit.kernel.ir import Kernel, Part, Site
from rosetta_jit.kernel.traits import asks_host
from rosetta_jit.startup.dataclass import replace

NO_MEMORY = "the message asks for more memory than its size allows"
SYSTEM = """\
(asdf:defsystem "$package"
  :description $description
  :components ((:file "$package-runtime")
               (:file "$package" :depends-on ("$package-runtime"))))
"""
NAMES: dict[Role, str] = {"borrow": "decode", "encode": "encode", "size": "size"}
"""What the functions of a kernel begin with."""


def files(unit: Unit) -> dict[str, str]:
    """The texts of the system's files by their names."""
    package = package_of(unit.name)
    made = _Source(unit)
    return {
        f"{package}.asd": made.head() + Template(SYSTEM).substitute(package=package, description=literal(f"Messages: {unit.made_from[0]}")),
        f"{package}-runtime.lisp": runtime(package),
        f"{package}.lisp": made.text(package),
    }


def runtime(package: str) -> str:
    """What all units have, in a package."""
    return runtime_text().replace("$package", package)


class _Source:
    """Prints the unit's own file."""

    def __init__(self, unit: Unit) -> None:
        self.unit, self.classes = unit, classes_of(unit)
        self.wires = wire_symbols(self.classes, filter(None, map(wire_of, unit.kernels)))
        self.verbs = {role: f"decode-{self.wires[wire_of(role)]}" if wire_of(role) else NAMES[role] for role in unit.kernels}
        self.shares: dict[Role, str] = {}
        self.whole: dict[str, str] = {}
        self.functions = function_symbols(self.classes, [each.name for each in unit.functions])
        longest = max(unit.kernels.values(), key=lambda each: len(each.strides))
        c = named_lanes(unit, frozenset())(longest.strides)
        self.lanes = lanes_of(c.all, c.own, self.classes.constants())
        self.paths = tuple(f".{each.name}" if each.name else "" for each in unit.layout.lanes)
        self.printed: dict[Role, Printed] = {role: self._kernel(role, kernel) for role, kernel in unit.kernels.items()}

    def _kernel(self, role: Role, kernel: Kernel) -> Printed:
        about = About(self.unit.origins.get(role, ()), self.paths, self.functions)
        rows = zip(self.lanes.all, kernel.strides, strict=False)
        lanes = replace(self.lanes, all=tuple(replace(lane, stride=stride) for lane, stride in rows))  # hidden ones have rows of their own
        return print_kernel(kernel, lanes, self.verbs[role], about)

    def head(self) -> str:
        """What the file was made from."""
        said = (MADE, *self.unit.made_from)
        return "".join(f";;; {'  ' * line.startswith(' ')}{comment(line)}\n" for line in said) + "\n"

    def text(self, package: str) -> str:
        """All of it."""
        walks = self._walks()  # which name what the constants must have
        parts = [
            self._package(package),
            definitions(self.classes),
            self._constants(),
            self._codec(),
            *(text for role in self.unit.kernels for text in (self._sites(role), self.printed[role].text)),
            *walks,
            *self._functions_of_the_header(),
        ]
        return self.head() + "\n".join(part.rstrip("\n") + "\n" for part in parts)

    def _package(self, package: str) -> str:
        lines = Lines()
        lines.line(f"(in-package #:{package})")
        lines.line("")
        lines.line("(declaim (sb-ext:muffle-conditions sb-ext:compiler-note))")
        lines.line("")
        more = [*self.functions.values(), *(["*codec*"] if self.unit.state else [])]
        more += [f"{verb}-{wire}" for wire in self.wires.values() for verb in ("decode", "age")]
        lines.groups("(export '(", [*self.classes.exported(), more])
        lines.close(2)
        return lines.text()

    def _constants(self) -> str:
        """The bytes of rows where fields lie."""
        return "".join(f"(defconstant {name} {offset})\n" for name, offset in self.lanes.offsets.items())

    def _sites(self, role: Role) -> str:
        """What can be wrong: the sites that the kernel's function names."""
        sites = self.unit.kernels[role].sites
        lines = Lines()
        with lines.form(f"(defparameter *{self.verbs[role]}-sites*"), lines.form("(sites"):
            lines.line(f'\'((:count "" {literal(NO_MEMORY)} "")')
            lines.column += 2
            for number in self.printed[role].sites[1:]:
                lines.line(self._site(sites[number]))
            lines.column -= 2
            lines.close()
        return lines.text()

    def _site(self, site: Site) -> str:
        parts = f" :parts ({' '.join(map(_part, site.parts))})" if site.parts else ""
        scratch = "" if site.detail_lane is None else f" :scratch codec.{self.lanes.rows(site.detail_lane)}"
        return f"(:{site.kind} {literal(site.path)} {literal(site.detail)} {literal(site.line)}{parts}{scratch})"

    def _walks(self) -> list[str]:
        found: list[str] = []
        take, put = Take(self.classes, self.lanes, "take"), Put(self.classes, self.lanes, "put")
        if "borrow" in self.unit.kernels:
            self.whole["take"] = take.whole()
        self.shares = {role: take.whole(self.wires[wire_of(role)], ways) for role, ways in self.unit.shares.items() if wire_of(role)}
        if take.pending:
            found.append(take.printed())
        if "encode" in self.unit.kernels:
            self.whole["put"] = put.whole()
            found.append(put.printed())
        return found

    def _codec(self) -> str:
        changed = sorted({lane for role in self.unit.shares if wire_of(role) for lane in changed_lanes(self.unit.kernels[role])})
        more = [f"({self.lanes.rows(lane)}.saved (no-octets) :type octets)" for lane in (0, *changed)] if self.wires else []
        more += ["(writer nil)"] if self.wires and "encode" in self.unit.kernels else []
        spilled = max(each.spilled for each in self.printed.values())
        return codec(self.lanes, self.unit.state, more, spilled)

    def _needs_measures(self) -> bool:
        """Whether an encoder reads what measuring has left in lanes that the holder does not have, as sizes of messages within others."""
        hidden = map(self.lanes.place, range(self.lanes.own, len(self.lanes.all)))
        return "encode" in self.printed and any(place in self.printed["encode"].text for place in hidden)

    def _functions_of_the_header(self) -> Iterator[str]:
        """Those that a program calls."""
        sections = dict(part.split("\n", 1) for part in API.read_text("utf-8").split(";; == ")[1:])
        calls_host = asks_host(self.unit.kernels.values())
        filling = {
            **self.whole,
            "type": self.classes.types[self.unit.type],
            "codec": "*codec*" if self.unit.state else "(make-codec)",
            "tell": "(tell codec)" if calls_host else "",
            "measure": "(size-of-rows codec)" if self._needs_measures() else "",
            "empty": "".join(f"\n        {self.lanes.place_of_used(lane)} 0" for lane in range(1, self.lanes.own)),
        }
        apart = bool(self.wires) and "encode" in self.unit.kernels
        filling["apart"] = "(setf codec (writer codec))" if apart else ""
        for role, kernel in self.unit.kernels.items():
            if role == "size":
                continue
            floats = computes_with_floats(kernel) or (role == "encode" and computes_with_floats(self.unit.kernels["size"]))
            around = {"begin": "with-floats" if floats else "progn", "attempts": str(self.printed[role].attempts)}
            section = sections["wire" if wire_of(role) else self.verbs[role]]
            yield _tidy(Template(section).substitute(filling, **around, **self._of_wire(role)))
        if self.wires:
            writer = "\n        (codec.writer codec) nil" if apart else ""
            yield Template(sections["wires"]).substitute(emptied=(filling["empty"] + writer).strip())
        if apart:
            yield sections["writer"]

    def _of_wire(self, role: Role) -> dict[str, str]:
        """The words of the functions of one of several wires."""
        wire = wire_of(role)
        if not wire:
            return {}
        places = [self.lanes.place(lane) for lane in (0, *changed_lanes(self.unit.kernels[role]))]
        saved = [f"{place[: -len(' codec)')]}.saved codec)" for place in places]
        every, last = self.unit.arrivals[wire]
        return {
            "wire": wire,
            "decode": self.verbs[role],
            "age": f"age-{self.wires[wire]}",
            "share": self.shares[role],
            "every": str(every),
            "last": str(last),
            "save": "\n          ".join(f"{spare} (saved {spare} {place})" for place, spare in zip(places, saved, strict=True)),
            "restore": "\n      ".join(f"(replace {place} {spare})" for place, spare in zip(places, saved, strict=True)),
        }


def _tidy(text: str) -> str:
    """Without the lines of what there is not."""
    return re.sub(r"\n +(?=\n)|\n +(?=\))", "", text)


def codec(lanes: Lanes, state: Sequence[tuple[str, int]] = (), more: Sequence[str] = (), spilled: int = 0) -> str:
    """The structure with a vector for each lane, and how many of its rows are in use; one of its own for a mapping that has state.

    ``more`` are the slots of a mapping of several wires, ``spilled`` the bytes that kernels need for locals.
    """
    lines = Lines()
    if state:
        head = "(eval-when (:compile-toplevel :load-toplevel :execute)", "(defparameter *initial-state*", "(list"
        with lines.form(head[0]), lines.form(head[1]), lines.form(head[2]):
            for name, word in state:
                lines.line(str(word), name)
    included = "".join(f" ({each}-registers (apply #'registers *initial-state*))" for each in ("first", "unpack", "pack") if state)
    included += " (forget 'forget-rows)" if more else ""
    included += f" (spilled (make-array {spilled} :element-type 'u8))" if spilled else ""
    options = "(:conc-name codec.) (:constructor make-codec ()) (:copier nil) (:predicate nil)"
    with lines.form(f"(defstruct (codec (:include codec-state{included}) {options})"):
        lines.line('"Memory that is kept from one message to the next. Each thread needs its own."')
        for lane in range(len(lanes.all)):
            size = lanes.stride(0) if lane == 0 else 0
            lines.line(f"({lanes.rows(lane)} (make-array {size} :element-type 'u8) :type octets)")
            if lane:
                lines.line(f"({lanes.used(lane)} 0 :type fixnum)")
        for slot in more:
            lines.line(slot)
    if state:
        lines.line('(defvar *codec* (make-codec) "Keeps the state of the mapping, for functions that are given no other codec.")')
    return lines.text()


def _part(part: Part) -> str:
    """A stretch of bytes that a site stands for."""
    return f"({part.offset} {part.size} {part.step} {literal(part.path)})"
