"""Every Python example of the documents runs."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests import mapping_examples

ROOT = Path(__file__).resolve().parent.parent
DOCUMENTS = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]


LONG = ("scale.md",)
"""Those that start a cluster."""


@pytest.mark.parametrize("document", [each for each in DOCUMENTS if each.name not in LONG], ids=lambda path: path.name)
def test_examples_run(document):
    run_examples(document)


@pytest.mark.campaign
@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("document", LONG)
def test_long_examples_run(document):
    run_examples(ROOT / "docs" / document)


def run_examples(document):
    names: dict[str, object] = {}
    for block in re.findall(r"```python\n(.*?)```", document.read_text(), re.DOTALL):
        exec(compile(block, str(document), "exec"), names)  # noqa: S102 - our own documents


EXAMPLES = {
    f"{path.name}-{number}": block
    for path in DOCUMENTS
    for number, block in enumerate(re.findall(r"```mapping\n(.*?)```", path.read_text("utf-8"), re.DOTALL))
}


@pytest.mark.parametrize("block", EXAMPLES.values(), ids=EXAMPLES)
def test_mappings_do_what_is_shown_below_them(block):
    mapping_examples.run(block)


@pytest.mark.parametrize(("shown", "instead"), [("turns': 1.5", "turns': 2.5"), ("range .count", "range .turns"), ("540", "541")])
def test_an_example_that_shows_something_else_is_noticed(shown, instead):
    block = next(each for each in EXAMPLES.values() if "tick.mapping" in each).replace('"turns"', "'turns'")
    assert shown in block
    with pytest.raises(AssertionError):
        mapping_examples.run(block.replace(shown, instead))


@pytest.mark.skipif(shutil.which("gcc") is None, reason="the example in C is compiled by gcc, which is not installed")
def test_the_example_in_c_runs(tmp_path, monkeypatch):
    from rosetta_jit.cli import main

    text = (ROOT / "docs" / "c.md").read_text()
    (generate, build, _, bare, firmware), (source, program), (said,) = (
        re.findall(rf"```{kind}\n(.*?)```", text, re.DOTALL) for kind in ("sh", "c", "text")
    )
    monkeypatch.chdir(tmp_path)
    assert main(generate.split()[1:]) == 0
    Path("main.c").write_text(source)
    assert subprocess.run(["sh", "-ec", build], capture_output=True, text=True, check=True).stdout == said
    assert main(bare.split()[1:]) == 0
    Path("firmware.c").write_text(program)
    monkeypatch.setenv("CC", "gcc")  # a compiler for the machine is seldom there; what it has to understand is the same
    monkeypatch.setenv("FLAGS", "-Wall -Wextra -Werror -fno-stack-protector")
    subprocess.run(["sh", "-ec", firmware], check=True)
    needed = subprocess.run(["nm", "-u", "torso_state.o"], capture_output=True, text=True, check=True).stdout.split()
    assert set(needed) <= {"U", "memcpy", "memset"}


@pytest.mark.skipif(shutil.which("cmake") is None or shutil.which("g++") is None, reason="CMake and g++ build the example in C++")
def test_the_example_in_cpp_runs(tmp_path, monkeypatch):
    """The project of the page, as its reader builds it."""
    text = (ROOT / "docs" / "cpp.md").read_text()
    (build,), (project,), (source, _), (said,) = (
        re.findall(rf"```{kind}\n(.*?)```", text, re.DOTALL) for kind in ("sh", "cmake", "cpp", "text")
    )
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PATH", f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}")
    Path("CMakeLists.txt").write_text(project)
    Path("main.cpp").write_text(source)
    done = subprocess.run(["sh", "-ec", build], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.endswith(said)


def test_the_example_in_python_runs(tmp_path, monkeypatch):
    """In a process that does not know this library."""
    from rosetta_jit.cli import main

    text = (ROOT / "docs" / "python.md").read_text()
    (generate, _, wires, again), (source, joined, arrays), (said, sole, shown) = (
        re.findall(rf"```{kind}\n(.*?)```", text, re.DOTALL) for kind in ("sh", "py", "text")
    )
    monkeypatch.chdir(tmp_path)
    assert main(generate.split()[1:]) == 0
    Path("main.py").write_text(source)
    assert subprocess.run([sys.executable, "-S", "main.py"], capture_output=True, text=True, check=True).stdout == said
    for line in wires.splitlines():
        assert main(line.split()[1:]) == 0
    assert subprocess.run([sys.executable, "-S", "-c", joined], capture_output=True, text=True, check=True).stdout == sole
    assert main(again.split()[1:]) == 0
    assert subprocess.run([sys.executable, "-c", arrays], capture_output=True, text=True, check=True).stdout == shown


@pytest.mark.skipif(shutil.which("sbcl") is None, reason="SBCL runs the example in Lisp")
def test_the_example_in_lisp_runs(tmp_path, monkeypatch):
    from rosetta_jit.cli import main

    text = (ROOT / "docs" / "lisp.md").read_text()
    (generate, run), (source,), (said,) = (re.findall(rf"```{kind}\n(.*?)```", text, re.DOTALL) for kind in ("sh", "lisp", "text"))
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert main(generate.split()[1:]) == 0
    Path("main.lisp").write_text(source)
    assert subprocess.run(run.split(), capture_output=True, text=True, check=True).stdout == said


def test_the_documented_mapping_is_the_shipped_one():
    text = (ROOT / "docs" / "mappings.md").read_text()
    shipped = (ROOT / "mappings" / "yarp" / "icub" / "torso_state.mapping").read_text()
    rules = [line.strip() for line in shipped.splitlines() if line.startswith("  ")]
    assert all(rule in text for rule in rules)


def anchors(document):
    """What links may lead to within a document."""
    text = re.sub(r"```.*?```", "", document.read_text("utf-8"), flags=re.DOTALL)
    headings = re.findall(r"(?m)^#+ (.*)$", text)
    return {re.sub(r"[^\w\- ]", "", each.lower()).replace(" ", "-") for each in headings}


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_links_lead_somewhere(document):
    text = re.sub(r"```.*?```", "", document.read_text("utf-8"), flags=re.DOTALL)
    for link in re.findall(r"\]\(([^)\s:]+)\)", text):
        file, _, anchor = link.partition("#")
        found = document.parent / file if file else document
        assert found.exists(), link
        assert not anchor or found.suffix != ".md" or anchor in anchors(found), link
