"""Mappings of several wires as users hold them: a decoder for each wire, which fill one holder together, or an encoder for each."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, Generic, TypedDict, TypeVar, Unpack

from rosetta_jit.api.decoder import Decoder
from rosetta_jit.api.encoder import Encoder
from rosetta_jit.api.options import Options, request_of
from rosetta_jit.api.programs import program_of
from rosetta_jit.kernel.state import VALID
from rosetta_jit.pipeline.request import Direction, Request
from rosetta_jit.runtime.arrivals import ages
from rosetta_jit.runtime.holder import Holder
from rosetta_jit.runtime.program import shared_of, wires_of
from rosetta_jit.startup.dataclass import replace
from rosetta_jit.startup.garbage import imported

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer as Buffer

    from rosetta_jit.pipeline.checked_mapping import CheckedMapping

_Program = TypeVar("_Program", Decoder, Encoder)


class _Encodings(TypedDict, total=False):
    encodings: Mapping[str, str]


class WireOptions(Options, _Encodings, total=False):
    """As `Options`, for all wires.

    Attributes
    ----------
    encodings : mapping of str to str
        How the messages of some wires are encoded, by the names of the wires.
    """


class _Programs(Mapping[str, _Program], Generic[_Program]):
    """A program for each wire of a mapping, by the names of the wires: `programs["pose"]`, or `programs.pose`."""

    _direction: Direction

    def __init__(self, mapping: str | os.PathLike[str], **options: Unpack[WireOptions]) -> None:
        encodings = dict(options.pop("encodings", {}))
        request = request_of(self._direction, options, mapping=os.fspath(mapping))
        first = program_of(_of_wire(request, next(iter(encodings), ""), encodings))
        wires = wires_of(first)
        for unknown in sorted(set(encodings) - set(wires)):
            program_of(replace(request, wire=unknown))  # raises
        self._make([_of_wire(request, wire, encodings) for wire in wires])

    def _make(self, requests: list[Request]) -> None:
        self._requests = requests
        self._programs: dict[str, _Program] = {}
        for request in requests:
            self._programs[request.wire or ""] = program_of(request, self._first if self._programs else None)

    @property
    def _first(self) -> _Program:
        return next(iter(self._programs.values()))

    def __getitem__(self, wire: str) -> _Program:
        if wire not in self._programs:
            raise KeyError(f"there is no wire {wire!r}; the wires are {', '.join(self)}")
        return self._programs[wire]

    def __iter__(self) -> Iterator[str]:
        return iter(self._programs)

    def __len__(self) -> int:
        return len(self._programs)

    def __getattr__(self, name: str) -> _Program:
        programs = vars(self).get("_programs", {})
        if name not in programs:
            known = ", ".join(programs)
            raise AttributeError(f"{type(self).__name__} have no {name!r}; the wires are {known}", name=name, obj=self)
        return programs[name]

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._programs]

    def __eq__(self, other: object) -> bool:
        return self is other

    def __hash__(self) -> int:
        return id(self)

    def __repr__(self) -> str:
        return f"<{type(self).__name__} of {self._requests[0].mapping}: {', '.join(self)}>"

    def __reduce__(self) -> tuple[Any, ...]:
        """Copies and pickles are made anew, as those of a `Decoder`."""
        return _made_again, (type(self), self._requests)

    @property
    def holder_type(self) -> type[Holder]:
        """The class of the holders."""
        return self._first.holder_type

    @property
    def mapping(self) -> CheckedMapping | None:
        """The mapping with its ``warnings`` and ``laws``. It is read anew: keep what is found."""
        return self._first.mapping

    @property
    def state(self) -> Mapping[str, bool | int | float]:
        """What each state variable of the mapping is for the next message, whichever wire's it is."""
        return self._first.state

    def reset(self) -> None:
        """Let the next message be the first one. Raises `InUse` as `Decoder.reset`."""
        self._first.reset()

    def new(self) -> Any:
        """A holder of one's own."""
        return self._first.new()


class Decoders(_Programs[Decoder]):
    """Decodes the messages of several wires into one holder: ``decoders.pose(message)`` fills what `pose` tells, and returns the holder.

    What messages of the other wires have filled stays. Each decoder is a `Decoder`; they share their own holder, and the mapping's state.
    A message that is refused leaves its wire's part half filled: the holder is not valid until the next message of that wire.

    Parameters
    ----------
    mapping : path
        A mapping of several wires, as of a `Decoder`.
    **options
        See `WireOptions`. Bytes cannot be borrowed.

    Raises
    ------
    MappingError, SchemaError
        With every mistake and its place.
    """

    _direction = "decode"

    def _make(self, requests: list[Request]) -> None:
        super()._make(requests)
        self._times: dict[str, Any] = {}

    def decode(self, wire: str, message: Buffer, *, time: Any = None) -> Any:
        """Decode a message of a wire into the holder, and keep the time at which it came, whatever its unit, for `times`."""
        holder = self._programs[wire](message)
        self._times[wire] = time
        return holder

    def encoder(self, **options: Unpack[Options]) -> Encoder:
        """An encoder of the whole holder, in an encoding of its own framework: ``decoders.encoder(encoding="ros1")``."""
        imported("rosetta_jit.pipeline.bridge")
        from rosetta_jit.pipeline.bridge import closed

        return program_of(closed(request_of("encode", options), self._requests[0]))

    @property
    def holder(self) -> Any:
        """The holder that the decoders fill where they are given none: that of the thread that decodes first."""
        return shared_of(self._first).holder

    @property
    def ages(self) -> dict[str, int | None]:
        """How many messages of all wires have been decoded since the last one of each: 0 of the latest, None where there was none.

        Raises
        ------
        InUse
            Another thread's call has not returned.
        """
        registers = shared_of(self._first).registers
        return {} if registers is None else ages(registers.shown(), list(self))

    @property
    def times(self) -> dict[str, Any]:
        """The time of the last message of each wire, of those that `decode` was given."""
        return dict(self._times)

    @property
    def missing(self) -> tuple[str, ...]:
        """The wires without a message so far, and those whose last message was refused: without any, `holder` is complete."""
        lanes = self.holder.lanes_
        broken = set[int]() if lanes.words[VALID] else shared_of(self._first).broken.get(lanes, set[int]())
        return tuple(wire for number, (wire, age) in enumerate(self.ages.items()) if age is None or number in broken)

    def reset(self) -> None:
        """Let the next message be the first one, and empty `holder`. Raises `InUse` as `Decoder.reset`."""
        super().reset()
        self.holder.clear()
        self._times.clear()


class Encoders(_Programs[Encoder]):
    """Encodes one holder as messages of several wires: ``encoders.pose(holder)`` gives bytes, ``encoders(holder)`` those of all wires.

    Parameters and errors are those of `Decoders`.
    """

    _direction = "encode"

    def __call__(self, holder: Any) -> dict[str, bytes]:
        """The message of each wire. Raises `EncodeError` where the holder has values that a wire cannot carry."""
        return {wire: encode(holder) for wire, encode in self._programs.items()}


def _of_wire(request: Request, wire: str, encodings: Mapping[str, str]) -> Request:
    return replace(request, wire=wire, encoding=encodings.get(wire, request.encoding))


def _made_again(programs: type[_Programs[Any]], requests: list[Request]) -> _Programs[Any]:
    made: Any = programs.__new__(programs)
    made._make(requests)
    return made
