"""Opening rosbag2's folders: `metadata.yaml` names the files, which are read one after the other."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from typing import Any, cast
from weakref import finalize

from rosetta_jit.catalogue import logs as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.errors import LogError
from rosetta_jit.logs.base import Block, Connection, Extent, Piece, Reader, Wanted
from rosetta_jit.logs.limits import MAX_METADATA_BYTES, MAX_RECORD_BYTES
from rosetta_jit.logs.mcap.reader import McapReader
from rosetta_jit.logs.reading.blocks import blocks_of
from rosetta_jit.logs.reading.compression import Scratch, decompressed, zstd_size
from rosetta_jit.logs.reading.storage import Storage, open_storage
from rosetta_jit.logs.rosbag2.sqlite import SqliteReader
from rosetta_jit.startup.dataclass import replace

PART = 1 << 32
"""Connections of file n are numbered from n times this on."""

ZSTD = bytes.fromhex("28b52ffd")
"""How a frame of zstd begins."""

SUFFIXES = (".db3", ".mcap", ".db3.zstd", ".mcap.zstd")


class Rosbag2Reader:
    """An open folder of a rosbag2."""

    def __init__(self, storage: Storage, tell: Callable[[Diagnostic], None], *, check: bool) -> None:
        self._folder, self._tell, self._check = storage.path, tell, check
        information = self._metadata()
        mode = information.get("compression_mode")
        self._compressed = isinstance(mode, str) and mode.upper() == "MESSAGE"
        self._parts: list[Reader] = []
        for name in self._files(information):
            try:
                self._parts.append(self._opened(self._folder / name))
            except LogError as error:  # the others are read
                for each in error.diagnostics:
                    tell(replace(each, severity="warning"))
        self._compressed = self._compressed or (not information and self._begins_compressed())
        if not self._parts:
            raise LogError((words.not_a(storage.name, "rosbag2: none of its files can be read"),))

    @property
    def connections(self) -> Mapping[int, Connection]:
        numbered = ((place * PART, part.connections) for place, part in enumerate(self._parts))
        return {base + number: replace(each, number=base + number) for base, found in numbered for number, each in found.items()}

    @property
    def extent(self) -> Extent | None:
        found = [each.extent for each in self._parts if each.extent is not None]
        return Extent(min(each.start_ns for each in found), max(each.end_ns for each in found)) if found else None

    @property
    def facts(self) -> Mapping[str, str]:
        return {"files": str(len(self._parts)), **self._parts[0].facts}

    @property
    def pieces(self) -> Sequence[Piece]:
        found = list[Piece]()
        for place, part in enumerate(self._parts):
            for each in part.pieces:
                numbers = None if each.connections is None else frozenset(place * PART + number for number in each.connections)
                found.append(Piece(each.size, each.times, numbers))
        return found

    @property
    def works_ahead(self) -> bool:
        return not self._compressed and all(isinstance(each, McapReader) and each.works_ahead for each in self._parts)

    def blocks(self, wanted: Wanted) -> Iterator[Block]:
        before = 0
        for place, part in enumerate(self._parts):
            base, pieces = place * PART, range(len(part.pieces))
            first = before
            if wanted.pieces is not None:
                pieces = pieces[max(wanted.pieces.start - before, 0) : max(wanted.pieces.stop - before, 0)]
            before += len(part.pieces)
            if not pieces:
                continue
            own = None
            if wanted.connections is not None:
                own = frozenset(each - base for each in wanted.connections if base <= each < base + PART)
                if not own:
                    continue
            blocks = part.blocks(Wanted(own, wanted.start_ns, wanted.end_ns, pieces if wanted.pieces is not None else None))
            for block in blocks_of(self._unpacked(blocks)) if self._compressed else blocks:
                yield Block(block.data, replace(block.rows, channels=block.rows.channels + base), first + block.piece)

    def _begins_compressed(self) -> bool:
        """Whether the first message is compressed by zstd, where no metadata tell: no encoding begins so."""
        block = next((block for part in self._parts for block in part.blocks(Wanted())), None)
        return block is not None and block.data[block.rows.begins[0] :][: len(ZSTD)].tobytes() == ZSTD

    def _unpacked(self, blocks: Iterable[Block]) -> Iterator[tuple[int, int, int, bytes]]:
        """The messages of a bag in which each is compressed by zstd, one by one."""
        scratch = Scratch()
        for block in blocks:
            rows, view = block.rows, block.data.data
            columns = (each.tolist() for each in (rows.channels, rows.log_ns, rows.publish_ns, rows.begins, rows.ends))
            for channel, log_ns, publish_ns, begin, end in zip(*columns, strict=True):
                data = view[begin:end]
                found, wrong = decompressed(str(self._folder), "zstd", data, zstd_size(data), scratch)
                if wrong:
                    self._tell(words.chunk_damaged(str(self._folder), begin, wrong))
                yield channel, log_ns, publish_ns, found.tobytes()

    def _metadata(self) -> dict[str, Any]:
        """What `metadata.yaml` says; nothing where it is damaged or missing."""
        path = self._folder / "metadata.yaml"
        try:
            yaml: Any = import_module("yaml")
        except ImportError:
            raise LogError((words.needs(str(path), "pyyaml", "logs"),)) from None
        try:
            with path.open("rb") as file:
                found = yaml.load(file.read(MAX_METADATA_BYTES), Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader))
            information = found["rosbag2_bagfile_information"]
            return dict(information)
        except FileNotFoundError:
            self._tell(words.missing_file(str(self._folder), path.name))
            return {}
        except (OSError, yaml.YAMLError, KeyError, TypeError, ValueError, RecursionError) as error:
            self._tell(words.bad_index(str(path), str(error).partition("\n")[0]))
            return {}

    def _files(self, information: dict[str, Any]) -> list[str]:
        """The names of the files: those of the metadata, and those that it does not mention."""
        listed: object = information.get("relative_file_paths") or []
        named = [each for each in cast("list[object]", listed) if isinstance(each, str)] if isinstance(listed, list) else []
        if named != listed:
            self._tell(words.bad_index(str(self._folder / "metadata.yaml"), "`relative_file_paths` is no list of names"))
        own = [each for each in named if self._has(each)]
        for each in named:
            if each not in own:
                self._tell(words.missing_file(str(self._folder), each))
        there = sorted(path.name for path in self._folder.iterdir() if path.name.endswith(SUFFIXES))
        unnamed = [each for each in there if each not in {Path(one).name for one in own}]
        for each in unnamed if named else ():
            self._tell(words.unnamed_file(str(self._folder), each))
        return own + unnamed

    def _has(self, name: str) -> bool:
        """Whether a name that the metadata gives is that of a file in the folder; the file system may not even have such names."""
        path = Path(name)
        with suppress(OSError, ValueError):
            return not path.is_absolute() and ".." not in path.parts and (self._folder / path).is_file()
        return False

    def _opened(self, path: Path) -> Reader:
        if path.suffix == ".zstd":
            path = self._decompressed(path)
        storage = open_storage(str(path))
        if storage.read(0, 5) == b"\x89MCAP":
            return McapReader(storage, self._tell, check=self._check)
        return SqliteReader(storage, self._tell, check=self._check)

    def _decompressed(self, path: Path) -> Path:
        """A file that was compressed as a whole, as a temporary file as long as the log is open."""
        try:
            zstandard: Any = import_module("zstandard")
        except ImportError:
            raise LogError((words.needs(str(path), "zstandard", "logs"),)) from None
        folder = tempfile.mkdtemp(prefix="rosetta-jit-")
        finalize(self, shutil.rmtree, folder, ignore_errors=True)
        target = Path(folder) / path.stem
        room = shutil.disk_usage(folder).free // 2
        with path.open("rb") as file, target.open("wb") as out:
            try:
                with zstandard.ZstdDecompressor(max_window_size=MAX_RECORD_BYTES).stream_reader(file) as stream:
                    while piece := stream.read(1 << 20):
                        out.write(piece)
                        if out.tell() > room:
                            raise LogError((words.unreadable(str(path), "it holds more than half of the disk has room for"),))
            except zstandard.ZstdError as error:
                self._tell(words.chunk_damaged(str(path), out.tell(), str(error)))
        return target
