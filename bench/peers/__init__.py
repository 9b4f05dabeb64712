"""Whom we are compared with: each peer that is installed, on each message that it can read.

`python_peers` and `native_peers` say who they are; a peer that is not installed is left out of the report, never an error.
"""

from __future__ import annotations

from importlib.util import find_spec
from typing import TYPE_CHECKING

from bench.peers import betterproto, by_hand, cyclone, lcm_gen, mcap, protobuf, pybag, rosbags

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from bench.peers.base import Peer
    from bench.subjects import Subject

_PACKAGES: Mapping[str, tuple[str, Callable[[Subject], tuple[Peer, ...]]]] = {
    "rosbags": ("rosbags", rosbags.peers),
    "mcap-ros1-support": ("mcap_ros1", mcap.ros1_peers),
    "mcap-ros2-support": ("mcap_ros2", mcap.ros2_peers),
    "pybag-sdk": ("pybag", pybag.peers),
    "cyclonedds": ("cyclonedds", cyclone.peers),
    "lcm": ("lcm", lcm_gen.peers),
    "protobuf": ("grpc_tools", protobuf.peers),
    "betterproto2": ("betterproto2", betterproto.peers),
}
"""Distribution → what to look for, and its peers for a message."""


def packages() -> tuple[str, ...]:
    """The distributions of peers that there are, installed or not."""
    return tuple(_PACKAGES)


def installed() -> tuple[str, ...]:
    """Those of them that take part."""
    return tuple(name for name, (module, _) in _PACKAGES.items() if find_spec(module) is not None)


def python_peers(subject: Subject) -> tuple[Peer, ...]:
    """All that read the subject's message in this process; what a person writes by hand comes last."""
    return (*peers_of(subject, installed()), *by_hand.peers(subject))


def peers_of(subject: Subject, packages: Sequence[str]) -> tuple[Peer, ...]:
    """Those that some packages have, if they are installed."""
    return tuple(peer for name in installed() if name in packages for peer in _PACKAGES[name][1](subject))
