"""Generated C in place of compiled kernels, through the functions of its header: whatever decodes and encodes here can do so in C.

C has rows of its own form, structs within structs padded; they are brought into that of the library's holders, and back.
"""

from __future__ import annotations

import ctypes
import hashlib
import subprocess
import tempfile
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import numpy as np

from rosetta_jit.api import programs
from rosetta_jit.generate.build import unit_of
from rosetta_jit.generate.c.header import STATUSES
from rosetta_jit.generate.c.language import files
from rosetta_jit.kernel.state import (
    ERROR_INDICES,
    ERROR_OFFSET,
    ERROR_SITE,
    GROW,
    GROW_LANE,
    GROW_ROWS,
    NOW,
    NUMBER,
    USED,
    lane_word,
)
from rosetta_jit.model.layout import LINK_WORDS, WIDTH, Number, Row, Span, Variant
from rosetta_jit.runtime import run
from rosetta_jit.runtime.program import Loaded

GCC = ("gcc", "-std=c11", "-Wall", "-Wextra", "-Wconversion", "-pedantic", "-Werror")
TRAPS = ("-fsanitize=undefined", "-fsanitize-undefined-trap-on-error", "-fno-sanitize=nonnull-attribute")


class Error(ctypes.Structure):
    _fields_ = (
        ("status", ctypes.c_int),
        ("offset", ctypes.c_int64),
        ("path", ctypes.c_char_p),
        ("indices", ctypes.c_int64 * 4),
        ("detail", ctypes.c_void_p),
        ("detail_size", ctypes.c_size_t),
        ("line", ctypes.c_char_p),
        ("lane", ctypes.c_int64),
        ("missing", ctypes.c_int64),
        ("site", ctypes.c_int),
    )


@cache
def compiled(text: str, header: str, name: str) -> ctypes.CDLL:
    """A shared library, whose undefined behaviour ends the process."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / f"{name}.h").write_text(header)
        (Path(folder) / f"{name}.c").write_text(text)
        made = Path(folder) / "unit.so"
        command = [*GCC, "-O0", *TRAPS, "-shared", "-fPIC", f"{name}.c", "-lm", "-o", made]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        return ctypes.CDLL(str(made))


@dataclass
class Moves:
    """Where the scalars of a row lie in both forms, and its spans, with their lanes."""

    pieces: list[tuple[int, int, int]] = field(default_factory=list)
    spans: list[tuple[int, int]] = field(default_factory=list)

    def walk(self, theirs, ours):
        """C's slot, and the same one of the library."""
        match theirs:
            case Number(offset, scalar):
                self.pieces.append((offset, ours.offset, WIDTH[scalar]))
            case Span(offset, lane):
                self.pieces.append((offset, ours.offset, 16))
                self.spans.append((ours.offset, lane))
            case Row(offset, _, words, members, unknown):
                self.pieces.append((offset, ours.offset, 8 * words))
                if unknown is not None:
                    self.walk(unknown, ours.unknown)
                for one, other in zip(members, ours.members, strict=True):
                    self.walk(one.slot, other.slot)
            case Variant(offset, members):
                self.pieces.append((offset, ours.offset, 8))
                for one, other in zip(members, ours.members, strict=True):
                    self.walk(one.slot, other.slot)
        return self

    def links(self, theirs, ours):
        if theirs is not None:
            self.pieces.append((theirs, ours, 8 * LINK_WORDS))
        return self


class InC:
    """The functions of one unit, and memory for its holder."""

    def __init__(self, request, roles, plain):
        self.unit = unit_of(request, roles, "unit")
        texts = files(self.unit)
        self.library = compiled(texts["unit.c"], texts["unit.h"], "unit")
        self.lanes = self.unit.layout.lanes
        self.plain = plain
        self.moves = [
            Moves().walk(one.element, other.element).links(one.links, other.links)
            for one, other in zip(self.lanes, plain.lanes, strict=True)
        ]
        self.scratch = texts["unit.h"].count("} scratch[") and int(texts["unit.h"].split("} scratch[")[1].split("]")[0])
        self.sites = [run.Site("", "", "", "", (), None)]  # the result of the first would be `run.GROW`
        self.memory: list[np.ndarray] = []  # of the last call: the words of a rejection lie there

    def call(self, function, lanes, row, *arguments, fill):
        """Call with the room that the library's holder has. Gives the status, the error, and the holder's memory."""
        own = len(self.lanes)
        begins = [0 if fill and row == 0 else int(lanes.words[lane_word(k, USED)]) if fill else 0 for k in range(own)]
        rooms = [lanes.capacity(k) - begins[k] for k in range(1, own)]
        rows = [np.zeros(max(1, room) * lane.stride, np.uint8) for room, lane in zip(rooms, self.lanes[1:], strict=True)]
        used = [0] * (own - 1)
        words = np.zeros(self.lanes[0].stride // 8 + 3 * (own - 1) + 2 * self.scratch + 2, np.int64)
        message = words.view(np.uint8)[: self.lanes[0].stride]
        if not fill:
            used = [int(lanes.words[lane_word(k, USED)]) for k in range(1, own)]
            self.put(lanes, row, message, rows, used)
        at = self.lanes[0].stride // 8
        for array, room, count in zip(rows, rooms, used, strict=True):
            words[at : at + 3] = array.ctypes.data, room, count
            at += 3
        sizes = self.scratch_sizes(lanes)
        self.memory = [np.zeros(max(1, size), np.uint8) for size in sizes]
        for array, size in zip(self.memory, sizes, strict=True):
            words[at : at + 2] = array.ctypes.data, size
            at += 2
        words[at:] = lanes.words[NOW], lanes.words[NUMBER] + row
        error = Error()
        given = (ctypes.c_void_p(words.ctypes.data), *arguments, ctypes.byref(error))
        status = getattr(self.library, f"unit_{function}")(*given)
        after = [int(words[self.lanes[0].stride // 8 + 3 * k + 2]) for k in range(own - 1)]
        return status, error, (message, rows, after, begins)

    def scratch_sizes(self, lanes):
        """The library's last lane is scratch, too."""
        hidden = [] if lanes.hidden is None else [buffer.size for buffer in lanes.hidden.buffers]
        sizes = [8 * lanes.capacity(len(self.lanes)), *hidden]
        return (sizes + [0] * self.scratch)[: self.scratch]

    def outcome(self, status, error, lanes, begin):
        """What a kernel returns that failed so, with the words that it leaves."""
        words = lanes.words
        if STATUSES[status] == "full":
            own = len(self.lanes)
            words[GROW_LANE] = error.lane
            words[GROW_ROWS] = -(-error.missing // 8) if error.lane == own else error.missing
            return GROW
        room = ctypes.create_string_buffer(8)
        length = self.library.unit_error_path(ctypes.byref(error), room, ctypes.c_size_t(8))
        room = ctypes.create_string_buffer(length + 1)
        assert self.library.unit_error_path(ctypes.byref(error), room, ctypes.c_size_t(length + 1)) == length
        path = room.value.decode("utf-8", "surrogateescape").replace("{", "{{").replace("}", "}}")
        detail = ctypes.string_at(error.detail, error.detail_size).decode("utf-8", "replace")
        site = run.Site(STATUSES[status], path, detail, error.line.decode(), (), None)
        if site not in self.sites:
            self.sites.append(site)
        words[ERROR_SITE], words[ERROR_OFFSET], words[ERROR_INDICES] = self.sites.index(site), begin + error.offset, 0
        return -1 - self.sites.index(site)

    def take(self, lanes, row, found, begin):
        """Bring C's rows into the holder."""
        message, rows, used, begins = found
        counts = [1, *used]
        bases = [row, *begins[1:]]
        for k, (lane, count, base) in enumerate(zip(self.lanes, counts, bases, strict=True)):
            if count == 0:
                lanes.words[lane_word(k, USED)] = base + count if k else lanes.words[lane_word(0, USED)]
                continue
            theirs = (message if k == 0 else rows[k - 1])[: count * lane.stride].reshape(count, lane.stride)
            stride = self.plain.lanes[k].stride
            ours = lanes.buffers[k][base * stride : (base + count) * stride].reshape(count, stride)
            ours[:] = 0
            for source, target, width in self.moves[k].pieces:
                ours[:, target : target + width] = theirs[:, source : source + width]
            for offset, span in self.moves[k].spans:
                ends = ours[:, offset : offset + 16].copy().view(np.int64)
                ends[:, 0] += np.where(ends[:, 1] < 0, begin, np.where(ends[:, 1] > 0, bases[span], 0))
                ours[:, offset : offset + 16] = ends.view(np.uint8).reshape(count, 16)
            if k:
                lanes.words[lane_word(k, USED)] = base + count

    def put(self, lanes, row, message, rows, used):
        """Bring the holder's rows to C."""
        for k, (lane, count) in enumerate(zip(self.lanes, [1, *used], strict=True)):
            stride, first = self.plain.lanes[k].stride, row if k == 0 else 0
            ours = lanes.buffers[k][first * stride : (first + count) * stride].reshape(count, stride)
            theirs = (message if k == 0 else rows[k - 1])[: count * lane.stride].reshape(count, lane.stride)
            for source, target, width in self.moves[k].pieces:
                theirs[:, source : source + width] = ours[:, target : target + width]

    # --- as kernels of the library -------------------------------------------------------------------------------------

    def decoder(self, role):
        def decode(buffer, begin, end, lanes, row):
            message = (ctypes.c_char * (end - begin)).from_buffer_copy(bytes(buffer[begin:end].data)) if end > begin else None
            status, error, found = self.call(role, lanes, row, message, ctypes.c_size_t(end - begin), fill=True)
            if status != 0:
                return self.outcome(status, error, lanes, begin)
            self.take(lanes, row, found, begin)
            return end

        return decode

    def encode(self, buffer, begin, end, lanes, row):
        spare = 64  # a caller may have more room than is needed
        room, size = (ctypes.c_char * (spare + end - begin))(), ctypes.c_size_t(0)
        given = (room, ctypes.c_size_t(spare + end - begin), ctypes.byref(size))
        status, error, _ = self.call("encode", lanes, row, *given, fill=False)
        if status != 0:
            return self.outcome(status, error, lanes, begin)
        assert size.value <= end - begin, "the message is longer than it was measured"
        buffer[begin : begin + size.value] = np.frombuffer(room, np.uint8)[: size.value]
        return begin + size.value

    def size(self, buffer, begin, end, lanes, row):  # noqa: ARG002 - as kernels have it
        size = ctypes.c_size_t(0)
        status, error, _ = self.call("size", lanes, row, ctypes.byref(size), fill=False)
        return begin + size.value if status == 0 else self.outcome(status, error, lanes, begin)


def loaded_in_c(request) -> Loaded:
    """A program that runs in C."""
    build = programs.build_of(request)
    header = build.header
    if header["host"] or build.functions:
        raise NotImplementedError("functions of the host")
    if build.wires:
        raise NotImplementedError("messages of several wires: tests/generate/test_wires.py has them")
    role = "encode" if request.direction == "encode" else "borrow" if request.borrow else "decode"
    made = InC(request, (role,), build.layout)
    return Loaded(
        holder_type=programs._holder_type(header),
        sites=made.sites,
        kernel=made.encode if role == "encode" else made.decoder(role),
        size=made.size if role == "encode" else None,
        size_sites=made.sites,
        borrow=request.borrow,
        asks_host=header["asks_host"],
        limit=header["limit"],
    )


def name_of(request) -> str:
    """What tells requests apart."""
    return hashlib.sha256(repr(request.key()).encode()).hexdigest()
