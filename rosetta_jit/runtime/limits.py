"""The limits of holders, programs and the cache while they run, and of what is shown of messages. docs/security.md prints them."""

from __future__ import annotations

# --- Holders and programs -----------------------------------------------------------------------------------------------

MAX_DEPTH = 100
"""messages within each other, as in protobuf"""

MAX_GENERATIONS = 1000
"""times that rows of recursive lanes refer to further ones: those that another thread is writing may do so for ever"""

MAX_READINGS = 100
"""times that something is read again because another thread has changed it meanwhile"""

MAX_SPARES = 8
"""holders that a program keeps for objects of other classes: one for each thread that uses it for those at the same time"""

MAX_ENDED = 8
"""holders of one layout that have ended, whose memory waits for new ones"""

MAX_ENDED_BYTES = 1 << 13
"""bytes of the memory of each of them"""

MAX_CLASSES = 64
"""classes of objects of which it is remembered how they are read: a program that makes classes all the time does not keep them alive"""

FEW_HOLDERS = 32
"""holders of a type that are made in Python before code for that is compiled, which takes as long as to make some hundred"""

MAX_RECIPES = 4
"""layouts of which a class keeps what makes holders"""

MAX_VIEWS = 32
"""records in the row of a message whose views are made at once: of more, each is made when it is asked for"""

# --- Images that a mapping compresses or decompresses -------------------------------------------------------------------

MAX_PIXEL_BYTES = 1 << 28
"""bytes of the pixels of an image"""

MAX_IMAGE_SIDE = 65500
"""pixels of a side of an image that is written: JPEG has 16 bits for it, less what its library keeps"""

# --- Functions of users, of which the cache has to know whether they have changed ---------------------------------------

MAX_FUNCTIONS = 250
"""functions that are followed from one"""

MAX_FUNCTION_DEPTH = 100
"""values within values of a function"""

MAX_FUNCTION_VALUES = 100_000
"""values of a function in all: a tuple of a tuple twice, and so on, has more of them than bytes"""

MAX_FROZEN_BYTES = 10**6
"""bytes of an array whose values numba compiles into a function; of a larger one it compiles the address"""

MAX_USAGE_RECORDS = 256
"""records of the file that counts the bytes of the cache, before they are summed up"""

# --- What is shown of a message -----------------------------------------------------------------------------------------

MAX_TEXT_DEPTH = 6
"""messages within each other in a text"""

MAX_TEXT_NUMBERS = 12
"""numbers of an array in a text"""

MAX_TEXT_ITEMS = 4
"""items of other arrays and maps in a text"""

MAX_TEXT_CHARACTERS = 120
"""characters of a string in a text"""

MAX_TEXT_BYTES = 24
"""bytes of a byte string in a text"""

MAX_TEXT_FIELDS = 50
"""fields of a message in a text"""

MAX_PAGE_DEPTH = 4
"""messages within each other on a notebook's page"""

MAX_PAGE_MESSAGES = 3
"""messages of an array on a page"""

MAX_PAGE_ROWS = 5
"""rows of a batch on a page"""

MAX_PAGE_FIELDS = 200
"""fields on a page"""

MAX_PAGE_COLUMNS = 20
"""columns of a batch on a page"""

MAX_PAGE_CELL = 240
"""characters of a field of a batch on a page"""

MAX_PAGE_PIXELS = 640
"""pixels of the longer side of an image on a page: larger ones are thinned out"""

MAX_PAGE_IMAGE_BYTES = 4 << 20
"""bytes of a compressed image that a page shows as it is"""

MAX_SHOWN_SIDE = 1 << 16
"""pixels of a side of an image that is shown"""
