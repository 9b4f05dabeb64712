"""Routes as they stand in files of bridges."""

from __future__ import annotations

TORSO = "yarp/icub/torso_state.mapping"
MAPPED = f'mapping = "{TORSO}"\ndecode = {{ encoding = "yarp4" }}'


def route(source, target, *lines):
    return "\n".join(["[[route]]", f'source = "tcp:{source}"', f'target = "tcp:{target}"', *lines, ""])
