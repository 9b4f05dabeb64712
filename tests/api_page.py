"""The API reference as text, made from docstrings: `docs/api.md` is what `page` gives."""

from __future__ import annotations

import inspect
import re

import rosetta_jit as rj
from rosetta_jit.api.bridges import BridgeOptions
from rosetta_jit.api.options import Options
from rosetta_jit.api.wires import WireOptions
from rosetta_jit.frameworks.corba.manners import Structure
from rosetta_jit.frameworks.lcm.manners import LcmMessage
from rosetta_jit.frameworks.protobuf.manners import ProtobufMessage
from rosetta_jit.frameworks.ros1.manners import RosMessage
from rosetta_jit.frameworks.ros2.manners import Ros2Message
from rosetta_jit.frameworks.yarp.manners import BottleMessage
from rosetta_jit.logs.channel import Channel
from rosetta_jit.logs.log import Log
from rosetta_jit.runtime.batches.nested import Columns, Ragged
from rosetta_jit.runtime.batches.texts import Texts
from rosetta_jit.startup.cached import cached_property
from rosetta_jit.transports.base import Message, Sink, Source
from rosetta_jit.transports.calls import Caller, Server

HEAD = """\
# API reference

Made from the docstrings; `UPDATE_GOLDENS=1 pytest tests/test_api_page.py` writes it again. `help()` says the same in Python. The command
line is described by `rosetta-jit --help`.

    import rosetta_jit as rj

"""
CHAPTERS = {
    "Programs": (rj.Decoder, rj.Encoder, rj.Bridge, rj.Decoders, rj.Encoders, Options, WireOptions, BridgeOptions, rj.check, rj.infer),
    "Messages": (rj.Holder, rj.Batch, Columns, Ragged, Texts),
    "Logs": (rj.open, Log, Channel),
    "Transports": (rj.subscribe, rj.publish, rj.call, rj.serve, Message, Source, Sink, Caller, Server),
    "What holders of a framework have besides": (ProtobufMessage, RosMessage, Ros2Message, LcmMessage, Structure, BottleMessage),
    "Errors": tuple(
        found for found in (getattr(rj, name) for name in rj.__all__) if isinstance(found, type) and issubclass(found, Exception)
    ),
}
SECTION = re.compile(r"^(\w[\w ]*)\n-{3,}\n", re.MULTILINE)


def page():
    parts = [HEAD]
    for chapter, members in CHAPTERS.items():
        parts.append(f"## {chapter}\n\n")
        parts += [_class(each) if isinstance(each, type) else _function(each, "### ", f"rj.{each.__name__}") for each in members]
    return "".join(parts).rstrip("\n") + "\n"


def _class(class_):
    name = f"rj.{class_.__name__}" if class_.__name__ in rj.__all__ else class_.__name__
    bases = [each.__name__ for each in class_.__bases__ if issubclass(class_, Exception)]
    head = f"### {name}{f' ({bases[0]})' if bases else ''}\n\n{_text(class_)}"
    if class_ in (rj.Decoder, rj.Encoder, rj.Bridge):
        head += f"A program is called as `program{inspect.signature(_program(class_))}`.\n\n"
    return head + "".join(_member(class_, each) for each in _names(class_))


def _program(class_):
    options = {"encoding": "ros1", "backend": "python"}
    return class_.of("std_msgs/Empty", **({"decode": options, "encode": options} if class_ is rj.Bridge else options))


def _names(class_):
    """Public members that the class, or a base that is not shown by itself, defines; none of what Python's own classes have."""
    above = [] if issubclass(class_, rj.Holder) else [each for each in class_.__mro__ if each.__module__.startswith("rosetta_jit")]
    ours = [class_, *above]
    names = dict.fromkeys(name for each in ours for name, value in vars(each).items() if _is_shown(name, value))
    return sorted(names) if not issubclass(class_, Exception) else ()


def _is_shown(name, value):
    if name.startswith("_") or name.endswith("_") or "; for transports." in (value.__doc__ or ""):
        return False  # what only those call who write a transport stands in their source
    return isinstance(value, property | cached_property | classmethod | staticmethod) or inspect.isfunction(value)


def _member(class_, name):
    value = inspect.getattr_static(class_, name)
    if isinstance(value, property | cached_property):
        doc = value.__doc__ or ""
        return f"**`.{name}`**\n\n{_markdown(inspect.cleandoc(doc))}\n\n" if doc else f"**`.{name}`**\n\n"
    return _function(getattr(class_, name), "**`.", name, "`**")


def _function(function, before, name, after=""):
    bare = [
        each.replace(annotation=inspect.Parameter.empty) for each in inspect.signature(function).parameters.values() if each.name != "self"
    ]
    signature = str(inspect.Signature(bare))
    head = f"{before}{name}{signature}{after}" if after else f"{before}{name}\n\n`{name}{signature}`"
    return f"{head}\n\n{_text(function)}"


def _text(thing):
    doc = inspect.getdoc(thing)
    return f"{_markdown(doc)}\n\n" if doc and doc != inspect.getdoc(object) else ""


def _markdown(doc):
    """A docstring with its sections as lists."""
    first, *sections = SECTION.split(doc)
    parts = [first.strip().replace("``", "`")]
    for title, body in zip(sections[::2], sections[1::2], strict=True):
        parts.append(f"*{title}*\n\n{_items(body)}")
    return "\n\n".join(parts)


def _items(body):
    """The entries of a section: lines at its margin, and what is said of each below."""
    lines = []
    for line in body.strip("\n").splitlines():
        text = line.strip().replace("``", "`")
        if line and not line.startswith(" "):
            lines.append(f"- `{text}`" if re.fullmatch(r"[\w*, .|:()+\[\]{}\"]+", text) else f"- {text}")
        elif text:
            lines.append(f"  {text}")
    return "\n".join(lines)
