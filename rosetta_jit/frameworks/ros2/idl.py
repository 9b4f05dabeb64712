"""The front end of ROS 2's `.msg`, `.srv` and `.action` files, and of the concatenated texts in an MCAP file, as rosidl reads them.

https://docs.ros.org/en/rolling/Concepts/Basic/About-Interfaces.html
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from rosetta_jit.frameworks.ros import Dialect, Gathered, Interface, Rule, gathered, schema_of
from rosetta_jit.frameworks.ros.sections import HEADER, SEPARATOR
from rosetta_jit.frameworks.ros2.empty import DUMMY
from rosetta_jit.model.types import Bool, Field, Float, Int, Schema, String
from rosetta_jit.parsing.idl import Load
from rosetta_jit.source import Source
from rosetta_jit.startup.late import Late

if TYPE_CHECKING:
    from rosetta_jit.frameworks.omg import idl as omg
    from rosetta_jit.frameworks.ros2 import adapter
else:
    adapter = Late("rosetta_jit.frameworks.ros2.adapter")
    omg = Late("rosetta_jit.frameworks.omg.idl")

SCALARS = {
    "bool": Bool("bool"),
    "byte": Int(8, signed=False, spelling="byte"),
    "char": Int(8, signed=False, spelling="char"),
    "float32": Float(32, "float32"),
    "float64": Float(64, "float64"),
    "int8": Int(8, spelling="int8"),
    "uint8": Int(8, signed=False, spelling="uint8"),
    "int16": Int(16, spelling="int16"),
    "uint16": Int(16, signed=False, spelling="uint16"),
    "int32": Int(32, spelling="int32"),
    "uint32": Int(32, signed=False, spelling="uint32"),
    "int64": Int(64, spelling="int64"),
    "uint64": Int(64, signed=False, spelling="uint64"),
    "string": String("utf-8", "string"),
    "wstring": String("utf-16", "wstring"),
}

EVENT = "service_msgs/ServiceEventInfo info\n{0}_Request[<=1] request\n{0}_Response[<=1] response"
DESCRIBED = "{0}_Request request_message\n{0}_Response response_message\n{0}_Event event_message"
"""A service itself is no message; this is what its type hash is of (REP 2011)."""
SERVICE = Interface(("{}_Request", "{}_Response"), {"{}_Event": EVENT, "{}": DESCRIBED})
ACTION = Interface(
    ("{}_Goal", "{}_Result", "{}_Feedback"),
    {
        "{}_SendGoal_Request": "unique_identifier_msgs/UUID goal_id\n{}_Goal goal",
        "{}_SendGoal_Response": "bool accepted\nbuiltin_interfaces/Time stamp",
        "{}_SendGoal_Event": EVENT.replace("{0}", "{0}_SendGoal"),
        "{}_SendGoal": DESCRIBED.replace("{0}", "{0}_SendGoal"),
        "{}_GetResult_Request": "unique_identifier_msgs/UUID goal_id",
        "{}_GetResult_Response": "int8 status\n{}_Result result",
        "{}_GetResult_Event": EVENT.replace("{0}", "{0}_GetResult"),
        "{}_GetResult": DESCRIBED.replace("{0}", "{0}_GetResult"),
        "{}_FeedbackMessage": "unique_identifier_msgs/UUID goal_id\n{}_Feedback feedback",
        "{}": "{0}_Goal goal\n{0}_Result result\n{0}_Feedback feedback\n{0}_SendGoal send_goal_service\n"
        "{0}_GetResult get_result_service\n{0}_FeedbackMessage feedback_message",
    },
)

LOWER = Rule(re.compile(r"[a-z](?:_?[a-z0-9])*"), "lower-case letters, digits and single underscores, a letter first")

ROS2 = Dialect(
    name="ros2",
    qualified="{package}/{folder}/{name}",
    scalars=SCALARS,
    octets=frozenset({"uint8", "byte", "char"}),
    packages=LOWER,
    messages=Rule(
        re.compile(
            r"(?:Sample_)?[A-Z][A-Za-z0-9]*(?:_(?:Request|Response|Event|Goal|Result|Feedback|SendGoal|GetResult|FeedbackMessage))*"
        ),
        "letters and digits, an upper-case one first",
    ),
    fields=LOWER,
    constants=Rule(re.compile(r"[A-Z](?:_?[A-Z0-9])*"), "upper-case letters, digits and single underscores, a letter first"),
    integers=re.compile(r"[+-]?(?:[0-9]+|0[xX][0-9a-fA-F]+|0[oO][0-7]+|0[bB][01]+)"),
    line_ends=re.compile(r"\r\n|[\n\r\v\f\x1c-\x1e\x85\u2028\u2029]"),
    dashes=re.compile(r"^---\r?(?:\n|\Z)", re.MULTILINE),
    extended=True,
    foreign=".idl",
    usual={"Header": "std_msgs/msg/Header"},
    interfaces={"srv": SERVICE, "action": ACTION},
    empty=(Field(DUMMY, SCALARS["uint8"]),),
)


def as_idl(found: Gathered, source: Source, load: Load) -> Schema:
    """All messages as rosidl would write them in `.idl` files, which can include others, and the `.idl` files of the text itself."""
    texts = {f"{each.name}.idl": adapter.idl_text(each, ROS2) for each in found.definitions} | dict(in_order(found.files))
    root = Source(f"{source.name}.idl", "".join(f'#include "{name}"\n' for name in texts))
    return omg.parse(root, adapter.with_messages(load, ROS2, texts))


def parse(source: Source, load: Load) -> Schema:
    """The messages of a file and those that they need, from the text itself where it has their definitions, else from the search path.

    Where one of these is declared in a `.idl` file, all are read as IDL, as rosidl does with every `.msg` file: then their names are
    ``pkg::msg::Name``. The default of a field is `Field.default`; that of an array other than bytes is its option ``default``, a list in
    JSON.

    Parameters
    ----------
    source
        The text, named after what it declares: ``sensor_msgs/msg/Imu.msg``, ``sensor_msgs/Imu.msg``, ``std_srvs/srv/SetBool.srv``. It may
        hold several, each behind a line of `=` and one with its kind and name.
    load
        Finds the files of other messages.

    Raises
    ------
    SchemaError
        With everything that is wrong in any of the texts.
    """
    found = gathered(source, load, ROS2)
    return as_idl(found, source, load) if found.foreign or found.files else schema_of(found.definitions, ROS2)


def parse_idl(source: Source, load: Load) -> Schema:
    """The same of a `.idl` file, or of several in one text, which may include the `.idl` files that rosidl would make of `.msg` files.

    Raises
    ------
    SchemaError
        With everything that is wrong.
    """
    if is_concatenated(source.text):
        return parse(source, load)
    return omg.parse(source, adapter.with_messages(load, ROS2))


NO_NAMES = re.compile(r"//[^\n]*|/\*.*?(?:\*/|\Z)|\"(?:[^\"\\]|\\.)*(?:\"|\Z)", re.DOTALL)
"""Comments and strings, of which the last may have no end."""
WORD = re.compile(r"\w+")


def is_concatenated(text: str) -> bool:
    """Whether a text is several files, as MCAP's schema encoding ros2idl has them: in any order, and not all with their `#include`s.

    Such a text begins with a line of `=` and one that names what follows: https://mcap.dev/spec/registry#ros2idl.
    """
    line = SEPARATOR.search(text)
    return line is not None and not text[: line.start()].strip() and HEADER.match(text, line.end()) is not None


def in_order(files: Mapping[str, str]) -> Iterator[tuple[str, str]]:
    """The files, each behind those whose types it mentions: IDL knows a name once it is declared."""
    declaring: dict[str, list[str]] = {}
    for name in files:
        declaring.setdefault(name.removesuffix(".idl").rpartition("/")[2], []).append(name)
    whole: dict[str, bool] = {}
    for name in files:
        waiting = [name]
        while waiting:
            current = waiting[-1]
            if current not in whole:
                whole[current] = False
                mentioned = dict.fromkeys(WORD.findall(NO_NAMES.sub(" ", files[current])))
                waiting += [each for word in mentioned for each in declaring.get(word, ()) if each not in whole]
                continue
            waiting.pop()
            if not whole[current]:
                whole[current] = True
                yield current, files[current]
