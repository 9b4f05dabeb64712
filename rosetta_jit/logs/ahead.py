"""Reading ahead: while one block is decoded, a thread reads and decompresses the next. Both do their work without the interpreter lock."""

from __future__ import annotations

from contextlib import suppress
from queue import Empty, Full, Queue
from threading import Event, Thread
from typing import TYPE_CHECKING, TypeVar

from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Generator, Iterator

Item = TypeVar("Item")
POLL_S = 0.1
"""How long the thread sleeps before it looks whether anybody still wants what it has."""


@dataclass(frozen=True, slots=True)
class Failed:
    """What the iterator raised."""

    error: BaseException


class _End:
    """There is no more."""


def ahead(items: Iterator[Item]) -> Generator[Item]:
    """The same items, of which one is made while another one is used. What the iterator raises is raised here.

    Three are alive at once: the one that is used, one that waits, and the one that is made.
    """
    waiting: Queue[Item | Failed | _End] = Queue(maxsize=1)
    unwanted = Event()

    def put(item: Item | Failed | _End) -> None:
        while not unwanted.is_set():
            try:
                return waiting.put(item, timeout=POLL_S)
            except Full:
                continue
        return None

    def make() -> None:
        try:
            for item in items:
                put(item)
                if unwanted.is_set():
                    return
            put(_End())
        except BaseException as error:  # noqa: BLE001 - it is raised where the items are used
            put(Failed(error))

    thread = Thread(target=make, name="rosetta_jit reads ahead", daemon=True)
    thread.start()
    try:
        while True:
            match waiting.get():
                case Failed(error):
                    raise error
                case _End():
                    return
                case item:
                    yield item
    finally:
        unwanted.set()
        with suppress(Empty):
            waiting.get_nowait()
        thread.join()
