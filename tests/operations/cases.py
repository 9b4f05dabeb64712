"""Two mappings for each of the nine operations, and what plain Python and numpy say that they do.

A case makes messages of its wire; ``unpack`` says what holder one becomes, ``pack`` what message that holder becomes again. Whoever refuses
raises `Refused`.
"""

from __future__ import annotations

import io
import math
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta
from typing import TYPE_CHECKING, Any

import numpy as np
from PIL import Image

if TYPE_CHECKING:
    from collections.abc import Callable

EPOCH = datetime(1970, 1, 1, tzinfo=UTC)
Values = dict[str, Any]


class Refused(Exception):  # noqa: N818 - what happens to a message, not to the test
    """The kind of the error that is expected."""


@dataclass(frozen=True)
class Case:
    """A mapping of ``tests/operations/mappings``; ``number`` of a message counts those that a decoder has made."""

    name: str
    wire: str
    make: Callable[[np.random.Generator], Values]
    unpack: Callable[[Values, int], Values]
    pack: Callable[[Values], Values]
    encoding: str = "yarp4"
    options: Values = field(default_factory=dict)

    @property
    def operation(self) -> str:
        return self.name.partition("_")[0]


# --- arithmetic --------------------------------------------------------------------------------------------------------


def make_wheel(rng: np.random.Generator) -> Values:
    return {"ticks": int(rng.integers(-(10**9), 10**9)), "heading": int(rng.integers(-18000, 18000)), "slip": float(rng.uniform(-0.5, 1.5))}


def unpack_wheel(wire: Values, _: int) -> Values:
    theta = np.float32(np.radians(wire["heading"] * 0.01))
    return {"way": wire["ticks"] * 0.21 * math.pi / 4096, "theta": float(theta), "slip": int(np.rint(np.clip(wire["slip"], 0, 1) * 100))}


def pack_wheel(holder: Values) -> Values:
    ticks, heading = holder["way"] * 4096 / (0.21 * math.pi), np.degrees(np.float64(holder["theta"])) * 100
    return {"ticks": round(ticks), "heading": int(np.rint(heading)), "slip": holder["slip"] / 100}


def make_word(rng: np.random.Generator) -> Values:
    return {name: int(rng.integers(-(2**bits), 2**bits)) for name, bits in (("word", 62), ("left", 30), ("right", 30))}


def unpack_word(wire: Values, _: int) -> Values:
    mean, rest = divmod(wire["left"] + wire["right"], 2)
    return {"low": wire["word"] % 256, "high": wire["word"] // 256, "mean": mean, "rest": rest, "left": wire["left"]}


def pack_word(holder: Values) -> Values:
    return {
        "word": holder["high"] * 256 + holder["low"],
        "left": holder["left"],
        "right": 2 * holder["mean"] + holder["rest"] - holder["left"],
    }


# --- array reorder -----------------------------------------------------------------------------------------------------


def make_frame(rng: np.random.Generator) -> Values:
    height, width = (int(each) for each in rng.integers(1, 9, 2))
    rows = rng.integers(0, 256, (height, 3 * width), np.uint8)
    return {"width": width, "height": height, "pixels": np.pad(rows, ((0, 0), (0, -3 * width % 4))).tobytes()}


def unpack_frame(wire: Values, _: int) -> Values:
    rows = np.frombuffer(wire["pixels"], np.uint8).reshape(wire["height"], -1)[:, : 3 * wire["width"]]
    planes = np.moveaxis(rows.reshape(wire["height"], wire["width"], 3), 2, 0)
    return {"width": wire["width"], "height": wire["height"], "order": "SEPARATE", "data": planes.tobytes()}


def pack_frame(holder: Values) -> Values:
    height, width = holder["height"], holder["width"]
    pixels = np.moveaxis(np.frombuffer(holder["data"], np.uint8).reshape(3, height, width), 0, 2).reshape(height, -1)
    return {"width": width, "height": height, "pixels": np.pad(pixels, ((0, 0), (0, -3 * width % 4))).tobytes()}


def make_scan(rng: np.random.Generator) -> Values:
    points = [{"x": float(x), "y": float(y)} for x, y in rng.normal(size=(int(rng.integers(0, 20)), 2))]
    return {"points": points, "matrix": rng.normal(size=6).tolist(), "colors": rng.bytes(3 * int(rng.integers(0, 9)))}


def unpack_scan(wire: Values, _: int) -> Values:
    matrix = np.array(wire["matrix"])
    return {
        "x": [point["x"] for point in wire["points"]],
        "y": [point["y"] for point in wire["points"]],
        "columns": matrix.reshape(2, 3).ravel(order="F").tolist(),
        "colors": np.frombuffer(wire["colors"], np.uint8).reshape(-1, 3)[:, ::-1].tobytes(),
        "first": matrix[0:4:2][::-1].tolist(),
    }


def pack_scan(holder: Values) -> Values:
    points = [{"x": x, "y": y} for x, y in zip(holder["x"], holder["y"], strict=True)]
    colors = np.frombuffer(holder["colors"], np.uint8).reshape(-1, 3)[:, ::-1].tobytes()
    return {"points": points, "matrix": np.array(holder["columns"]).reshape(3, 2).T.ravel().tolist(), "colors": colors}


# --- string manipulation -----------------------------------------------------------------------------------------------


def make_topic(rng: np.random.Generator) -> Values:
    robot, part, key = (str(rng.choice(words)) for words in (["iCub", "R1", "Ärger"], ["left_arm", "head", "_"], ["heat", " gain", "é"]))
    return {"topic": f"/{robot}/{part}/state", "line": f"{key} = {rng.normal() * 100!r}".replace("np.float64(", "").replace(")", "")}


def ascii_case(text: str, change: Callable[[str], str]) -> str:
    return "".join(change(char) if char.isascii() else char for char in text)


def unpack_topic(wire: Values, _: int) -> Values:
    _, robot, part, *_ = wire["topic"].split("/")
    key, value = (each.strip() for each in wire["line"].split("="))
    return {
        "robot": ascii_case(robot, str.lower),
        "part": part.replace("_", " "),
        "key": ascii_case(key, str.upper),
        "value": float(value),
    }


def pack_topic(holder: Values) -> Values:
    return {
        "topic": f"/{holder['robot']}/{holder['part'].replace(' ', '_')}",
        "line": f"{holder['key']} = {holder['value']:.3f}",
    }


def make_record(rng: np.random.Generator) -> Values:
    name = str(rng.choice(["", "torso", "sixteen bytes so"])).encode()
    value, count = float(rng.normal() * 10.0 ** rng.integers(-20, 20)), int(rng.integers(-(2**63), 2**63 - 1))
    note = str(rng.choice(["#hidden", "né", "a longer note"])).encode("latin-1")
    return {"name": list(name.ljust(16, b"\0")), "value": value, "count": count, "note": note}


def unpack_record(wire: Values, _: int) -> Values:
    return {
        "name": bytes(wire["name"]).partition(b"\0")[0].decode(),
        "value": repr(wire["value"]),
        "count": str(wire["count"]),
        "note": wire["note"].decode("latin-1"),
        "long": len(wire["note"]) > 5 and not wire["note"].startswith(b"#"),
    }


def pack_record(holder: Values) -> Values:
    name, note = holder["name"].encode().ljust(16, b"\0"), holder["note"].encode("latin-1")
    return {"name": list(name), "value": float(holder["value"]), "count": int(holder["count"]), "note": note}


# --- image compression -------------------------------------------------------------------------------------------------


def compressed(pixels: np.ndarray, kind: str, **options: int) -> bytes:
    written = io.BytesIO()
    Image.fromarray(pixels).save(written, kind, **options)
    return written.getvalue()


def make_shot(kind: str) -> Callable[[np.random.Generator], Values]:
    def make(rng: np.random.Generator) -> Values:
        if rng.random() < 0.2:
            return {"name": kind, "data": compressed(np.zeros((2, 2), np.uint8), kind)}
        height, width = (int(each) for each in rng.integers(8, 20, 2))
        slope = np.linspace(0, 200, width)[None, :, None] + np.linspace(0, 50, height)[:, None, None]
        return {"name": kind, "data": compressed((slope + rng.integers(0, 5, 3)).astype(np.uint8), kind)}

    return make


def unpack_shot(wire: Values, _: int) -> Values:
    image = Image.open(io.BytesIO(wire["data"]))
    if image.mode != "RGB":
        raise Refused("rejected")
    return {"width": image.width, "height": image.height, "pixels": image.tobytes()}


def pack_shot(kind: str, **options: int) -> Callable[[Values], Values]:
    def pack(holder: Values) -> Values:
        pixels = np.frombuffer(holder["pixels"], np.uint8).reshape(holder["height"], holder["width"], 3)
        return {"name": kind, "data": compressed(pixels, kind, **options)}

    return pack


# --- predicate assignment ----------------------------------------------------------------------------------------------


def make_lamp(rng: np.random.Generator) -> Values:
    return {"kind": str(rng.choice(["plain", "dimmed", "broken"])), "level": int(rng.integers(0, 100))}


def unpack_lamp(wire: Values, _: int) -> Values:
    match wire["kind"]:
        case "plain":
            return {"kind": "PLAIN", "percent": 100 * wire["level"], "bright": wire["level"] > 0}
        case "dimmed":
            return {"kind": "DIMMED", "percent": wire["level"], "bright": wire["level"] > 50}
        case _:
            raise Refused("rejected")


def pack_lamp(holder: Values) -> Values:
    is_plain = holder["kind"] == "PLAIN"
    return {"kind": "plain" if is_plain else "dimmed", "level": holder["percent"] // (100 if is_plain else 1)}


def make_target(rng: np.random.Generator) -> Values:
    return {"kind": int(rng.integers(1, 3)), "place": int(rng.integers(99)), "word": "dock", "urgent": bool(rng.integers(2))}


def unpack_target(wire: Values, _: int) -> Values:
    case = {"place": wire["place"]} if wire["kind"] == 1 else {"word": wire["word"]}
    return {**case, "weight": 10 if wire["urgent"] else 1}


def pack_target(holder: Values) -> Values:
    kind = 1 if "place" in holder else 2
    return {"kind": kind, "place": holder.get("place", -1), "word": holder.get("word", ""), "urgent": holder["weight"] > 5}


# --- subtype loops -----------------------------------------------------------------------------------------------------


def make_arm(rng: np.random.Generator) -> Values:
    joints = [{"label": f"joint {n}", "angle": float(rng.normal() * 90), "torque": 1.0} for n in range(int(rng.integers(0, 8)))]
    return {"side": str(rng.choice(["left", "right"])), "joints": joints}


def unpack_arm(wire: Values, _: int) -> Values:
    joints = [{"name": each["label"], "radians": float(np.float32(np.radians(each["angle"])))} for each in wire["joints"]]
    return {"left": wire["side"] == "left", "joints": joints}


def pack_arm(holder: Values) -> Values:
    joints = [{"label": each["name"], "angle": float(np.degrees(each["radians"])), "torque": 0.0} for each in holder["joints"]]
    return {"side": "left" if holder["left"] else "right", "joints": joints}


def make_tree(rng: np.random.Generator, depth: int = 0) -> Values:
    number = int(rng.integers(-5, 5))
    count = int(rng.integers(0, 3)) if depth < 2 else int(rng.random() < 0.1)
    return {"number": number, "below": [make_tree(rng, depth + 1) for _ in range(count)]}


def unpack_tree(wire: Values, number: int, depth: int = 0) -> Values:
    if depth > 2:
        raise Refused("rejected")
    return {"value": wire["number"], "children": [unpack_tree(each, number, depth + 1) for each in wire["below"]]}


def pack_tree(holder: Values) -> Values:
    return {"number": holder["value"], "below": [pack_tree(each) for each in holder["children"]]}


# --- rejection ---------------------------------------------------------------------------------------------------------


def make_grip(rng: np.random.Generator) -> Values:
    count = 5 if rng.random() < 0.8 else int(rng.integers(0, 8))
    return {"hand": str(rng.choice(["left", "right", "left", "right", "third"])), "fingers": rng.normal(size=count).tolist()}


def unpack_grip(wire: Values, _: int) -> Values:
    if len(wire["fingers"]) != 5 or wire["hand"] not in {"left", "right"}:
        raise Refused("rejected")
    return dict(wire)


def make_order(rng: np.random.Generator) -> Values:
    mode, weight = str(rng.choice(["slow", "fast", "slow", "fast", "never"])), float(rng.choice([0.5, 2.0, 4.0, 8.5, -1.0, 0.0001]))
    return {"version": 3 if rng.random() < 0.9 else 2, "mode": mode, "amount": int(rng.choice([7, -5, 9, 0, 2**40])), "weight": weight}


def unpack_order(wire: Values, _: int) -> Values:
    if wire["mode"] not in {"slow", "fast"}:
        raise Refused("rejected")
    if abs(wire["amount"]) >= 2**31 or wire["weight"] * 1000 % 1:
        raise Refused("range")
    if wire["version"] != 3:
        raise Refused("rejected")
    return {"mode": wire["mode"].upper(), "amount": wire["amount"], "grams": int(wire["weight"] * 1000), "format": 7}


def pack_order(holder: Values) -> Values:
    if holder["format"] != 7 or holder["grams"] < 0:
        raise Refused("rejected")
    return {"version": 3, "mode": holder["mode"].lower(), "amount": holder["amount"], "weight": holder["grams"] / 1000}


# --- generators --------------------------------------------------------------------------------------------------------

AXIS = [0.0, 1.0, 0.5]
SERIES = {"prefix": "joint", "axis": AXIS}


def make_series(rng: np.random.Generator) -> Values:
    return {"values": rng.normal(size=int(rng.integers(0, 12))).tolist()}


def unpack_series(wire: Values, _: int) -> Values:
    samples = [{"name": f"joint {n}", "index": n, "value": value} for n, value in enumerate(wire["values"])]
    return {"samples": samples, "unit": "mm", "axis": AXIS}


def pack_series(holder: Values) -> Values:
    return {"values": [each["value"] for each in holder["samples"]]}


def calibrate(raw: float, channel: int) -> float:
    return raw * (1.0 + 0.5 * channel) if channel >= 0 else raw / (1.0 - 0.5 * channel)


def make_reading(rng: np.random.Generator) -> Values:
    return {"raw": float(rng.normal()), "channel": int(rng.integers(0, 4))}


def unpack_reading(wire: Values, number: int) -> Values:
    return {"value": wire["raw"] * (2 + wire["channel"]) / 2, "number": number, "channel": wire["channel"]}


def pack_reading(holder: Values) -> Values:
    return {"raw": holder["value"] * 2 / (2 + holder["channel"]), "channel": holder["channel"]}


# --- date manipulation -------------------------------------------------------------------------------------------------


def make_stamp(rng: np.random.Generator) -> Values:
    secs, micros = int(rng.integers(-(10**10), 10**10)), int(rng.integers(0, 10**6))
    return {"secs": secs, "nsecs": 1000 * micros, "age": int(rng.integers(-(10**6), 10**6)) / 64}


def unpack_stamp(wire: Values, _: int) -> Values:
    micros = wire["secs"] * 10**6 + wire["nsecs"] // 1000
    return {"micros": micros, "date": written(micros), "age": int(wire["age"] * 10**9)}


def written(micros: int) -> str:
    found = (EPOCH + timedelta(microseconds=micros)).isoformat(timespec="microseconds").removesuffix("+00:00")
    whole, _, decimals = found.partition(".")
    kept = decimals[:3] if decimals.endswith("000") else decimals
    return whole + ("" if decimals == "000000" else f".{kept}") + "Z"


def pack_stamp(holder: Values) -> Values:
    secs, micros = divmod(holder["micros"], 10**6)
    return {"secs": secs, "nsecs": 1000 * micros, "age": holder["age"] / 1e9}


def make_dated(rng: np.random.Generator) -> Values:
    micros = int(rng.integers(-(10**16), 10**16)) // 1000 * int(rng.choice([1, 1000]))
    return {"date": written(micros), "micros": int(rng.integers(-(10**12), 10**12))}


def unpack_dated(wire: Values, _: int) -> Values:
    micros = (datetime.fromisoformat(wire["date"]) - EPOCH) // timedelta(microseconds=1)
    return {"secs": micros // 10**6, "nsecs": micros % 10**6 * 1000, "seconds": wire["micros"] / 1e6}


def pack_dated(holder: Values) -> Values:
    micros = holder["secs"] * 10**6 + holder["nsecs"] // 1000
    return {"date": written(micros), "micros": round(holder["seconds"] * 1e6)}


CASES = (
    Case("arithmetic_wheel", "ops.wheel", make_wheel, unpack_wheel, pack_wheel),
    Case("arithmetic_word", "ops.word", make_word, unpack_word, pack_word),
    Case("reorder_frame", "ops.frame", make_frame, unpack_frame, pack_frame),
    Case("reorder_scan", "ops.scan", make_scan, unpack_scan, pack_scan),
    Case("string_topic", "ops.topic", make_topic, unpack_topic, pack_topic),
    Case("string_record", "ops.record", make_record, unpack_record, pack_record),
    Case("image_png", "ops.shot", make_shot("png"), unpack_shot, pack_shot("png", compress_level=1)),
    Case("image_jpeg", "ops.shot", make_shot("jpeg"), unpack_shot, pack_shot("jpeg", quality=95)),
    Case("predicate_lamp", "ops.lamp", make_lamp, unpack_lamp, pack_lamp),
    Case("predicate_target", "ops.target", make_target, unpack_target, pack_target),
    Case("subtype_arm", "ops.arm", make_arm, unpack_arm, pack_arm),
    Case("subtype_tree", "ops.Wide", make_tree, unpack_tree, pack_tree, encoding="protobuf"),
    Case("rejection_grip", "ops.grip", make_grip, unpack_grip, dict),
    Case("rejection_order", "ops.order", make_order, unpack_order, pack_order),
    Case("generators_series", "ops.values", make_series, unpack_series, pack_series, options={"parameters": SERIES}),
    Case("generators_reading", "ops.raw", make_reading, unpack_reading, pack_reading, options={"functions": {"calibrate": calibrate}}),
    Case("date_stamp", "ops.stamp", make_stamp, unpack_stamp, pack_stamp),
    Case("date_moment", "ops.dated", make_dated, unpack_dated, pack_dated),
)
OPERATIONS = {
    "arithmetic": "arithmetic",
    "reorder": "array reorder",
    "string": "string manipulation",
    "image": "image compression",
    "predicate": "predicate assignment",
    "subtype": "subtype loops",
    "rejection": "rejection",
    "generators": "generators",
    "date": "date manipulation",
}
"""The paper's operations, by the first word of a mapping's name."""
