"""What generated C says of errors are tables: small ones, of which a small machine keeps two directions of a mapping in 3 KB."""

from __future__ import annotations

import re
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest

from rosetta_jit.api.options import request_of
from rosetta_jit.generate.build import Wishes, generated, unit_of
from rosetta_jit.generate.c.language import files
from rosetta_jit.kernel.ir import Part
from tests.generate.driver import compiled, needs_gcc, write
from tests.generate.test_c import BOTH, TORSO

CORTEX_M7 = {
    "gcc 12": ("arm-linux-gnueabihf-gcc", "-mthumb", "-mfloat-abi=hard"),
    "clang 14": ("clang", "--target=thumbv7em-none-eabihf"),
    "clang 14, `-munaligned-access`": ("clang", "--target=thumbv7em-none-eabihf", "-munaligned-access"),
}
PAGE = Path(__file__).resolve().parents[2] / "docs/c.md"
TABLE = re.findall(r"^\| (gcc.*|clang.*) \| ([\d,]+) bytes \| ([\d,]+) bytes \|$", PAGE.read_text("utf-8"), re.MULTILINE)
"""A compiler, and the bytes of both directions with texts and without, as the page says."""
OTHER_COMPILER = 1.1
"""Other versions make a little more."""


@pytest.mark.parametrize("compiler", CORTEX_M7)
@pytest.mark.parametrize("words", [(), ("NO_TEXTS",)])
def test_a_cortex_m7_needs_what_the_page_says(compiler, words, tmp_path):
    """All sections of both directions that take memory; without texts no function divides numbers of 64 bits."""
    command, *machine = CORTEX_M7[compiler]
    if shutil.which(command) is None or shutil.which("size") is None:
        pytest.skip(f"{command} or binutils are not installed")
    write(tmp_path, generated(TORSO, "c", BOTH, "torso_state", Wishes(freestanding=True)))
    options = ("-mcpu=cortex-m7", "-mfpu=fpv5-d16", "-Os", "-ffreestanding", "-fno-pic", *(f"-DTORSO_STATE_{word}" for word in words))
    made = compiled(command, tmp_path, "torso_state", *machine, *options)
    found = int(subprocess.run(["size", made], check=True, capture_output=True, text=True).stdout.splitlines()[1].split()[3])
    said = {name: int(figures[len(words)].replace(",", "")) for name, *figures in TABLE}[compiler]
    version = subprocess.run([command, "--version"], check=True, capture_output=True, text=True).stdout
    if re.search(rf"\b{re.findall(r'[0-9]+', compiler)[0]}\.[0-9]+\.[0-9]+", version):
        assert found == said
    assert found <= OTHER_COMPILER * said
    if words:
        assert b"divmod" not in made.read_bytes()


def torso_with(parts):
    """The torso's unit, of whose sites each lacks such parts; ``detail_lane`` is of a text that the mapping puts together."""
    unit = unit_of(TORSO, BOTH, "torso_state")
    kernels = {
        role: replace(kernel, sites=tuple(replace(site, parts=parts) for site in kernel.sites)) for role, kernel in unit.kernels.items()
    }
    return replace(unit, kernels=kernels)


SAYS = request_of("decode", {"encoding": "ros1"}, mapping="ros1/nav_sat_fix_utm.mapping")
"""It puts the texts of errors together."""
TOLD_APART = {
    "fields": lambda: unit_of(TORSO, BOTH, "torso_state"),
    "fields, and texts of the mapping": lambda: unit_of(SAYS, BOTH, "torso_state"),
    "elements": lambda: torso_with((Part(0, 8, ".a[{}].b", 16),)),
}


@needs_gcc
@pytest.mark.parametrize("compiler", ["gcc", "clang"])
@pytest.mark.parametrize("parts", TOLD_APART)
def test_source_has_no_function_that_it_does_not_call(parts, compiler, tmp_path):
    """What tells parts apart, with texts and without."""
    if shutil.which(compiler) is None:
        pytest.skip(f"{compiler} is not installed")
    name = write(tmp_path, files(TOLD_APART[parts]()))
    for words in ((), ("-DTORSO_STATE_NO_TEXTS",)):
        compiled(compiler, tmp_path, name, *words)
    assert ("step" in (tmp_path / f"{name}.c").read_text()) == (parts == "elements")


@pytest.mark.parametrize("language", ["c", "cpp"])
def test_sites_that_check_the_same_parts_share_a_table(language):
    text = generated(TORSO, language, BOTH, "torso_state")[f"torso_state.{language}"]
    tables = re.findall(r"const (?:struct )?part \w+\[\] = \{\n(.*?)\n\};", text, re.DOTALL)
    assert len(tables) == len(set(tables)) > 1
