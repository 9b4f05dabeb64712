"""The kernel cache: what was compiled once is loaded by every later process, which then parses and compiles nothing.

Three kinds of file. An *entry* holds the object code of a program; its name is what the code depends on (`cache_names.entry_name`). A
*manifest* leads to it: its name is what was asked for (`cache_names.request_name`), its content the digests of all files that were read for
the answer. A warm process digests those files again and never looks into them. A *note* names a program that cannot be kept, and why.

Whatever is wrong with a file or a folder costs a recompile and one warning, never an error.
"""

from __future__ import annotations

import errno
import os
import sys
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from functools import lru_cache
from typing import TYPE_CHECKING, cast

from rosetta_jit.errors import CacheWarning, warn
from rosetta_jit.runtime.cache.sealed import DamagedError, Entry, seal, unseal
from rosetta_jit.runtime.cache.stores import FolderStore, MemoryStore, Store, Stored, UntrustedError
from rosetta_jit.startup.dataclass import dataclass
from rosetta_jit.startup.sha import sha256

if TYPE_CHECKING:
    from pathlib import Path

    from rosetta_jit.diagnostics import Diagnostic

DEFAULT_MAX_BYTES = 512 * 1024 * 1024
ENTRY, MANIFEST, NOTE = ".kernel", ".manifest", ".note"
OWN = (ENTRY, MANIFEST, NOTE)


@dataclass(frozen=True, slots=True)
class Unkept:
    """A program that is compiled anew in each process, and why. It was so when it was made last."""

    program: str
    reasons: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class CacheInfo:
    """What `rosetta-jit cache info` shows. ``folder`` is None when the cache keeps nothing on disk, ``problem`` says why it cannot."""

    folder: Path | None
    problem: str
    entries: int
    manifests: int
    size_bytes: int
    max_bytes: int
    compiled_anew: tuple[Unkept, ...]


@dataclass(frozen=True, slots=True)
class DamagedFile:
    """One finding of `Cache.verify`."""

    name: str
    reason: str


class Cache:
    """Compiled programs by name, in a folder or, where that is not possible, in memory.

    Parameters
    ----------
    folder : path or None
        Created when first written to, with mode 0700. It must belong to the user, must not be a symbolic link, and nobody else may be
        able to write to it. None keeps everything in memory.
    max_bytes : int
        When exceeded, the files that were not used for the longest time are removed, until an eighth is free. 0 keeps nothing.
    """

    def __init__(self, folder: str | os.PathLike[str] | None, *, max_bytes: int = DEFAULT_MAX_BYTES) -> None:
        self._folder = None if folder is None else os.fspath(folder)
        self.max_bytes = max_bytes
        self._memory = MemoryStore()
        self._store: Store = self._memory if self._folder is None else FolderStore(self._folder)
        self._warned: set[str] = set()

    @staticmethod
    def default() -> Cache:
        """The user's cache, one object a process. ROSETTA_JIT_CACHE_DIR names another folder, ROSETTA_JIT_CACHE=off keeps nothing."""
        return _default(os.environ.get("ROSETTA_JIT_CACHE_DIR", ""), os.environ.get("ROSETTA_JIT_CACHE", ""))

    @property
    def folder(self) -> Path | None:
        """Where the files lie; None where everything is kept in memory."""
        from pathlib import Path

        return None if self._folder is None else Path(self._folder)

    @property
    def is_kept(self) -> bool:
        """Whether later processes find what this one has put here: there is a folder, and writing to it has not failed."""
        return self._folder is not None and "folder" not in self._warned

    @property
    def keeps_nothing(self) -> bool:
        """Whether nobody needs the name of a program: none is found here."""
        return not self.max_bytes

    def get(self, name: str) -> Entry | None:
        """The program of that name, or None."""
        return self._read(name + ENTRY)

    def put(self, name: str, header: Mapping[str, object], image: bytes) -> None:
        """Keep a program; ``header`` holds plain values."""
        self._write(name + ENTRY, header, image)

    def get_manifest(self, request: str) -> str | None:
        """The name of the entry that answers a request, if each file is as it was when the answer was made."""
        manifest = self._read(request + MANIFEST)
        if manifest is None:
            return None
        files = cast("dict[str, str | None]", manifest.header["files"])
        is_search_path = manifest.header.get("search path", sys.path) == sys.path
        unchanged = is_search_path and all(digest_file(path) == digest for path, digest in files.items())
        return cast("str", manifest.header["entry"]) if unchanged else None

    def put_manifest(self, request: str, files: Mapping[str, str | None], entry: str, *, by_search_path: bool = False) -> None:
        """Keep the answer to a request.

        ``files`` gives the SHA-256 of each file as it was read, and None for each path where a file would have been preferred but none was.
        ``by_search_path`` says that modules were found on `sys.path` beside ours: with another one they might be others.
        """
        path = {"search path": sys.path} if by_search_path else {}
        self._write(request + MANIFEST, {"entry": entry, "files": dict(files), **path}, b"")

    def put_note(self, name: str, program: str, reasons: tuple[str, ...]) -> None:
        """Note that a program is not kept, unless the same is noted already."""
        header = {"program": program, "reasons": list(reasons)}
        noted = self._read(name + NOTE)
        if noted is None or noted.header != header:
            self._write(name + NOTE, header, b"")

    def drop_note(self, name: str) -> None:
        """Forget a note: the program is kept."""
        for store in (self._store, self._memory):
            with suppress(OSError, UntrustedError):
                store.remove(name + NOTE)

    def info(self) -> CacheInfo:
        problem = ""
        try:
            stored = self._store.stored()
        except (OSError, UntrustedError) as error:
            stored, problem = self._memory.stored(), str(error)
        return CacheInfo(
            folder=self.folder,
            problem=problem,
            entries=sum(file.name.endswith(ENTRY) for file in stored),
            manifests=sum(file.name.endswith(MANIFEST) for file in stored),
            size_bytes=sum(file.size_bytes for file in stored),
            max_bytes=self.max_bytes,
            compiled_anew=tuple(sorted(self._unkept(stored), key=lambda each: each.program)),
        )

    def verify(self) -> tuple[DamagedFile, ...]:
        """Read everything; the files that would not be used, and why."""
        found = [(file.name, _damage(self._store, file.name)) for file in self._own_files()]
        return tuple(DamagedFile(name, reason) for name, reason in sorted(found) if reason)

    def clear(self) -> int:
        """Remove all entries, manifests and notes, and nothing else; how many there were."""
        from rosetta_jit.runtime.cache.usage import USAGE

        files = self._own_files()
        for file in files:
            self._store.remove(file.name)
        self._store.remove(USAGE)
        return len(files)

    def _read(self, name: str) -> Entry | None:
        try:
            data = self._store.read(name)
        except (OSError, UntrustedError) as error:
            self._warn_of_folder(error)
            data = None
        if data is None:
            data = self._memory.read(name)
        try:
            return None if data is None else unseal(name, data)
        except DamagedError as error:
            from rosetta_jit.catalogue.cache import damaged_file

            self._warn(name, damaged_file(name, str(error)))
            return None

    def _write(self, name: str, header: Mapping[str, object], image: bytes) -> None:
        data = seal(name, header, image)
        try:
            self._store.write(name, data)
            self._keep_small(self._store, len(data))
        except (OSError, UntrustedError) as error:
            self._warn_of_folder(error)
            self._memory.write(name, data)
            self._keep_small(self._memory, len(data))

    def _own_files(self) -> list[Stored]:
        return [file for file in self._store.stored() if file.name.endswith(OWN)]

    def _unkept(self, stored: Iterable[Stored]) -> Iterator[Unkept]:
        for noted in [self._read(file.name) for file in stored if file.name.endswith(NOTE)]:
            if noted is not None:
                yield Unkept(str(noted.header["program"]), tuple(map(str, cast("list[object]", noted.header["reasons"]))))

    def _keep_small(self, store: Store, written_bytes: int) -> None:
        from rosetta_jit.runtime.cache.usage import begin_look, end_look, note

        if note(store, written_bytes, max_bytes=self.max_bytes):
            begin_look(store)
            end_look(store, self._evict(store))

    def _evict(self, store: Store) -> int:
        """Make room where it lacks, and then for more than the next file, which would need another look at all; the bytes that stay."""
        files = sorted(store.stored(), key=lambda file: file.used_ns)
        total = sum(file.size_bytes for file in files)
        if total <= self.max_bytes:
            return total
        for file in files:
            if total <= self.max_bytes * 7 // 8:
                break
            if file.name.endswith(OWN):
                store.remove(file.name)
                total -= file.size_bytes
        return total

    def _warn_of_folder(self, error: Exception) -> None:
        from rosetta_jit.catalogue.cache import full_folder, unusable_folder

        is_full = isinstance(error, OSError) and error.errno in {errno.ENOSPC, errno.EDQUOT}
        self._warn("folder", (full_folder if is_full else unusable_folder)(str(self._folder), str(error)))

    def _warn(self, subject: str, diagnostic: Diagnostic) -> None:
        if subject in self._warned:
            return
        from rosetta_jit.diagnostics import render

        self._warned.add(subject)
        warn(render(diagnostic), CacheWarning)


@lru_cache(maxsize=4)
def _default(folder: str, switch: str) -> Cache:
    if switch.lower() in {"off", "0", "no", "false"}:
        return Cache(None, max_bytes=0)
    return Cache(folder or _users_folder())


def _users_folder() -> str:
    """What platformdirs says, which is asked where it is more than two words: its import takes a tenth of a warm start."""
    if sys.platform == "linux":
        named = os.environ.get("XDG_CACHE_HOME", "").strip()
        return os.path.join(named if os.path.isabs(named) else os.path.expanduser("~/.cache"), "rosetta_jit")
    from platformdirs import user_cache_dir

    return user_cache_dir("rosetta_jit", appauthor=False)


def digest_file(path: str) -> str | None:
    """SHA-256 of a file's content, or None where there is no file to read: mostly, where one would be preferred, which raises nothing."""
    if not os.access(path, os.F_OK):
        return None
    try:
        with open(path, "rb", buffering=0) as file:
            return sha256(file.read()).hexdigest()
    except OSError:
        return None


def _damage(store: Store, name: str) -> str:
    try:
        data = store.read(name)
        if data is not None:
            unseal(name, data)
    except (DamagedError, UntrustedError, OSError) as error:
        return str(error)
    return ""
