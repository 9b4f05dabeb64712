"""`python -m tests.usecase`: plays the use case, with the real YARP where it is built, and writes a page about it."""

from __future__ import annotations

import argparse
import os
import shutil
import socket
import subprocess
import sys
import tempfile
import time
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rosetta_jit.bridge.checking import checked
from rosetta_jit.bridge.running import Running
from tests.transports.real_yarp import dialect, program
from tests.usecase.component import Seen, run
from tests.usecase.page import write

if TYPE_CHECKING:
    from collections.abc import Generator

HERE = Path(__file__).parent
POSES = ((0.6, 0.0, 0.3), (-0.5, 0.2, 0.8), (0.0, 0.0, 0.0))
"""Radians: yaw, roll, pitch."""
START_S = 20.0


def play(seconds: float, build: Path | None) -> tuple[Seen, list[dict[str, Any]]]:
    """Name server, simulator, bridge and component, for so many seconds; ``build`` is the folder for the real simulator, None for ours."""
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        yarp, rsb = _free_port(), _free_port()
        if build is None:
            from tests.transports.name_server import NameServer

            stack.callback(NameServer(yarp).close)
            stack.enter_context(_program([sys.executable, "-m", "tests.usecase.simulator", str(yarp)]))
        else:
            env = _name_server_environment(folder, yarp)
            arguments = ["--read", "--socket", str(yarp), "--portdb", ":memory:", "--subdb", ":memory:"]
            stack.enter_context(_program([program("yarpserver"), *arguments], env=env))
            _until_it_answers(yarp)
            stack.enter_context(_program([str(build / "simulator")], env=env))
        bridge = _bridge(folder, yarp, rsb, "yarp3" if build is None else dialect())
        stack.callback(bridge.stop, 1.0)
        _until_it_runs(bridge)
        seen = run(rsb, seconds, POSES)
        return seen, bridge.snapshot()


def built(folder: Path) -> Path | None:
    """The folder of the simulator on the real YARP; None where YARP is not there."""
    if not program("yarpserver") or shutil.which("cmake") is None:
        return None
    folder.mkdir(parents=True, exist_ok=True)
    try:
        for command in (["cmake", "-S", str(HERE), "-B", str(folder)], ["cmake", "--build", str(folder)]):
            subprocess.run(command, check=True, capture_output=True, text=True)
    except subprocess.CalledProcessError as error:
        print(error.stdout[-2000:], error.stderr[-2000:], sep="\n", file=sys.stderr)
        return None
    return folder


def _name_server_environment(folder: Path, port: int) -> dict[str, str]:
    (folder / "yarp.conf").write_text(f"127.0.0.1 {port} yarp\n")
    return {**os.environ, **dict.fromkeys(("YARP_CONFIG_HOME", "YARP_DATA_HOME", "YARP_CONF", "HOME"), str(folder))}


def _bridge(folder: Path, yarp: int, rsb: int, written: str) -> Running:
    text = (HERE / "bridge.toml").read_text().replace("{yarp}", str(yarp)).replace("{rsb}", str(rsb)).replace("yarp3", written)
    (folder / "bridge.toml").write_text(text)
    bridge = Running(checked(str(folder / "bridge.toml")), lambda line: print(line, file=sys.stderr))
    bridge.start()
    return bridge


def _until_it_runs(bridge: Running) -> None:
    end = time.monotonic() + START_S
    while any(each["problem"] for each in bridge.snapshot()) or not all(each["taken"] for each in bridge.snapshot()[:2]):
        if time.monotonic() > end:
            raise SystemExit(f"the simulator does not come: {bridge.snapshot()}")
        time.sleep(0.05)


def _until_it_answers(port: int) -> None:
    end = time.monotonic() + START_S
    while time.monotonic() < end:
        with socket.socket() as found:
            if not found.connect_ex(("127.0.0.1", port)):
                return
        time.sleep(0.05)
    raise SystemExit("yarpserver does not answer")


@contextmanager
def _program(command: list[str], **how: Any) -> Generator[None]:
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, cwd=HERE.parents[1], **how) as program:
        try:
            yield
        finally:
            program.kill()


def _free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as found:
        return found.getsockname()[1]


def main() -> int:
    parser = argparse.ArgumentParser(prog="usecase", description=__doc__)
    parser.add_argument("--seconds", type=float, default=9.0)
    parser.add_argument("--output", type=Path, default=HERE.parents[1] / "build" / "usecase")
    given = parser.parse_args()
    build = built(given.output / "simulator")
    how = "The simulator is on the real YARP" if build else "The simulator is on ports of ours, because YARP is not built (`make yarp`)"
    print(f"{how}; {given.seconds:g} seconds …")
    seen, snapshot = play(given.seconds, build)
    given.output.mkdir(parents=True, exist_ok=True)
    write(given.output / "index.html", seen, snapshot, how)
    print(f"{len(seen.angles)} joint angles, {seen.images} images, {len(seen.commands)} commands: {given.output / 'index.html'}")
    return 0 if seen.angles and seen.images else 1


if __name__ == "__main__":
    raise SystemExit(main())
