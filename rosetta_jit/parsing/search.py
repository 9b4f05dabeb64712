"""The search path: where a mapping and what it imports are found.

In this order: texts given by the caller, the importing file's folder, the user's folders (argument, then the environment
variable ROSETTA_JIT_PATH), what is shipped with the package, and the current folder. A file that the user names himself, in an
argument, may also be a path of any form; one that a text imports never leaves the search path, whether it is named from a folder of that
or by an absolute path.
"""

from __future__ import annotations

import os
from codecs import BOM_UTF8
from collections.abc import Iterable, Mapping
from contextlib import suppress
from itertools import islice
from pathlib import Path, PurePosixPath

from rosetta_jit.catalogue import mapping as words
from rosetta_jit.catalogue import suggestions
from rosetta_jit.errors import MappingError, SchemaError
from rosetta_jit.parsing.idl import Load
from rosetta_jit.parsing.limits import MAX_FILE_BYTES, MAX_LISTED_FILES, MAX_TEXT_BYTES
from rosetta_jit.source import Source, shipped_folders
from rosetta_jit.startup.dataclass import dataclass, field, replace
from rosetta_jit.startup.sha import sha256

ENVIRONMENT_VARIABLE = "ROSETTA_JIT_PATH"

UNITS_SUFFIX = ".units"
"""Of files that say of fields which units they have, beside those that declare them."""


@dataclass(frozen=True, slots=True)
class Lookup:
    """One file that was asked for: by which name, by whom, where it was (None where there was none), and the SHA-256 of its text."""

    name: str
    importer: str | None
    found: str | None
    digest: str | None


@dataclass(slots=True)
class Reading:
    """Collects what was read to make a program, for the key of the kernel cache."""

    lookups: list[Lookup] = field(default_factory=list[Lookup])
    size_bytes: int = 0

    def take(self, other: Reading) -> None:
        """Everything that another one has recorded."""
        self.lookups += other.lookups
        self.size_bytes += other.size_bytes

    def record(self, name: str, importer: Source | None, found: Source) -> None:
        data = found.text.encode()
        self.size_bytes += len(data)
        if self.size_bytes > MAX_TEXT_BYTES:
            raise SchemaError((words.texts_too_large(found.name, MAX_TEXT_BYTES),))
        digest = sha256(data).hexdigest()
        self.lookups.append(Lookup(name, importer.name if importer else None, found.name, digest))

    def record_missing(self, name: str, importer: Source | None) -> None:
        self.lookups.append(Lookup(name, importer.name if importer else None, None, None))


@dataclass(frozen=True, slots=True)
class SearchPath:
    """Folders and in-memory files, in the order in which they are searched.

    Parameters
    ----------
    folders
        Searched after ``files`` and the importing file's folder.
    files
        Names and texts, as if they lay on the search path.
    """

    folders: tuple[Path, ...] = ()
    files: tuple[tuple[str, str], ...] = ()

    @classmethod
    def of(
        cls,
        folders: Iterable[str | os.PathLike[str]] = (),
        *,
        files: Mapping[str, str] | None = None,
        environment: Mapping[str, str] = os.environ,
    ) -> SearchPath:
        """The user's search path: ``folders``, those of the environment, the shipped ones, then the current one."""
        named = [folder for folder in environment.get(ENVIRONMENT_VARIABLE, "").split(os.pathsep) if folder]
        users = tuple(Path(folder) for folder in (*folders, *named))
        return cls((*users, *shipped_folders(), Path()), tuple((files or {}).items()))

    def find(self, name: str, importer: Source | None = None) -> Source | None:
        """The file that an import names, or None.

        Raises
        ------
        SchemaError
            The name leaves the search path, or the file or text is too large or no text.
        """
        texts = dict(self.files)
        beside = (Path(importer.name).parent,) if importer and importer.name not in texts else ()
        folders = (*beside, *self.folders)
        why = refusal(name) or ("" if not _is_absolute(name) or _lies_in(name, folders) else "it lies outside of the search path")
        if why:
            raise SchemaError((words.import_name(None, name, why),))
        if name in texts:
            return _from_memory(name, texts[name])
        return next((_read(path) for path in (folder / name for folder in folders) if _is_file(path)), None)

    def alike(self, name: str) -> list[str]:
        """Files that may be meant by the name of one that there is not: those that are called like it, else those of its folder."""
        if refusal(name) or _is_absolute(name):
            return []
        around, called = PurePosixPath(name).parent, PurePosixPath(name).name.casefold()
        found, shipped = [each for each, _ in self.files], shipped_folders()
        for folder in self.folders:
            paths = folder.rglob("*.*") if folder in shipped else (folder / around).glob("*.*")
            found += [path.relative_to(folder).as_posix() for path in _first(paths)]
        same = [each for each in found if PurePosixPath(each).name.casefold() == called]
        return same or [each for each in found if PurePosixPath(each).parent == around]

    def preferred(self, lookup: Lookup) -> tuple[str, ...]:
        """The paths at which a file would have been found before the one that was, or at all."""
        if lookup.importer is None:
            return ()
        beside = () if lookup.importer in dict(self.files) else (Path(lookup.importer).parent,)
        candidates = [str(folder / lookup.name) for folder in (*beside, *self.folders)]
        if lookup.found is None:
            return tuple(candidates)
        return tuple(candidates[: candidates.index(lookup.found)]) if lookup.found in candidates else ()

    def named(self, name: str) -> Source | None:
        """The file that the user names: a text in memory, a path of any form, or a name on the search path; None if there is none.

        Raises
        ------
        SchemaError
            The file or text is too large or no text.
        """
        texts = dict(self.files)
        if name in texts:
            return _from_memory(name, texts[name])
        if _is_file(Path(name)):
            return _read(Path(name))
        return None if refusal(name) or _is_absolute(name) else self.find(name)

    def open(self, path: str | os.PathLike[str]) -> Source:
        """The mapping that the user names, as `named` finds it; raises MappingError where there is none, or it cannot be read."""
        name = os.fspath(path)
        try:
            found = self.named(name)
        except SchemaError as error:
            raise MappingError(error.diagnostics) from error
        if found is None:
            near = suggestions.closest(name, self.alike(name))
            raise MappingError((words.mapping_not_found(name, map(str, self.folders), near),))
        return found

    def loader(self, reading: Reading, importer: Source | None = None) -> Load:
        """`find` as front ends take it: every file that they get is recorded in ``reading``."""

        def load(name: str) -> Source | None:
            found = self.find(name, importer)
            if found is None:
                reading.record_missing(name, importer)
            else:
                reading.record(name, importer, found)
            return found

        return load


def refusal(name: str) -> str:
    """Why a name must not be imported; empty if it may be."""
    parts = PurePosixPath(name).parts
    if not parts or not name.isprintable():
        return "it is not a file name"
    if name.startswith("~") or "\\" in name or ":" in parts[0]:
        return "it is no path that all systems have"
    if ".." in parts:
        return "it leaves the search path"
    return ""


def _is_absolute(name: str) -> bool:
    return PurePosixPath(name).is_absolute()


def _lies_in(name: str, folders: tuple[Path, ...]) -> bool:
    """Whether an absolute path names something in one of some folders."""
    return any(Path(name).is_relative_to(place) for folder in folders for place in (folder.absolute(), folder.resolve()))


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except (OSError, ValueError):  # a name that the file system cannot have
        return False


def _first(paths: Iterable[Path]) -> list[Path]:
    """The first of some files: none of a folder whose name the file system cannot have."""
    found = list[Path]()
    with suppress(OSError, ValueError):
        found.extend(islice(paths, MAX_LISTED_FILES))
    return found


def _read(path: Path) -> Source:
    name = str(path)
    try:
        with path.open("rb") as file:
            data = file.read(MAX_FILE_BYTES + 1)
    except OSError as error:
        why = error.strerror or "unknown reason"
        raise SchemaError((words.file_unreadable(name, why),)) from error
    return _text(name, data)


def _from_memory(name: str, text: str) -> Source:
    """A text that the caller gave, which Python may have let him make of halves of characters."""
    try:
        data = text[: MAX_FILE_BYTES + 1].encode()
    except UnicodeEncodeError as error:
        raise SchemaError((words.file_not_text(name),)) from error
    return replace(_text(name, data), text=text)


def _text(name: str, data: bytes) -> Source:
    if len(data) > MAX_FILE_BYTES:
        raise SchemaError((words.file_too_large(name, MAX_FILE_BYTES),))
    try:
        return Source(name, data.removeprefix(BOM_UTF8).decode())
    except UnicodeDecodeError as error:
        raise SchemaError((words.file_not_text(name),)) from error
