"""`rosetta-jit generate`: where files go, and what is refused instead of being left out in silence."""

from __future__ import annotations

import errno
import os
import re
from pathlib import Path

import pytest

from rosetta_jit.cli import main

MAPPINGS = Path(__file__).resolve().parents[2] / "mappings"
HEADER = ["generate", "std_msgs/Header", "--encoding", "ros1"]
MACHINES = [
    (["--target", "x86_64-linux-gnu", "--cpu", "cortex-m7"], "LLVM knows no processor `cortex-m7` of it"),
    (["--target", "thumbv7em-none-eabihf", "--cpu", "cortex-m99"], "LLVM knows no processor `cortex-m99` of it"),
    (["--target", "spirv64"], "LLVM ERROR"),
    (["--target", "nvptx64-nvidia-cuda"], "can't emit a file of this type"),
    (["--target", "msp430"], "LLVM has failed"),
    (["--target", "\udcff"], "can't encode"),
]
REFUSED = [
    (["--freestanding", "--language", "cpp"], "needless-option"),
    (["--freestanding", "--language", "python"], "needless-option"),
    (["--include", "a.h"], "needless-option"),
    (["--include", "a.h", "--language", "lisp"], "needless-option"),
    (["--include", "a.h", "--language", "cpp"], "needless-option"),
    (["--include", "a.h", "--language", "cpp", "--holder", "yarp"], "needless-option"),
    (["--include", "a.h>\nint x;", "--language", "cpp", "--holder", "ros1"], "unusable-header"),
    (["--name", ""], "unusable-name"),
]


@pytest.mark.parametrize(("arguments", "why"), MACHINES)
def test_machines_without_objects_do_not_end_the_command(arguments, why, tmp_path, capfd):
    """LLVM would end the process, or go on with another processor than the one that was named."""
    assert main([*HEADER, "--emit", "object", *arguments, "-o", str(tmp_path)]) == 1
    said = capfd.readouterr().err
    assert "error[no-target]: there are no objects for " in said
    assert why in said
    assert said.count("\n") == 2
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(("arguments", "kind"), REFUSED)
def test_what_says_nothing_is_refused(arguments, kind, tmp_path, capsys):
    assert main([*HEADER, *arguments, "-o", str(tmp_path)]) == 1
    assert f"error[{kind}]" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_a_folder_with_the_name_of_a_file_leaves_everything_as_it_was(tmp_path, capsys):
    (tmp_path / "header.h").mkdir()
    assert main([*HEADER, "-o", str(tmp_path)]) == 1
    assert capsys.readouterr().err == f"error: [Errno 21] Is a directory: '{tmp_path}/header.h'\n"
    assert [each.name for each in tmp_path.iterdir()] == ["header.h"]


def test_no_folder_is_left_where_nothing_could_be_written(tmp_path, capsys, monkeypatch):
    """As on a full disk: folders that were there stay, with what is in them."""
    (tmp_path / "there").mkdir()
    monkeypatch.setattr(Path, "write_bytes", lambda path, _: refuse(errno.ENOSPC, str(path)))
    assert main([*HEADER, "--language", "cpp", "-o", f"{tmp_path}/there/a/b"]) == 1
    assert capsys.readouterr().err == f"error: [Errno 28] No space left on device: '{tmp_path}/there/a/b/header.hpp'\n"
    assert [*tmp_path.rglob("*")] == [tmp_path / "there"]


def refuse(number, path):
    raise OSError(number, os.strerror(number), path)


def test_what_this_command_did_not_make_is_not_replaced(tmp_path, capsys):
    """A program of somebody's own may be called as a message."""
    (tmp_path / "header.c").write_text("int main(void) { return 0; }\n")
    (tmp_path / "notes.txt").write_text("mine")
    assert main([*HEADER, "-o", str(tmp_path)]) == 1
    said = capsys.readouterr().err
    assert said.startswith(f"error[not-replaced]: `{tmp_path}/header.c` was not made by this command, and would be lost\n")
    assert "--name" in said
    assert sorted(each.name for each in tmp_path.iterdir()) == ["header.c", "notes.txt"]
    assert (tmp_path / "header.c").read_text() == "int main(void) { return 0; }\n"
    for _ in range(2):
        assert main([*HEADER, "-o", str(tmp_path), "--name", "header_message"]) == 0
    assert (tmp_path / "notes.txt").read_text() == "mine"


LANGUAGES = {"c": "point.c", "cpp": "point.hpp", "python": "point.py", "lisp": "point.lisp"}
POINTS = {"a": "float64 x\n", "b": "float64 x\nstring name\n"}


@pytest.mark.parametrize("language", LANGUAGES)
def test_files_of_another_type_are_not_replaced(language, tmp_path, capsys, monkeypatch):
    """Types of two packages are often called the same; those of one are made anew, whichever direction and encoding they were of."""
    monkeypatch.chdir(tmp_path)
    for package, fields in POINTS.items():
        (tmp_path / package / "msg").mkdir(parents=True)
        (tmp_path / package / "msg" / "Point.msg").write_text(fields)

    def made(package, encoding, *more):
        options = ["--import", f"{package}/msg/Point.msg", "--encoding", encoding, "--language", language, "-o", "out"]
        return main(["generate", f"{package}/Point", *options, *more])

    for encoding, *more in (["cdr"], ["cdr"], ["cdr", "--directions", "encode"], ["cdr2"], ["cdr", "--directions", "encode,decode"]):
        assert made("a", encoding, *more) == 0, capsys.readouterr().err
    before = {each: each.read_bytes() for each in Path("out").glob("*.*")}
    assert made("b", "cdr") == 1
    said = capsys.readouterr().err
    assert f"error[not-replaced]: `out/{LANGUAGES[language]}` was made from `a/msg/Point`, and would be lost\n" in said
    assert "--name" in said
    assert {each: each.read_bytes() for each in Path("out").glob("*.*")} == before
    assert made("b", "cdr", "--name", "other_point") == 0


def test_files_of_another_mapping_are_not_replaced(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = (MAPPINGS / "yarp/icub/torso_state.mapping").read_text()
    for name in ("torso", "waist"):
        (tmp_path / f"{name}.mapping").write_text(text)
    command = ["--encoding", "yarp3", "--name", "unit"]
    for more in ([], [], ["--directions", "encode"]):
        assert main(["generate", "torso.mapping", *command, *more]) == 0, capsys.readouterr().err
    assert main(["generate", "waist.mapping", *command]) == 1
    said = "`unit.h` was made from `rst.kinematics.JointAngles, by torso.mapping`, and would be lost"
    assert said in capsys.readouterr().err


@pytest.mark.parametrize("below", ["", "/inner"])
def test_a_file_is_no_folder(below, tmp_path, capsys):
    (tmp_path / "file").write_text("")
    assert main([*HEADER, "-o", f"{tmp_path}/file{below}"]) == 1
    assert capsys.readouterr().err == f"error: [Errno 20] Not a directory: '{tmp_path}/file{below}'\n"


def test_links_are_replaced_not_followed(tmp_path, capsys):
    (tmp_path / "elsewhere").write_text("x")
    (tmp_path / "header.h").symlink_to("elsewhere")
    for _ in range(2):
        assert main([*HEADER, "-o", str(tmp_path)]) == 0
    assert (tmp_path / "elsewhere").read_text() == "x"
    assert (tmp_path / "header.h").read_text().startswith("/*")
    assert sorted(each.name for each in tmp_path.iterdir()) == ["elsewhere", "header.c", "header.h"]
    assert capsys.readouterr().out.count("wrote") == 4


def test_files_declare_a_type(tmp_path, capsys):
    (tmp_path / "lab.proto").write_text('syntax = "proto3"; package lab; message Arm { uint32 joints = 1; }')
    command = ["generate", "lab.Arm", "--language", "python", "-o", str(tmp_path)]
    assert main(command) == 1
    assert "error[unknown-type]" in capsys.readouterr().err
    assert main([*command, "--import", str(tmp_path / "lab.proto")]) == 0
    assert "class Arm:" in (tmp_path / "arm.py").read_text()


@pytest.mark.parametrize("file", ["my-arm", "a state whose name is longer than that of most others"])
def test_the_name_of_a_mapping_becomes_one_of_files(file, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path(f"{file}.mapping").write_text((MAPPINGS / "yarp/icub/torso_state.mapping").read_text())
    assert main(["generate", f"{file}.mapping", "--encoding", "yarp3", "-o", "made"]) == 0, capsys.readouterr().err
    name = re.sub(r"\W", "_", file)[:40]
    assert sorted(each.name for each in Path("made").iterdir()) == [f"{name}.c", f"{name}.h"]


@pytest.mark.parametrize("type_", ["", ".", "lab.Nothing"])
def test_a_type_that_there_is_not_is_what_is_wrong(type_, tmp_path, capsys):
    assert main(["generate", type_, "--framework", "protobuf", "-o", str(tmp_path)]) == 1
    assert f"error[unknown-type]: no file declares a message `{type_}`" in capsys.readouterr().err


def test_mappings_import_by_themselves(tmp_path, capsys):
    command = ["generate", "yarp/icub/torso_state.mapping", "--encoding", "yarp3", "--import", "lab.proto", "-o", str(tmp_path)]
    assert main(command) == 1
    assert "error[needless-option]: `--import` says nothing about a mapping" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


ADVICE = [
    (["lab.Nothing", "--framework", "protobuf"], "name the files that declare it: --import FILE"),
    (["lab.Arm", "--import", "nowhere.proto"], "add its folder: --search-path FOLDER"),
    (["lab/msg/Arm.msg", "--encoding", "ros1"], "a file is imported, and a type in it is named: --import lab/msg/Arm.msg"),
    (["yarp/icub/torso_state.mapping"], "say which by --encoding, one of yarp3, yarp4"),
    (["std_msgs/Header", "--encoding", "ros1", "--byte-order", "big"], "leave out --byte-order"),
    (["lab.Arm", "--encoding", "protobuf", "--import", "{folder}/lab.proto", "--lenient", "all"], "leave out --lenient"),
]


@pytest.mark.parametrize(("arguments", "advice"), ADVICE)
def test_advice_is_in_words_of_the_command_line(arguments, advice, tmp_path, capsys, monkeypatch):
    """What a program would be told is another word: ``search_path=[folder]``."""
    monkeypatch.chdir(tmp_path)
    Path("lab.proto").write_text('syntax = "proto3"; package lab; message Arm { uint32 joints = 1; }')
    assert main(["generate", *(each.format(folder=tmp_path) for each in arguments), "-o", "made"]) == 1
    assert f"  = help: {advice}" in capsys.readouterr().err


def test_definitions_are_found_in_folders_that_are_named(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("own").mkdir()
    Path("own/lab.proto").write_text('syntax = "proto3"; package lab; message Arm { uint32 joints = 1; }')
    command = ["generate", "lab.Arm", "--import", "lab.proto", "--language", "python"]
    assert main(command) == 1
    assert main([*command, "--search-path", "own"]) == 0, capsys.readouterr().err
    assert "class Arm:" in Path("arm.py").read_text()
