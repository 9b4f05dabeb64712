"""Why it cannot be told which function a user's function is, in phrases that follow the function's name: "f: …"."""

from __future__ import annotations

from rosetta_jit.catalogue.suggestions import shorten


def unknown_object(path: str, value: object) -> str:
    """An object of a kind that nothing is known of."""
    kind = f"{type(value).__module__}.{type(value).__qualname__}"
    return f"`{shorten(path)}` is a `{shorten(kind)}`, and the content of such objects cannot be compared"


def plain_function(path: str) -> str:
    """A Python function, which numba can only call where somebody has taught it to."""
    return f"`{shorten(path)}` is a Python function without njit: an overload says how numba calls it, and overloads cannot be compared"


def module_as_value(path: str) -> str:
    """A module that is not followed by an attribute's name."""
    return f"the module `{shorten(path)}` is used as a value, so that any of its attributes may be meant"


def no_attribute(path: str) -> str:
    """An attribute that a module makes up when it is asked for it, or that is not there."""
    return f"`{shorten(path)}` is not in its module's dictionary"


def strange_name(path: str, name: str) -> str:
    """A name that is imported, assigned or deleted, or whose globals are no plain dictionary."""
    return f"`{shorten(path)}` uses the name `{shorten(name)}` in another way than to read a global variable"


def no_such_name(path: str) -> str:
    """A global variable or a variable of an enclosing function without a value."""
    return f"`{shorten(path)}` has no value yet"


def too_much(path: str) -> str:
    """More functions than are followed, or values within values."""
    return f"`{shorten(path)}` reaches too many functions, or values that are nested too deeply"


def at_its_address(path: str) -> str:
    """An array that numba does not copy into the code."""
    return f"`{shorten(path)}` is an array of more than 1,000,000 bytes, or not contiguous: numba compiles its address, not its content"


def own_attribute(path: str) -> str:
    """A function with an attribute that changes how numba or `inspect` sees it."""
    return f"`{shorten(path)}` redirects to another function"


def compiled_before(path: str) -> str:
    """A dispatcher whose code is older than this look at it."""
    return f"`{shorten(path)}` was compiled by numba before this program was made: its code has the values that its globals had then"


def other_compiler(path: str) -> str:
    """A dispatcher that numba's usual compiler does not compile alone: its own passes, numba's file cache, a closed list of types."""
    return f"`{shorten(path)}` is compiled by passes of its own, comes from numba's cache, or is no ordinary dispatcher of numba's"


def changed_while_compiled(name: str) -> str:
    """A function that is not now what it was before it was compiled."""
    return f"`{shorten(name)}`, or something that it reaches, changed while it was compiled"


def address_in_code(name: str) -> str:
    """Code with an address of this process."""
    return f"the code of `{shorten(name)}` has addresses of the process that compiled it"


def more_reasons(count: int) -> str:
    """The end of a list that was cut."""
    return f"… and {count} more"


def unknown_numba() -> str:
    """An installation of numba without metadata."""
    return "numba's version cannot be told: its folder has no metadata beside it"


def extended_by_package(names: str) -> str:
    """Packages that teach numba when it first compiles."""
    return f"installed packages extend numba when it starts ({shorten(names)}: entry points `numba_extensions`)"


def set_by_hand(name: str) -> str:
    """A setting of numba that neither the environment nor its file gives."""
    return f"`numba.config.{shorten(name)}` was set in the process"


def registered(what: str) -> str:
    """An overload, or the like, of something that any function may use."""
    return f"numba was taught in the process: {shorten(what)}"
