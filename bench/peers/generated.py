"""Generated C and C++, compiled as a person would."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from bench.peers.yarp_native import nanoseconds
from rosetta_jit.api.options import request_of
from rosetta_jit.generate.build import Wishes, generated

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy as np

SOURCES = Path(__file__).resolve().parents[1] / "native"


def generated_cpp(mapping: Path, folder: Path, message: bytes, angles: np.ndarray) -> dict[str, Callable[[int], float]]:
    """The same into protoc's class, where that is installed: our decoder in C++, and two by hand."""
    if shutil.which("protoc") is None:
        return {}
    texts = generated(
        request_of("decode", {"encoding": "yarp3"}, mapping=str(mapping)), "cpp", ("decode",), "joints", Wishes(holder="protobuf")
    )
    for name, text in texts.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text)
    proto = "rst/kinematics/JointAngles"
    subprocess.run(["protoc", f"--cpp_out={folder}", "-I", SOURCES.parents[1] / "idl", f"{proto}.proto"], check=True)
    made = folder / "generated_cpp.so"
    sources = [SOURCES / "generated_protobuf.cpp", "joints.cpp", f"{proto}.pb.cc"]
    options = ["-std=c++17", "-O2", "-fPIC", "-shared", f"-I{folder}", f"-I{SOURCES}"]
    if subprocess.run(["g++", *options, *sources, "-lprotobuf", "-o", made], cwd=folder, check=False).returncode != 0:
        return {}
    library = ctypes.CDLL(str(made))
    found: dict[str, Callable[[int], float]] = {}
    for who in ("codec", "add", "resize"):
        function = getattr(library, f"protobuf_{who}_ns")
        function.restype = ctypes.c_double
        found[who] = partial(nanoseconds, function, (message, ctypes.c_int64(len(message)), angles.ctypes))
    return found


def generated_c(mapping: Path, folder: Path, message: bytes, angles: np.ndarray) -> Callable[[int], float]:
    """The decoder of a mapping of joints: a function from iterations to nanoseconds a message, which fills the angles."""
    for name, text in generated(request_of("decode", {"encoding": "yarp3"}, mapping=str(mapping)), "c", ("decode",), "joints").items():
        (folder / name).write_text(text)
    subprocess.run(["gcc", "-std=c11", "-O2", "-fPIC", "-c", "joints.c", "-o", "joints.o"], cwd=folder, check=True)
    made = folder / "generated.so"
    options = ["-std=c++17", "-O2", "-fPIC", "-shared", f"-I{folder}", f"-I{SOURCES}"]
    subprocess.run(["g++", *options, SOURCES / "generated.cpp", folder / "joints.o", "-o", made], check=True)
    function = ctypes.CDLL(str(made)).generated_decode_ns
    function.restype = ctypes.c_double
    return partial(nanoseconds, function, (message, ctypes.c_int64(len(message)), angles.ctypes))
