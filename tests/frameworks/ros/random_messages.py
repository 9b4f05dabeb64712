"""Random types of ROS 1 and random messages of them, written by a few lines of their own."""

from __future__ import annotations

import random
import struct

SCALARS = {
    "int8": "b",
    "byte": "b",
    "uint8": "B",
    "char": "B",
    "int16": "h",
    "uint16": "H",
    "int32": "i",
    "uint32": "I",
    "int64": "q",
    "uint64": "Q",
    "float32": "f",
    "float64": "d",
    "bool": "?",
    "time": "II",
    "duration": "ii",
}


class Definitions:
    """A message of up to three others, as concatenated text."""

    def __init__(self, seed):
        self.choose = random.Random(seed)
        self.name = "pkg/M0"
        self.fields = {}
        for number in reversed(range(4)):
            inner = [f"pkg/M{each}" for each in range(number + 1, 4)]
            self.fields[f"pkg/M{number}"] = [self._type(inner) for _ in range(self.choose.randrange(1, 7))]
        separator = "=" * 80
        texts = {name: "".join(f"{type_}{size} f{i}\n" for i, (type_, size) in enumerate(types)) for name, types in self.fields.items()}
        self.text = texts[self.name] + "".join(f"{separator}\nMSG: {name}\n{text}" for name, text in texts.items() if name != self.name)

    def message(self):
        """The bytes of a message."""
        return self._message(self.name)

    def _type(self, inner):
        type_ = self.choose.choice([*SCALARS, "string", "string", *inner, *inner])
        return type_, self.choose.choice(["", "", "[]", f"[{self.choose.randrange(1, 5)}]"])

    def _message(self, name):
        return b"".join(self._field(type_, size) for type_, size in self.fields[name])

    def _field(self, type_, size):
        if not size:
            return self._value(type_)
        count = self.choose.randrange(4) if size == "[]" else int(size[1:-1])
        return (struct.pack("<I", count) if size == "[]" else b"") + b"".join(self._value(type_) for _ in range(count))

    def _value(self, type_):
        if type_ in self.fields:
            return self._message(type_)
        if type_ == "string":
            data = "".join(self.choose.choice(["", "a", "é", "€", "\0", "😀"]) for _ in range(5)).encode()
            return struct.pack("<I", len(data)) + data
        if type_ == "bool":
            return self.choose.choice([b"\0", b"\1"])
        return self.choose.randbytes(struct.calcsize(f"<{SCALARS[type_]}"))
