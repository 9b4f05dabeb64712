"""Lines of Lisp: forms that are opened and closed, each with a comment where one belongs to it."""

from __future__ import annotations

from collections.abc import Generator, Iterable, Sequence
from contextlib import contextmanager
from textwrap import wrap

from rosetta_jit.generate.lisp.texts import WIDTH, broken, comment
from rosetta_jit.startup.dataclass import dataclass, field

MAX_LINE = 140


@dataclass(slots=True)
class Line:
    """A line at a column, and what is said of it."""

    column: int
    text: str
    said: str = ""


@dataclass(slots=True)
class Lines:
    """Source text in the making, at the current column."""

    lines: list[Line] = field(default_factory=list[Line])
    column: int = 0

    def line(self, form: str, said: str = "") -> None:
        """A form, which is broken where it is too long, with a comment behind it or, where that is too long, above it."""
        first, *others = broken(form, self.column)
        text = comment(said) if said else ""
        if text and (others or self.column + len(first) + len(text) > MAX_LINE):
            self.lines.append(Line(self.column, f";; {text}"))
            text = ""
        self.lines.append(Line(self.column, first, text))
        self.lines += [Line(0, each) for each in others]

    def said(self, text: str) -> None:
        """A comment of a line."""
        self.lines.append(Line(self.column, f";; {comment(text)}"))

    def slots(self, slots: Sequence[Sequence[str]]) -> None:
        """The list of a class's slots, of which each is a name and its options: in one line where that fits, else an option a line."""
        if not slots:
            self.line("()")
        for number, (first, *options) in enumerate(slots):
            column, opened = self.column + bool(number), "" if number else "("
            whole = f"{opened}({' '.join((first, *options))})"
            if column + len(whole) <= WIDTH:
                self.lines.append(Line(column, whole))
                continue
            self.lines.append(Line(column, f"{opened}({first}"))
            below = self.column + 3 + first.index(" ")
            self.lines += [Line(below, each) for each in options]
            self.close()
        if slots:
            self.close()

    def groups(self, opened: str, groups: Iterable[Sequence[str]]) -> None:
        """Symbols within an open form: each group begins a line, and goes on in the next one where that is full."""
        column = self.column + len(opened)
        found = [line for group in groups for line in wrap(" ".join(group), WIDTH - column, break_long_words=False, break_on_hyphens=False)]
        self.lines.append(Line(self.column, opened + "".join(found[:1])))
        self.lines += [Line(column, line) for line in found[1:]]

    def close(self, many: int = 1) -> None:
        """End forms."""
        self.lines[-1].text += ")" * many

    @contextmanager
    def form(self, head: str, by: int = 2) -> Generator[None]:
        """A form whose body is what is written until the end of the `with`."""
        self.line(f"{head})")
        self.lines[-1].text = self.lines[-1].text[:-1]
        self.column += by
        yield
        self.column -= by
        self.close()

    def text(self) -> str:
        """All of it."""
        return "".join(f"{' ' * each.column}{each.text}{f'  ; {each.said}' if each.said else ''}\n" for each in self.lines)
