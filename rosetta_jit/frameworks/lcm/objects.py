"""Objects of the classes that lcm-gen writes."""

from __future__ import annotations

import sys

from rosetta_jit.runtime.holder.objects.foreign import Foreign


def class_of(owner: type, struct: str) -> type | None:  # noqa: ARG001  packages have one class for a struct
    """The class of a struct, if somebody has imported its package. One without a package has a module of its own."""
    package, _, name = struct.rpartition(".")
    return getattr(sys.modules.get(package or name), name, None)


OBJECTS = Foreign(class_of=class_of)
"""Objects of the classes that lcm-gen writes."""
