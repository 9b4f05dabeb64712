"""Classes of frameworks, filled by generated C++ and by the code of the framework itself."""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
from dataclasses import dataclass
from typing import TYPE_CHECKING

from bench.peers.generated import SOURCES
from rosetta_jit.generate.build import Wishes, generated

if TYPE_CHECKING:
    from pathlib import Path

    from rosetta_jit.pipeline.request import Request

ROSCPP = ("-lroscpp_serialization", "-lrostime", "-lcpp_common")
LIBRARIES = {"ros1": ROSCPP, "ros2": ROSCPP, "protobuf": ("-lprotobuf",), "lcm": ()}
FAST_CDR = "fastcdr/Cdr.h"
HEADERS = {
    "ros1": "sensor_msgs/JointState.h",
    "ros2": "sensor_msgs/JointState.h",
    "protobuf": "google/protobuf/message.h",
    "lcm": "lcm/lcm_coretypes.h",
}
GENERATORS = {"protobuf": "protoc", "ros2": "rosidl", "lcm": "lcm-gen"}
ROSIDL = tuple(f"-I/usr/include/rosidl_runtime_{each}" for each in ("c", "cpp"))
"""What the structs of rclcpp include besides."""
IDL = SOURCES.parents[1] / "idl"
RCLCPP = {
    "builtin_interfaces": ("Time",),
    "std_msgs": ("Header",),
    "geometry_msgs": ("Point", "Quaternion", "Vector3", "Pose", "PoseArray"),
    "sensor_msgs": ("Imu", "JointState", "LaserScan", "Image"),
}
"""The structs of rclcpp that are made."""


ENCAPSULATION = bytes((0, 1, 0, 0))
"""What little-endian CDR begins with in ROS 2."""


def installed(holder: str) -> bool:
    """Whether the framework's generator, headers and compiler are."""
    return all(shutil.which(each) is not None for each in ("g++", GENERATORS.get(holder, "g++"))) and _is_found(HEADERS[holder])


def has_fast_cdr() -> bool:
    """Whether Fast CDR is installed, with which ROS 2's default middleware reads and writes."""
    return _is_found(FAST_CDR)


def _is_found(header: str) -> bool:
    command = ["g++", "-std=c++17", *_flags("CPPFLAGS"), "-E", "-x", "c++", "-"]
    return subprocess.run(command, input=f"#include <{header}>\n", capture_output=True, text=True, check=False).returncode == 0


def _flags(name: str) -> list[str]:
    """Where headers and libraries lie that no compiler looks for by itself."""
    return shlex.split(os.environ.get(name, ""))


@dataclass(frozen=True, slots=True)
class Messages:
    """The same data twice: as generated code reads it, and as the framework's own does."""

    ours: bytes
    theirs: bytes


def program(request: Request, holder: str, folder: Path, *, proto: str = "", lcm: Path | None = None, peer: str = "") -> Path:
    """A program that measures both; protoc makes the class from ``proto``, lcm-gen from ``lcm``.

    Of ROS 2 the other one is Fast CDR, if it is installed; else roscpp, which fills its struct ``peer`` of the same data.
    """
    include = proto.replace(".proto", ".pb.h")
    for name, text in generated(request, "cpp", ("decode", "encode"), "unit", Wishes(holder=holder, include=include)).items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text)
    sources = [str(SOURCES / "classes.cpp"), "unit.cpp"]
    if proto:
        subprocess.run(["protoc", f"--cpp_out={folder}", "-I", SOURCES, "-I", IDL, proto], check=True)
        sources.append(proto.replace(".proto", ".pb.cc"))
    if lcm is not None:
        subprocess.run(["lcm-gen", "--cpp", "--cpp-hpath", folder, lcm], check=True, capture_output=True)
    if peer:
        _structs_of_rclcpp(folder)
    words = ['-DHEADER="unit.hpp"', "-DUNIT=unit", f"-D{holder.upper()}"]
    libraries = LIBRARIES[holder]
    if peer and has_fast_cdr():
        words, libraries = [*words, "-DFASTCDR", *ROSIDL], ("-lfastcdr",)
    elif peer:
        words += [f'-DPEER_HEADER="{peer}.h"', f"-DPEER={peer.replace('/', '::')}", *ROSIDL]
    options = ["-std=c++17", "-O2", f"-I{folder}", f"-I{SOURCES}", *_flags("CPPFLAGS"), *words]
    made = folder / "classes"
    subprocess.run(["g++", *options, *sources, *_flags("LDFLAGS"), *libraries, "-o", made], cwd=folder, check=True)
    return made


def _structs_of_rclcpp(folder: Path) -> None:
    """The headers that ROS 2's own generator writes."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    for package, names in RCLCPP.items():
        files = [f"msg/{name}.msg" for name in names]
        command = ["rosidl", "generate", "-o", str(folder / package), "-t", "cpp", "-I", "..", package, *files]
        subprocess.run(command, cwd=IDL / "ros2" / package, env=environment, check=True, capture_output=True)


def measured(program: Path, messages: Messages, rounds: int, round_s: float) -> dict[str, tuple[float, ...]]:
    """Nanoseconds a message, a figure a round, by who and job, as ``"ours decode"``; it fails where both do not read and write the same."""
    for name in ("ours", "theirs"):
        program.with_name(name).write_bytes(getattr(messages, name))
    command = [str(program), *(str(program.with_name(name)) for name in ("ours", "theirs")), str(rounds), str(round_s)]
    said = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    found: dict[str, list[float]] = {}
    for line in said.splitlines():
        who, took = line.rsplit(" ", 1)
        found.setdefault(who, []).append(float(took))
    return {who: tuple(taken) for who, taken in found.items()}
