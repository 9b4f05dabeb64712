"""A master as far as nodes need it, for tests where ROS 1 is not installed; it answers as rosmaster does."""

from __future__ import annotations

import threading
from xmlrpc.client import ServerProxy
from xmlrpc.server import SimpleXMLRPCServer


class Master:
    def __init__(self, port=0):
        self.nodes, self.publishers, self.subscribers, self.services = {}, {}, {}, {}
        self.server = SimpleXMLRPCServer(("127.0.0.1", port), logRequests=False, allow_none=True)
        self.port = self.server.server_address[1]
        self.uri = f"http://127.0.0.1:{self.port}"
        self.server.register_instance(self)
        threading.Thread(target=self.server.serve_forever, args=(0.01,), daemon=True).start()

    def close(self):
        self.server.shutdown()
        self.server.server_close()

    def lookupNode(self, _, name):  # noqa: N802 - the master's API
        return [1, "", self.nodes[name]] if name in self.nodes else [-1, "unknown node", ""]

    def registerPublisher(self, name, topic, type_, uri):  # noqa: N802
        self.nodes[name] = uri
        self.publishers.setdefault(topic, {})[uri] = type_
        self.tell(topic)
        return [1, "", [*self.subscribers.get(topic, {})]]

    def registerSubscriber(self, name, topic, type_, uri):  # noqa: N802
        self.nodes[name] = uri
        self.subscribers.setdefault(topic, {})[uri] = type_
        return [1, "", [*self.publishers.get(topic, {})]]

    def unregisterPublisher(self, _, topic, uri):  # noqa: N802
        self.publishers.get(topic, {}).pop(uri, None)
        self.tell(topic)
        return [1, "", 1]

    def unregisterSubscriber(self, _, topic, uri):  # noqa: N802
        self.subscribers.get(topic, {}).pop(uri, None)
        return [1, "", 1]

    def registerService(self, name, service, place, uri):  # noqa: N802
        self.nodes[name] = uri
        self.services[service] = place
        return [1, "", 1]

    def unregisterService(self, _, service, __):  # noqa: N802
        self.services.pop(service, None)
        return [1, "", 1]

    def lookupService(self, _, service):  # noqa: N802
        return [1, "", self.services[service]] if service in self.services else [-1, "no provider", ""]

    def getTopicTypes(self, _):  # noqa: N802
        return [1, "", [[topic, next(iter(found.values()))] for topic, found in self.publishers.items() if found]]

    def tell(self, topic):
        uris = [*self.publishers.get(topic, {})]
        for uri in self.subscribers.get(topic, {}):
            threading.Thread(target=self._update, args=(uri, topic, uris), daemon=True).start()

    @staticmethod
    def _update(uri, topic, uris):
        try:
            with ServerProxy(uri) as node:
                node.publisherUpdate("/master", topic, uris)
        except OSError:
            pass
