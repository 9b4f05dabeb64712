"""How ROS 2 names topics and types below: `/chatter` is `rt/chatter` in DDS, `std_msgs/msg/String` is `std_msgs::msg::dds_::String_`."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rosetta_jit.transports.address import Address

TOPIC = re.compile(r"/[A-Za-z_][A-Za-z0-9_]*(/[A-Za-z_][A-Za-z0-9_]*)*")
TYPE = re.compile(r"[A-Za-z][A-Za-z0-9_]*/(msg|srv|action)/[A-Za-z][A-Za-z0-9_]*")
MANGLED = re.compile(r"([A-Za-z][A-Za-z0-9_]*)::(msg|srv|action)::dds_::([A-Za-z][A-Za-z0-9_]*)_")


def topic_of(address: Address) -> str:
    """The topic that an address names, with its first slash.

    Raises
    ------
    AddressError
        It is none.
    """
    if not TOPIC.fullmatch(address.rest):
        raise address.wrong("a topic of ROS 2: `/`, then letters, digits and `_` between slashes", f"{address.scheme}:/chatter")
    return address.rest


def mangled(type_: str, address: Address) -> str:
    """The name of a type in DDS.

    Raises
    ------
    AddressError
        It is no name of a type of ROS 2.
    """
    if not TYPE.fullmatch(type_):
        raise address.wrong("a topic with a type of ROS 2", f"{address.scheme}:/chatter?type=std_msgs/msg/String")
    package, kind, name = type_.split("/")
    return f"{package}::{kind}::dds_::{name}_"


def plain(name: str) -> str:
    """The name of a type in ROS 2; another name as it is."""
    match = MANGLED.fullmatch(name)
    return f"{match[1]}/{match[2]}/{match[3]}" if match else name
