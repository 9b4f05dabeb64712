"""Projects of others use the CMake package beside what they have already."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.generate.test_cpp import CMAKE

ICUB = CMAKE.parents[2] / "mappings/yarp/icub"
PROJECT = """
cmake_minimum_required(VERSION 3.13)
project(node LANGUAGES C CXX)
find_package(rosetta_jit 0.1 REQUIRED)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

add_library(messages STATIC own.c)
set_target_properties(messages PROPERTIES C_STANDARD 99)
target_link_libraries(messages m)
rosetta_generate(messages ros1/nav_sat_fix_utm.mapping ENCODING ros1 LANGUAGE c)
rosetta_generate(messages yarp/icub/torso_state.mapping ENCODING yarp3)
install(TARGETS messages EXPORT node ARCHIVE DESTINATION lib)
install(EXPORT node DESTINATION lib)

add_executable(node main.cpp)
target_link_libraries(node messages)
rosetta_generate(node sensor_msgs/JointState ENCODING cdr NAME joints BYTE_ORDER big LENIENT bool trailing)
rosetta_generate(node lab.Arm NAME lab_arm IMPORTS lab.proto)
rosetta_generate(node the-torso.mapping ENCODING yarp3)
"""
SCHEMA = 'syntax = "proto3"; package lab; message Arm { uint32 joints = 1; }'
MAIN = """
#include "lab_arm.hpp"
#include "joints.hpp"
#include "nav_sat_fix_utm.h"
#include "the_torso.hpp"
#include "torso_state.hpp"
#include <cstdio>
extern "C" int own(void);
int main()
{
    the_torso::codec torso;
    joints::JointState empty;
    lab_arm::Arm six;
    six.joints = 6;
    std::printf("%zu ", lab_arm::codec().encode(six).size());
    static_cast<void>(torso);
    const auto is_little = static_cast<std::size_t>(joints::codec().encode(empty)[1]);
    std::printf("%d %zu %s\\n", own(), is_little, nav_sat_fix_utm_status_text(NAV_SAT_FIX_UTM_OK));
    return torso_state::codec().try_size(torso_state::JointAngles()).has_value();
}
"""
OWN = "int own(void) { typeof(1) extension_of_gnu = 7; return extension_of_gnu; }\n"


@pytest.mark.skipif(
    any(shutil.which(each) is None for each in ("cmake", "gcc", "g++")), reason="CMake and the compilers are not all installed"
)
def test_a_project_of_others(tmp_path):
    """Libraries are linked without keywords, C has extensions, the target is exported, and two languages are generated for it.

    Files become those of another type when a mapping's is another one.
    """
    shutil.copy(ICUB / "torso_state.mapping", tmp_path / "the-torso.mapping")
    for name, text in (("CMakeLists.txt", PROJECT), ("main.cpp", MAIN), ("own.c", OWN), ("lab.proto", SCHEMA)):
        (tmp_path / name).write_text(text)
    environment = {**os.environ, "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"}

    def run(*command):
        done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr

    run("cmake", "-S", ".", "-B", "made", f"-Drosetta_jit_DIR={CMAKE}")
    run("cmake", "--build", "made")
    assert subprocess.run([tmp_path / "made/node"], capture_output=True, text=True, check=False).stdout == "2 7 0 ok\n"  # 0: big-endian
    shutil.copy(ICUB / "camera_image.mapping", tmp_path / "the-torso.mapping")
    run("cmake", "--build", "made", "--target", "node")
    assert "-> rst.vision.Image, by the-torso.mapping" in (tmp_path / "made/rosetta_jit/node/the_torso.hpp").read_text()
