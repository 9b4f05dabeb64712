"""What a bridge carries on one core: many topics, and large images."""

from __future__ import annotations

import os
import socket
import threading
import time
from contextlib import ExitStack
from typing import Any

import rosetta_jit as rj
from bench.bridge_load.processes import Arrived, Lines, before_all_others, connected, cpu_s, framed, free_ports, running

IMAGES = """decode_type = "sensor_msgs/Image"
encode_type = "sensor_msgs/msg/Image"
decode = { encoding = "ros1" }
encode = { encoding = "cdr" }
"""
IMAGES_AT_ONCE = 4


def topics(count: int = 100, rate: int = 1000, seconds: float = 10.0) -> dict[str, Any]:
    """So many topics of 200 bytes at a rate, mapped: what arrives, and how much of a core the bridge takes.

    The bridge goes before all other programs, where the user may say so.
    """
    bottle = rj.Encoder.of("yarp.sig.Vector", encoding="yarp4", imports=["yarp/sig/Vector.bottle-schema"])({"values": [0.5] * 24})
    message = framed(bottle)
    ports = free_ports(2 * count)
    routes = "".join(
        f'[[route]]\nname = "{number}"\nsource = "tcp:{one}"\ntarget = "tcp:{other}"\nbetween = ["yarp4", "yarp3"]\n'
        for number, (one, other) in enumerate(zip(ports[:count], ports[count:], strict=True))
    )
    with ExitStack() as stack:
        listeners = [stack.enter_context(socket.create_server(("127.0.0.1", port))) for port in ports[count:]]
        program = stack.enter_context(running(routes))
        lines = Lines(program)
        arrived = Arrived([each.accept()[0] for each in listeners])
        senders = [stack.enter_context(connected(port)) for port in ports[:count]]
        is_first = stack.enter_context(before_all_others(program.pid))
        before, begun = cpu_s(program.pid), time.monotonic()
        sent = 0
        while (passed := time.monotonic() - begun) < seconds:
            due = int(passed * rate) - sent // count
            if due > 0:
                for each in senders:
                    each.sendall(message * due)
                sent += due * count
            else:
                time.sleep(0.0002)
        took = time.monotonic() - begun
        arrived.wait()
        used = cpu_s(program.pid) - before
        program.terminate()
        last = lines.last()
        arrived.close()
    return {
        "bytes": len(bottle),
        "offered_per_s": sent / took,
        "carried_per_s": sum(each["sent"] for each in last) / took,
        "not_taken": sent - sum(each["taken"] for each in last),
        "lost": sum(sum(each["dropped"].values()) for each in last),
        "cpu_us_a_message": used / max(sent, 1) * 1e6,
        "cores": used / took,
        "p99_us": max(each["p99_us"] for each in last),
        "before_all_others": is_first,
    }


def images(size: int = 1_000_000, seconds: float = 5.0) -> dict[str, Any]:
    """Images of ROS 1 that become those of ROS 2, over loopback: gigabytes a second. At most four are on their way."""
    image = rj.Encoder.of("sensor_msgs/Image", encoding="ros1")({"height": 1000, "width": 1000, "step": 1000, "data": bytes(size)})
    source, target = free_ports(2)
    route = f'[[route]]\nsource = "tcp:{source}"\ntarget = "tcp:{target}"\nqueue = 4\n{IMAGES}'
    with socket.create_server(("127.0.0.1", target)) as listener, running(route) as program:
        lines = Lines(program)
        arrived, message = Arrived([listener.accept()[0]]), framed(image)
        with connected(source) as sender, before_all_others(program.pid) as is_first:
            before, begun, sent = cpu_s(program.pid), time.monotonic(), 0
            while time.monotonic() - begun < seconds:
                if sent - arrived.bytes // len(message) < IMAGES_AT_ONCE:
                    sender.sendall(message)
                    sent += 1
                else:
                    time.sleep(0.0001)
            took = time.monotonic() - begun
            arrived.wait()
            used = cpu_s(program.pid) - before
            program.terminate()
            (last,) = lines.last()
        arrived.close()
    return {
        "gigabytes_per_s": last["bytes_out"] / took / 1e9,
        "lost": sum(last["dropped"].values()),
        "cores": used / took,
        "cpu_us_an_image": used / max(last["taken"], 1) * 1e6,
        "p99_us": last["p99_us"],
        "before_all_others": is_first,
    }


def shared(size: int = 1_000_000, seconds: float = 5.0) -> dict[str, Any]:
    """The same images through shared memory (iceoryx2), there and back; the next one goes as soon as at most one is on its way."""
    image = rj.Encoder.of("sensor_msgs/Image", encoding="ros1")({"height": 1000, "width": 1000, "step": 1000, "data": bytes(size)})
    there, back = f"iceoryx:bench/{os.getpid()}/there?first={2 * size}", f"iceoryx:bench/{os.getpid()}/back?first={2 * size}"
    route = f'[[route]]\nsource = "{there}"\ntarget = "{back}"\n{IMAGES}'
    free, came = threading.Semaphore(2), threading.Event()

    def take(_: object) -> None:
        came.set()
        free.release()

    with running(route) as program, rj.subscribe(back, take) as source, rj.publish(there) as sink:
        lines = Lines(program)
        while not came.is_set():
            sink.send(image)
            came.wait(0.1)
        time.sleep(1.0)
        free, before, first, begun, sent = threading.Semaphore(2), cpu_s(program.pid), source.messages, time.monotonic(), 0
        with before_all_others(program.pid) as is_first:
            while time.monotonic() - begun < seconds:
                if free.acquire(timeout=1.0):
                    sink.send(image)
                    sent += 1
        took = time.monotonic() - begun
        time.sleep(1.0)
        used, arrived = cpu_s(program.pid) - before, source.messages - first
        program.terminate()
        (last,) = lines.last()
    return {
        "gigabytes_per_s": arrived * size / took / 1e9,
        "lost": sent - arrived,
        "cores": used / took,
        "cpu_us_an_image": used / max(arrived, 1) * 1e6,
        "p99_us": last["p99_us"],
        "before_all_others": is_first,
    }
