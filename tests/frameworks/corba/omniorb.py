"""omniORB as a peer: a program, built from what omniidl makes of an IDL, that reads each message and writes it again."""

from __future__ import annotations

import shutil
import subprocess

PROGRAM = """
#include "types.hh"
#include <cstdio>
#include <iostream>
#include <string>
#include <vector>

template <class T> void again(const std::vector<unsigned char>& bytes, bool swap) {
  try {
    cdrMemoryStream in((void*)bytes.data(), bytes.size());
    in.setByteSwapFlag(swap);
    T value;
    value <<= in;
    cdrMemoryStream out((CORBA::ULong)0, (CORBA::Boolean)1);
    out.setByteSwapFlag(swap);
    value >>= out;
    for (size_t i = 0; i < out.bufSize(); i++) std::printf("%02x", ((unsigned char*)out.bufPtr())[i]);
    std::printf(" %zu\\n", bytes.size() - in.currentInputPtr());
  } catch (CORBA::SystemException& error) {
    std::printf("%s 0\\n", error._name());
  }
}

int main(int count, char** words) {
  CORBA::ORB_var orb = CORBA::ORB_init(count, words);
  std::string name, order, hex;
  while (std::cin >> name >> order >> hex) {
    std::vector<unsigned char> bytes;
    for (size_t i = 0; i + 1 < hex.size(); i += 2) bytes.push_back(std::stoi(hex.substr(i, 2), nullptr, 16));
    bool little = order == "little";
    CASES
    std::fflush(stdout);
  }
}
"""
COMPILER = shutil.which("g++")
OMNIIDL = shutil.which("omniidl")


def is_installed():
    """Whether such programs can be built: compiler, omniidl and omniORB's headers."""
    if COMPILER is None or OMNIIDL is None:
        return False
    asked = subprocess.run(
        [COMPILER, "-E", "-x", "c++", "-"], input="#include <omniORB4/CORBA.h>", capture_output=True, text=True, check=False
    )
    return asked.returncode == 0


def build(folder, idl, names):
    """The program for some structs of an IDL. setByteSwapFlag asks for little-endian streams."""
    (folder / "types.idl").write_text(idl)
    subprocess.run([OMNIIDL, "-bcxx", "-Wbh=.hh", "-Wbs=SK.cc", "types.idl"], cwd=folder, check=True)
    cases = "".join(f'if (name == "{name}") again<{name}>(bytes, little);\n    ' for name in names)
    (folder / "main.cc").write_text(PROGRAM.replace("CASES", cases))
    sources = ["main.cc", "typesSK.cc"]
    subprocess.run([COMPILER, "-O0", "-o", "again", *sources, "-lomniORB4", "-lomnithread"], cwd=folder, check=True, capture_output=True)
    return folder / "again"


def run(program, messages):
    """For each name, order and message what omniORB writes again, and how many bytes it left unread; or the exception's name."""
    lines = "".join(f"{name} {order} {data.hex()}\n" for name, order, data in messages)
    done = subprocess.run([program], input=lines, capture_output=True, text=True, check=True)
    return [tuple(line.split()) for line in done.stdout.splitlines()]
