"""`rosetta-jit plot`: numbers of a log over time, in the terminal or as a picture."""

from __future__ import annotations

import argparse
import shutil
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, cast

from rosetta_jit.cli.arguments import Commands, add_command
from rosetta_jit.cli.logs import add_decoding, add_log, add_times, log_of, target_of
from rosetta_jit.terminal import printable

if TYPE_CHECKING:
    from rosetta_jit.logs.curves import Curve

PICTURES = (".png", ".svg", ".pdf")
HEIGHT = 10
"""Lines of a curve in the terminal."""


def add(commands: Commands) -> None:
    """Declare the arguments."""
    command = add_command(commands, "plot", "Draw numbers of a log over time, in the terminal or as a picture.", run)
    add_log(command)
    command.add_argument(
        "fields",
        metavar="TOPIC.FIELD",
        nargs="+",
        help="a number of a topic's messages: /imu.angular_velocity.x, /joint_states.position[2]; several are drawn below each other",
    )
    add_times(command)
    add_decoding(command)
    command.add_argument("-o", "--output", metavar="OUT", help="a picture (.png, .svg, .pdf) instead of text; needs matplotlib")


def run(arguments: argparse.Namespace) -> int:
    """Exit code 1 if something is wrong with the log, 2 if the picture is of no kind that is drawn."""
    from rosetta_jit.logs.curves import curve_of

    output = Path(arguments.output) if arguments.output else None
    if output is not None and output.suffix not in PICTURES:
        print(f"error: {output.name}: pictures are {', '.join(PICTURES)}", file=sys.stderr)
        return 2
    with log_of(arguments) as log:
        target, fields = target_of(arguments), cast("list[str]", arguments.fields)
        curves = [curve_of(log, each, target, arguments.start, arguments.end) for each in fields]
        times = [int(each) for curve in curves if len(curve.times_ns) for each in (curve.times_ns.min(), curve.times_ns.max())]
        span = (min(times, default=0), max(times, default=0))
        if output is None:
            _print(curves, span)
        else:
            _draw(curves, span, output, log.name)
        return int(bool(log.problems))


def _print(curves: Sequence[Curve], span_ns: tuple[int, int]) -> None:
    from rosetta_jit.cli.drawing import drawn
    from rosetta_jit.logs.moments import shown

    width = shutil.get_terminal_size().columns
    braille = (sys.stdout.encoding or "").lower().replace("-", "") == "utf8"
    for curve in curves:
        print("\n".join(printable(line) for line in drawn(curve, span_ns, width, HEIGHT, braille=braille)))
    print(f"0 s is {shown(span_ns[0])}")


def _draw(curves: Sequence[Curve], span_ns: tuple[int, int], output: Path, name: str) -> None:
    """A picture with a field for each curve; raises MissingPackage where matplotlib is not installed."""
    from rosetta_jit.errors import MissingPackage
    from rosetta_jit.file_errors import named
    from rosetta_jit.logs.moments import shown

    try:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure
    except ImportError:
        raise MissingPackage("pictures take matplotlib: pip install 'rosetta-jit[demo]'") from None
    figure = Figure(figsize=(10.0, 1.0 + 2.2 * len(curves)), layout="constrained")
    FigureCanvasAgg(figure)
    for place, curve in enumerate(curves):
        axes = figure.add_subplot(len(curves), 1, place + 1)
        axes.plot((curve.times_ns - span_ns[0]) / 1e9, curve.values, linewidth=0.8)
        axes.set(title=curve.name, xlabel=f"s since {shown(span_ns[0])}" if curve is curves[-1] else "", ylabel=printable(curve.unit or ""))
        axes.grid(visible=True, alpha=0.3)
    with named(output):
        figure.savefig(output)
    print(f"wrote {output}: {len(curves)} curve{'s' * (len(curves) != 1)} of {printable(name)}")
