"""What libclang sees in a header, as plain data. A program of its own: it reads a request from its input and answers on its output.

    request = {"main": path, "files": {path: text}, "user": folder, "standard": folder, "most": Most}
    Most    = {"seconds": of processor time, "bytes": of memory, "depth": of types, "members": of structs, "errors": that are told}
    answer  = {"missing": true} | {"failed": true} | {"errors": [[text, Place]]} | {"records": [...], "enums": [...], "aliases": [...]}
    Type    = ["bool"] | ["int", bits, signed, word] | ["float", bits, word] | ["string"] | ["vector", Type] | ["array", Type, length]
            | ["record", name] | ["enum", name] | ["no", reason, word]
    Place   = [path, begin, end]            in bytes of UTF-8

A header may be hostile, and a compiler is a large program that expands macros and templates without end: here it has little memory and
time, sees no file but those of the request, and takes nobody down with it.
"""

from __future__ import annotations

import json
import sys
from collections import Counter
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

NO_FILES = '{"version": 0, "fallthrough": "false", "roots": []}'
"""A file system in which there is nothing (llvm::vfs::RedirectingFileSystem): all that the compiler finds are the texts of the request."""

INTEGERS = {
    "CHAR_S": (8, True),
    "SCHAR": (8, True),
    "UCHAR": (8, False),
    "SHORT": (16, True),
    "USHORT": (16, False),
    "INT": (32, True),
    "UINT": (32, False),
    "LONG": (64, True),
    "ULONG": (64, False),
    "LONGLONG": (64, True),
    "ULONGLONG": (64, False),
    "CHAR16": (16, False),
    "CHAR32": (32, False),
}
REASONS = {
    "POINTER": "pointer",
    "LVALUEREFERENCE": "reference",
    "RVALUEREFERENCE": "reference",
    "MEMBERPOINTER": "pointer",
    "INCOMPLETEARRAY": "flexible",
}
ARGUMENTS = (
    *("-x", "c++", "-std=c++17", "-target", "x86_64-unknown-linux-gnu"),
    *("-nostdinc", "-nostdinc++", "-fno-access-control", "-w"),
    *("-include", "vector", "-include", "array", "-include", "string", "-include", "cstdint"),
    *("-ftemplate-depth=64", "-fbracket-depth=64", "-fconstexpr-steps=10000", "-fconstexpr-depth=64", "-ferror-limit=20"),
)


class Reading:
    """The declarations of one translation unit."""

    def __init__(self, cindex: Any, index: Any, request: dict[str, Any], no_files: str) -> None:
        self.cindex, self.index, self.request, self.no_files = cindex, index, request, no_files
        self.most: dict[str, int] = request["most"]
        self.names: dict[str, str] = {}  # of unnamed types, by their USR: the member that has such a type names them
        self.records: dict[str, dict[str, Any]] = {}
        self.enums: list[dict[str, Any]] = []
        self.aliases: list[list[Any]] = []
        self.members = 0

    def answer(self) -> dict[str, Any]:
        """Everything that was asked for, or what is wrong."""
        unit = self.parse(self.request["files"])
        errors = [[each.spelling, self.place(each)] for each in unit.diagnostics if each.severity >= self.cindex.Diagnostic.Error]
        if errors:
            return {"errors": errors[: self.most["errors"]]}
        self.walk(unit.cursor)
        self.measure_bases()
        return {"records": list(self.records.values()), "enums": self.enums, "aliases": self.aliases}

    def parse(self, files: dict[str, str]) -> Any:
        folders = ("-I", self.request["user"], "-isystem", self.request["standard"])
        arguments = [*ARGUMENTS, *folders, "-ivfsoverlay", self.no_files]
        option = self.cindex.TranslationUnit.PARSE_SKIP_FUNCTION_BODIES
        return self.index.parse(self.request["main"], args=arguments, unsaved_files=list(files.items()), options=option)

    # --- declarations ------------------------------------------------------------------------------------------------

    def walk(self, root: Any) -> None:
        """All declarations outside of functions, in the order of the text."""
        pending = list(reversed(list(root.get_children())))
        while pending:
            cursor = pending.pop()
            if self.is_standard(cursor):
                continue
            match cursor.kind.name:
                case "NAMESPACE" | "LINKAGE_SPEC" | "UNEXPOSED_DECL":
                    pending += reversed(list(cursor.get_children()))
                case "STRUCT_DECL" | "CLASS_DECL" if cursor.is_definition() and cursor.type.get_num_template_arguments() <= 0:
                    self.record(cursor)
                    pending += reversed(list(cursor.get_children()))
                case "ENUM_DECL" if cursor.is_definition():
                    self.enum(cursor)
                case "TYPEDEF_DECL" | "TYPE_ALIAS_DECL":
                    name = self.qualified(cursor)
                    self.aliases.append([name, self.type(cursor.underlying_typedef_type), self.place(cursor), cursor.raw_comment or ""])
                case _:
                    pass

    def record(self, cursor: Any) -> None:
        name = self.qualified(cursor)
        if not name:
            return
        if name in self.records:  # one of them is in an unnamed namespace
            self.records[name]["again"] = self.place(cursor)
            return
        children = list(cursor.get_children())
        self.records[name] = {
            "name": name,
            "place": self.place(cursor),
            "again": None,
            "doc": cursor.raw_comment or "",
            "size": cursor.type.get_size(),
            "alignment": cursor.type.get_align(),
            "virtual": any(each.is_virtual_method() for each in children if each.kind.name in {"CXX_METHOD", "DESTRUCTOR"}),
            "bases": [self.base(each) for each in children if each.kind.name == "CXX_BASE_SPECIFIER"],
            "members": [self.member(name, each) for each in cursor.type.get_fields()],
        }
        self.inherit(self.records[name])

    def inherit(self, record: dict[str, Any]) -> None:
        """Members of the bases come before a record's own."""
        known = [self.records.get(base["name"], {"members": []}) for base in record["bases"]]
        inherited = [{**member, "offset": None} for base in known for member in base["members"]]
        record["members"] = [*inherited, *record["members"]]
        self.members += len(record["members"])
        if self.members > self.most["members"]:
            raise MemoryError

    def base(self, cursor: Any) -> dict[str, Any]:
        kind, *rest = self.type(cursor.type)
        return {
            "name": rest[0] if kind == "record" else "",
            "place": self.place(cursor),
            "virtual": self.cindex.conf.lib.clang_isVirtualBase(cursor) > 0,
            "public": cursor.access_specifier.name == "PUBLIC",
        }

    def member(self, record: str, cursor: Any) -> dict[str, Any]:
        name = "" if _is_unnamed(cursor) else cursor.spelling
        if name:
            self.name_unnamed(cursor.type, f"{record}::{name}")
        return {
            "name": name,
            "type": self.type(cursor.type),
            "place": self.place(cursor),
            "doc": cursor.raw_comment or "",
            "offset": cursor.get_field_offsetof() // 8,
            "bits": bool(cursor.is_bitfield()),
            "public": cursor.access_specifier.name == "PUBLIC",
        }

    def name_unnamed(self, type_: Any, name: str) -> None:
        canonical = type_.get_canonical()
        for _ in range(self.most["depth"]):
            if canonical.kind.name != "CONSTANTARRAY":
                break
            canonical = canonical.element_type
        declared = canonical.get_declaration()
        if _is_unnamed(declared):
            self.names.setdefault(declared.get_usr(), name)

    def enum(self, cursor: Any) -> None:
        bits, signed = INTEGERS.get(cursor.enum_type.get_canonical().kind.name, (8, False))
        numbers = [[each.spelling, each.enum_value] for each in cursor.get_children() if each.kind.name == "ENUM_CONSTANT_DECL"]
        self.enums.append(
            {
                "name": self.qualified(cursor),
                "scope": self.scope(cursor),
                "place": self.place(cursor),
                "bits": bits,
                "signed": signed,
                "values": numbers,
            }
        )

    def measure_bases(self) -> None:
        """The offsets of inherited members. Only the compiler knows them: padding at the end of a base may hold members of a derived class.

        It tells the offsets as values of an enum that is added to the header (Itanium C++ ABI, 2.4).
        """
        unique = [
            (name, member)
            for name, record in self.records.items()
            for times in [Counter(member["name"] for member in record["members"])]
            for member in record["members"]
            if member["offset"] is None and times[member["name"]] == 1 and member["name"] and not member["bits"]
        ]
        if not unique:
            return
        values = [f"rosetta_jit_{number} = __builtin_offsetof(::{name}, {each['name']})," for number, (name, each) in enumerate(unique)]
        main = self.request["main"]
        text = "\n".join((self.request["files"][main], "enum rosetta_jit_offsets : unsigned long {", *values, "};\n"))
        unit = self.parse({**self.request["files"], main: text})
        if any(each.severity >= self.cindex.Diagnostic.Error for each in unit.diagnostics):
            return
        offsets = [each for each in unit.cursor.get_children() if each.spelling == "rosetta_jit_offsets"]
        for (_, member), value in zip(unique, offsets[-1].get_children(), strict=True):
            member["offset"] = value.enum_value

    # --- types and names ---------------------------------------------------------------------------------------------

    def type(self, type_: Any, depth: int = 0) -> list[Any]:
        canonical = type_.get_canonical()
        kind, word = canonical.kind.name, canonical.spelling.replace("const ", "").replace("volatile ", "")
        match kind:
            case _ if depth > self.most["depth"]:
                return ["no", "nesting", ""]
            case "BOOL":
                return ["bool"]
            case "FLOAT" | "DOUBLE":
                return ["float", canonical.get_size() * 8, word]
            case "CONSTANTARRAY":
                return ["array", self.type(canonical.element_type, depth + 1), canonical.element_count]
            case "ENUM" if self.is_standard(canonical.get_declaration()):
                return ["int", 8, False, word]
            case "ENUM":
                return ["enum", self.qualified(canonical.get_declaration())]
            case "RECORD":
                return self.class_type(canonical, word, depth)
            case _ if kind in INTEGERS:
                return ["int", *INTEGERS[kind], word]
            case _:
                return ["no", REASONS.get(kind, "other"), word]

    def class_type(self, type_: Any, word: str, depth: int) -> list[Any]:
        declared = type_.get_declaration()
        arguments = [type_.get_template_argument_type(number) for number in range(max(0, type_.get_num_template_arguments()))]
        template = declared.spelling if arguments and self.is_standard(declared) else ""
        if template == "vector" and arguments[1].spelling.startswith("std::allocator<"):
            return ["vector", self.type(arguments[0], depth + 1)]
        if template == "array":
            return ["array", self.type(arguments[0], depth + 1), declared.get_template_argument_unsigned_value(1)]
        if template == "basic_string":
            return ["string"] if arguments[0].kind.name == "CHAR_S" else ["no", "wide", word]
        if arguments or self.is_standard(declared):
            return ["no", "template", word]
        if declared.kind.name == "UNION_DECL":
            return ["no", "union", ""]
        if declared.get_definition() is None:
            return ["no", "incomplete", word]
        name = self.qualified(declared)
        return ["record", name] if name else ["no", "unnamed", ""]

    def qualified(self, cursor: Any) -> str:
        """The name from the global namespace on; empty for an unnamed type that no member names."""
        if _is_unnamed(cursor):
            return self.names.get(cursor.get_usr(), "")
        scope = self.scope(cursor)
        return f"{scope}::{cursor.spelling}" if scope else cursor.spelling

    def scope(self, cursor: Any) -> str:
        """The qualified name of what a declaration stands in, unnamed namespaces left out."""
        parts: list[str] = []
        outer = cursor.semantic_parent
        while outer is not None and outer.kind.name != "TRANSLATION_UNIT":
            if _is_unnamed(outer) and outer.kind.name in {"STRUCT_DECL", "CLASS_DECL"}:
                parts.append(self.names.get(outer.get_usr(), ""))
                break
            if outer.spelling and not _is_unnamed(outer):
                parts.append(outer.spelling)
            outer = outer.semantic_parent
        return "::".join(reversed(parts))

    def is_standard(self, cursor: Any) -> bool:
        file = cursor.location.file
        return file is not None and file.name.startswith(self.request["standard"])

    def place(self, item: Any) -> list[Any]:
        """Where a name, or whatever a diagnostic is about, stands."""
        location = item.location
        path = location.file.name if location.file is not None else self.request["main"]
        name = "" if isinstance(item, self.cindex.Diagnostic) else item.spelling
        width = len(name.encode()) if name and "(" not in name and " " not in name else 1
        return [path, location.offset, location.offset + width]


def _is_unnamed(cursor: Any) -> bool:
    return not cursor.spelling or "(" in cursor.spelling


def main() -> None:
    """Answer one request."""
    request = json.load(sys.stdin)
    try:
        from clang import cindex
    except ImportError:
        json.dump({"missing": True}, sys.stdout)
        return
    index = cindex.Index.create()
    _confine(request["most"]["seconds"], request["most"]["bytes"])
    with TemporaryDirectory() as folder:
        no_files = Path(folder) / "none.yaml"
        no_files.write_text(NO_FILES, encoding="utf-8")
        try:
            answer = Reading(cindex, index, request, str(no_files)).answer()
        except (MemoryError, RecursionError, cindex.TranslationUnitLoadError):
            answer = {"failed": True}
    json.dump(answer, sys.stdout)


def _confine(seconds: int, memory: int) -> None:
    """From here on memory and time are short."""
    if sys.platform != "win32":
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
        resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


if __name__ == "__main__":
    main()
