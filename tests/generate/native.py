"""The real classes of frameworks: where their headers and generators are installed, what a program with them is compiled with."""

from __future__ import annotations

import base64
import json
import shutil
import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from tests.generate import cpp

if TYPE_CHECKING:
    from collections.abc import Iterable

ROOT = Path(__file__).resolve().parents[2]
PEER = ROOT / "tests" / "vectors" / "protobuf" / "peer.json"
ROS1 = ("sensor_msgs/JointState", "std_msgs/UInt8MultiArray", "geometry_msgs/PoseArray", "sensor_msgs/CameraInfo")
LCM = ("exlcm.example_t", "lcmtest.multidim_array_t", "lcmtest.byte_array_t", "rjtest.doubles_t")
PROTOBUF = ("rj.Image", "rj.Scalars", "rj.Repeats", "rj.Groups", "rj.OneOf", "rj.Maps", "rj3.All")


@cache
def finds(*headers: str) -> bool:
    """Whether the compiler finds headers by itself."""
    text = "".join(f"#include <{header}>\n" for header in headers)
    done = subprocess.run(["g++", "-std=c++17", "-E", "-x", "c++", "-"], input=text, capture_output=True, text=True, check=False)
    return done.returncode == 0


def of_roscpp(type_: str, folder: Path) -> tuple[list[str], str]:
    """Options of the compiler, and the header to include if it is not the usual one."""
    if not finds(f"{type_}.h"):
        pytest.skip(f"{type_} of roscpp is not installed")
    return ["-lroscpp_serialization", "-lrostime", "-lcpp_common"], ""


def of_lcm(type_: str, folder: Path) -> tuple[list[str], str]:
    """The same of lcm-gen."""
    generator = shutil.which("lcm-gen", path=f"{Path(sys.executable).parent}:{Path('/usr/bin')}")
    if generator is None or not finds("lcm/lcm_coretypes.h"):
        pytest.skip("lcm-gen is not installed")
    for source in (ROOT / "idl" / "lcm" / type_.split(".", maxsplit=1)[0]).glob("*.lcm"):
        subprocess.run([generator, "--cpp", "--cpp-hpath", folder, source], check=True, capture_output=True)
    return ["-isystem", str(folder)], ""


def of_protoc(type_: str, folder: Path) -> tuple[list[str], str]:
    """The same of protoc."""
    needs_protoc()
    (folder / "set.pb").write_bytes(base64.b64decode(json.loads(PEER.read_text())["file_descriptor_set_b64"]))
    package = type_.split(".", maxsplit=1)[0]
    subprocess.run(["protoc", "--descriptor_set_in=set.pb", "--cpp_out=.", f"{package}.proto"], cwd=folder, check=True)
    return ["-isystem", str(folder), "-w", f"{folder}/{package}.pb.cc", "-lprotobuf"], f"{package}.pb.h"


def needs_protoc() -> None:
    """Skip where the real protoc is not installed."""
    if shutil.which("protoc") is None or not finds("google/protobuf/message.h"):
        pytest.skip("protoc and its library are not installed")


def protoc(folder: Path, name: str, text: str) -> None:
    """A schema's file, and the classes that the real protoc makes of it."""
    needs_protoc()
    (folder / f"{name}.proto").write_text(text)
    subprocess.run(["protoc", "--cpp_out=.", f"{name}.proto"], cwd=folder, check=True)


def program_of_protoc(folder: Path, unit: str, classes: str, options: tuple[str, ...], units: Iterable[str] = ()) -> Path:
    """The program around a unit that fills protoc's classes."""
    options = (*options, f"-isystem{folder}")
    return cpp.program(folder, unit, "-lprotobuf", options=options, units=units, classes=f"{classes}.pb.cc")


OF = {"ros1": of_roscpp, "lcm": of_lcm, "protobuf": of_protoc}
NATIVE = [*(("ros1", each) for each in ROS1), *(("lcm", each) for each in LCM), *(("protobuf", each) for each in PROTOBUF)]
