"""The words of the language (OMG IDL 4.2, 7.2.4, table 7-6)."""

from __future__ import annotations

KEYWORDS = frozenset(
    [
        "abstract",
        "any",
        "attribute",
        "boolean",
        "case",
        "char",
        "const",
        "context",
        "custom",
        "default",
        "double",
        "enum",
        "exception",
        "factory",
        "FALSE",
        "fixed",
        "float",
        "in",
        "inout",
        "interface",
        "local",
        "long",
        "module",
        "native",
        "Object",
        "octet",
        "oneway",
        "out",
        "private",
        "public",
        "raises",
        "readonly",
        "sequence",
        "short",
        "string",
        "struct",
        "supports",
        "switch",
        "TRUE",
        "truncatable",
        "typedef",
        "union",
        "unsigned",
        "ValueBase",
        "valuetype",
        "void",
        "wchar",
        "wstring",
    ]
)
"""Those of CORBA 2: no declaration has such a name, in whatever case. The later ones (`map`, `int8`) may be names, as they were before."""

FOLDED = {word.lower(): word for word in KEYWORDS}

SCALARS = frozenset(["boolean", "char", "double", "float", "octet", "short", "wchar"])
"""Types of one word; `long` and `unsigned` may go on."""

OPAQUE = frozenset(["bitmask", "bitset", "component", "connector", "eventtype", "home", "native", "porttype"])
"""Declarations that are skipped but for their names."""

SKIPPED = frozenset(["import", "typeid", "typeprefix"])
"""Statements that are skipped."""

SERVICES = frozenset(("msg", "srv", "action"))
"""The modules in which rosidl puts what it generates, within that of the package."""
