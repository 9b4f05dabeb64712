"""The module that `rosetta-jit generate --language python` writes: what a lab has that can install nothing."""

from __future__ import annotations

import sys
import types
from typing import TYPE_CHECKING, Any

from bench.peers.base import Peer
from rosetta_jit.api.options import type_request
from rosetta_jit.generate.build import generated

if TYPE_CHECKING:
    from bench.subjects import Subject

WHO = "rosetta_jit, generated Python"


def peers(subject: Subject) -> tuple[Peer, ...]:
    options: Any = {"encoding": subject.encoding, **subject.options}
    texts = generated(type_request("decode", subject.type, options), "python", ("decode", "encode"), "unit")
    module = types.ModuleType(f"generated_{abs(hash(subject.type))}")
    sys.modules[module.__name__] = module
    exec(compile(texts["unit.py"], "unit.py", "exec"), module.__dict__)  # noqa: S102 - what people import
    return (Peer(WHO, "an object, anew; lists of numbers", module.decode, module.encode),)
