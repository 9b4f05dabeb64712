"""Addresses and their options: what is wrong is said, and installed packages offer further ones."""

from __future__ import annotations

import pytest

import rosetta_jit as rj
from rosetta_jit.errors import AddressError


@pytest.mark.parametrize(
    ("address", "said"),
    [
        ("/icub/torso", "an address begins with its transport"),
        ("tpc:9000", "did you mean `tcp:`?"),
        ("tcp:localhost", "expected a host and a port"),
        ("tcp:1:99999", "expected a host and a port"),
        ("tcp:9000?fram=u32", "did you mean `frame`?"),
        ("tcp:9000?frame=u31", "`frame` takes one of `u32`"),
        ("tcp:9000?max_message=-1", "`max_message` takes a number of bytes"),
        ("tcp:9000?queue=1&queue=2", "`queue` is said twice"),
        ("tcp:9000?timeout=nan", "`timeout` takes a number of seconds"),
        ("udp:9000?frame=u32", "there is no option `frame`"),
    ],
)
def test_what_is_wrong_with_an_address_is_said(address, said):
    with pytest.raises(AddressError, match=r"(?s)error\[") as caught:
        rj.subscribe(address)
    assert said in str(caught.value)


@pytest.mark.usefixtures("offers_anew")
def test_an_installed_package_may_offer_a_transport(tmp_path, monkeypatch):
    (tmp_path / "toy_transport.py").write_text(
        "from rosetta_jit.transports.base import Message, Transport\n"
        "def subscribe(address, source, options):\n"
        "    source.arrived(Message(address.rest.encode(), address.rest))\n"
        "    source.ended()\n"
        "TOY = Transport('toy', ('toy',), 'toy:a', subscribe='toy_transport:subscribe')\n"
    )
    described = tmp_path / "toy-1.dist-info"
    described.mkdir()
    (described / "METADATA").write_text("Metadata-Version: 2.1\nName: toy\nVersion: 1\n")
    (described / "entry_points.txt").write_text("[rosetta_jit.transports]\ntoy = toy_transport:TOY\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    with rj.subscribe("toy:hello") as source:
        assert [each.data for each in source] == [b"hello"]
    with pytest.raises(AddressError, match="cannot publish"):
        rj.publish("toy:hello")


def test_options_of_a_call_go_before_those_of_the_address():
    with pytest.raises(AddressError, match="takes an integer"):
        rj.subscribe("tcp:9000?queue=5", queue="many")
