"""Constants of a schema's structs, and values of its enums, are in the generated source, whatever they are called and say."""

from __future__ import annotations

import math
import shutil
import subprocess
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

from rosetta_jit.api.options import type_request
from rosetta_jit.generate.build import generated
from tests.generate import cpp, driver, lisp
from tests.generate.python import BOTH, module
from tests.generate.test_names import words

TEXT = 'a "b" \\ ??/ */ #.(quit) é'
ARM = f"""\
uint8 IDLE=0
uint8 MOVING=1 # on its way \\ */
int8 BACK=-1
int64 LEAST=-9223372036854775808
uint64 MOST=18446744073709551615
int32 LOW=-2147483648
float32 HALF=0.5
float64 TINY=5e-324
float64 NONE=nan
float32 FAR=-inf
bool YES=True
string NAME={TEXT}
uint8 state
uint8 IDLE_
"""
VALUES = {
    "IDLE": 0,
    "MOVING": 1,
    "BACK": -1,
    "LEAST": -(2**63),
    "MOST": 2**64 - 1,
    "LOW": -(2**31),
    "HALF": 0.5,
    "TINY": 5e-324,
    "NONE": math.nan,
    "FAR": -math.inf,
    "YES": True,
    "NAME": TEXT,
}
REQUEST = type_request("decode", "lab/Arm", {"encoding": "ros1", "schema": {"lab/msg/Arm.msg": ARM}})
MODES = 'syntax = "proto3"; package e; enum Mode { OFF = 0; LOW = -2147483648; ON = 5; } message M { Mode mode = 1; }'
OF_MODES = type_request("decode", "e.M", {"encoding": "protobuf", "schema": {"e.proto": MODES}})

IDL = """
const long OUTSIDE = 1;
module other { const long ELSEWHERE = 9; };
module lab {
  const long LIMIT = 3;
  const long class = 4;
  module msg {
    const double HALF = 0.5;
    module Arm_Constants { const octet OK = 5; };
    struct msg { long HALF; };
    struct Arm { sequence<string, LIMIT> names; msg part; };
  };
};
"""
"""Constants stand beside the messages and around them; a struct is called as its module."""
OF_MODULES = type_request("decode", "lab::msg::Arm", {"encoding": "cdr-giop", "framework": "corba", "schema": {"lab.idl": IDL}})


def named_as(language: str) -> tuple[Any, int]:
    """A type whose constants are called as many words of a language, and their number."""
    some = [each for each in words(language) if each[:1].isalpha()]
    text = "".join(f"int32 {name}={number}\n" for number, name in enumerate(some))
    options: Any = {"encoding": "ros1", "schema": {"lab/msg/Words.msg": f"{text}uint8 x\n"}}
    return type_request("decode", "lab/Words", options), len(some)


def checks(before: str) -> str:
    """Statements of C that leave with the number of the first constant whose value is another one."""
    lines = list[str]()
    for number, (name, value) in enumerate(VALUES.items(), 1):
        match value:
            case str():
                said = ", ".join(map(str, [*value.encode(), 0]))
                lines.append(f"    static const unsigned char text_{number}[] = {{{said}}};")
                found = f"memcmp({before}{name}, text_{number}, sizeof text_{number}) == 0"
            case float():
                found = f"{before}{name} != {before}{name}" if math.isnan(value) else f"{before}{name} == {float_of(value)}"
            case _:
                found = f"(uint64_t){before}{name} == UINT64_C({value & 2**64 - 1})"
        lines.append(f"    if (!({found})) return {number};")
    return "\n".join(lines)


def float_of(value: float) -> str:
    return value.hex() if math.isfinite(value) else f"{'-' if value < 0 else ''}INFINITY"


def left_with(program: Path) -> int:
    return subprocess.run([program], check=False).returncode


@driver.needs_gcc
@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_in_c(compiler, tmp_path):
    if shutil.which(compiler) is None:
        pytest.skip(f"{compiler} is not installed")
    for request, name in ((REQUEST, "unit"), (OF_MODES, "modes"), (OF_MODULES, "lab"), (named_as("c")[0], "words")):
        driver.compiled(compiler, tmp_path, driver.write(tmp_path, generated(request, "c", BOTH, name)))
    enum = "    if (modes_Mode_ON != 5 || modes_Mode_LOW != INT32_MIN) return 99;"
    of_modules = "lab_constants_OUTSIDE != 1 || lab_lab_LIMIT != 3 || lab_lab_class != 4 || lab_lab_msg_HALF != 0.5 || lab_Arm_OK != 5"
    text = f"{checks('unit_Arm_')}\n{enum}\n    if ({of_modules}) return 98;\n    return 0;"
    (tmp_path / "main.c").write_text(
        f'#include "unit.h"\n#include "modes.h"\n#include "lab.h"\n#include <math.h>\n#include <string.h>\nint main(void)\n{{\n{text}\n}}\n'
    )
    subprocess.run([compiler, "-std=c11", "-Wall", "-Wextra", "-Werror", "main.c", "-o", "main"], cwd=tmp_path, check=True)
    assert left_with(tmp_path / "main") == 0


@cpp.needs_cpp
def test_in_cpp(tmp_path):
    cpp.write(
        tmp_path,
        {
            each: text
            for name, request in (("unit", REQUEST), ("lab", OF_MODULES), ("words", named_as("c")[0]))
            for each, text in generated(request, "cpp", BOTH, name).items()
        },
    )
    of_modules = "constants::OUTSIDE != 1 || ::lab::lab::LIMIT != 3 || ::lab::lab::class_ != 4 || lab_msg::HALF != 0.5 || Arm::OK != 5"
    text = f"{checks('unit::Arm::')}\n    using namespace lab;\n    if ({of_modules}) return 98;\n    return unit::Arm{{}}.state;"
    (tmp_path / "main.cpp").write_text(
        f'#include "unit.hpp"\n#include "words.hpp"\n#include "lab.hpp"\n#include <cmath>\n#include <cstring>\nint main()\n{{\n{text}\n}}\n'
    )
    subprocess.run(["g++", *cpp.STRICT, "-I.", "main.cpp", "-o", "main"], cwd=tmp_path, check=True)
    assert left_with(tmp_path / "main") == 0


@lisp.needs_sbcl
def test_in_lisp(tmp_path):
    package = lisp.write(tmp_path, generated(REQUEST, "lisp", BOTH, "unit"))
    others = lisp.write(tmp_path, generated(named_as("lisp")[0], "lisp", BOTH, "words"))
    of_modules = lisp.write(tmp_path, generated(OF_MODULES, "lisp", BOTH, "lab"))
    forms = list[str]()
    for name, value in VALUES.items():
        constant = f"{package}:+arm.{name.lower()}+"
        match value:
            case str():
                forms.append(f"(equal (map 'list #'char-code {constant}) '({' '.join(str(ord(each)) for each in value)}))")
            case bool():
                forms.append(f"(eq {constant} t)")
            case float() if math.isnan(value):
                forms.append(f"(sb-ext:float-nan-p {constant})")
            case float() if math.isinf(value):
                forms.append(f"(and (sb-ext:float-infinity-p {constant}) (minusp {constant}))")
            case _:
                forms.append(f"(= {constant} {Fraction(value)})")
    values = {"constants.outside": 1, "lab.limit": 3, "lab.class": 4, "msg-2.half": 0.5, "arm.ok": 5}
    forms += [f"(= {of_modules}:+{name}+ {value})" for name, value in values.items()]
    said = lisp.run(
        *lisp.begun(),
        *(f'(unit "{tmp_path}/" "{each}")' for each in (package, others, of_modules)),
        f"(print (list {' '.join(forms)}))",
        cwd=tmp_path,
    )
    assert said.split() == f"({' '.join(['T'] * len(forms))})".split()


def test_in_python():
    arm = module(REQUEST).Arm
    for name, value in VALUES.items():
        assert repr(getattr(arm, name)) == repr(value)
    assert arm.__slots__ == ("state", "IDLE_")
    assert module(OF_MODES).Mode.ON == 5
    lab = module(OF_MODULES)
    assert (lab.constants.OUTSIDE, lab.lab.LIMIT, lab.lab.class_, lab.lab_msg.HALF, lab.Arm.OK) == (1, 3, 4, 0.5, 5)
    assert not hasattr(lab, "other")


def test_names_in_python():
    request, count = named_as("python")
    found = [value for name, value in vars(module(request).Words).items() if name[:1].isalpha() and isinstance(value, int)]
    assert sorted(found) == [*range(count)]
