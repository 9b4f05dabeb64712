"""Which message a file declares, and in which files a message may be declared."""

from __future__ import annotations

from pathlib import PurePosixPath
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rosetta_jit.frameworks.ros.dialect import Dialect

SUFFIX = ".msg"


def declared_in(file: str, dialect: Dialect) -> tuple[str, str]:
    """The package and the name of the message of ``sensor_msgs/msg/Imu.msg`` or ``sensor_msgs/Imu.msg``; no package if none is told."""
    path = PurePosixPath(file.replace("\\", "/"))
    package = _package_folder(path).name
    return package if dialect.packages.allows(package) else "", path.name.removesuffix(SUFFIX)


def split(name: str) -> tuple[str, str]:
    """The package and the last part of a qualified name."""
    parts = name.split("/")
    return parts[0] if len(parts) > 1 else "", parts[-1]


def places(name: str, importer: str, dialect: Dialect) -> Iterator[str]:
    """Where a message may be declared, in the order in which it is looked for.

    Beside the importing file if it is of the same package, then on the search path, then among the folders around the importing one
    (``ros1-2012/std_msgs/Header.msg`` for a file of ``ros1-2012/nav_msgs``), then among the shipped ones.
    """
    package, short = split(name)
    home = declared_in(importer, dialect)[0]
    if not package or package == home:
        yield f"{short}{SUFFIX}"
    if not package:
        return
    inside = f"{package}/{short}{SUFFIX}", f"{package}/msg/{short}{SUFFIX}"
    yield inside[1]
    yield inside[0]
    around = _package_folder(PurePosixPath(importer.replace("\\", "/"))).parent.name
    for folder in dict.fromkeys((around, dialect.name)):
        if folder not in ("", ".."):
            yield f"{folder}/{inside[0]}"
            yield f"{folder}/{inside[1]}"


def _package_folder(path: PurePosixPath) -> PurePosixPath:
    return path.parent.parent if path.parent.name == "msg" else path.parent
