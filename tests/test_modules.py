"""Our own finder of modules finds what Python's would, whatever state the folder of the package is in."""

from __future__ import annotations

import os
import py_compile
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

OURS = Path(__file__).resolve().parent.parent / "rosetta_jit/startup/modules.py"
SHOWS = """
import sys
import pack
from pack.inner import one
import pack.two
print(pack.two.VALUE, one.VALUE, type(pack.two.__spec__.loader).__module__, pack.two.__file__ == pack.two.where.__code__.co_filename)
"""
FOUND = "2 1 pack.startup.modules True"


@pytest.fixture
def package(tmp_path):
    """A package with our finder, the compiled files of which are there."""
    package = tmp_path / "place/pack"
    for folder in ("startup", "inner"):
        (package / folder).mkdir(parents=True)
        (package / folder / "__init__.py").touch()
    (package / "__init__.py").write_text("from pack.startup import modules\nmodules.install()\n")
    (package / "two.py").write_text("VALUE = 2\ndef where(): pass\n")
    (package / "inner/one.py").write_text("VALUE = 1\n")
    shutil.copy(OURS, package / "startup")
    assert shown(package) == FOUND
    return package


def shown(package, program=SHOWS, *options, **environment):
    """What a process prints that imports the package, with Python's own settings for compiled files unless others are given."""
    settings = {name: value for name, value in os.environ.items() if name not in ("PYTHONDONTWRITEBYTECODE", "PYTHONPYCACHEPREFIX")}
    environment = {**settings, "PYTHONPATH": str(package.parent), **environment}
    return subprocess.run(
        [sys.executable, *options, "-c", program], env=environment, check=True, capture_output=True, text=True
    ).stdout.strip()


def compiled(package):
    return Path(*(package / "__pycache__").glob("two.*.pyc"))


def test_compiled_files_are_read_again(package):
    when = compiled(package).stat().st_mtime_ns
    assert shown(package) == FOUND
    assert compiled(package).stat().st_mtime_ns == when


def test_an_edited_source_counts(package):
    (package / "two.py").write_text("VALUE = 22\ndef where(): pass\n")
    assert shown(package) == FOUND.replace("2 1", "22 1")
    assert shown(package) == FOUND.replace("2 1", "22 1")  # from what has been compiled meanwhile


def test_a_source_of_another_time_counts(package):
    (package / "two.py").write_text("VALUE = 3\ndef where(): pass\n")
    os.utime(package / "two.py", (1, 1))
    assert shown(package) == FOUND.replace("2 1", "3 1")


def test_no_compiled_file_is_needed(package):
    compiled(package).unlink()
    assert shown(package) == FOUND
    assert compiled(package).exists()


@pytest.mark.parametrize("harm", [b"", b"short", bytes(16)])
def test_a_compiled_file_without_its_head_is_made_anew(package, harm):
    compiled(package).write_bytes(harm)
    assert shown(package) == FOUND
    assert len(compiled(package).read_bytes()) > 100


def test_a_compiled_file_that_is_compared_by_its_hash(package):
    py_compile.compile(str(package / "two.py"), str(compiled(package)), invalidation_mode=py_compile.PycInvalidationMode.CHECKED_HASH)
    (package / "two.py").write_text("VALUE = 4\ndef where(): pass\n")
    assert shown(package) == FOUND.replace("2 1", "4 1")


def test_a_package_that_was_moved(package):
    moved = package.parent.parent / "elsewhere/pack"
    shutil.copytree(package, moved)  # with the times of its files
    assert shown(moved) == FOUND


def test_compiled_files_elsewhere(package, tmp_path):
    shutil.rmtree(package / "__pycache__")
    assert shown(package, PYTHONPYCACHEPREFIX=str(tmp_path / "prefix")) == FOUND
    assert shown(package, PYTHONPYCACHEPREFIX=str(tmp_path / "prefix")) == FOUND
    assert not (package / "__pycache__").exists()


def test_without_assertions(package):
    assert shown(package, SHOWS, "-O") == FOUND
    assert len([*(package / "__pycache__").glob("two.*.pyc")]) == 2


def test_an_archive(package):
    archive = shutil.make_archive(str(package.parent.parent / "archive"), "zip", package.parent)
    assert shown(Path(archive) / "pack") == "2 1 zipimport True"


def test_modules_that_come_and_go(package):
    program = """
import importlib, os
from pathlib import Path
import pack
folder = Path(pack.__file__).parent
(folder / "late.py").write_text("VALUE = 5")
importlib.invalidate_caches()
from pack import late
(folder / "two.py").unlink()
try:
    import pack.two
except (ModuleNotFoundError, FileNotFoundError) as error:
    print(late.VALUE, type(error).__name__)
"""
    assert shown(package, program).startswith("5 ")


def test_a_module_that_is_not_there(package):
    program = "import pack\ntry:\n    import pack.three\nexcept ModuleNotFoundError as error:\n    print(error)"
    assert shown(package, program) == "No module named 'pack.three'"


def test_what_a_loader_tells(package):
    program = """
import inspect, pkgutil
from importlib import resources
import pack, pack.two
print(inspect.getsource(pack.two.where).strip())
print(*sorted(each.name for each in pkgutil.iter_modules(pack.__path__)))
print(resources.files("pack").joinpath("two.py").read_text().split("\\n")[0])
"""
    assert shown(package, program).splitlines() == ["def where(): pass", "inner startup two", "VALUE = 2"]


def test_others_are_not_touched(package):
    (package.parent / "packs.py").write_text("VALUE = 6")
    assert shown(
        package, "import pack, packs, json\nprint(*[type(each.__spec__.loader).__module__ for each in (packs, json)])"
    ) == " ".join(["_frozen_importlib_external"] * 2)


def test_finders_of_others_come_first(package):
    """As those that measure coverage or check types do: they were there before this package."""
    program = """
import sys
from importlib.machinery import ModuleSpec, SourceFileLoader
class Finder:
    def find_spec(self, name, path=None, target=None):
        return ModuleSpec(name, Loader(name, "")) if name == "pack.two" else None
class Loader(SourceFileLoader):
    def get_code(self, fullname):
        return compile("VALUE = 'theirs'", "<theirs>", "exec")
sys.meta_path.insert(0, Finder())
import pack.two
print(pack.two.VALUE)
"""
    assert shown(package, program) == "theirs"
