"""Events as they stand on the wire: `rsb.protocol.Notification`, a protobuf message (proto2).

    Notification  6 scope, 7 wire_schema, 9 data, 13 causes (EventId)*, 14 method, 15 meta_data, 108 event_id
    EventId       1 sender_id (16 bytes), 2 sequence_number
    EventMetaData 2 create_time, 3 send_time, 4 receive_time, 5 deliver_time (microseconds), 6 user_times*, 7 user_infos*
    UserTime      1 key, 2 timestamp
    UserInfo      1 key, 2 value

The number of event_id is 100 + 8, the version of the format, which is that of RSB 0.6 and later.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache
from typing import Any, NamedTuple

from rosetta_jit.transports.limits import MAX_ENTRIES

ID_BYTES = 16
_WIDTH = {1: 8, 5: 4}


class EventId(NamedTuple):
    """Which event it is: who sent it, and the how many-th of him it is."""

    participant: bytes
    sequence: int

    @property
    def uuid(self) -> str:
        """The UUID of the event: version 5, of the sequence number in eight hexadecimal digits, in the name space of the participant."""
        from uuid import UUID, uuid5

        return str(uuid5(UUID(bytes=self.participant), f"{self.sequence:08x}"))

    def __str__(self) -> str:
        text = self.participant.hex()
        return f"{text[:8]}-{text[8:12]}-{text[12:16]}-{text[16:20]}-{text[20:]}:{self.sequence}"


class Event(NamedTuple):
    """One event.

    Times are in microseconds since 1970; of receiving and delivering none is kept: who receives knows it better.
    """

    id: EventId
    scope: str
    schema: str
    data: bytes | bytearray | memoryview
    create_time: int = 0
    send_time: int = 0
    method: str = ""
    causes: Sequence[EventId] = ()
    user_infos: Mapping[str, str] = {}
    user_times: Mapping[str, int] = {}


class NoEventError(ValueError):
    """Bytes that are no event."""


def encode(event: Event) -> tuple[bytes, bytes | bytearray | memoryview, bytes]:
    """The parts of a notification, with the payload as it is. Fields stand in the order of their numbers, as other peers write them."""
    event_id, scope, schema, data, create, send, method, causes, infos, times = event
    meta = b"\x10" + _varint(create) + b"\x18" + _varint(send)
    for name, number in times.items():
        meta += _chunk(b"\x32", _chunk(b"\x0a", name.encode()) + b"\x10" + _varint(number))
    for name, text in infos.items():
        meta += _chunk(b"\x3a", _chunk(b"\x0a", name.encode()) + _chunk(b"\x12", text.encode()))
    behind = b"".join([_chunk(b"\x6a", _id(each)) for each in causes]) if causes else b""
    if method:
        behind += _chunk(b"\x72", method.encode())
    behind += _chunk(b"\x7a", meta) + _chunk(b"\xe2\x06", _id(event_id))
    return _before(scope, schema) + _varint(len(data)), data, behind


@lru_cache(maxsize=1024)
def _before(scope: str, schema: str) -> bytes:
    """The bytes of a notification before the length of its payload."""
    return _chunk(b"\x32", scope.encode()) + _chunk(b"\x3a", schema.encode()) + b"\x4a"


def scope_in(message: memoryview) -> str:
    """The scope of a notification, without reading more than that.

    Raises
    ------
    NoEventError
        It is no notification, or has none.
    """
    for number, found in _fields(message):
        if number == 6:
            return _text(found)
    raise NoEventError("an event without a scope")


def decode(message: memoryview) -> Event:
    """The event of a notification; its data lie in the message.

    Raises
    ------
    NoEventError
        It is none, or lacks what each has.
    """
    scope, schema, method, data = "", "", "", message[:0]
    event_id: EventId | None = None
    causes: list[EventId] = []
    meta: _Meta = _NO_META
    at, end = 0, len(message)
    while at < end:
        tag, at = _read_varint(message, at)
        if tag & 7 != 2:
            at = _skipped(message, at, tag & 7)
            continue
        size, at = _read_varint(message, at)
        stop = at + size
        if stop > end:
            raise NoEventError("a field beyond the end of the event")
        found = message[at:stop]
        at = stop
        match tag >> 3:
            case 6:
                scope = str(found, "utf-8", "replace")
            case 7:
                schema = str(found, "utf-8", "replace")
            case 9:
                data = found
            case 13:
                causes.append(_id_of(found))
            case 14:
                method = str(found, "utf-8", "replace")
            case 15:
                meta = _meta(found)
            case 108:
                event_id = _id_of(found)
            case _:
                pass
    if event_id is None or len(causes) > MAX_ENTRIES:
        raise NoEventError("an event without an id" if event_id is None else "too many causes")
    return Event(event_id, scope, schema, data, meta[0], meta[1], method, causes, meta[3], meta[2])


def _skipped(message: memoryview, at: int, kind: int) -> int:
    """The place behind a field that is not bytes."""
    if kind == 0:
        return _read_varint(message, at)[1]
    if kind not in _WIDTH:
        raise NoEventError(f"wire type {kind}")
    if at + _WIDTH[kind] > len(message):
        raise NoEventError("a field beyond the end of the event")
    return at + _WIDTH[kind]


_Meta = tuple[int, int, dict[str, int], dict[str, str]]
_NO_META: _Meta = (0, 0, {}, {})


def _meta(message: memoryview) -> _Meta:
    if len(message) == 18 and message[0] == 0x10 and message[9] == 0x18:  # both times alone, as nearly always
        create, at = _read_varint(message, 1)
        if at == 9:
            send, at = _read_varint(message, 10)
            if at == 18:
                return create, send, {}, {}
    create = send = 0
    times: dict[str, int] = {}
    infos: dict[str, str] = {}
    for number, found in _fields(message):
        if number == 2:
            create = _int(found)
        elif number == 3:
            send = _int(found)
        elif number in (6, 7):
            entry: dict[int, Any] = dict(_fields(_bytes(found)))
            key = _text(entry.get(1, message[:0]))
            if number == 6:
                times[key] = _int(entry.get(2, 0))
            else:
                infos[key] = _text(entry.get(2, message[:0]))
    if len(times) + len(infos) > MAX_ENTRIES:
        raise NoEventError("too many user infos and times")
    return create, send, times, infos


def _id_of(message: memoryview) -> EventId:
    if len(message) > 19 and message[0] == 0x0A and message[1] == ID_BYTES and message[18] == 0x10:
        number, at = _read_varint(message, 19)
        if at == len(message):
            return EventId(bytes(message[2:18]), number & 0xFFFFFFFF)
    entry: dict[int, Any] = dict(_fields(message))
    sender = bytes(_bytes(entry.get(1, message[:0])))
    if len(sender) != ID_BYTES:
        raise NoEventError(f"a participant id of {len(sender)} bytes")
    return EventId(sender, _int(entry.get(2, 0)) & 0xFFFFFFFF)


def _fields(message: memoryview) -> Iterator[tuple[int, memoryview | int]]:
    """The fields of a protobuf message: bytes, or a number."""
    at, end = 0, len(message)
    while at < end:
        tag, at = _read_varint(message, at)
        kind = tag & 7
        if kind == 0:
            value, at = _read_varint(message, at)
            yield tag >> 3, value
            continue
        if kind == 2:
            size, at = _read_varint(message, at)
        elif kind in _WIDTH:
            size = _WIDTH[kind]
        else:
            raise NoEventError(f"wire type {kind}")
        if size > end - at:
            raise NoEventError("a field beyond the end of the event")
        yield tag >> 3, message[at : at + size]
        at += size


def _read_varint(message: memoryview, at: int) -> tuple[int, int]:
    """A number, and where it ends."""
    if at >= len(message):
        raise NoEventError("the event ends within a number")
    number = message[at]
    if number < 128:
        return number, at + 1
    raw = int.from_bytes(message[at : at + 8], "little")
    if raw & _TOPS == _TOPS_OF_8:  # eight bytes, as times have
        raw = raw & 0x007F007F007F007F | (raw & 0x7F007F007F007F00) >> 1
        raw = raw & 0x00003FFF00003FFF | (raw & 0x3FFF00003FFF0000) >> 2
        return raw & 0x0FFFFFFF | (raw & 0x0FFFFFFF00000000) >> 4, at + 8
    number, shift = number & 127, 7
    for place in range(at + 1, min(at + 10, len(message))):
        byte = message[place]
        number |= (byte & 127) << shift
        if byte < 128:
            return number, place + 1
        shift += 7
    raise NoEventError("the event ends within a number" if len(message) < at + 10 else "a number of more than ten bytes")


_TOPS, _TOPS_OF_8 = 0x8080808080808080, 0x0080808080808080


def _varint(number: int) -> bytes:
    if 0 <= number < 128:
        return _BYTES[number]
    if 1 << 49 <= number < 1 << 56:  # eight bytes, as times have
        number = number & 0x0FFFFFFF | (number & 0x00FFFFFFF0000000) << 4
        number = number & 0x00003FFF00003FFF | (number & 0x0FFFC0000FFFC000) << 2
        number = number & 0x007F007F007F007F | (number & 0x3F803F803F803F80) << 1
        return (number | _TOPS_OF_8).to_bytes(8, "little")
    number &= 0xFFFFFFFFFFFFFFFF  # negative ones are those of 64 bits
    out = bytearray()
    while number > 127:
        out.append(number & 127 | 128)
        number >>= 7
    out.append(number)
    return bytes(out)


_BYTES = [bytes([each]) for each in range(128)]


def _chunk(tag: bytes, data: bytes) -> bytes:
    return tag + _varint(len(data)) + data


def _id(event_id: EventId) -> bytes:
    return b"\x0a\x10" + event_id.participant + b"\x10" + _varint(event_id.sequence)


def _bytes(found: memoryview | int) -> memoryview:
    if isinstance(found, int):
        raise NoEventError("a number where bytes belong")
    return found


def _int(found: memoryview | int) -> int:
    """A number, signed."""
    if not isinstance(found, int):
        raise NoEventError("bytes where a number belongs")
    return found - (1 << 64) if found >= 1 << 63 else found


def _text(found: memoryview | int) -> str:
    return str(_bytes(found), "utf-8", "replace")
