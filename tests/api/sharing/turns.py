"""What each kind of sharing needs: messages that say which one they are, and threads that take turns."""

from __future__ import annotations

import random
import threading
import time

import numpy as np

import rosetta_jit as rj

SCHEMA = {
    "p/A.msg": "int32 n\nfloat64[] d\nstring s\nstring[] names\nB[] items\nuint8[] raw\n",
    "p/B.msg": "int32 k\nstring t\n",
}
DIGITS = "0123456789"
CHOICES = {
    "choices.proto": """syntax = "proto3";
package p;
message N { string t = 1; repeated double d = 2; }
message C { oneof u { string a = 1; N b = 2; int32 c = 3; } map<string, N> m = 4; map<int32, string> k = 5; N n = 6; }
"""
}
KINDS = {}


def kind(function):
    KINDS[function.__name__] = function
    return function


def of(program):
    return program.of("p/A", schema=SCHEMA, encoding="ros1", imports=["p/A.msg"])


def plain(number):
    """All parts of a message say which one it is; few are of one size."""
    size = 1 + number * 37 % 1000
    word = f"{number} " * size
    return {
        "n": number,
        "d": [float(number)] * size,
        "s": word,
        "names": [word] * (1 + number % 4),
        "items": [{"k": number, "t": str(number)}] * (number % 5),
        "raw": word.encode() * (1 + number % 3 * 20),
    }


def choice(number):
    """The same of a message with a oneof and maps."""
    word = str(number % 10) * (1 + number * 37 % 500)
    nested = {"t": word, "d": [float(number)] * (number % 50)}
    chosen = ({"a": word}, {"b": nested}, {"c": number})[number % 3]
    return {**chosen, "m": {f"{word}{i}": nested for i in range(number % 6)}, "k": dict.fromkeys(range(number % 9), word), "n": nested}


def buffer_of(sent):
    return b"".join(sent), np.cumsum([0, *map(len, sent)])


def messages(count):
    encode = of(rj.Encoder)
    return [bytes(encode(encode.holder_type.from_dict(plain(number)))) for number in range(count)]


def check(found, number=None):
    if found != plain(found["n"] if number is None else number):
        raise AssertionError(f"a mixture: {found['n']} of {number}, {found['d'][:1]} {found['s'][:10]} {str(found['names'])[:10]}")


class Turns:
    """Threads that call functions, again and again, until the time is over or one of them has seen what must not be."""

    def __init__(self, seconds):
        self.seconds = seconds
        self.end = float("inf")
        self.failed = None
        self.counts = {}

    def run(self, *functions):
        self.end = time.monotonic() + self.seconds
        threads = [threading.Thread(target=self._again, args=(number, each)) for number, each in enumerate(functions)]
        for each in threads:
            each.start()
        for each in threads:
            each.join()
        if self.failed is not None:
            raise self.failed

    def _again(self, number, function):
        right = refused = 0
        rng = random.Random(number)
        while time.monotonic() < self.end and self.failed is None:
            try:
                function(rng)
                right += 1
            except rj.InUse:
                refused += 1
                time.sleep(1e-4)  # as who is refused does something else first
            except BaseException as error:
                self.failed = error
                raise
        self.counts[f"{number} {function.__name__}"] = (right, refused)
