"""How many messages a second each transport carries between two processes, and how long one takes: `python -m tests.transports.measure`.

The other process receives, and sends back what it is asked to. Name servers and brokers that are needed are started here; transports whose
client or broker is absent are left out.
"""

from __future__ import annotations

import json
import shutil
import socket
import statistics
import subprocess
import sys
import time
from contextlib import ExitStack, suppress

import rosetta_jit as rj
from rosetta_jit.errors import RosettaError
from tests.transports.free import answers, free_port, running, until
from tests.transports.name_server import NameServer
from tests.transports.ros_master import Master

COUNT, SIZE, ROUNDS = 20_000, 200, 2_000
STRING = "type=std_msgs/String&md5=992ce8a1687cec8c8bd883ec73ca41d1"
LARGE = 1 << 20


def addresses(stack):
    """Of each transport: what this process publishes to and subscribes to, and the same for the other one."""
    one, two = free_port(), free_port()
    yield "TCP", f"tcp:{one}", f"tcp:{two}", f"tcp:{one}", f"tcp:{two}"
    yield "Unix socket", f"unix:/tmp/rj-{one}", f"unix:/tmp/rj-{two}", f"unix:/tmp/rj-{one}", f"unix:/tmp/rj-{two}"
    yield "UDP", f"udp:{one}", f"udp:{two}", f"udp:{one}", f"udp:{two}"
    names = stack.enter_context(closing(NameServer()))
    for carrier in ("tcp", "fast_tcp", "udp", "mcast"):
        at = f"?server=127.0.0.1:{names.port}&carrier={carrier}"
        there, back = f"yarp:/{carrier}{at}", f"yarp:/{carrier}/back{at}"
        yield f"YARP, {carrier}", f"{there}&wait=yes", back, there, f"{back}&wait=yes"
    at = f"port={free_port()}"
    yield "RSB", f"rsb:/there?{at}&type=bytes", f"rsb:/back?{at}", f"rsb:/there?{at}", f"rsb:/back?{at}&type=bytes"
    at = f"master={stack.enter_context(closing(Master())).uri}"
    yield "ROS 1", f"ros1:/there?{at}&{STRING}", f"ros1:/back?{at}", f"ros1:/there?{at}", f"ros1:/back?{at}&{STRING}"
    url = f"url=udpm://239.255.76.67:{free_port()}%3Fttl=0"
    yield "LCM", f"lcm:A?{url}", f"lcm:B?{url}", f"lcm:A?{url}", f"lcm:B?{url}"
    broker = shutil.which("mosquitto", path="/usr/sbin:/usr/bin")
    if broker:
        port = free_port()
        stack.enter_context(running(broker, "-p", port))
        until(lambda: answers(port))
        more = f"?port={port}&queue=100000"
        yield "MQTT", f"mqtt:a{more}", f"mqtt:b{more}", f"mqtt:a{more}", f"mqtt:b{more}"
    place = f"tcp/127.0.0.1:{free_port()}"
    yield "zenoh", f"zenoh:a?listen={place}", f"zenoh:b?listen={place}", f"zenoh:a?connect={place}", f"zenoh:b?connect={place}"
    dds = "?type=bench/msg/Bytes&domain=78&keep=1000"
    yield "DDS", f"ros2-dds:/a{dds}", f"ros2-dds:/b{dds}", f"ros2-dds:/a{dds}", f"ros2-dds:/b{dds}"
    yield "shared memory", *(f"iceoryx:{name}{one}?buffer=1000" for name in "abab")


class closing:  # noqa: N801 - as contextlib names it, with the value inside
    def __init__(self, value):
        self.value = value

    def __enter__(self):
        return self.value

    def __exit__(self, *_):
        self.value.close()


def other(there, back):
    """The other process: counts what begins with `c`, sends the rest back, and says the count when it gets `?`."""
    seen, ends = [0, 0.0], []
    sink = rj.publish(back)

    def take(message):
        first = message.data[4]
        if first == 99:
            seen[0] += 1
            seen[1] = time.perf_counter()
        elif first == 63:
            sink.send(b"\0\1\0\0" + json.dumps(seen).encode())
        elif first == 113:
            ends.append(1)
        else:
            sink.send(bytes(message.data))

    with rj.subscribe(there, take):
        print("ready", flush=True)
        while not ends:
            time.sleep(0.01)
    sink.close()


def asked(sink, source, text):
    """What the other one answers, asked again until it does: connections take a moment."""
    while True:
        sink.send(b"\0\1\0\0" + text)
        message = source.take(0.3)
        if message is not None:
            while (more := source.take(0.05)) is not None:
                message = more
            return bytes(message.data)


def measured(name, to, back, there, back_there):
    command = [sys.executable, "-m", "tests.transports.measure", there, back_there]
    with ExitStack() as stack:
        source = stack.enter_context(rj.subscribe(back))
        sink = stack.enter_context(rj.publish(to)) if to.startswith(("ros1", "yarp")) or "listen" in to else None
        process = stack.enter_context(subprocess.Popen(command, stdout=subprocess.PIPE, text=True))
        try:
            process.stdout.readline()
            sink = sink or stack.enter_context(rj.publish(to))
            asked(sink, source, b"hello")
            row = name, *rate(sink, source, SIZE, COUNT), *latency(sink, source), *rate(sink, source, LARGE, 200)
            sink.send(b"\0\1\0\0q")
            with suppress(subprocess.TimeoutExpired):
                process.wait(5)
            return row
        finally:
            process.kill()


def rate(sink, source, size, count):
    """Messages a second, and how many of a hundred arrived."""
    data = (b"\0\1\0\0c" + bytes(size))[:size]
    before = json.loads(asked(sink, source, b"?")[4:].rstrip(b"\0"))[0]
    began = time.perf_counter()
    try:
        for _ in range(count):
            sink.send(data)
    except RosettaError:  # larger than it takes
        return 0, 0
    sink.flush(20)
    arrived, last = json.loads(asked(sink, source, b"?")[4:].rstrip(b"\0"))
    return (arrived - before) / max(last - began, 1e-6), round(100 * (arrived - before) / count)


def latency(sink, source):
    """Half the time there and back, in microseconds: median, and 99 of 100."""
    data, times = b"\0\1\0\0l" + bytes(SIZE - 5), []
    for _ in range(ROUNDS):
        began = time.perf_counter()
        sink.send(data)
        if source.take(1) is not None:
            times.append((time.perf_counter() - began) / 2e-6)
    return statistics.median(times), statistics.quantiles(times, n=100)[98]


def plain():
    """The same with sockets alone: a length before each message, `recv` into a buffer, blocking."""
    one, two = socket.socketpair()
    child = subprocess.Popen([sys.executable, "-c", ECHO, str(two.fileno()), str(SIZE), str(ROUNDS)], pass_fds=[two.fileno()])
    data, times = bytes(SIZE), []
    for _ in range(ROUNDS):
        began = time.perf_counter()
        one.sendall(data)
        one.recv(SIZE, socket.MSG_WAITALL)
        times.append((time.perf_counter() - began) / 2e-6)
    child.wait()
    return statistics.median(times), statistics.quantiles(times, n=100)[98]


ECHO = """
import socket, sys
sock = socket.socket(fileno=int(sys.argv[1]))
for _ in range(int(sys.argv[3])):
    sock.sendall(sock.recv(int(sys.argv[2]), socket.MSG_WAITALL))
"""


def main():
    if len(sys.argv) > 2:
        other(*sys.argv[1:])
        return
    chosen = sys.argv[1] if len(sys.argv) == 2 else ""
    print(f"{'':16} {'messages/s':>11} {'arrived':>8} {'one way, µs':>12} {'p99':>7} {'MB/s':>7}")
    print(f"{'sockets alone':16} {'':11} {'':8} {'{:12.0f} {:7.0f}'.format(*plain())}")
    with ExitStack() as stack:
        for each in addresses(stack):
            if chosen.lower() not in each[0].lower():
                continue
            try:
                name, many, arrived, median, worst, large, _ = measured(*each)
            except RosettaError as error:
                print(f"{each[0]:16} left out: {error}")
                continue
            speed = f"{large * LARGE / 1e6:7.0f}" if large else ""
            print(f"{name:16} {many:11,.0f} {arrived:7} % {median:12.0f} {worst:7.0f} {speed}", flush=True)


if __name__ == "__main__":
    main()
