"""Our own modules found and read with fewer questions: a compiler is some 350 of them, and Python asks each time as if it knew nothing.

`install` puts a finder before Python's own, for the modules of this package alone. Where Python lists folders and asks the finder of each,
it looks whether the file is there that a name stands for, and reads a module's compiled file as Python does where that is as new
as the source. All else - no compiled file, one elsewhere or too old, an archive - is left to Python's own finder and loader.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from importlib.machinery import BuiltinImporter, FrozenImporter, ModuleSpec, PathFinder, SourceFileLoader
from importlib.util import MAGIC_NUMBER, cache_from_source
from marshal import loads
from stat import S_ISREG
from struct import pack
from types import CodeType, ModuleType
from typing import Any

_FOLDER = os.path.dirname(os.path.dirname(__file__))
_PREFIX = f"{__name__.partition('.')[0]}."

_IN_VAIN: tuple[Any, ...] = (BuiltinImporter, FrozenImporter)
"""Python's own finders that need not be asked for a module of ours."""

_COMPARED_BY_TIME = MAGIC_NUMBER + bytes(4)
"""How a compiled file of this Python begins that is as new as its source if the time and the size which follow are those of the source."""

_ROOM = 1 << 18
"""Bytes of a compiled file that are read at once; a longer one is left to Python."""

_ROOMS: list[bytearray] = []
"""Where files are read to, one for each thread that imports at the time: a new place for each file would be cleared by the system first."""


def install() -> None:
    """Have the modules of this package found so from now on, where names of files that differ in case are different files.

    Finders that others have put before Python's own are asked before ours, too: they may change what they find.
    """
    if sys.platform == "linux" and PathFinder in sys.meta_path:
        place = sys.meta_path.index(PathFinder)
        while place and sys.meta_path[place - 1] in _IN_VAIN:
            place -= 1
        sys.meta_path.insert(place, _Finder())


class _Finder:
    """The modules of this package that are in folders."""

    def __init__(self) -> None:
        self._compiled: dict[str, tuple[str, str]] = {}

    def find_spec(self, fullname: str, path: Sequence[str] | None = None, target: ModuleType | None = None) -> ModuleSpec | None:
        """As of each finder; None leaves a module to the others."""
        del target
        if path is None or not fullname.startswith(_PREFIX) or len(path) != 1 or not path[0].startswith(_FOLDER):
            return None
        place = f"{path[0]}/{fullname.rpartition('.')[2]}"
        found = self._spec(fullname, path[0], f"{place}.py")
        if found is None:
            found = self._spec(fullname, place, f"{place}/__init__.py")
            if found is not None:
                found.submodule_search_locations = [place]
        return found

    def _spec(self, fullname: str, folder: str, source: str) -> ModuleSpec | None:
        """The module of a source file in a folder, if there is one."""
        try:
            found = os.stat(source)
        except OSError:
            return None
        if not S_ISREG(found.st_mode):
            return None
        around = self._compiled.get(folder)
        if around is None:
            before, _, behind = cache_from_source(f"{folder}/?.py").rpartition("?")
            around = self._compiled[folder] = before, behind
        compiled = source[len(folder) + 1 : -3].join(around)
        spec = ModuleSpec(fullname, _Loader(fullname, source, compiled, found), origin=source)
        spec.has_location, spec.cached = True, compiled
        return spec


class _Loader(SourceFileLoader):
    """The code of one module, whose source file was ``found`` so."""

    def __init__(self, fullname: str, path: str, compiled: str, found: os.stat_result) -> None:
        super().__init__(fullname, path)
        self._compiled, self._found = compiled, found

    def get_code(self, fullname: str) -> CodeType | None:
        return self._as_compiled() or super().get_code(fullname)

    def _as_compiled(self) -> CodeType | None:
        try:
            file = os.open(self._compiled, os.O_RDONLY)
        except OSError:
            return None
        room = _ROOMS.pop() if _ROOMS else bytearray(_ROOM)
        try:
            size = os.preadv(file, (room,), 0)
            stamp = pack("<II", int(self._found.st_mtime) & 0xFFFFFFFF, self._found.st_size & 0xFFFFFFFF)
            if size == _ROOM or not room.startswith(_COMPARED_BY_TIME + stamp):
                return None
            code: CodeType = loads(memoryview(room)[16:size])  # noqa: S302 - the file that Python would read
        finally:
            os.close(file)
            _ROOMS.append(room)
        return code if code.co_filename == self.path else None
