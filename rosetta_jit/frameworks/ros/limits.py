"""The limits of the languages of ROS 1 and ROS 2. docs/security.md prints them."""

from __future__ import annotations

MAX_MESSAGES = 4096
"""message types that one needs, directly or not"""

MAX_DEPTH = 64
"""messages within messages"""

MAX_DIGITS = 80
"""digits of an integer, in whatever base it is written"""

MAX_UNIT = 64
"""characters of a unit in a comment"""

MAX_PROBLEMS = 100
"""problems of all files together, beyond which reading stops"""
