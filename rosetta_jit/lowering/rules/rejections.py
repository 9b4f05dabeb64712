"""Rejections that show values: their text is put together where the message is refused, and nowhere else."""

from __future__ import annotations

from rosetta_jit.kernel.ir import Site
from rosetta_jit.kernel.nodes import Binary, Const, Expect, Expr, Failure, If
from rosetta_jit.kernel.terms import add
from rosetta_jit.language import typed
from rosetta_jit.lowering.evaluation import Evaluation
from rosetta_jit.lowering.limits import MAX_VALUE_SHOWN
from rosetta_jit.lowering.texts.values import text_of
from rosetta_jit.lowering.texts.views import Quoted, Text, joined, sound
from rosetta_jit.lowering.writer import block
from rosetta_jit.startup.dataclass import replace


def reject_with(pieces: tuple[typed.Expr, ...], reason: str, when: Expr | None, values: Evaluation) -> None:
    """Refuse the message with a text that is put together where it is refused; long values are cut."""
    writer = values.writer
    with values.source.forgetting(), writer.nested() as refused:
        shown = joined(writer, [_shown(text_of(piece, values), values) for piece in pieces])
        site = Site("rejected", values.where.path, reason, values.line, detail_lane=shown.lane)
        number = writer.sites.setdefault(site, len(writer.sites))
        indices = (*values.where.indices, shown.first, shown.size)
        writer.emit(Expect(Const("bool", value=False), Failure(number, writer.position, indices)))
    writer.emit(If(Const("bool", value=True) if when is None else when, block(refused)))


def _shown(text: Text, values: Evaluation) -> Text:
    if isinstance(text, Quoted):
        return text
    after = values.writer.let("cut", Binary("min", text.after, add(text.first, MAX_VALUE_SHOWN)))
    return sound(values.writer, replace(text, after=after))
