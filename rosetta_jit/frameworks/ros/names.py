"""Which message a file declares, and in which files a message may be declared."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import PurePosixPath

from rosetta_jit.frameworks.ros.dialect import Dialect
from rosetta_jit.startup.dataclass import dataclass

SUFFIX = ".msg"
KINDS = ("srv", "action")
"""Folders of a package besides that of its messages."""


@dataclass(frozen=True, slots=True)
class Declared:
    """The name of a type, taken from that of its file: package (empty where it is missing), kind of interface, and last part."""

    package: str
    folder: str
    short: str


def declared_in(file: str, dialect: Dialect) -> Declared:
    """What ``sensor_msgs/msg/Imu.msg``, ``sensor_msgs/Imu.msg`` or ``std_srvs/srv/Empty.srv`` declares."""
    path = PurePosixPath(file.replace("\\", "/"))
    inside = path.parent.name if path.parent.name in dialect.interfaces else "msg"
    package = _package_folder(path).name
    folder = path.suffix[1:] if path.suffix[1:] in dialect.interfaces else inside
    return Declared(package if dialect.packages.allows(package) else "", folder, path.stem)


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
    home = declared_in(importer, dialect).package
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
    inner = path.parent
    is_kind = inner.name == "msg" or (inner.name in KINDS and inner.parent.name != "")
    return inner.parent if is_kind else inner
