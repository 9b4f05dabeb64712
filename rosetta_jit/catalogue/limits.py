"""The limits of reports. docs/security.md prints them."""

from __future__ import annotations

MAX_CANDIDATES = 500
"""names among which the one is looked for that was meant: comparing is slow"""

MAX_COMPARED = 100
"""characters of such a name: longer ones are not meant, and of the one that was written no more are compared"""

MAX_NAMES = 20
"""names that a report lists to choose from"""

MAX_QUOTED = 40
"""characters of a value that a report repeats"""

MAX_PLACES = 5
"""fields that a report about both directions names"""

MAX_REST = 200
"""fields that a report about `default` or `ignore rest` names"""
