"""Whether a package offers frameworks is seen without importlib.metadata, wherever importlib.metadata would see it."""

from __future__ import annotations

import subprocess
import sys
import zipfile
from importlib.metadata import entry_points
from pathlib import Path

import pytest

from rosetta_jit.startup.entry_points import may_be_offered

GROUP = "a.group.of.tests"
OFFERS = f"[{GROUP}]\nthing = somewhere:THING\n"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder in which packages are installed."""
    monkeypatch.setattr(sys, "path", [*(each for each in sys.path if Path(each).is_dir()), str(tmp_path), str(tmp_path / "nowhere")])
    return tmp_path


@pytest.fixture
def own_finders(monkeypatch):
    """An interpreter to which no package has added a finder of its own, which might know of packages anywhere."""
    own = [each for each in sys.meta_path if getattr(each, "__module__", "").startswith("_frozen_importlib")]
    monkeypatch.setattr(sys, "meta_path", own)


@pytest.mark.usefixtures("own_finders")
def test_nothing_is_offered_by_others(folder):
    (folder / "other-1.dist-info").mkdir()
    (folder / "other-1.dist-info" / "entry_points.txt").write_text("[console_scripts]\nother = other:main\n")
    (folder / "bare-1.dist-info").mkdir()
    (folder / "old-1.egg-info").write_text("Name: old\n")
    assert not may_be_offered(GROUP)
    assert not entry_points(group=GROUP)


@pytest.mark.parametrize("name", ["mine-1.dist-info", "mine.egg-info", "MINE-1.DIST-INFO"])
def test_what_is_offered_is_seen(name, folder):
    (folder / name).mkdir()
    (folder / name / "METADATA").write_text("Metadata-Version: 2.1\nName: mine\nVersion: 1\n")
    (folder / name / "PKG-INFO").write_text("Metadata-Version: 2.1\nName: mine\nVersion: 1\n")
    (folder / name / "entry_points.txt").write_text(OFFERS)
    assert may_be_offered(GROUP)
    assert entry_points(group=GROUP)


@pytest.mark.usefixtures("own_finders")
def test_archives_and_other_finders_might_offer_it(folder, monkeypatch):
    assert not may_be_offered(GROUP)
    with zipfile.ZipFile(folder / "packed.zip", "w") as packed:
        packed.writestr("packed-1.dist-info/entry_points.txt", OFFERS)
    monkeypatch.setattr(sys, "path", [*sys.path, str(folder / "packed.zip")])
    assert may_be_offered(GROUP)
    monkeypatch.undo()

    class Finder:
        def find_distributions(self, *_):
            return []

    monkeypatch.setattr(sys, "meta_path", [*sys.meta_path, Finder()])
    assert may_be_offered(GROUP)


def test_a_first_compile_does_without_importlib_metadata():
    program = (
        "import sys; from rosetta_jit.frameworks.installed import installed; installed(); assert 'importlib.metadata' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", program], check=True)
