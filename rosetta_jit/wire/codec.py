r"""A codec: an invertible description of bytes, without a direction.

    Codec  = Number | Unsent | Table | Varint | Constant | Computed | Padding | Align | Blob | Seq | Repeat | Choice | Cases | Maybe
           | Delimited | Members | Parameter | Parameters | Utf16 | Tagged | Recursion
    Count  = how many elements or bytes follow: a number on the wire, perhaps one that the schema fixes or computes, or that alone

A leaf names the field that it carries by a path relative to the element around it: the message, an element of a `Repeat`, or a message of
a `Tagged` field. The path () is that element itself. What decoding and encoding do with a leaf is none of its business.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Literal

from rosetta_jit.startup.dataclass import dataclass, field, replace

if TYPE_CHECKING:
    from rosetta_jit.model.expr import Expr

Path = tuple[str, ...]
Order = Literal["<", ">"]


@dataclass(frozen=True, slots=True)
class Number:
    """A fixed-width scalar, stored as it is; ``absent`` where it is in a member of a mutable struct that did not come.

    ``holder_scalar`` is the integer that the holder has for it, where that is another one: a value that does not fit is refused.
    """

    path: Path
    scalar: str
    order: Order = "<"
    absent: int | float = 0
    holder_scalar: str | None = None


@dataclass(frozen=True, slots=True)
class Unsent:
    """A scalar that a holder has and the wire does not: it is zero where the message is read, and nothing else can be written."""

    path: Path
    scalar: str


@dataclass(frozen=True, slots=True)
class Table:
    """A fixed-width number on the wire that stands for a value of the field: pairs of wire number and value. Others are refused.

    Without a ``scalar`` nothing is on the wire, and the field has the value of the one pair. ``absent`` as of a `Number`.
    """

    path: Path
    scalar: str | None
    pairs: tuple[tuple[int, int], ...]
    order: Order = "<"
    absent: int | float = 0


@dataclass(frozen=True, slots=True)
class Varint:
    """A base-128 integer of at most ten bytes; a signed one is sign-extended to 64 bits, or zig-zag coded."""

    path: Path
    zigzag: bool = False


@dataclass(frozen=True, slots=True)
class Constant:
    """Bytes that are always the same: a number of the scalar type, or text."""

    path: Path
    value: int | float | bytes
    scalar: str = "u8"
    order: Order = "<"
    kind: Literal["constant", "tag", "count"] = "constant"


@dataclass(frozen=True, slots=True)
class Computed:
    """A number that other fields of the message determine."""

    path: Path
    scalar: str
    value: Expr
    order: Order = "<"


@dataclass(frozen=True, slots=True)
class Padding:
    """A number that means nothing: any is read, this one is written."""

    scalar: str
    value: int
    order: Order = "<"


@dataclass(frozen=True, slots=True)
class Count:
    """A number of elements or bytes before them: of a scalar type or a varint. ``value`` fixes or computes it.

    Without a ``scalar`` nothing is on the wire, and ``value`` tells it: an expression reads fields of the struct around the array that
    have come before. ``maximum`` bounds it. Each element counts as ``unit``, and what is counted with the elements as one.
    """

    scalar: str | Literal["varint"] | None
    order: Order = "<"
    value: int | Expr | None = None
    maximum: int | None = None
    unit: int = 1


@dataclass(frozen=True, slots=True)
class Align:
    """Padding up to the next multiple of ``size`` bytes from the origin of the encoding. Zeros are written."""

    size: int


@dataclass(frozen=True, slots=True)
class Blob:
    """Counted bytes of a string or bytes field. ``text`` must be UTF-8; ``terminated`` counts a NUL that is not part of the value.

    ``absent`` as of a `Number`; bytes that it lacks are zero.
    """

    path: Path
    count: Count
    text: bool = False
    terminated: bool = False
    absent: bytes = b""


@dataclass(frozen=True, slots=True)
class Seq:
    items: tuple[Codec, ...]


@dataclass(frozen=True, slots=True)
class Repeat:
    """Counted elements of an array. Other fields may stand between the count and the elements (``head``), and be counted with them.

    Before the first element, if there is one, there is padding up to a multiple of ``align`` bytes. ``absent`` as of a `Number`: the units
    of a text.
    """

    path: Path
    count: Count
    item: Codec
    head: tuple[Codec, ...] = ()
    extra: int = 0
    align: int = 1
    absent: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class Choice:
    """A number that says which of several codecs of the same fields follows. Any is read.

    The first is written, or the one numbered ``when_empty`` where the array at ``path`` has no elements. Where there are ``labels``, the
    discriminator at ``path`` tells: each alternative but the last is written for its label, the last for any other.

    The first ``tried`` are what an earlier attempt at the message reads. It has failed where they come here, and a reader makes nothing of
    them. It looks at them where that attempt knows messages by their length, and so does not say what is wrong with another.
    """

    path: Path
    scalar: str
    alternatives: tuple[tuple[int, Codec], ...]
    when_empty: int = 0
    order: Order = "<"
    labels: tuple[int, ...] = ()
    tried: int = 0


@dataclass(frozen=True, slots=True)
class Cases:
    """A discriminator, and what follows for its values: one of the cases of the union at ``path``, or nothing.

    The codecs' paths start where that of the union does. ``default`` is the number of the case for any other value; without one there
    is nothing.
    """

    path: Path
    discriminator: Codec
    cases: tuple[tuple[tuple[int, ...], Codec], ...]
    default: int | None = None


@dataclass(frozen=True, slots=True)
class Maybe:
    """A byte that says whether the optional field at ``path`` follows."""

    path: Path
    value: Codec


@dataclass(frozen=True, slots=True)
class Utf16:
    """Counted octets of UTF-16, which may begin with a byte order mark and are big-endian without one (CORBA 3.3 part 2, 9.3.1.6).

    Written with the mark of a little-endian writer, as omniORB does; the empty string is nothing.
    """

    path: Path
    count: Count


@dataclass(frozen=True, slots=True)
class Member:
    """A member with its id and its length before it; ``length_code`` is how XCDR2 tells that (``LC`` of DDS-XTypes 1.3, 7.4.3.4.2).

    A mutable struct without an ``owed`` one is refused; any other has a value where it does not come.
    """

    number: int
    path: Path
    value: Codec
    length_code: int = 4
    optional: bool = False
    must_understand: bool = False
    owed: bool = False


@dataclass(frozen=True, slots=True)
class Members:
    """The number of bytes of what follows, then members with their ids in any order, unknown ones skipped (PL_CDR2)."""

    path: Path
    members: tuple[Member, ...]
    order: Order = "<"


@dataclass(frozen=True, slots=True)
class Parameter:
    """One member at its place, which its id must be: an optional one as XCDR1 has it, or what a mutable union consists of.

    ``second`` says that its id and length are those of XCDR2; else a length of zero says that it is absent, and alignment counts from its
    begin.
    """

    member: Member
    order: Order = "<"
    second: bool = False


@dataclass(frozen=True, slots=True)
class Parameters:
    """Such members in any order up to a sentinel, absent ones left out, unknown ones skipped (PL_CDR)."""

    path: Path
    members: tuple[Member, ...]
    order: Order = "<"


@dataclass(frozen=True, slots=True)
class Delimited:
    """The number of bytes of what follows, then that."""

    path: Path
    value: Codec
    order: Order = "<"


WireType = Literal[0, 1, 2, 3, 5]
"""Protocol Buffers' wire types: varint, 64 bits, length-delimited, group, 32 bits."""


@dataclass(frozen=True, slots=True)
class Entry:
    """A field of a tagged message: its number and the codec of one value without the tag.

    ``label`` says what a second value does: it replaces the first (``single``), or follows it (``repeated``, ``packed``: both forms
    are read, the one named is written). ``implicit`` fields are not written when they hold zero. A value not ``allowed`` (where any are
    named) counts as an unknown field.
    """

    number: int
    wire: WireType
    path: Path
    value: Codec
    label: Literal["single", "repeated", "packed"] = "single"
    implicit: bool = False
    allowed: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class Tagged:
    """A message of tagged fields in any order (protobuf), unknown ones skipped; ``required`` ones must come.

    Delimited by a length before it (``delimited``), by the end tag of its group (``group`` is the field number), or by the end of
    the bytes. One that is ``whole`` or not at all, an entry of a map, counts as an unknown field itself if a value of it is not allowed.
    """

    path: Path
    entries: tuple[Entry, ...]
    required: tuple[str, ...] = ()
    delimited: bool = False
    group: int | None = None
    whole: bool = False


@dataclass(frozen=True, slots=True)
class Recursion:
    """A value of a recursive struct, by name."""

    path: Path
    struct: str
    group: int | None = None


Codec = (
    Number
    | Unsent
    | Table
    | Varint
    | Constant
    | Computed
    | Padding
    | Align
    | Blob
    | Seq
    | Repeat
    | Choice
    | Cases
    | Maybe
    | Delimited
    | Members
    | Parameter
    | Parameters
    | Utf16
    | Tagged
    | Recursion
)


@dataclass(frozen=True, slots=True)
class Ending:
    """Padding behind a message: the last two bits of its byte number ``size_byte`` say how many bytes.

    It is written up to a multiple of ``align`` bytes from the origin. Where these bits say that there is none, zeros up to a multiple of
    ``unstated`` bytes are read nevertheless, and padding that is written is not stated.
    """

    size_byte: int
    align: int = 1
    unstated: int = 1


@dataclass(frozen=True, slots=True)
class Rare:
    """Messages that hardly ever come: they begin with ``opening``, as no others do. A program for ``byte_order`` reads them alone."""

    opening: bytes
    byte_order: Literal["little", "big"]


@dataclass(frozen=True, slots=True)
class Encoding:
    """All that a wire is for one type.

    ``attempts`` are what a reader tries, in this order; ``written`` is what a writer writes, None where it would have to guess.
    ``recursive`` are the messages of recursive structs; where the message is not `Tagged`, ``nested`` are their codecs, for each attempt.
    ``origin`` is where alignment counts from, in bytes behind the begin of the message. At its end there is what ``ending`` says, and
    ``spare`` bytes may be left over. Of the leniency ``trailing`` of the encoding, so many could: ``forgivable``, 0 where it has none.
    The last attempt is for messages that hardly ever come, if there is ``rare``. The first ``expected`` attempts read the usual form alone:
    a later one reads all that they read, and says what is wrong with what they do not.
    """

    name: str
    attempts: tuple[Codec, ...]
    written: Codec | None
    recursive: Mapping[str, Tagged] = field(default_factory=dict["str", "Tagged"])
    nested: tuple[Mapping[str, Codec], ...] = ()
    origin: int = 0
    ending: Ending | None = None
    spare: int = 0
    forgivable: int = 0
    rare: Rare | None = None
    expected: int = 0

    @property
    def usual(self) -> Encoding:
        """The encoding without what hardly ever comes."""
        return self if self.rare is None else replace(self, attempts=self.attempts[:-1], nested=self.nested[:-1], rare=None)
