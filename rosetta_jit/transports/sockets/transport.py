"""Sockets and pipes as `Transport`s."""

from __future__ import annotations

from rosetta_jit.transports.address import Option
from rosetta_jit.transports.base import Transport

HERE = "rosetta_jit.transports.sockets"

FRAMES = ("u32", "u32be", "u16", "u16be", "u64", "u64be", "varint", "line", "none")

FRAME = {
    "frame": Option(
        FRAMES, "u32", "what stands before each message: its length; `line`: nothing, it ends with a newline; `none`: what one read gives"
    )
}
STREAM = FRAME | {
    "listen": Option(("yes", "no", ""), "", "wait for connections, or make one; by default who receives waits"),
    "wait": Option("flag", True, "a full queue makes the sender wait; else the message is dropped"),
}

TRANSPORTS = (
    Transport(
        "TCP and Unix sockets",
        ("tcp", "unix"),
        "tcp:127.0.0.1:9000",
        subscribe=f"{HERE}.tcp:subscribe",
        publish=f"{HERE}.tcp:TcpSink",
        call=f"{HERE}.calls:TcpCaller",
        serve=f"{HERE}.calls:serve",
        check=f"{HERE}.endpoints:place",
        options=STREAM,
    ),
    Transport(
        "UDP",
        ("udp",),
        "udp:127.0.0.1:9000",
        subscribe=f"{HERE}.udp:subscribe",
        publish=f"{HERE}.udp:UdpSink",
        check=f"{HERE}.endpoints:place",
        options={"interface": Option("text", "127.0.0.1", "by which address of this machine groups are joined and reached")},
    ),
    Transport(
        "pipes and files",
        ("pipe",),
        "pipe:-",
        subscribe=f"{HERE}.pipe:subscribe",
        publish=f"{HERE}.pipe:publish",
        options=FRAME,
    ),
)
