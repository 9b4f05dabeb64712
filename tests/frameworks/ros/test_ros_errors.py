"""Each wrong file has a report of its own, and the peer whose language it is refuses it too."""

from __future__ import annotations

import pytest

from rosetta_jit.errors import SchemaError
from tests.frameworks.ros.ros_files import GOLDEN, alone, debian
from tests.golden import check_golden

FILES = [path for dialect in ("ros1", "ros2") for path in sorted((GOLDEN / dialect).iterdir()) if path.suffix != ".err"]
BEYOND = {
    "CycleOfTwo",
    "DuplicateConstant",
    "LongDashes",
    "LongName",
    "NoDashes",
    "SectionName",
    "SectionTwice",
    "SectionUnnamed",
    "Time",
    "TooDeep",
    "TooFewDashes",
    "TooManyDashes",
    "UnknownMessage",
    "WrongPart",
    "lowercase_action",
}
"""What the peers' parsers of one file do not look at, but their generators or C++ compilers do."""


def ident(path):
    return f"{path.parent.name}-{path.stem}"


def report_of(path):
    with pytest.raises(SchemaError) as caught:
        alone(path.read_bytes().decode(), f"pkg/{path.name}", path.parent.name)
    return caught.value


@pytest.mark.parametrize("path", FILES, ids=ident)
def test_report(path):
    check_golden(path.with_suffix(".err"), f"{report_of(path)}\n")


@pytest.mark.parametrize("path", FILES, ids=ident)
def test_every_diagnostic_points_at_its_place(path):
    assert all(problem.span and problem.label for problem in report_of(path).diagnostics)


@pytest.mark.parametrize("path", [each for each in FILES if each.stem not in BEYOND], ids=ident)
def test_the_peer_refuses_each_line(path, capsys):
    """Each line that we report is wrong alone, too."""
    for problem in report_of(path).diagnostics:
        line = path.read_bytes().decode().split("\n")[problem.span.source.line_column(problem.span.start)[0] - 1]
        assert refused_by_peer(path, line), line


def refused_by_peer(path, text):
    if path.parent.name == "ros1":
        loader = debian("genmsg", "msg_loader")
        try:
            loader.load_msg_from_string(loader.MsgContext.create_default(), text, f"pkg/{path.stem}")
        except loader.InvalidMsgSpec:
            return True
        return False
    parser = debian("rosidl_adapter", "parser")
    try:
        parser.parse_message_string("pkg", path.stem, text)
    except (parser.InvalidSpecification, parser.InvalidValue, TypeError, ValueError, NameError, IndexError, NotImplementedError):
        return True
    return False
