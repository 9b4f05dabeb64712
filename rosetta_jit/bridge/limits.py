"""The limits of bridges: what keeps memory bounded whatever peers send. docs/security.md prints them."""

from __future__ import annotations

# --- Routes --------------------------------------------------------------------------------------------------------------

MAX_OPENING = 16
"""routes that are being opened at the same time"""

MAX_CLOSING = 64
"""routes that are being closed at the same time"""

MAX_FOUND = 1000
"""routes that one pattern becomes: a hostile name server could name any number of channels"""

MAX_QUEUE = 1_000_000
"""messages that a route's `queue` may have wait for its target; all of them together have bytes that are bounded, too"""

MAX_CAUSES = 100
"""different causes of errors that a route counts apart"""

MAX_ASKING = 16
"""requests for metrics that are answered at the same time; others are hung up on"""

MAX_NAME = 48
"""characters of a route's name in the live table"""

MAX_STATE = 200
"""characters of a route's state in the live table"""

MAX_REASONS = 3
"""reasons that the live table shows below a route; `--json` and the metrics have all"""
