"""Generated C, and objects, on microcontrollers: boards that QEMU emulates, which refuse what the processor refuses.

The programs are built with newlib, which reads and writes the files of whoever debugs the board.
"""

from __future__ import annotations

import re
import shutil
import struct
import subprocess
from dataclasses import dataclass
from pathlib import Path

import pytest

import rosetta_jit as rj
from rosetta_jit.cli import main
from rosetta_jit.generate.build import generated, object_of
from tests.generate import driver
from tests.generate.driver import answers, expected, harmed, write
from tests.generate.native import ROOT
from tests.generate.test_c import BOTH, SUBJECTS

HERE = Path(__file__).with_name("cortex_m")
GCC, QEMU = "arm-none-eabi-gcc", "qemu-system-arm"


@dataclass(frozen=True)
class Board:
    """One of QEMU's, what gcc is told of its processor, and how LLVM calls it."""

    name: str
    flags: tuple[str, ...]
    triple: str
    cpu: str

    @property
    def runner(self) -> tuple[str, ...]:
        """What runs a program."""
        quiet = ("-nographic", "-monitor", "none", "-serial", "none")
        return (QEMU, "-M", self.name, *quiet, "-semihosting-config", "enable=on,target=native", "-kernel")

    def program(self, made: Path, *words: str | Path) -> Path:
        """A program for it, from sources and objects."""
        asked = [GCC, *self.flags, "-print-file-name=rdimon-crt0.o"]
        begin = subprocess.run(asked, capture_output=True, text=True, check=True).stdout.strip()
        around = ("--specs=rdimon.specs", "-nostartfiles", "-T", HERE / "board.ld", HERE / "start.c", begin, "-lm")
        command = [GCC, *self.flags, "-std=gnu11", "-O2", "-ffp-contract=off", *words, *around, "-o", made]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        return made


M7 = Board("mps2-an500", ("-mcpu=cortex-m7", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv5-d16"), "thumbv7em-none-eabihf", "cortex-m7")
M3 = Board("mps2-an385", ("-mcpu=cortex-m3", "-mthumb"), "thumbv7m-none-eabi", "cortex-m3")
BOARDS = {each.cpu: each for each in (M7, M3)}

pytestmark = pytest.mark.skipif(
    shutil.which(GCC) is None or shutil.which(QEMU) is None, reason="gcc for Cortex-M or QEMU's boards are not installed"
)


@pytest.mark.parametrize("how", ["source", "object"])
@pytest.mark.parametrize("name", SUBJECTS)
@pytest.mark.parametrize("board", BOARDS.values(), ids=BOARDS)
def test_a_board_answers_as_the_library_does(board, name, how, tmp_path):
    request, good = SUBJECTS[name]
    if how == "source":
        write(tmp_path, generated(request, "c", BOTH, name))
        unit: tuple[Path, ...] = (tmp_path / f"{name}.c",)
    else:
        write(tmp_path, object_of(request, BOTH, name, board.triple, board.cpu))
        calls = tmp_path / "calls.c"
        calls.write_text(f'#define {name.upper()}_IMPLEMENTATION\n#include "{name}.h"\n')
        unit = (calls, tmp_path / f"{name}.o")
    words = (f'-DHEADER="{name}.h"', f"-DUNIT={name}", f"-I{tmp_path}")
    program = board.program(tmp_path / "program", *words, driver.MAIN, *unit)
    messages = harmed(good, 8, name)
    found = answers(program, messages, *board.runner)
    of = (rj.Decoder, rj.Encoder) if request.mapping else (rj.Decoder.of, rj.Encoder.of)
    decode, encode = (each(request.mapping or request.type, encoding=request.encoding) for each in of)
    assert found == [expected(decode, encode, message) for message in messages]


def test_the_firmware_of_the_documentation_answers(tmp_path, monkeypatch):
    """From zero to a running program: all blocks of the page's section, and a serial line around them."""
    text = (ROOT / "docs" / "c.md").read_text().partition("## On a microcontroller")[2].partition("\n## ")[0]
    (firmware,), (generate, _) = (re.findall(rf"```{kind}\n(.*?)```", text, re.DOTALL) for kind in ("c", "sh"))
    flags = re.search(r"`FLAGS` of the machine, as `(.*?)`", text)
    assert flags is not None
    assert tuple(flags[1].split()) == M7.flags
    monkeypatch.chdir(tmp_path)
    assert main(generate.split()[1:]) == 0
    Path("firmware.c").write_text(firmware)
    program = M7.program(tmp_path / "program", "firmware.c", "torso_state.c", HERE / "serial.c")
    message = struct.pack("<ii3d", 266, 3, 10.0, 20.0, 30.0)
    said = subprocess.run([*M7.runner, program], input=message, capture_output=True, check=True).stdout
    yaw, *others = struct.unpack("<ii3d", bytes.fromhex(said.decode()))[2:]
    assert yaw == 0
    assert others == pytest.approx([20, 30], rel=1e-6)
    assert subprocess.run([*M7.runner, program], input=message[:20], capture_output=True, check=True).stdout == b"\n"
