"""Peers that send byte by byte, and hosts that are none: what waits for them ends in time, and the threads that ask go on."""

from __future__ import annotations

import socket
import threading
import time
from contextlib import contextmanager

import pytest

import rosetta_jit as rj
from rosetta_jit.errors import TransportError
from rosetta_jit.transports import http_server
from rosetta_jit.transports.conversation import connected
from rosetta_jit.transports.ros1 import xmlrpc
from rosetta_jit.transports.yarp.admin import ask_port, leave
from rosetta_jit.transports.yarp.names import Contact, NameServer
from tests.transports.free import until
from tests.transports.name_server import NameServer as Names
from tests.transports.ros_master import Master

NO_HOSTS = ("a..b", "x" * 70, "\ud800", "a\0b")


@contextmanager
def trickling(first=b"", piece=b"a"):
    """Who sends a byte every few milliseconds, for ever; gives the port."""
    ends = threading.Event()

    def serve():
        while True:
            try:
                sock, _ = server.accept()
            except OSError:
                return
            threading.Thread(target=send, args=(sock,), daemon=True).start()

    def send(sock):
        with sock:
            try:
                sock.sendall(first)
                while not ends.wait(0.01):
                    sock.sendall(piece)
            except OSError:
                pass

    with socket.create_server(("127.0.0.1", 0)) as server:
        threading.Thread(target=serve, daemon=True).start()
        yield server.getsockname()[1]
        ends.set()
        server.shutdown(socket.SHUT_RDWR)


def in_time(work, seconds=1.0):
    begun = time.monotonic()
    with pytest.raises(TransportError):
        work()
    assert time.monotonic() - begun < seconds


def test_name_servers_and_ports_that_send_byte_by_byte():
    with trickling() as port:
        in_time(lambda: NameServer("127.0.0.1", port, 0.2).query("/a"))
        contact = Contact("/a", "127.0.0.1", port, "tcp")
        in_time(lambda: ask_port(contact, "[list] [in]", 0.2))
        begun = time.monotonic()
        leave(contact, "/b", 0.2)
        assert time.monotonic() - begun < 1.0


def test_nodes_that_answer_byte_by_byte(monkeypatch):
    monkeypatch.setattr(xmlrpc, "TIMEOUT_S", 0.2)
    for first in (b"", b"HTTP/1.0 200 OK\r\nX: ", b"HTTP/1.0 200 OK\r\n\r\n"):
        with trickling(first) as port:
            in_time(lambda port=port: xmlrpc.ask(f"http://127.0.0.1:{port}/", "getPid", "/me"))


def test_who_asks_a_node_byte_by_byte_is_hung_up_on(monkeypatch):
    monkeypatch.setattr(http_server, "ANSWER_S", 0.2)
    node = xmlrpc.Answering("127.0.0.1", {})
    try:
        with socket.create_connection(("127.0.0.1", node.port), 5) as slow:
            until(lambda: not is_taken(slow), 3.0)
    finally:
        node.close()


def is_taken(sock):
    time.sleep(0.01)
    try:
        sock.sendall(b"x")
    except OSError:
        return False
    return True


ANSWERS = (b"<bigdecimal>x</bigdecimal>", b"<array><data><value><i4>0</i4></value></data></array>", b"<i4>9e9</i4>", b"\xff")


@pytest.mark.parametrize("answer", ANSWERS)
def test_answers_that_are_none_of_ros(answer):
    body = b"<?xml version='1.0'?><methodResponse><params><param><value>%s</value></param></params></methodResponse>" % answer
    with trickling(b"HTTP/1.0 200 OK\r\nContent-Length: %d\r\n\r\n%s" % (len(body), body)) as port, pytest.raises(TransportError):
        xmlrpc.ask(f"http://127.0.0.1:{port}/", "getPid", "/me")


@pytest.mark.parametrize("host", NO_HOSTS)
def test_hosts_that_are_none(host):
    with pytest.raises(OSError, match=r"no such host|not known"):
        connected(host, 1, 0.1)


def test_a_publisher_at_no_host_costs_no_other_one():
    """The node's own thread makes all connections."""
    master, bad = Master(), Master()
    bad.requestTopic = lambda *_: [1, "", ["TCPROS", "a..b", 1]]
    at = f"?master={master.uri}&type=std_msgs/String&md5=992ce8a1687cec8c8bd883ec73ca41d1"
    master.registerPublisher("/bad", "/chat", "std_msgs/String", bad.uri)
    try:
        with rj.subscribe(f"ros1:/chat{at}&name=/reader") as source, rj.publish(f"ros1:/chat{at}&name=/writer") as sink:
            until(lambda: sink.connections)
            sink.send(b"\0\0\0\0")
            assert source.take(5)
    finally:
        master.close()
        bad.close()


def test_a_port_at_no_host_costs_its_writer_nothing():
    names = Names()
    names.ports["/bad"] = "a..b", "1"
    at = f"?server=127.0.0.1:{names.port}"
    try:
        with rj.publish(f"yarp:/out{at}") as sink:
            host, port = names.ports["/out"]
            contact = Contact("/out", host, int(port), "tcp")
            assert "no such host" in ask_port(contact, '[add] "/bad"', 2.0)
            with rj.subscribe(f"yarp:/out{at}") as source:
                until(lambda: sink.connections)
                sink.send(b"x")
                assert source.take(5).data == b"x"
    finally:
        names.close()
