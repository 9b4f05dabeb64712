"""The limits that all readers of texts share. docs/security.md prints them."""

from __future__ import annotations

MAX_ERRORS = 20
"""syntax errors of a text, after which reading stops: later ones are mostly consequences of earlier ones"""
