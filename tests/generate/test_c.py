"""Generated C does what the library does, is clean, reads the same every time, and is safe from what a schema says."""

from __future__ import annotations

import errno
import json
import os
import re
import shutil
import struct
import subprocess
import sys
from pathlib import Path

import pytest

import rosetta_jit as rj
from rosetta_jit.api.options import request_of, type_request
from rosetta_jit.cli import main
from rosetta_jit.generate.build import NO_WISHES, Wishes, generated
from tests.generate.driver import STRICT, answers, compiled, driver, expected, harmed, needs_gcc, write
from tests.golden import GOLDEN, check_golden

TORSO = request_of("decode", {"encoding": "yarp3"}, mapping="yarp/icub/torso_state.mapping")
BOTH = ("decode", "encode")
HOSTILE = """\
# */ #include "/etc/passwd"
int32 linux
float64 default
string INT64_MAX
bool[4] presence
uint8[] padding_1
Inner[] rows
"""
ROUNDS = 12


def joint_states():
    names = [b"arm", "ellenbogen\u00e9".encode(), b""]
    head = struct.pack("<III", 7, 1_700_000_000, 5) + struct.pack("<I", 4) + b"base"
    text = struct.pack("<I", len(names)) + b"".join(struct.pack("<I", len(each)) + each for each in names)
    numbers = struct.pack("<I3d", 3, 0.5, -1.25, float("inf")) + struct.pack("<I", 0) + struct.pack("<Id", 1, 1e-300)
    return [head + text + numbers, struct.pack("<IIII", 0, 0, 0, 0) + bytes(16)]


def proto_angles():
    packed = b"\x0a\x0c" + struct.pack("<3f", 0.5, 1.5, -2.5)
    return [b"", packed, b"\x0d" + struct.pack("<f", 4.0) + packed, packed + b"\x12\x03abc", b"\x0a\x80\x80\x00"]


SUBJECTS = {
    "torso": (TORSO, [struct.pack("<ii3d", 266, 3, 10, 20, 30), struct.pack("<iiidididi"[:-1], 256, 3, 10, 1.0, 10, 2.0, 10, 3.0)]),
    "joints": (type_request("decode", "sensor_msgs/JointState", {"encoding": "ros1"}), joint_states()),
    "angles": (type_request("decode", "rst.kinematics.JointAngles", {"encoding": "protobuf"}), proto_angles()),
}


@pytest.fixture(scope="module", params=SUBJECTS)
def unit(request, tmp_path_factory):
    """A unit in C, the library's own programs, and messages."""
    wanted, messages = SUBJECTS[request.param]
    folder = tmp_path_factory.mktemp(request.param)
    write(folder, generated(wanted, "c", BOTH, request.param))
    options = {"encoding": wanted.encoding}
    of = (rj.Decoder, rj.Encoder) if wanted.mapping else (rj.Decoder.of, rj.Encoder.of)
    programs = [make(wanted.mapping or wanted.type, **options) for make in of]
    return folder, request.param, programs, messages


@needs_gcc
def test_c_answers_as_the_library_does(unit):
    folder, name, (decode, encode), good = unit
    messages = harmed(good, ROUNDS, name)
    found = answers(driver(folder, name), messages)
    wanted = [expected(decode, encode, message) for message in messages]
    assert [line for line in found if line.startswith("ok")], "no message was read"
    assert {line.split()[0] for line in found} >= {"ok", "truncated"}
    assert found == wanted


@needs_gcc
@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_no_compiler_complains(unit, compiler):
    if shutil.which(compiler) is None:
        pytest.skip(f"{compiler} is not installed")
    compiled(compiler, unit[0], unit[1], "-O2")


@needs_gcc
def test_the_header_is_one_of_c_plus_plus(unit):
    if shutil.which("g++") is None:
        pytest.skip("g++ is not installed")
    options = ["-std=c++17", *STRICT[1:], "-fsyntax-only", "-x", "c++"]
    subprocess.run(["g++", *options, unit[0] / f"{unit[1]}.h"], check=True)


@needs_gcc
def test_freestanding_source_needs_no_library(tmp_path):
    name = write(tmp_path, generated(TORSO, "c", BOTH, "torso", Wishes(freestanding=True)))
    made = compiled("gcc", tmp_path, name, "-O2", "-ffreestanding", "-fno-stack-protector")
    undefined = subprocess.run(["nm", "-u", made], capture_output=True, text=True, check=True).stdout.split()
    assert set(undefined) <= {"U", "memset"}, "a function copies the bytes of numbers"
    includes = set(re.findall(r"#include <(\w+\.h)>", "".join((tmp_path / f"{name}.{end}").read_text() for end in "hc")))
    assert includes == {"float.h", "stdbool.h", "stddef.h", "stdint.h"}


@needs_gcc
def test_compilers_that_do_not_tell_their_byte_order(tmp_path):
    """Numbers are then put together byte by byte."""
    texts = generated(SUBJECTS["joints"][0], "c", BOTH, "joints")
    texts["joints.c"] = re.sub(r"#(el)?if defined\(__GNUC__\).*", r"#\1if 0", texts["joints.c"])
    assert "#if 0" in texts["joints.c"]
    name = write(tmp_path, texts)
    compiled("gcc", tmp_path, name, "-O2")
    assert answers(driver(tmp_path, name), joint_states()) == [f"ok {message.hex()}" for message in joint_states()]


@needs_gcc
def test_nothing_is_allocated_and_nothing_changes_but_the_holder(unit):
    made = compiled("gcc", unit[0], unit[1], "-O2", "-fno-stack-protector")
    symbols = subprocess.run(["nm", made], capture_output=True, text=True, check=True).stdout
    assert not re.findall(r" [bBDC] ", symbols), "there is a global that can change"
    assert set(re.findall(r" U (\w+)", symbols)) <= {"memcpy", "memset", "memmove", "strlen"}


WITHOUT_TEXTS = """\
#include "torso_state.h"
int main(void)
{
    static const unsigned char cut[20] = {0x0a, 0x01, 0, 0, 3};
    static torso_state_memory memory;
    torso_state_holder holder;
    torso_state_error error;
    char path[8] = "?";
    torso_state_use(&holder, &memory);
    if (torso_state_decode(&holder, cut, sizeof cut, &error) != TORSO_STATE_TRUNCATED) {
        return 1;
    }
    torso_state_error_path(&error, path, sizeof path);
    return error.offset == 16 && error.site > 0 && path[0] == 0 && error.detail[0] == 0 ? 0 : 2;
}
"""


@needs_gcc
def test_errors_without_texts_have_status_offset_and_site(tmp_path):
    name = write(tmp_path, generated(TORSO, "c", BOTH, "torso_state"))
    (tmp_path / "main.c").write_text(WITHOUT_TEXTS)
    command = ["gcc", *STRICT, "-DTORSO_STATE_NO_TEXTS", f"{name}.c", "main.c", "-o", "main"]
    subprocess.run(command, check=True, cwd=tmp_path)
    assert subprocess.run([tmp_path / "main"], check=False).returncode == 0


@pytest.mark.parametrize("end", ["h", "c"])
def test_the_text_is_the_same_every_time(end):
    texts = generated(TORSO, "c", BOTH, "torso_state")
    check_golden(GOLDEN / "generate" / f"torso_state.{end}", texts[f"torso_state.{end}"])


@needs_gcc
def test_a_hostile_schema_stays_in_its_place(tmp_path):
    inner = "=" * 80 + "\nMSG: evil/Inner\nfloat32 while\nstring memcpy\nuint8 holder\nint64[2] which\n"
    request = type_request("decode", "evil/Outer", {"encoding": "ros1", "schema": HOSTILE + inner})
    name = write(tmp_path, generated(request, "c", BOTH, "evil"))
    compiled("gcc", tmp_path, name, "-O1")
    program = driver(tmp_path, name)
    rows = struct.pack("<If", 1, 2.5) + struct.pack("<I", 2) + b"ab" + bytes([7]) + struct.pack("<2q", -1, 1)
    message = struct.pack("<id", 5, 0.5) + struct.pack("<I", 3) + b'*/"' + bytes([1, 0, 1, 1]) + struct.pack("<I", 2) + b"\0\1" + rows
    assert answers(program, [message]) == [f"ok {message.hex()}"]


OWN_NAMES = "int64_t load_i16_le store_i16_le HAS_ORDER ONCE TEXT evil_Inner EVIL_H codec most i i_5 Inner ROSETTA_JIT_COLD linux restrict"
"""Names of the runtime, of its macros, of what the unit itself defines; and one that another becomes where it is numbered."""


def named(kind):
    """A schema whose fields have such names."""
    fields = "\n".join(f"{kind} {name}" for name in OWN_NAMES.split())
    inner = "=" * 80 + "\nMSG: evil/Inner\nint16 x\nstring y\n"
    return type_request("decode", "evil/Outer", {"encoding": "ros1", "schema": f"{fields}\n{inner}"})


@needs_gcc
@pytest.mark.parametrize("kind", ["int32", "string", "Inner", "Inner[]", "string[]", "float32[2]"])
def test_fields_are_called_as_the_unit_calls_its_own(tmp_path, kind):
    for wishes in (NO_WISHES, Wishes(freestanding=True)):
        name = write(tmp_path, generated(named(kind), "c", BOTH, "evil", wishes))
        subprocess.run(["gcc", *STRICT, "-fsyntax-only", tmp_path / f"{name}.c"], check=True)


IN_LCM = "int16_t a; int32_t b; int64_t c; float d; double e; int8_t f; double g[3]; int32_t h[2];"
IN_IDL = "short a; unsigned long b; long long c; float d; double e; octet f; double g[3]; sequence<long> h;"
SCALARS = {
    "ros1": ("a/M", {"schema": "int16 a\nuint32 b\nint64 c\nfloat32 d\nfloat64 e\nuint8 f\nfloat64[3] g\nint32[] h\n"}),
    "lcm": ("a.m", {"schema": {"m.lcm": f"package a; struct m {{ {IN_LCM} }}"}}),
    "cdr-giop": ("A::M", {"schema": {"m.idl": f"module A {{ struct M {{ {IN_IDL} }}; }};"}, "byte_order": "big"}),
}
ALL_SCALARS = {"a": -2, "b": 7, "c": -(1 << 40), "d": 1.5, "e": -0.1, "f": 3, "g": [1.0, 2.0, 1e300], "h": [1, -1]}


@needs_gcc
@pytest.mark.parametrize("encoding", ["cdr-giop", "lcm", "ros1"])
def test_small_code_of_a_machine_that_aligns_its_numbers(tmp_path, encoding):
    """Numbers of all sizes, little- and big-endian: functions that are there once read and write them."""
    gcc = "arm-linux-gnueabihf-gcc"
    if shutil.which(gcc) is None or shutil.which("qemu-arm") is None:
        pytest.skip("gcc for ARM or qemu-user are not installed")
    type_, schema = SCALARS[encoding]
    options = {"encoding": encoding, **schema}
    decode, encode = (of(type_, **options) for of in (rj.Decoder.of, rj.Encoder.of))
    good = [bytes(encode(encode.holder_type.from_dict(each))) for each in (ALL_SCALARS, {})]
    name = write(tmp_path, generated(type_request("decode", type_, options), "c", BOTH, "unit", Wishes(freestanding=True)))
    assert "ONCE uint32_t load_u32_" in (tmp_path / f"{name}.c").read_text()
    machine = ("-Os", "-mno-unaligned-access", "-static")
    messages = harmed(good, 12, encoding)
    found = answers(driver(tmp_path, name, gcc, machine), messages, "qemu-arm")
    assert found == [expected(decode, encode, each) for each in messages]


def test_the_header_says_what_the_schema_says_of_fields():
    text = """syntax = "proto3"; message Arm {
  // Where the arm is.
  double angle = 1;
  bool is_on = 2; // whether it moves
  repeated double gains = 3; /* of its controller */
}"""
    request = type_request("decode", "Arm", {"schema": {"arm.proto": text}})
    header = generated(request, "c", ("decode",), "arm", NO_WISHES)["arm.h"]
    assert "    double angle; /* Where the arm is */" in header
    assert "    uint8_t is_on; /* whether it moves; 0, or else true */" in header
    assert "    arm_span gains; /* of its controller; in `gains` */" in header


def test_texts_end_neither_literals_nor_comments():
    from rosetta_jit.generate.c.texts import comment, literal

    hostile = '*/ "); /* \\ \n ??/ \0 \x7f \u00e9 // %s'
    assert re.fullmatch(r'"(?:[ !#->@-\[\]-~]|\\["\\]|\\[0-7]{3})*"', literal(hostile))
    inside = comment(hostile)[2:-2]
    assert not re.search(r"\*/|/\*|\?\?", inside)
    assert inside.isprintable()
    assert inside.isascii()
    assert len(literal("x" * 100_000)) < 4095


def test_the_command_writes_both_files(tmp_path, capsys):
    assert main(["generate", "sensor_msgs/JointState", "--encoding", "ros1", "-o", str(tmp_path), "--directions", "decode"]) == 0
    assert {path.name for path in tmp_path.iterdir()} == {"joint_state.h", "joint_state.c"}
    assert "joint_state.c" in capsys.readouterr().out
    text = (tmp_path / "joint_state.h").read_text()
    assert "joint_state_decode(" in text
    assert "joint_state_encode(" not in text


def test_a_full_disk_leaves_all_files_as_they_were(tmp_path, capsys, monkeypatch):
    """Also those that were written before the one for which there was no room."""
    command = ["generate", "sensor_msgs/JointState", "--encoding", "ros1", "-o", str(tmp_path)]
    write_bytes = Path.write_bytes

    def full(path, data):
        write_bytes(path, data if ".h." in path.name else data[:10])
        if ".h." not in path.name:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with monkeypatch.context() as disk:
        disk.setattr(Path, "write_bytes", full)
        assert main(command) == 1
        assert "joint_state.c" in capsys.readouterr().err
        assert not [*tmp_path.iterdir()]
    (tmp_path / "joint_state.h").write_text("/* older */")
    with monkeypatch.context() as disk:
        disk.setattr(Path, "write_bytes", full)
        assert main(command) == 1
    assert [(each.name, each.read_text()) for each in tmp_path.iterdir()] == [("joint_state.h", "/* older */")]


def test_the_lines_of_the_mapping_stand_beside_what_comes_from_them():
    text = generated(TORSO, "c", BOTH, "torso")["torso.c"]
    assert (
        "(float)(load_f64_le(bytes + 16) * 0.017453292519943295); /* torso_state.mapping:12: .angles[1] <-> float32(radians(.roll)) */"
        in text
    )
    assert "const float element_2 = angles[start + 1]; /* torso_state.mapping:12: " in text


@pytest.mark.parametrize(
    ("arguments", "kind"),
    [
        (["sensor_msgs/JointState", "--encoding", "ros1", "--language", "basic"], "unknown-language"),
        (["sensor_msgs/JointState", "--encoding", "ros1", "--name", "1x"], "unusable-name"),
        (["sensor_msgs/JointState", "--encoding", "ros1", "--name", "string"], "unusable-name"),
        (["yarp/icub/torso_state.mapping"], "ambiguous-encoding"),
        (["no/Such", "--encoding", "ros1"], "unknown-type"),
    ],
)
def test_what_cannot_be_generated_is_said(arguments, kind, capsys):
    assert main(["generate", *arguments]) == 1
    assert f"error[{kind}]" in capsys.readouterr().err


def test_a_wrong_direction_is_exit_code_2(capsys):
    with pytest.raises(SystemExit) as end:
        main(["generate", "sensor_msgs/JointState", "--directions", "sideways"])
    assert end.value.code == 2
    assert "sideways" in capsys.readouterr().err


def test_a_header_of_c_is_not_hidden(tmp_path):
    assert main(["generate", "std_msgs/String", "--encoding", "ros1", "-o", str(tmp_path)]) == 0
    assert {path.name for path in tmp_path.iterdir()} == {"std_msgs_string.h", "std_msgs_string.c"}


CALLING = """\
import "rst/kinematics/JointAngles.proto"
import "yarp/icub/torso_state.bottle-schema"

function halved(float64): float64

data-holder: rst.kinematics.JointAngles
wire-schema: yarp.icub.torso.state

unpack-rules:
  len(.angles) = 1
  .angles[0] = float32(halved(radians(.yaw)))
  ignore .roll
  ignore .pitch
"""
HALVED = """\
#include "calling.h"
#include <stdio.h>

bool calling_halved(double number, double *result)
{
    *result = number / 2.0;
    return number >= 0.0;
}

static double decoded(double degrees)
{
    static calling_memory memory;
    calling_holder holder;
    struct { int tag, count; double numbers[3]; } message = {266, 3, {degrees, 0.0, 0.0}};
    calling_use(&holder, &memory);
    if (calling_decode(&holder, &message, sizeof message, NULL) == CALLING_REJECTED) {
        return -1.0;
    }
    return (double)holder.angles.rows[holder.message.angles.start];
}

int main(void)
{
    printf("%.3f %.3f", decoded(90.0), decoded(-90.0));
    return 0;
}
"""


@needs_gcc
def test_functions_of_the_mapping_are_the_programs_own(tmp_path):
    (tmp_path / "calling.mapping").write_text(CALLING)
    request = request_of("decode", {"encoding": "yarp3"}, mapping=str(tmp_path / "calling.mapping"))
    write(tmp_path, generated(request, "c", ("decode",), "calling"))
    (tmp_path / "main.c").write_text(HALVED)
    subprocess.run(["gcc", *STRICT, "main.c", "calling.c", "-o", "main"], cwd=tmp_path, check=True)
    assert subprocess.run([tmp_path / "main"], capture_output=True, text=True, check=True).stdout == "0.785 -1.000"


BORROWING = """\
#include "image.h"
#include <stdio.h>

int main(void)
{
    static const unsigned char message[] = {2, 0, 0, 0, 'h', 'i', 3, 0, 0, 0, 7, 8, 9};
    static image_memory memory;
    image_holder holder;
    image_use(&holder, &memory);
    if (image_borrow(&holder, message, sizeof message, NULL) != IMAGE_OK) {
        return 1;
    }
    const image_span data = holder.message.data;
    printf("%d bytes from %d, the last is %d", (int)(-1 - data.count), (int)data.start, message[data.start + (-1 - data.count) - 1]);
    return 0;
}
"""


@needs_gcc
def test_borrowed_bytes_stay_in_the_message(tmp_path):
    request = type_request("decode", "a/Image", {"encoding": "ros1", "schema": "string name\nuint8[] data\n"})
    write(tmp_path, generated(request, "c", ("borrow",), "image"))
    (tmp_path / "main.c").write_text(BORROWING)
    subprocess.run(["gcc", *STRICT, "main.c", "image.c", "-o", "main"], cwd=tmp_path, check=True)
    assert subprocess.run([tmp_path / "main"], capture_output=True, text=True, check=True).stdout == "3 bytes from 10, the last is 9"


TOY = """\
import json
from rosetta_jit.generate.languages import Language

TOY = Language("toy", "the kernels' directions as JSON", "toy_language:files")

def files(unit):
    return {f"{unit.name}.json": json.dumps({role: kernel.name for role, kernel in unit.kernels.items()})}
"""


def offers(folder, line, monkeypatch, text=TOY):
    """A package with a language."""
    (folder / "toy_language.py").write_text(text)
    (folder / "toy-1.dist-info").mkdir()
    (folder / "toy-1.dist-info" / "METADATA").write_text("Metadata-Version: 2.1\nName: toy\nVersion: 1\n")
    (folder / "toy-1.dist-info" / "entry_points.txt").write_text(f"[rosetta_jit.languages]\n{line}\n")
    monkeypatch.syspath_prepend(str(folder))


@pytest.mark.usefixtures("offers_anew")
def test_a_language_from_another_package(tmp_path, monkeypatch):
    offers(tmp_path, "toy = toy_language:TOY", monkeypatch)
    assert main(["generate", "sensor_msgs/JointState", "--encoding", "ros1", "--language", "toy", "-o", str(tmp_path)]) == 0
    made = json.loads((tmp_path / "joint_state.json").read_text())
    assert made == dict.fromkeys(("decode", "encode", "size"), "sensor_msgs/JointState")


@pytest.mark.usefixtures("offers_anew")
@pytest.mark.parametrize("line", ["c = toy_language:TOY", "broken = no_such_module:TOY"])
def test_no_package_takes_the_place_of_our_languages_or_stops_them(line, tmp_path, monkeypatch):
    offers(tmp_path, line, monkeypatch, TOY.replace('"toy"', '"c"'))
    assert main(["generate", "sensor_msgs/JointState", "--encoding", "ros1", "-o", str(tmp_path)]) == 0
    assert (tmp_path / "joint_state.h").exists()


@pytest.mark.usefixtures("offers_anew")
@pytest.mark.parametrize(
    ("line", "text", "why"),
    [
        ("toy = no_such_module:TOY", TOY, "ModuleNotFoundError: No module named 'no_such_module'"),
        ("toy = toy_language:TOI", TOY, "AttributeError: module 'toy_language' has no attribute 'TOI'"),
        ("toy = toy_language:TOY", "raise RuntimeError('half')", "RuntimeError: half"),
    ],
)
def test_a_broken_language_is_named(line, text, why, tmp_path, monkeypatch, capsys):
    offers(tmp_path, line, monkeypatch, text)
    monkeypatch.delitem(sys.modules, "toy_language", raising=False)
    assert main(["generate", "sensor_msgs/JointState", "--encoding", "ros1", "--language", "toy", "-o", str(tmp_path / "made")]) == 1
    said = f"`rosetta_jit.languages: {line}` cannot be imported ({why})"
    assert capsys.readouterr().err == f"the installed package `toy` is broken: {said}; repair it, or uninstall it\n"
    assert not (tmp_path / "made").exists()


@pytest.mark.usefixtures("offers_anew")
def test_a_language_without_its_printer_is_named(tmp_path, monkeypatch, capsys):
    offers(tmp_path, "toy = toy_language:TOY", monkeypatch, TOY.replace("toy_language:files", "toy_printer:files"))
    monkeypatch.delitem(sys.modules, "toy_language", raising=False)
    assert main(["generate", "sensor_msgs/JointState", "--encoding", "ros1", "--language", "toy", "-o", str(tmp_path / "made")]) == 1
    said = "`toy_printer:files` cannot be imported (ModuleNotFoundError: No module named 'toy_printer')"
    assert capsys.readouterr().err == f"the installed package `toy_printer` is broken: {said}; repair it, or uninstall it\n"


def test_capacities_are_what_the_schema_bounds():
    text = generated(TORSO, "c", ("decode",), "torso")["torso.h"]
    assert "#define TORSO_ANGLES_ROWS 3 " in text
    assert Path("torso.h").name in generated(TORSO, "c", ("decode",), "torso")


def test_lanes_of_one_field_are_told_apart():
    """By what they hold, whatever other fields there are: their names are those of constants, too."""
    schema = "string[] name\nstring name_bytes\nPart[] parts\n===\nMSG: a/Part\nstring[] name\n"
    text = generated(type_request("decode", "a/B", {"encoding": "ros1", "schema": schema}), "c", BOTH, "unit")["unit.h"]
    assert re.findall(r"#ifndef UNIT_(\w+)_ROWS", text) == [
        "NAME",
        "NAME_BYTES_2",
        "NAME_BYTES",
        "PARTS",
        "PARTS_NAME",
        "PARTS_NAME_BYTES",
    ]


MAPS = """syntax = "proto3"; package m; message Pad { repeated float taxels = 1; }
message Hand { map<string, Pad> pads = 1; repeated Pad history = 2; repeated double angles = 3; }"""


def test_the_header_says_in_which_lane_the_elements_of_an_array_are():
    """A struct that stands in several places has a lane for each of them."""
    text = generated(type_request("decode", "m.Hand", {"encoding": "protobuf", "schema": {"m.proto": MAPS}}), "c", BOTH, "hand")["hand.h"]
    assert "hand_span angles; /* in `angles` */" in text
    assert "hand_span taxels; /* in the lane of its path, as `pads_value_taxels` */" in text
    assert "/* an entry of a map */" in text
