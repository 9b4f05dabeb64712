"""What folders of topics are called."""

from __future__ import annotations

from collections.abc import Iterable
from urllib.parse import quote

from rosetta_jit.startup.sha import sha256

NAME_BYTES = 180


def folder_names(topics: Iterable[str]) -> dict[str, str]:
    """What the folders of topics are called: `/camera/left` is `camera.left`; those that would be called alike get a digest."""
    names = {topic: _name(topic) for topic in topics}
    taken = [name.lower() for name in names.values()]
    return {topic: name if taken.count(name.lower()) == 1 else _digested(name, topic) for topic, name in names.items()}


def _name(topic: str) -> str:
    name = quote(topic.strip("/").replace("/", "."), safe=" .-_")
    if name.startswith((".", "_")) or not name.strip(". "):
        name = f"topic{name}"
    return name if len(name) <= NAME_BYTES else _digested(name[:NAME_BYTES], topic)


def _digested(name: str, topic: str) -> str:
    return f"{name}-{sha256(topic.encode('utf-8', 'replace')).hexdigest()[:12]}"
