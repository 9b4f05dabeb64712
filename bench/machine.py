"""What a run was made on and with, for its report."""

from __future__ import annotations

import os
import shutil
import subprocess
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from bench.peers import packages
from bench.peers.native import absent, built

LIBRARIES = ("rosetta-jit", "numpy", "numba", "llvmlite", "pytest-benchmark")


def versions() -> dict[str, str]:
    """Programs and libraries by name, those of the peers included."""
    from llvmlite import binding

    found = {name: _version(name) for name in (*LIBRARIES, *packages())}
    return {
        **found,
        "LLVM": ".".join(map(str, binding.llvm_version_info)),
        "C++ compiler": _compiler(),
        "native peers": ", ".join(built()) or "none",
        "native peers not built": ", ".join(absent()) or "none",
        "load average": ", ".join(f"{load:.1f}" for load in os.getloadavg()),
        "clock": _governor(),
    }


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"


def _compiler() -> str:
    program = shutil.which("g++") or shutil.which("c++")
    if program is None:
        return "none"
    return subprocess.run([program, "--version"], capture_output=True, text=True, check=True).stdout.partition("\n")[0]


def _governor() -> str:
    path = Path("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor")
    return path.read_text("utf-8").strip() if path.exists() else "not told"
