"""The front end of ROS 1: `.msg`, `.srv` and `.action` files, and the concatenated definitions of a bag, as genmsg and actionlib read them.

https://wiki.ros.org/msg, https://wiki.ros.org/srv, https://wiki.ros.org/actionlib
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

from rosetta_jit.frameworks.ros import Definition, Dialect, Field, Interface, Rule, gathered, schema_of
from rosetta_jit.frameworks.ros1.time_types import INT32, STRUCTS, UINT32
from rosetta_jit.model.types import Bool, Float, Int, Schema, String
from rosetta_jit.parsing.idl import Load
from rosetta_jit.source import Source
from rosetta_jit.startup.md5 import md5

SCALARS = {
    "int8": Int(8, spelling="int8"),
    "uint8": Int(8, signed=False, spelling="uint8"),
    "int16": Int(16, spelling="int16"),
    "uint16": Int(16, signed=False, spelling="uint16"),
    "int32": INT32,
    "uint32": UINT32,
    "int64": Int(64, spelling="int64"),
    "uint64": Int(64, signed=False, spelling="uint64"),
    "float32": Float(32, "float32"),
    "float64": Float(64, "float64"),
    "string": String("utf-8", "string"),
    "bool": Bool("bool"),
    "char": Int(8, signed=False, spelling="char"),
    "byte": Int(8, spelling="byte"),
}

SERVICE = Interface(("{}Request", "{}Response"))
ACTION = Interface(
    ("{}Goal", "{}Result", "{}Feedback"),
    {
        "{}ActionGoal": "Header header\nactionlib_msgs/GoalID goal_id\n{}Goal goal",
        "{}ActionResult": "Header header\nactionlib_msgs/GoalStatus status\n{}Result result",
        "{}ActionFeedback": "Header header\nactionlib_msgs/GoalStatus status\n{}Feedback feedback",
        "{}Action": "{0}ActionGoal action_goal\n{0}ActionResult action_result\n{0}ActionFeedback action_feedback",
    },
)

IDENTIFIER = Rule(re.compile(r"[A-Za-z][A-Za-z0-9_]*"), "letters, digits and underscores, a letter first")

ROS1 = Dialect(
    name="ros1",
    qualified="{package}/{name}",
    scalars=SCALARS,
    octets=frozenset({"uint8", "char"}),
    packages=IDENTIFIER,
    messages=IDENTIFIER,
    fields=IDENTIFIER,
    constants=IDENTIFIER,
    integers=re.compile(r"[+-]?[0-9]+"),
    line_ends=re.compile(r"\n"),
    dashes=re.compile(r"^---[^\n]*(?:\n|\Z)", re.MULTILINE),
    extended=False,
    structs=STRUCTS,
    aliases={"Header": "std_msgs/Header"},
    interfaces={"srv": SERVICE, "action": ACTION},
)


def parse(source: Source, load: Load) -> Schema:
    """The messages of a file and those that they need, from the text itself where it has their definitions, else from the search path.

    The options of a struct are its ``definition``, the text without those of other messages, and its ``md5sum``; of a request or a response
    also ``service_md5sum``.

    Parameters
    ----------
    source
        The text, named after what it declares: ``sensor_msgs/Imu.msg``, ``std_srvs/srv/SetBool.srv``.
    load
        Finds the files of other messages.

    Raises
    ------
    SchemaError
        With everything that is wrong in any of the texts.
    """
    definitions = gathered(source, load, ROS1).definitions
    sums = md5_sums(definitions)
    services = service_sums(definitions, sums) if source.name.endswith(".srv") else {}

    def options(each: Definition) -> tuple[tuple[str, str], ...]:
        own = (("definition", each.text), ("md5sum", sums[each.name]))
        return (*own, ("service_md5sum", services[each.name])) if each.name in services else own

    return schema_of(definitions, ROS1, options)


def md5_sums(definitions: Iterable[Definition]) -> dict[str, str]:
    """The sums by which ROS 1 tells versions of messages apart, by name; each message comes after those that it contains.

    https://wiki.ros.org/ROS/Technical%20Overview, and genmsg's ``compute_md5``. A sum is of the declarations without comments and blanks,
    constants first, with the sum of a message in place of its name.
    """
    sums: dict[str, str] = {}
    for definition in definitions:
        sums[definition.name] = md5(hashed_text(definition, sums).encode(), usedforsecurity=False).hexdigest()
    return sums


def service_sums(definitions: Iterable[Definition], sums: Mapping[str, str]) -> dict[str, str]:
    """The sum of the service in a file, under the names of its request and its response; theirs are of their own texts alone."""
    halves = sorted((each for each in definitions if each.source.name.endswith(".srv")), key=lambda each: each.name)  # the request first
    text = "".join(hashed_text(each, sums) for each in halves)
    return dict.fromkeys((each.name for each in halves), md5(text.encode(), usedforsecurity=False).hexdigest())


def hashed_text(definition: Definition, sums: Mapping[str, str]) -> str:
    """The text of a message that is hashed; an array of messages counts as one of them."""
    constants = (f"{each.type.written} {each.name.text}={each.text.text}" for each in definition.constants)
    return "\n".join([*constants, *(_declaration(each, sums) for each in definition.fields)])


def _declaration(field: Field, sums: Mapping[str, str]) -> str:
    return f"{field.type.written if field.type.builtin else sums[field.type.base]} {field.name.text}"
