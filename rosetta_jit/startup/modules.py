"""Our own modules found and read with fewer questions: a compiler is some 350 of them, and Python asks each time as if it knew nothing.

`install` puts a finder before Python's own, for the folders of this package alone. It lists a folder once, and reads a module's compiled
file as Python does where that is as new as the source. All else - no compiled file, one elsewhere or too old, an archive - is left to
Python's own finder and loader, of which these are made.
"""

from __future__ import annotations

import os
import sys
from importlib.machinery import SOURCE_SUFFIXES, FileFinder, ModuleSpec, SourceFileLoader
from importlib.util import MAGIC_NUMBER, cache_from_source
from marshal import loads
from types import CodeType, ModuleType

_PACKAGE = os.path.dirname(os.path.dirname(__file__))

_COMPARED_BY_TIME = MAGIC_NUMBER + bytes(4)
"""How a compiled file of this Python begins that is as new as its source if the time and the size which follow are those of the source."""


def install() -> None:
    """Have the modules of this package found so from now on."""
    sys.path_hooks.insert(0, _finder)
    for folder in (_PACKAGE, os.path.dirname(__file__)):  # which have Python's finder already
        sys.path_importer_cache.pop(folder, None)


def _finder(folder: str) -> FileFinder:
    if not f"{folder}{os.sep}".startswith(f"{_PACKAGE}{os.sep}") or not os.path.isdir(folder):
        raise ImportError  # so Python is told that a finder does not know a folder
    return _Folder(folder)


class _Loader(SourceFileLoader):
    """The code of one module."""

    def __init__(self, fullname: str, path: str, compiled: str = "") -> None:
        super().__init__(fullname, path)
        self._compiled = compiled or cache_from_source(path)

    def get_code(self, fullname: str) -> CodeType | None:
        return self._as_compiled() or super().get_code(fullname)

    def _as_compiled(self) -> CodeType | None:
        try:
            source = os.stat(self.path)
            file = os.open(self._compiled, os.O_RDONLY | getattr(os, "O_BINARY", 0))
        except OSError:
            return None
        try:
            data = os.read(file, os.fstat(file).st_size)
        finally:
            os.close(file)
        stamp = b"".join((int(each) & 0xFFFFFFFF).to_bytes(4, "little") for each in (source.st_mtime, source.st_size))
        if data[:16] != _COMPARED_BY_TIME + stamp:
            return None
        code: CodeType = loads(memoryview(data)[16:])  # noqa: S302 - the file that Python would read
        return code if code.co_filename == self.path else None


class _Folder(FileFinder):
    """The modules of one folder."""

    def __init__(self, folder: str) -> None:
        super().__init__(folder, (_Loader, SOURCE_SUFFIXES))
        self._before, self._behind = cache_from_source(f"{folder}/?.py").split("?")
        self._listed = frozenset(os.listdir(folder))

    def find_spec(self, fullname: str, target: ModuleType | None = None) -> ModuleSpec | None:
        name = fullname.rpartition(".")[2]
        if name in self._listed or f"{name}.py" not in self._listed:  # a package, or one that came later
            return super().find_spec(fullname, target)
        path = f"{self.path}/{name}.py"
        compiled = f"{self._before}{name}{self._behind}"
        spec = ModuleSpec(fullname, _Loader(fullname, path, compiled), origin=path)
        spec.has_location, spec.cached = True, compiled
        return spec
