"""A name server as far as ports need it, for tests where YARP is not installed; what it answers is what yarpserver was seen to answer."""

from __future__ import annotations

import socketserver
import threading


class NameServer:
    def __init__(self, port=0):
        self.ports = {}
        self.groups = 0
        names = self

        class Request(socketserver.StreamRequestHandler):
            def handle(self):
                words = self.rfile.readline().decode().split()[1:]
                self.wfile.write(names.answer(words).encode())

        class Server(socketserver.ThreadingTCPServer):
            allow_reuse_address = True
            daemon_threads = True

        self.server = Server(("127.0.0.1", port), Request)
        self.port = self.server.server_address[1]
        threading.Thread(target=self.server.serve_forever, args=(0.01,), daemon=True).start()

    def answer(self, words):
        end = "*** end of message\r\n"
        match words:
            case ["announce", _]:
                return "[ok]\r\n"
            case ["register", "...", "mcast", "...", "..."]:
                self.groups += 1
                name = f"/tmp/port/{self.groups}"  # noqa: S108 - no file: so the name server calls them
                self.ports[name] = f"224.1.1.{self.groups % 250}", 10000 + self.port % 1000
                return self.line(name) + end
            case ["bot", "set", _, "owns", name]:
                return f'"{name}"\r\n'
            case ["register", name, "tcp", host, port]:
                self.ports[name] = host, port
            case ["unregister", name]:
                self.ports.pop(name, None)
                return end
            case ["list"]:
                return "".join(map(self.line, sorted(self.ports))) + end
            case ["set", name, key, *values]:
                return f"port {name} property {key} = {' '.join(sorted(values))}\r\n{end}"
        return (self.line(words[1]) if words[1] in self.ports else "") + end

    def line(self, name):
        host, port = self.ports[name]
        kind = "mcast" if host.startswith("224.") else "tcp"
        return f"registration name {name} ip {host} port {port} type {kind}\r\n"

    def close(self):
        self.server.shutdown()
        self.server.server_close()
