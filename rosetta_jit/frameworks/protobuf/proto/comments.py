"""The comment that documents a declaration: the one right before it, without an empty line between."""

from __future__ import annotations

from rosetta_jit.frameworks.protobuf.limits import MAX_COMMENT


def leading_comment(text: str, start: int) -> str:
    """The text of the comment that ends where the declaration at ``start`` begins; empty where there is none."""
    begin = max(0, start - MAX_COMMENT)
    before = text[begin:start]
    body = before.rstrip()
    if before[len(body) :].count("\n") > 1:
        return ""
    lines = body.split("\n")
    if lines[-1].lstrip().startswith("//"):
        return _line_comments(lines)
    if body.endswith("*/"):
        return _block_comment(body)
    return ""


def _line_comments(lines: list[str]) -> str:
    kept: list[str] = []
    for line in reversed(lines):
        stripped = line.strip()
        if not stripped.startswith("//"):
            break
        kept.append(stripped.lstrip("/").strip())
    return "\n".join(reversed(kept)).strip()


def _block_comment(body: str) -> str:
    start = body.rfind("/*")
    # A comment behind a statement, on its line, is about that statement.
    if start < 0 or body[:start].rpartition("\n")[2].strip():
        return ""
    return "\n".join(line.strip().lstrip("*").strip() for line in body[start + 2 : -2].split("\n")).strip()
