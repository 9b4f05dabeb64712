"""Mappings between a bottle and a protobuf message, in both directions, for tests to try."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

import pytest

import rosetta_jit as rj

BACKENDS = ["llvm", "python", "interpreter"]


@dataclass
class Pair:
    """A mapping in both directions, and the wire's own type."""

    decode: Any
    encode: Any
    read: Any
    write: Any

    def unpack(self, **values: object) -> dict[str, object]:
        return self.decode(self.message(**values)).to_dict()

    def pack(self, **values: object) -> dict[str, object]:
        return self.read(self.encode(self.encode.holder_type.from_dict(values))).to_dict()

    def message(self, **values: object) -> bytes:
        return self.write(self.write.holder_type.from_dict(values))

    def refused(self, **values: object) -> rj.EncodeError:
        with pytest.raises(rj.EncodeError) as error:
            self.pack(**values)
        return error.value


def files(wire: str, holder: str, rules: str) -> dict[str, str]:
    head = 'import "wire.bottle-schema"\nimport "holder.proto"\ndata-holder: h.Holder\nwire-schema: wire\n'
    return {
        "wire.bottle-schema": f'"wire" ({wire})',
        "holder.proto": f'syntax = "proto2"; package h;\nenum Mode {{ GRAY = 0; RGB = 1; BGR = 2; }}\nmessage Holder {{ {holder} }}',
        "m.mapping": head + rules,
    }


def pair(wire: str, holder: str, rules: str, backend: str = "interpreter", *, head: str = "") -> Pair:
    texts = files(wire, holder, rules)
    texts["m.mapping"] = head + texts["m.mapping"]
    options: dict[str, Any] = {"schema": texts, "encoding": "yarp3", "backend": backend}
    own = {**options, "imports": ["wire.bottle-schema"]}
    return Pair(
        rj.Decoder("m.mapping", **options),
        rj.Encoder("m.mapping", **options),
        rj.Decoder.of("wire", **own),
        rj.Encoder.of("wire", **own),
    )


class Later:
    """What a module has for several of its tests, made when the first of them asks: modules are imported by every process of a test run."""

    def __init__(self, make: Callable[..., Any], *arguments: object, **options: object) -> None:
        self._made = cache(lambda: make(*arguments, **options))

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):  # by which pytest looks for fixtures
            raise AttributeError(name)
        return getattr(self._made(), name)


def codes(wire: str, holder: str, rules: str) -> list[str]:
    with pytest.raises(rj.MappingError) as error:
        rj.Encoder("m.mapping", schema=files(wire, holder, rules), encoding="yarp3", backend="interpreter")
    return [problem.code for problem in error.value.diagnostics]
