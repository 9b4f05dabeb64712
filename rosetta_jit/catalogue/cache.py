"""What the kernel cache warns of. None of it is an error: the kernel is compiled again."""

from __future__ import annotations

from rosetta_jit.diagnostics import Diagnostic


def unusable_folder(folder: str, reason: str) -> Diagnostic:
    return _folder(folder, reason, "give it to its user alone (chmod 700)")


def full_folder(folder: str, reason: str) -> Diagnostic:
    return _folder(folder, reason, "make room there")


def _folder(folder: str, reason: str, remedy: str) -> Diagnostic:
    return Diagnostic(
        "warning",
        "cache-folder",
        f"the cache folder {folder} is not used: {reason}",
        notes=("compiled kernels are kept in memory and are lost when the process ends",),
        help=f"{remedy}, set ROSETTA_JIT_CACHE_DIR to another folder, or set ROSETTA_JIT_CACHE=off",
    )


def damaged_file(name: str, reason: str) -> Diagnostic:
    return Diagnostic(
        "warning",
        "cache-damaged",
        f"the cache file {name} is not used: {reason}",
        notes=("its kernel is compiled again, and the file is replaced",),
        help="`rosetta-jit cache verify` lists all damaged files, `rosetta-jit cache clear` removes them",
    )
