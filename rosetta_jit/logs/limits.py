"""The limits of logs: what keeps memory and time bounded whatever a file claims. docs/security.md prints them."""

from __future__ import annotations

# --- Any log -------------------------------------------------------------------------------------------------------------

MAX_RECORD_BYTES = 1 << 30
"""bytes of a record, and of what a chunk holds when it is decompressed: more is damage, or an attack"""

MAX_VARINT_BYTES = 10
"""bytes of a number whose bytes tell whether another one follows"""

MAX_LISTED_DEPTH = 8
"""messages within each other whose fields are listed where a name of a field is none"""

MAX_OPEN = 64
"""files of a partitioned folder that are open at once"""

MAX_STRETCHES = 10_000
"""folders of times in a partitioned folder: a damaged log may have any times"""

# --- Single formats ------------------------------------------------------------------------------------------------------

MAX_SUMMARY_BYTES = 1 << 28
"""bytes of the summary of an MCAP file: a larger one is not used"""

MAX_INDEX_BYTES = 1 << 28
"""bytes of the index of a bag: a larger one is not used"""

MAX_HEADER_BYTES = 16 << 20
"""bytes of the header of a record of a bag 1.2, which may hold the definition of a type"""

MAX_METADATA_BYTES = 16 << 20
"""bytes of the metadata of a rosbag2 folder"""

MAX_DEFINITION_BYTES = 64 << 20
"""bytes of the definition of a channel of a TIDE file"""

MAX_LINE_BYTES = 256 << 20
"""bytes of a line of a folder of `yarpdatadumper`"""

MAX_INFO_BYTES = 1 << 20
"""bytes of the file that describes such a folder"""

MAX_PIXELS = 1 << 28
"""pixels of an image of such a folder"""
