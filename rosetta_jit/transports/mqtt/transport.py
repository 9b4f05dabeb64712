"""MQTT as a `Transport`."""

from __future__ import annotations

from rosetta_jit.transports.address import Option
from rosetta_jit.transports.base import Transport

HERE = "rosetta_jit.transports.mqtt.client"

TRANSPORTS = (
    Transport(
        "MQTT",
        ("mqtt",),
        "mqtt:robot/arm/joints",
        subscribe=f"{HERE}:subscribe",
        publish=f"{HERE}:MqttSink",
        extra=("mqtt", "paho"),
        options={
            "host": Option("text", "127.0.0.1", "of the broker"),
            "port": Option("number", 1883, "of the broker"),
            "qos": Option(("0", "1", "2"), "0", "quality of service: at most once, at least once, exactly once"),
            "retain": Option("flag", False, "the broker keeps the last message for who subscribes later"),
            "username": Option("text", "", "for the broker"),
            "password": Option("text", "", "for the broker; as an argument rather than in the address, which is shown"),
            "tls": Option("flag", False, "speak TLS, and check the broker's certificate"),
            "client_id": Option("text", "", "by which the broker knows this client; by default one is made up"),
        },
    ),
)
