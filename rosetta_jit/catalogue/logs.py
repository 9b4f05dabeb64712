"""What can be wrong with a log."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.catalogue.spelling import closest
from rosetta_jit.diagnostics import Diagnostic

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

_READ = "what is whole is read"


def unreadable(name: str, why: str) -> Diagnostic:
    """A file that the system does not let us read."""
    return Diagnostic("error", "log-unreadable", f"{name} cannot be read: {why}")


def unknown_format(name: str, known: Iterable[str]) -> Diagnostic:
    """A file that no reader knows."""
    return Diagnostic("error", "log-format", f"{name} is no log that is known", help=f"there are readers of {', '.join(known)}")


def not_a(name: str, what: str) -> Diagnostic:
    """A file that begins otherwise."""
    return Diagnostic("error", "log-format", f"{name} is no {what}: it does not begin as one")


def old_version(name: str, version: str) -> Diagnostic:
    """A bag of another version."""
    return Diagnostic(
        "error",
        "log-version",
        f"{name} says that it is `{version}`",
        help="versions 2.0 and 1.2 are read; ROS's own `rosbag fix` makes 2.0 of older ones",
    )


def needs(name: str, package: str, extra: str) -> Diagnostic:
    """A package that is not installed."""
    return Diagnostic("error", "log-needs-package", f"{name} needs the package {package}", help=f"pip install 'rosetta-jit[{extra}]'")


def unfinished(name: str) -> Diagnostic:
    """No index, because whoever wrote the log was stopped."""
    return Diagnostic("warning", "log-unfinished", f"{name} has no index at its end: its writer was stopped", help=_READ)


def bad_index(name: str, why: str) -> Diagnostic:
    """An index that cannot be used."""
    return Diagnostic("warning", "log-index", f"{name}: its index cannot be used: {why}", help="it is read record by record instead")


def index_lies(name: str, at: int) -> Diagnostic:
    """An index that says where a chunk is, and there is none."""
    return Diagnostic(
        "warning",
        "log-index",
        f"{name}: the index says that a chunk is at byte {at}, and there is none",
        help="it is read record by record from there",
    )


def miscounted(name: str, topic: str, promised: int, found: int) -> Diagnostic:
    """An index that counts otherwise."""
    return Diagnostic("warning", "log-index", f"{name}: its index counts {promised} messages of {topic}, and {found} were found")


def log_cut(name: str, at: int) -> Diagnostic:
    """A file that ends within a record."""
    return Diagnostic("warning", "log-cut", f"{name} is cut short within the record at byte {at}", help=_READ)


def file_cut(name: str, size: int, promised: int) -> Diagnostic:
    """A file that is shorter than its header says."""
    help_ = "what is whole is read"
    return Diagnostic("warning", "log-cut", f"{name} is cut short: it has {size} bytes of {promised}", help=help_)


def rows_cut(name: str, count: int) -> Diagnostic:
    """Messages of a file of SQLite that lie partly behind its end."""
    what = "a message reaches" if count == 1 else f"{count} messages reach"
    return Diagnostic("warning", "log-cut", f"{name}: {what} beyond the end of the file", help="left out")


def damaged(name: str, at: int) -> Diagnostic:
    """Bytes that are no record."""
    return Diagnostic("warning", "log-damaged", f"{name}: there is no whole record at byte {at}", help="what lies before it is read")


def skipped(name: str, at: int, size: int) -> Diagnostic:
    """Bytes that are no record, and a record behind them."""
    return Diagnostic("warning", "log-damaged", f"{name}: {size} bytes from byte {at} on are no event and are left out", help=_READ)


def chunk_damaged(name: str, at: int, why: str) -> Diagnostic:
    """A chunk that cannot be decompressed to its end."""
    return Diagnostic(
        "warning", "log-chunk", f"{name}: the chunk at byte {at} is damaged: {why}", help="its messages before the damage are read"
    )


def chunk_unread(name: str, at: int, why: str) -> Diagnostic:
    """A chunk of which nothing can be read."""
    return Diagnostic("warning", "log-chunk", f"{name}: the chunk at byte {at} cannot be read: {why}", help="its messages are left out")


def checksum(name: str, at: int) -> Diagnostic:
    """A chunk whose bytes are not those that were written."""
    return Diagnostic(
        "warning",
        "log-checksum",
        f"{name}: the chunk at byte {at} has another checksum than when it was written; its messages are left out",
        help="`check=False`, or --no-check, reads them as they are",
    )


def bad_definition(name: str, at: int, why: str) -> Diagnostic:
    """A schema or channel that cannot be read."""
    return Diagnostic("warning", "log-definition", f"{name}: a definition at byte {at} is damaged: {why}")


def bad_row(name: str, table: str, why: str) -> Diagnostic:
    """Rows of a database that are none of its format."""
    return Diagnostic("warning", "log-row", f"{name}: a row of the table `{table}` is damaged: {why}", help="such rows are left out")


def redefined(name: str, what: str, topic: str) -> Diagnostic:
    """A definition that is there twice, in two forms."""
    return Diagnostic("warning", "log-definition", f"{name}: {what} (`{topic}`) is defined twice, differently; the first counts")


def no_schema(name: str, topic: str, schema: int) -> Diagnostic:
    """A channel with the number of a schema that is not there."""
    return Diagnostic("warning", "log-definition", f"{name}: `{topic}` is of schema {schema}, which the log does not have")


def unknown_channel(name: str, channel: int) -> Diagnostic:
    """Messages of a channel that is not defined."""
    return Diagnostic(
        "warning", "log-channel", f"{name}: messages are of channel {channel}, which the log does not define", help="they are left out"
    )


def out_of_order(name: str, topic: str, count: int) -> Diagnostic:
    """Messages that were logged before the one in front of them."""
    return Diagnostic("warning", "log-order", f"{name}: {count} messages of `{topic}` have an earlier time than the one before")


def undecodable(name: str, topic: str, index: int, why: str, count: int) -> Diagnostic:
    """Messages that are not of their type."""
    more = f" ({count} such messages in all)" if count > 1 else ""
    return Diagnostic("warning", "log-message", f"{name}: message {index} of `{topic}` has bytes that its type does not have: {why}{more}")


def unknown_topic(name: str, topic: str, known: Iterable[str]) -> Diagnostic:
    """A topic that the log does not have."""
    topics = tuple(known)
    near = closest(topic, topics)
    listed = ", ".join(topics[:20]) or "none"
    return Diagnostic(
        "error", "log-topic", f"{name} has no topic `{topic}`", help=f"did you mean `{near}`?" if near else f"it has {listed}"
    )


def unknown_field(name: str, topic: str, field: str, known: Iterable[str]) -> Diagnostic:
    """A field that messages of a topic do not have, or that is no number."""
    fields = tuple(known)
    near = closest(field, fields)
    listed = ", ".join(fields[:20]) or "none"
    return Diagnostic(
        "error",
        "log-field",
        f"{name}: messages of `{topic}` have no number `{field}`",
        help=f"did you mean `{near}`?" if near else f"they have {listed}",
    )


def several_types(name: str, topic: str, types: Iterable[str]) -> Diagnostic:
    """A topic with messages of several types."""
    found = ", ".join(f"`{each}`" for each in types)
    return Diagnostic(
        "error",
        "log-types",
        f"{name}: `{topic}` has messages of several types: {found}",
        help=f'name one: log["{topic}", type], or --type; into a folder, `rosetta-jit convert` writes tables of each',
    )


def several_definitions(name: str, topic: str, type_: str) -> Diagnostic:
    """A topic with messages of one type that the log defines in several ways."""
    return Diagnostic(
        "error",
        "log-types",
        f"{name}: `{topic}` has messages of `{type_}` by several definitions, which are no columns of one table",
        help="`log.messages()` and `rosetta-jit cat` decode each message by its own",
    )


def wire_without_topic(name: str, wire: str) -> Diagnostic:
    """A wire of a mapping whose messages nobody has named a topic for."""
    return Diagnostic(
        "error", "log-wire", f"{name}: it is not said which topic has the messages of wire `{wire}`", help=f'add `{{"{wire}": "/topic"}}`'
    )


def no_type(name: str, topic: str, details: str) -> Diagnostic:
    """A log that does not tell what its messages are."""
    return Diagnostic(
        "error",
        "log-no-type",
        f"{name} does not say of which type the messages of `{topic}` are{details}",
        help=f'name it: log["{topic}", "package.type"], or --type; its definition is looked for on the search path',
    )


def no_definition(name: str, topic: str, type_: str) -> Diagnostic:
    """A log that names a type and has no definition of it."""
    return Diagnostic(
        "error",
        "log-definition",
        f"{name} has no definition of `{type_}`, the type of the messages of `{topic}`, and the search path has none either",
        help="search_path=[folder], or --search-path, adds a folder that has its file; imports=[file], or --import, names that file",
    )


def unknown_encoding(name: str, topic: str, encoding: str) -> Diagnostic:
    """Messages in an encoding that no framework has."""
    return Diagnostic("error", "log-encoding", f"{name}: the messages of `{topic}` are encoded as `{encoding}`, which no framework reads")


def several_encodings(name: str, encodings: Sequence[str]) -> Diagnostic:
    """A log whose messages are in several encodings, or in one that it does not say."""
    message = (
        f"{name}: its messages are in {len(encodings)} encodings: {', '.join(encodings)}"
        if encodings
        else f"{name} does not say how its messages are encoded"
    )
    return Diagnostic("error", "log-encoding", message, help="name the one that is meant: `--encoding`")


def no_output(name: str, tables: Iterable[str], suffixes: Iterable[str]) -> Diagnostic:
    """A name that says neither a table, nor a folder, nor a log."""
    help_ = f"a table ends with {', '.join(tables)}, a log with {', '.join(suffixes)}, a folder of tables with `/`"
    return Diagnostic("error", "log-format", f"{name}: the name does not say what to write", help=help_)


def no_writer(name: str, suffixes: Iterable[str]) -> Diagnostic:
    """A file whose name tells no format that is written."""
    return Diagnostic("error", "log-format", f"{name}: nothing writes such files", help=f"names end with {', '.join(suffixes)}")


def not_carried(name: str, topic: str, encoding: str, carried: str) -> Diagnostic:
    """Messages that a format has no place for."""
    wrong = f"{name}: the messages of `{topic}` are encoded as `{encoding}`, and such files hold {carried}"
    return Diagnostic("error", "log-encoding", wrong, help="write .mcap, which holds all")


def which_topic(name: str, topics: Iterable[str]) -> Diagnostic:
    """A log of several topics, of which a command takes one."""
    return Diagnostic("error", "log-topic", f"{name} has several topics: {', '.join(topics)}", help="name one: --topic")


def stopped(name: str, why: str) -> Diagnostic:
    """A database that breaks off."""
    return Diagnostic("warning", "log-damaged", f"{name} cannot be read on: {why}", help="what lies before it is read")


def missing_file(name: str, file: str) -> Diagnostic:
    """A file that a log should have."""
    return Diagnostic("warning", "log-file", f"{name} has no file {file}", help=_READ)


def unnamed_file(name: str, file: str) -> Diagnostic:
    """A file that the metadata does not mention."""
    return Diagnostic("warning", "log-file", f"{name}: its metadata does not mention {file}, which is read all the same")


def bad_line(name: str, at: int, why: str) -> Diagnostic:
    """A line that is no message."""
    return Diagnostic("warning", "log-message", f"{name}: the line at byte {at} is no message: {why}")


def not_of_ros1(name: str, topic: str, encoding: str) -> Diagnostic:
    """Messages that cannot become those of ROS 2."""
    wrong = f"{name}: the messages of `{topic}` are encoded as `{encoding}`, and those of ROS 1 alone become those of ROS 2"
    return Diagnostic("error", "log-encoding", wrong, help="--topic names the others")


def no_successor(name: str, topic: str, type_: str) -> Diagnostic:
    """A type of ROS 1 that ROS 2 does not have."""
    return Diagnostic(
        "error",
        "log-no-type",
        f"{name}: there is no definition of {type_}, which the messages of `{topic}` would be",
        help="--search-path names the folder of its `.msg` file",
    )


def without_definition(topic: str) -> Diagnostic:
    """A topic that is written without the definition of its type."""
    return Diagnostic(
        "warning",
        "log-definition",
        f"the messages of `{topic}` are written without the definition of their type, which is not known",
        help=f"--type {topic}=package.type names it; its definition is looked for on the search path",
    )


def no_bytes(topic: str, type_: str) -> Diagnostic:
    """A mapping into data of which nobody has bytes."""
    return Diagnostic("error", "log-encoding", f"`{topic}`: messages of {type_} have no usual encoding, in which a log could keep them")


def not_empty(folder: str) -> Diagnostic:
    """A folder that is to be written, and has something in it."""
    return Diagnostic("error", "log-output", f"{folder} is there already", help="--resume continues a conversion; else name another folder")


def folder_is_there(folder: str) -> Diagnostic:
    """A log that is a folder, where there is one already."""
    return Diagnostic("error", "log-output", f"{folder} is there already, and not empty", help="name another folder")


def other_conversion(folder: str, what: str) -> Diagnostic:
    """A folder of another conversion."""
    return Diagnostic(
        "error", "log-output", f"{folder} was begun with another {what}", help="name another folder, or give the same log and options"
    )


def bad_journal(path: str, why: str) -> Diagnostic:
    """A journal that cannot be read."""
    return Diagnostic("error", "log-output", f"{path} does not say how far the conversion is: {why}", help="name another folder")


def many_stretches(folder: str, count: int) -> Diagnostic:
    """Times that are too far from each other."""
    return Diagnostic(
        "error", "log-time", f"{folder} would have more than {count} stretches of time", help="--every names longer ones: --every 1d"
    )


def not_written(name: str, topic: str, index: int, why: str) -> Diagnostic:
    """A message that a format has no form for."""
    return Diagnostic("error", "log-message", f"{name}: message {index} of `{topic}` cannot be written: {why}")


def no_time(name: str, time_ns: int) -> Diagnostic:
    """A time that a bag cannot have."""
    return Diagnostic("error", "log-time", f"{name}: bags have no time {time_ns} ns: it is before 1970 or after 2106")
