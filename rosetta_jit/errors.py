"""Every error that a user of rosetta_jit can meet.

RosettaError
    ReportError         what is wrong in a text that somebody wrote: diagnostics with places
        SchemaError         in an IDL file or a wire schema
        MappingError        in a mapping
        LogError            in a log that cannot be read at all
        AddressError        in the address of a transport
        BridgeError         in the file of a bridge
    MessageError        what is wrong with one message: kind and field path
        DecodeError         bytes that are not what the schema promises; with byte offset
        EncodeError         a holder whose values the wire cannot carry
    ValuesError         plain values that a holder's type cannot take; with field path
    InvalidHolder       a holder that was read although the last decode into it failed
    TransportError      a peer or a connection that fails; with kind and address
    MissingPackage      an extra that is not installed
    BrokenPackage       an installed package that cannot be imported
    InUse               a holder or batch that another thread uses at the same time

Errors of the caller (an object of the wrong type, a read-only output) are Python's own TypeError and BufferError.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from rosetta_jit.diagnostics import Diagnostic

Kind = Literal[
    "truncated",  # the message ends before the value does
    "trailing",  # bytes are left over
    "tag",  # a type tag or wire type that the schema does not have there
    "constant",  # a field whose value the schema fixes has another one
    "count",  # a negative or impossible number of elements
    "length",  # a negative or impossible number of bytes
    "nesting",  # deeper than the limit
    "text",  # bytes that are not valid UTF-8 where text is promised
    "varint",  # a variable-length integer of more than ten bytes
    "range",  # a value that its target cannot hold
    "index",  # a mapping reads or writes an element that is not there
    "missing",  # a required field did not come
    "image",  # a compressed image that is none, or pixels that cannot be compressed
    "rejected",  # the mapping refuses the message
    "union",  # another case of a union is set than its discriminator says
]


class RosettaError(Exception):
    """Base of all errors that rosetta_jit raises by itself."""


class ReportError(RosettaError):
    """Something is wrong in a text; `diagnostics` says what, where, and what to do."""

    def __init__(self, diagnostics: tuple[Diagnostic, ...]) -> None:
        from rosetta_jit.diagnostics import render_all

        self.diagnostics = diagnostics
        super().__init__(render_all(diagnostics))

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.diagnostics,)


class SchemaError(ReportError):
    """An IDL file or a wire schema that cannot be used."""


class MappingError(ReportError):
    """A mapping that cannot be used."""


class LogError(ReportError):
    """A log that cannot be read, or asks for what is not there."""


class BridgeError(ReportError):
    """A file of a bridge that cannot be used."""


class AddressError(ReportError):
    """An address of a transport, or an option behind it, that cannot be used."""


Failure = Literal[
    "unreachable",  # nothing answers at the address
    "taken",  # something else listens there, or has the name
    "unknown",  # nobody has the name
    "timeout",  # no answer in time
    "closed",  # the connection is gone, or was closed here
    "protocol",  # bytes that the protocol does not have there
    "type",  # the peer has another type, or another md5 sum
    "too large",  # a message above `max_message`
    "refused",  # the peer says no
]


class TransportError(RosettaError):
    """A peer or a connection that fails.

    Attributes
    ----------
    kind : str
        What happened, one word of `Failure`.
    address : str
        Which channel or peer it is about.
    detail : str
        One sentence for a person.
    """

    def __init__(self, kind: Failure, address: str, detail: str) -> None:
        from rosetta_jit.terminal import printable

        self.kind: Failure = kind
        self.address = address
        self.detail = detail
        super().__init__(printable(f"{kind}: {detail} - {address}"))

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.kind, self.address, self.detail)


class MessageError(RosettaError, ValueError):
    """One message that cannot be decoded or encoded.

    Attributes
    ----------
    kind : str
        What is wrong, one word of `Kind`.
    path : str
        The field, as written in the IDL, with indices: ``.joints[3].name``; empty for the message itself.
    detail : str
        One sentence for a person.
    """

    def __init__(self, kind: Kind, path: str, detail: str) -> None:
        self.kind: Kind = kind
        self.path = path
        self.detail = detail
        super().__init__(self.describe())

    def describe(self) -> str:
        return _placed(f"{self.kind}: {self.detail}", self.path)

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.kind, self.path, self.detail)


class DecodeError(MessageError):
    """Bytes that are not what the schema promises.

    Attributes
    ----------
    offset : int
        Where in the message, in bytes from its start.
    """

    def __init__(self, kind: Kind, path: str, detail: str, offset: int) -> None:
        self.offset = offset
        super().__init__(kind, path, detail)

    def describe(self) -> str:
        return _placed(f"{self.kind}: {self.detail}", self.path, f"byte {self.offset}")

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.kind, self.path, self.detail, self.offset)


class EncodeError(MessageError):
    """A holder whose values the wire cannot carry."""


class LogWarning(UserWarning):
    """Something is wrong with a log; what can be read of it is read."""


class CacheWarning(UserWarning):
    """The kernel cache is damaged or cannot be used; everything works, but compiles again."""


def warn(message: str, category: type[Warning]) -> None:
    """Warn of what was noticed here, at the line outside this package that led to it."""
    import warnings
    from inspect import currentframe

    frame, level = currentframe(), 0
    while frame is not None and frame.f_globals.get("__name__", "").partition(".")[0] == "rosetta_jit":
        frame, level = frame.f_back, level + 1
    warnings.warn(message, category, stacklevel=level + 1)


class ValuesError(RosettaError, ValueError):
    """Plain values that a holder's type cannot take.

    Attributes
    ----------
    path : str
        The field, as written in the IDL, with indices: ``.joints[3].name``.
    detail : str
        One sentence for a person.
    """

    def __init__(self, path: str, detail: str) -> None:
        self.path = path
        self.detail = detail
        super().__init__(_placed(detail, path))

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.path, self.detail)


def _placed(text: str, path: str, *more: str) -> str:
    """A sentence, and where it is about: of the message as a whole there is no path."""
    places = [*([f"`{path}`"] if path else []), *more]
    return f"{text} - at {', '.join(places)}" if places else text


class MissingPackage(RosettaError, ImportError):  # noqa: N818  the package is what is missing
    """What was asked for takes a package that is an extra; the message says how to install it."""


class BrokenPackage(RosettaError):  # noqa: N818  the package is what is broken
    """An installed package offers something for rosetta_jit that cannot be imported; the message names the package and the cause."""


class InvalidHolder(RosettaError):  # noqa: N818  the holder is what is wrong
    """A holder was read although the last decode into it failed."""


class InUse(RosettaError):  # noqa: N818  the holder is what is wrong
    """A holder or batch was used while another thread was changing, filling or encoding it."""
