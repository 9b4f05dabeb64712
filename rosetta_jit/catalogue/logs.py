"""What can be wrong with a log."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from rosetta_jit.catalogue.suggestions import closest
from rosetta_jit.diagnostics import Diagnostic, error, warning

_READ = "what is whole is read"


def unreadable(name: str, why: str) -> Diagnostic:
    return error("log-unreadable", f"{name} cannot be read: {why}")


def unknown_format(name: str, known: Iterable[str]) -> Diagnostic:
    return error("log-format", f"{name} is no log that is known", help_=f"there are readers of {', '.join(known)}")


def not_a(name: str, what: str) -> Diagnostic:
    return error("log-format", f"{name} is no {what}: it does not begin as one")


def old_version(name: str, version: str) -> Diagnostic:
    return error(
        "log-version",
        f"{name} says that it is `{version}`",
        help_="versions 2.0 and 1.2 are read; ROS's own `rosbag fix` makes 2.0 of older ones",
    )


def needs(name: str, package: str, extra: str) -> Diagnostic:
    return error("log-needs-package", f"{name} needs the package {package}", help_=f"pip install 'rosetta-jit[{extra}]'")


def unfinished(name: str) -> Diagnostic:
    return warning("log-unfinished", f"{name} has no index at its end: its writer was stopped", help_=_READ)


def bad_index(name: str, why: str) -> Diagnostic:
    return warning("log-index", f"{name}: its index cannot be used: {why}", help_="it is read record by record instead")


def index_lies(name: str, at: int) -> Diagnostic:
    return warning(
        "log-index",
        f"{name}: the index says that a chunk is at byte {at}, and there is none",
        help_="it is read record by record from there",
    )


def miscounted(name: str, topic: str, promised: int, found: int) -> Diagnostic:
    return warning("log-index", f"{name}: its index counts {promised} messages of {topic}, and {found} were found", None)


def log_cut(name: str, at: int) -> Diagnostic:
    return warning("log-cut", f"{name} is cut short within the record at byte {at}", help_=_READ)


def file_cut(name: str, size: int, promised: int) -> Diagnostic:
    help_ = "what is whole is read"
    return warning("log-cut", f"{name} is cut short: it has {size} bytes of {promised}", help_=help_)


def rows_cut(name: str, count: int) -> Diagnostic:
    what = "a message reaches" if count == 1 else f"{count} messages reach"
    return warning("log-cut", f"{name}: {what} beyond the end of the file", help_="left out")


def damaged(name: str, at: int) -> Diagnostic:
    return warning("log-damaged", f"{name}: there is no whole record at byte {at}", help_="what lies before it is read")


def skipped(name: str, at: int, size: int) -> Diagnostic:
    return warning("log-damaged", f"{name}: {size} bytes from byte {at} on are no event and are left out", help_=_READ)


def chunk_damaged(name: str, at: int, why: str) -> Diagnostic:
    return warning("log-chunk", f"{name}: the chunk at byte {at} is damaged: {why}", help_="its messages before the damage are read")


def chunk_unread(name: str, at: int, why: str) -> Diagnostic:
    return warning("log-chunk", f"{name}: the chunk at byte {at} cannot be read: {why}", help_="its messages are left out")


def checksum(name: str, at: int) -> Diagnostic:
    return warning(
        "log-checksum",
        f"{name}: the chunk at byte {at} has another checksum than when it was written; its messages are left out",
        help_="`check=False`, or --no-check, reads them as they are",
    )


def bad_definition(name: str, at: int, why: str) -> Diagnostic:
    return warning("log-definition", f"{name}: a definition at byte {at} is damaged: {why}", None)


def bad_row(name: str, table: str, why: str) -> Diagnostic:
    return warning("log-row", f"{name}: a row of the table `{table}` is damaged: {why}", help_="such rows are left out")


def redefined(name: str, what: str, topic: str) -> Diagnostic:
    return warning("log-definition", f"{name}: {what} (`{topic}`) is defined twice, differently; the first counts", None)


def no_schema(name: str, topic: str, schema: int) -> Diagnostic:
    return warning("log-definition", f"{name}: `{topic}` is of schema {schema}, which the log does not have", None)


def unknown_channel(name: str, channel: int) -> Diagnostic:
    return warning("log-channel", f"{name}: messages are of channel {channel}, which the log does not define", help_="they are left out")


def out_of_order(name: str, topic: str, count: int) -> Diagnostic:
    return warning("log-order", f"{name}: {count} messages of `{topic}` have an earlier time than the one before", None)


def undecodable(name: str, topic: str, index: int, why: str, count: int) -> Diagnostic:
    more = f" ({count} such messages in all)" if count > 1 else ""
    return warning("log-message", f"{name}: message {index} of `{topic}` has bytes that its type does not have: {why}{more}", None)


def unknown_topic(name: str, topic: str, known: Iterable[str]) -> Diagnostic:
    topics = tuple(known)
    near = closest(topic, topics)
    listed = ", ".join(topics[:20]) or "none"
    return error("log-topic", f"{name} has no topic `{topic}`", help_=f"did you mean `{near}`?" if near else f"it has {listed}")


def unknown_field(name: str, topic: str, field: str, known: Iterable[str]) -> Diagnostic:
    fields = tuple(known)
    near = closest(field, fields)
    listed = ", ".join(fields[:20]) or "none"
    return error(
        "log-field",
        f"{name}: messages of `{topic}` have no number `{field}`",
        help_=f"did you mean `{near}`?" if near else f"they have {listed}",
    )


def several_types(name: str, topic: str, types: Iterable[str]) -> Diagnostic:
    found = ", ".join(f"`{each}`" for each in types)
    return error(
        "log-types",
        f"{name}: `{topic}` has messages of several types: {found}",
        help_=f'name one: log["{topic}", type], or --type; into a folder, `rosetta-jit convert` writes tables of each',
    )


def several_definitions(name: str, topic: str, type_: str) -> Diagnostic:
    return error(
        "log-types",
        f"{name}: `{topic}` has messages of `{type_}` by several definitions, which are no columns of one table",
        help_="`log.messages()` and `rosetta-jit cat` decode each message by its own",
    )


def wire_without_topic(name: str, wire: str) -> Diagnostic:
    return error("log-wire", f"{name}: it is not said which topic has the messages of wire `{wire}`", help_=f'add `{{"{wire}": "/topic"}}`')


def no_type(name: str, topic: str, details: str, *, can_be_drafted: bool) -> Diagnostic:
    help_ = f'name it: log["{topic}", "package.type"], or --type; its definition is looked for on the search path'
    if can_be_drafted:
        help_ += f"; `rosetta-jit infer {name} --topic {topic}` drafts one from the messages"
    return error("log-no-type", f"{name} does not say of which type the messages of `{topic}` are{details}", help_=help_)


def no_definition(name: str, topic: str, type_: str) -> Diagnostic:
    return error(
        "log-definition",
        f"{name} has no definition of `{type_}`, the type of the messages of `{topic}`, and the search path has none either",
        help_="search_path=[folder] adds a folder that has its file; imports=[file] names that file",
    )


def unknown_encoding(name: str, topic: str, encoding: str) -> Diagnostic:
    return error("log-encoding", f"{name}: the messages of `{topic}` are encoded as `{encoding}`, which no framework reads")


def several_encodings(name: str, encodings: Sequence[str]) -> Diagnostic:
    message = (
        f"{name}: its messages are in {len(encodings)} encodings: {', '.join(encodings)}"
        if encodings
        else f"{name} does not say how its messages are encoded"
    )
    return error("log-encoding", message, help_="name the one that is meant: `--encoding`")


def no_output(name: str, tables: Iterable[str], suffixes: Iterable[str]) -> Diagnostic:
    help_ = f"a table ends with {', '.join(tables)}, a log with {', '.join(suffixes)}, a folder of tables with `/`"
    return error("log-format", f"{name}: the name does not say what to write", help_=help_)


def no_writer(name: str, suffixes: Iterable[str]) -> Diagnostic:
    return error("log-format", f"{name}: nothing writes such files", help_=f"names end with {', '.join(suffixes)}")


def not_carried(name: str, topic: str, encoding: str, carried: str) -> Diagnostic:
    wrong = f"{name}: the messages of `{topic}` are encoded as `{encoding}`, and such files hold {carried}"
    return error("log-encoding", wrong, help_="write .mcap, which holds all")


def which_topic(name: str, topics: Sequence[str]) -> Diagnostic:
    if not topics:
        return error("log-topic", f"{name} has no topics")
    return error("log-topic", f"{name} has several topics: {', '.join(topics)}", help_="name one: --topic")


def stopped(name: str, why: str) -> Diagnostic:
    return warning("log-damaged", f"{name} cannot be read on: {why}", help_="what lies before it is read")


def missing_file(name: str, file: str) -> Diagnostic:
    return warning("log-file", f"{name} has no file {file}", help_=_READ)


def unnamed_file(name: str, file: str) -> Diagnostic:
    return warning("log-file", f"{name}: its metadata does not mention {file}, which is read all the same", None)


def bad_line(name: str, at: int, why: str) -> Diagnostic:
    return warning("log-message", f"{name}: the line at byte {at} is no message: {why}", None)


def not_of_ros1(name: str, topic: str, encoding: str) -> Diagnostic:
    wrong = f"{name}: the messages of `{topic}` are encoded as `{encoding}`, and those of ROS 1 alone become those of ROS 2"
    return error("log-encoding", wrong, help_="--topic names the others")


def no_successor(name: str, topic: str, type_: str) -> Diagnostic:
    return error(
        "log-no-type",
        f"{name}: there is no definition of {type_}, which the messages of `{topic}` would be",
        help_="--search-path names the folder of its `.msg` file",
    )


def without_definition(topic: str) -> Diagnostic:
    return warning(
        "log-definition",
        f"the messages of `{topic}` are written without the definition of their type, which is not known",
        help_=f"--type {topic}=package.type names it; its definition is looked for on the search path",
    )


def no_bytes(topic: str, type_: str) -> Diagnostic:
    return error("log-encoding", f"`{topic}`: messages of {type_} have no usual encoding, in which a log could keep them")


def not_empty(folder: str) -> Diagnostic:
    return error("log-output", f"{folder} is there already", help_="--resume continues a conversion; else name another folder")


def folder_is_there(folder: str) -> Diagnostic:
    return error("log-output", f"{folder} is there already, and not empty", help_="name another folder")


def other_conversion(folder: str, what: str) -> Diagnostic:
    return error("log-output", f"{folder} was begun with another {what}", help_="name another folder, or give the same log and options")


def bad_journal(path: str, why: str) -> Diagnostic:
    return error("log-output", f"{path} does not say how far the conversion is: {why}", help_="name another folder")


def many_stretches(folder: str, count: int) -> Diagnostic:
    return error("log-time", f"{folder} would have more than {count} stretches of time", help_="--every names longer ones: --every 1d")


def not_written(name: str, topic: str, index: int, why: str) -> Diagnostic:
    return error("log-message", f"{name}: message {index} of `{topic}` cannot be written: {why}")


def no_time(name: str, time_ns: int) -> Diagnostic:
    return error("log-time", f"{name}: bags have no time {time_ns} ns: it is before 1970 or after 2106")
