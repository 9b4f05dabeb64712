"""Generated C++ around a codec: a message that reads and writes itself on a YARP port, and a converter for RSB."""

from __future__ import annotations

import os
import re
import subprocess
from pathlib import Path

import pytest

from rosetta_jit.api.options import request_of, type_request
from rosetta_jit.generate.build import Wishes, generated
from tests.generate import cpp, native
from tests.generate.test_c import TORSO

HERE = Path(__file__).parent
MODELS = f"-I{HERE / 'models'}"
BOTH = ("decode", "encode")
ASKING = {
    "a.bottle-schema": '"a" (("value" :int))',
    "b.proto": 'syntax = "proto3"; package b; message Number { int32 value = 1; int64 now = 2; }',
    "m.mapping": 'import "a.bottle-schema"\nimport "b.proto"\ndata-holder: b.Number\nwire-schema: a\nunpack-rules:\n'
    "  .value = int32(counter() + .value)\n  .now = now()\npack-rules:\n  .value = .value\n",
}
SAID_ON_PORTS = """\
tcp: 3 angles, 1.5708
tcp: truncated at .pitch, byte 24: the message ends here
tcp: 3 angles, 1.5708
local: 3 angles, 1.5708
text_ack: 3 angles, 1.5708
text_ack: truncated at .pitch, byte 24: the message ends here
text_ack: 3 angles, 1.5708
3 angles
"""


def said_by(program: Path, *arguments: str) -> list[str]:
    return subprocess.run([program, *arguments], capture_output=True, text=True, check=True).stdout.splitlines()


@cpp.needs_cpp
def test_a_class_that_reads_and_writes_itself_on_a_port(tmp_path):
    """With a model of YARP's classes, which have these signatures."""
    name = cpp.write(tmp_path, generated(TORSO, "cpp", BOTH, "torso_state", Wishes(holder="yarp")))
    made = cpp.program(tmp_path, name, options=("-O0", MODELS), main=HERE / "portable.cpp", is_apart=True)
    assert said_by(made) == [
        "1 3 1.5708",
        "1 32",
        "0 truncated at .roll, byte 16: the message ends here",
        "0 truncated, byte 0: the connection ends here",
        "truncated .roll 16",
        "index at .angles[2]: no such element (torso_state.mapping:13:3)",
        "0 0",
    ]


@cpp.needs_cpp
def test_what_a_mapping_asks_on_a_port(tmp_path):
    """The time, and how many messages there were before: a program has no place to say them there."""
    request = request_of("decode", {"schema": ASKING, "encoding": "yarp3"}, mapping="m.mapping")
    name = cpp.write(tmp_path, generated(request, "cpp", BOTH, "number", Wishes(holder="yarp")))
    made = cpp.program(tmp_path, name, options=("-O0", MODELS), main=HERE / "asking.cpp", is_apart=True)
    assert said_by(made) == ["40 1", "41 1", "42 1"]


@pytest.mark.skipif(not os.environ.get("YARP_DIR"), reason="YARP is not built: `make yarp`")
@cpp.needs_cpp
def test_on_ports_of_the_real_yarp(tmp_path):
    """Messages that are refused leave a connection open; text is written and read as bottles are. The page's example runs, too."""
    cpp.write(tmp_path / "unit", generated(TORSO, "cpp", BOTH, "torso_state", Wishes(holder="yarp")))
    _, example = re.findall(r"```cpp\n(.*?)```", (native.ROOT / "docs" / "cpp.md").read_text(), re.DOTALL)
    (tmp_path / "unit" / "example.inc").write_text(example)
    build = ["cmake", "-S", HERE / "on_yarp", "-B", tmp_path, f"-DUNIT={tmp_path / 'unit'}"]
    for command in (build, ["cmake", "--build", tmp_path]):
        subprocess.run(command, check=True, capture_output=True)
    said = [line for line in said_by(tmp_path / "ports") if not line.startswith("[")]  # these are YARP's own
    assert said == SAID_ON_PORTS.splitlines()


@pytest.mark.campaign
@cpp.needs_cpp
@pytest.mark.parametrize(
    ("request_", "schema", "same_bytes", "cut", "none"),
    [
        (
            type_request("decode", "rst.kinematics.JointAngles", {"encoding": "protobuf"}),
            ".rst.kinematics.JointAngles",
            "1",
            "truncated at .angles, byte 2: longer than what is left of the message",
            "taken",
        ),
        (
            TORSO,
            "yarp.icub.torso.state",
            "0",
            "truncated at .pitch, byte 24: the message ends here",
            "index at .angles[0]: no such element (torso_state.mapping:11:3)",
        ),
    ],
    ids=["protobuf", "a bottle"],
)
def test_a_converter_for_rsb(request_, schema, same_bytes, cut, none, tmp_path):
    """With protoc's real class, and a model of RSB's. RSB finds a converter by the name of the class, too."""
    native.needs_protoc()
    if not native.finds("boost/make_shared.hpp"):
        pytest.skip("Boost is not installed")
    name = cpp.write(tmp_path, generated(request_, "cpp", BOTH, "joint_angles", Wishes(holder="rsb")))
    subprocess.run(["protoc", f"--cpp_out={tmp_path}", "-I", native.ROOT / "idl", "rst/kinematics/JointAngles.proto"], check=True)
    around = (f"-isystem{tmp_path}", MODELS, "-O0", f"-DNAME={name}", str(tmp_path / "rst/kinematics/JointAngles.pb.cc"))
    made = cpp.program(tmp_path, name, "-lprotobuf", options=around, main=HERE / "converter.cpp")
    assert said_by(made, schema) == [f"{schema} {same_bytes}", "rst::kinematics::JointAngles -2", cut, none]
