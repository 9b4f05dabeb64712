"""Imports point one way (also those inside functions and under TYPE_CHECKING); this table is the architecture.

Each line says what a module or package may import besides itself; a package stands for all that is in it.
"""

from __future__ import annotations

import ast
from functools import cache
from pathlib import Path

import pytest

from rosetta_jit.runtime.cache.names import NO_CODE

PACKAGE = Path(__file__).resolve().parent.parent / "rosetta_jit"

REPORTS = {"source", "terminal", "diagnostics", "errors", "catalogue"}
READS = REPORTS | {"model", "language"}
LANGUAGE = {
    f"language.{room}" for room in ("parse", "parameters", "imports", "both_ways", "arrays", "units", "functions", "resolve", "check")
}
LANGUAGE |= {"language", "language.algebra", "language.laws"}
KERNEL = {"kernel", "kernel.proof", "kernel.passes"}
LOWERS = REPORTS | LANGUAGE | {"model", "wire", "kernel", "lowering"}
LOWERING = {"lowering", "lowering.codec", "lowering.texts", "lowering.rules", "lowering.staging", "lowering.mapped", "lowering.lower"}
BACKENDS = {"backends", "backends.llvm", "backends.numba", "backends.python", "backends.entry"}
RUNTIME = {"runtime", "runtime.limits", "runtime.code", "runtime.cache", "runtime.functions"}
RUNTIME |= {"runtime.attributes", "runtime.batches", "runtime.holder", "runtime.holder.objects", "runtime.looks", "runtime.arrow"}
HOLDERS = REPORTS | {"model.types", "model.words", "model.limits", "model.layout", "model.initial_values", "model.serial", "kernel.state"}
COMPILER = REPORTS | LANGUAGE | KERNEL | LOWERING | BACKENDS | RUNTIME | {"model", "parsing", "wire", "frameworks", "frameworks.installed"}
API = {"api", "api.options", "api.cacheable"}
FUNCTIONS = REPORTS | {"model", "kernel", "language", "language.functions"}
FUNCTIONS |= {"lowering", "lowering.codec", "lowering.texts", "lowering.colours"}
FRAMEWORK = REPORTS | {"model", "parsing", "wire", "frameworks"}
YARP = {f"frameworks.yarp.{module}" for module in ("bottle_diagnostics", "forms", "limits", "names", "tags")}
HOLDS = FRAMEWORK | {"runtime.holder", "runtime.holder.objects"}
LOG_READER = REPORTS | {"logs.base", "logs.limits", "logs.reading", "logs.reading.storage", "logs.reading.walking"}
TRANSPORT = REPORTS | {"transports"}
PRINTS = REPORTS | {"model", "kernel", "kernel.passes", "backends", "generate", "generate.passes"}
C = {"generate.c.holder", "generate.c.printing"}
CPP = PRINTS | C | {"generate.c", "generate.cpp.objects", "generate.cpp.passes"}
PYTHON = {"generate.c.holder"} | {f"generate.python.{room}" for room in ("passes", "printing", "runtime")}
ANYTHING = (
    COMPILER
    | API
    | {
        "in_numba",
        "stubs",
        "generate",
        "generate.build",
        "pipeline",
        "pipeline.request",
        "file_errors",
        "recording",
        "explain",
        "draft",
        "demo",
        "",
    }
    | {"logs", "logs.base", "logs.converting", "logs.reading.storage", "frameworks.features", "transports", "transports.opening", "bridge"}
)

MAY_IMPORT = {
    "startup": {"errors"},
    "source": set(),
    "terminal": set(),
    "file_errors": set(),
    "diagnostics": {"source", "terminal"},
    "errors": {"diagnostics", "terminal"},
    "catalogue": {"source", "diagnostics", "model"},
    "recording": REPORTS | {"file_errors"},
    "model": REPORTS,
    "parsing": REPORTS | {"model"},
    "wire": REPORTS | {"model"},
    "language": REPORTS | {"model"},
    "language.parse": READS | {"parsing"},
    "language.parameters": READS,
    "language.units": READS | {"language.parse"},
    "language.arrays": READS | {"language.units"},
    "language.functions": READS | {"language.arrays", "language.units"},
    "functions": FUNCTIONS,
    "language.both_ways": READS | {"language.arrays", "language.functions"},
    "language.imports": READS | {"parsing", "language.parse", "language.parameters"},
    "language.resolve": READS | {"language.parse", "language.arrays", "language.units", "language.functions", "language.both_ways"},
    "language.algebra": READS,
    "language.check": READS | {"parsing"} | LANGUAGE - {"language.laws", "language.both_ways"},
    "language.laws": READS | {"language.algebra", "language.check"},
    "kernel": set(),
    "kernel.proof": {"kernel"},
    "kernel.passes": {"kernel", "kernel.proof"},
    "lowering": LOWERS,
    "lowering.codec": LOWERS - LANGUAGE,
    "lowering.texts": LOWERS,
    "lowering.colours": LOWERS | {"lowering.texts"},
    "lowering.rules": LOWERS | {"lowering.codec", "lowering.texts"},
    "lowering.staging": LOWERS | {"lowering.codec"},
    "lowering.mapped": LOWERS | LOWERING - {"lowering.lower"},
    "lowering.lower": (LOWERS - LANGUAGE) | {"lowering.codec", "lowering.mapped"},
    "backends": {"kernel"},
    "backends.llvm": {"backends", "kernel"},
    "backends.numba": {"backends.llvm", "kernel"},
    "backends.python": {"backends", "kernel"},
    "backends.entry": {"backends.llvm", "backends.numba", "kernel", "runtime.code", "runtime.cache"},
    "frameworks": REPORTS | {"model", "parsing", "wire", "runtime.holder"},
    "frameworks.features": REPORTS | {"model", "frameworks"},
    "frameworks.installed": REPORTS | {"model", "parsing", "frameworks"},
    "frameworks.ros": HOLDS | {"runtime.looks"},
    "frameworks.ros1": HOLDS | {"frameworks.ros"},
    "frameworks.ros2": HOLDS | {"frameworks.ros", "frameworks.omg"},
    "frameworks.omg": FRAMEWORK,
    "frameworks.corba": HOLDS | {"frameworks.omg"},
    "frameworks.lcm": HOLDS,
    "frameworks.orocos": FRAMEWORK,
    "frameworks.protobuf": HOLDS | {"runtime.looks", "frameworks.protobuf.proto"},
    "frameworks.protobuf.proto": REPORTS
    | {"model", "parsing"}
    | {f"frameworks.protobuf.{module}" for module in ("diagnostics", "edition_diagnostics", "file_diagnostics", "json_names", "limits")},
    "frameworks.yarp": HOLDS | {"frameworks.yarp.thrift", "runtime.looks"},
    "frameworks.yarp.bottle_schema": FRAMEWORK | YARP,
    "frameworks.yarp.drafting": FRAMEWORK | {"frameworks.yarp"},
    "frameworks.yarp.thrift": FRAMEWORK | YARP,
    "runtime": HOLDERS | {"kernel.entries"} | RUNTIME - {"runtime.functions"},
    "runtime.holder": HOLDERS
    | {"runtime.holder.objects", "runtime.attributes", "runtime.looks", "runtime.limits"}
    | {
        f"runtime.{module}"
        for module in (
            "callable",
            "cells",
            "batches.columns",
            "pickled_lanes",
            "lanes",
            "locks",
            "memory",
            "memory_plan",
            "row_counts",
            "type_specs",
        )
    },
    "runtime.holder.objects": REPORTS
    | {"model.types", "runtime.attributes", "runtime.limits", "runtime.callable", "runtime.type_specs", "runtime.holder"},
    "runtime.attributes": REPORTS
    | {"model.types", "model.layout", "kernel.state", "runtime.limits", "runtime.code", "runtime.cache"}
    | {
        "runtime.callable",
        "runtime.cells",
        "runtime.memory_plan",
        "runtime.type_specs",
        "runtime.holder.record",
        "runtime.holder.objects.in_c",
    },
    "runtime.looks": HOLDERS | {"runtime.limits", "runtime.holder"},
    "runtime.batches": HOLDERS | RUNTIME - {"runtime.functions"},
    "runtime.arrow": HOLDERS | {"runtime.holder"} | {f"runtime.{module}" for module in ("cells", "lanes", "memory_for_arrow", "rows")},
    "runtime.limits": set(),
    "runtime.code": set(),
    "runtime.cache": REPORTS | {"runtime.limits", "runtime.code"},
    "runtime.functions": REPORTS | {"runtime.limits", "runtime.cache"},
    "in_numba": REPORTS | {"runtime", "runtime.holder", "model", "kernel", "backends", "backends.numba", "backends.llvm", "runtime.code"},
    "stubs": REPORTS | {"model", "frameworks", "runtime", "runtime.holder"},
    "pipeline.request": {"runtime.functions"},
    "pipeline": COMPILER | {"pipeline.request"},
    "api.options": REPORTS
    | {"model", "frameworks", "frameworks.installed", "frameworks.protobuf", "runtime.functions", "pipeline.request"},
    "api.cacheable": REPORTS | {"runtime.functions", "runtime.cache", "pipeline.request"},
    "api": COMPILER | API | {"in_numba", "stubs", "pipeline", "pipeline.request"},
    "logs": LOG_READER
    | {"api", "api.options", "file_errors", "recording", "parsing", "model.units", "frameworks.installed", "frameworks.lcm"}
    | {"frameworks.ros2", "logs.folder_names", "runtime", "runtime.arrow", "runtime.batches", "runtime.holder"},
    "logs.base": REPORTS | {"logs.reading.storage", "logs.reading.walking"},
    "logs.limits": set(),
    "logs.folder_names": set(),
    "logs.reading": LOG_READER | {"runtime.code", "runtime.memory"},
    "logs.reading.storage": REPORTS,
    "logs.reading.walking": {"runtime.code", "runtime.cache", "runtime.memory"},
    "logs.bag": LOG_READER,
    "logs.delimited": LOG_READER,
    "logs.lcm": LOG_READER,
    "logs.mcap": LOG_READER,
    "logs.recordings": LOG_READER | {"recording"},
    "logs.rosbag2": LOG_READER | {"logs.mcap"},
    "logs.tide": LOG_READER,
    "logs.yarp": LOG_READER | {"logs.folder_names", "frameworks.yarp"},
    "logs.converting": LOG_READER | {"logs", "logs.folder_names", "file_errors", "runtime.arrow"},
    "ray": REPORTS | {"logs"},
    "dask": REPORTS | {"logs"},
    "generate": REPORTS | {"model", "kernel", "kernel.passes", "language"},
    "generate.passes": REPORTS | {"model", "kernel", "kernel.passes", "generate.unit"},
    "generate.c": PRINTS | C | {"backends.entry"},
    "generate.c.holder": PRINTS | {"generate.c.support", "generate.c.words"},
    "generate.c.printing": PRINTS | {f"generate.c.{each}" for each in ("holder", "state", "support", "texts", "words")},
    "generate.cpp": CPP | {"generate.cpp.decoding", "generate.cpp.encoding", "generate.cpp.header_checks"},
    "generate.cpp.decoding": CPP | {"generate.cpp.header_checks"},
    "generate.cpp.encoding": CPP | {"generate.cpp.header_checks"},
    "generate.cpp.header_checks": CPP,
    "generate.cpp.objects": PRINTS | {"generate.c", "generate.c.holder"},
    "generate.cpp.passes": PRINTS | {"generate.c.holder", "generate.c.printing"},
    "generate.python": PRINTS | PYTHON | {"generate.python.decoding", "generate.python.encoding"},
    "generate.python.decoding": PRINTS | PYTHON,
    "generate.python.encoding": PRINTS | PYTHON,
    "generate.python.passes": PRINTS,
    "generate.python.printing": PRINTS | PYTHON,
    "generate.python.runtime": set(),
    "generate.lisp": PRINTS | {"generate.c.holder"},
    "generate.build": PRINTS | {"generate.c", "lowering.rules", "pipeline", "pipeline.request"},
    "transports": TRANSPORT,
    "transports.installed": TRANSPORT,
    "transports.opening": TRANSPORT | {"transports.installed"},
    "transports.cyclone": TRANSPORT,
    "transports.iceoryx": TRANSPORT,
    "transports.lcm": TRANSPORT,
    "transports.mqtt": TRANSPORT,
    "transports.ros1": TRANSPORT,
    "transports.rsb": TRANSPORT,
    "transports.sockets": TRANSPORT,
    "transports.yarp": TRANSPORT,
    "transports.zenoh": TRANSPORT,
    "bridge": REPORTS | {"api", "api.options", "transports", "transports.installed", "transports.opening"},
    "draft": REPORTS | LANGUAGE | {"model", "parsing", "frameworks", "frameworks.installed", "pipeline"},
    "explain": COMPILER - LOWERING - BACKENDS - RUNTIME | {"pipeline", "pipeline.request"},
    "demo": ANYTHING | {"frameworks.yarp"},
    "cli": ANYTHING,
    "__main__": {"cli"},
    "": ANYTHING - {"demo"},
}
"""A name that has a line of its own stands for that line alone: who may import `kernel` may not import `kernel.proof` for that."""


@cache
def modules():
    return {
        ".".join(path.relative_to(PACKAGE).with_suffix("").parts).removesuffix("__init__").rstrip("."): path
        for path in PACKAGE.rglob("*.py")
    }


@cache
def parsed(path):
    return ast.parse(path.read_text())


@cache
def imports(path):
    """All statements of a source file that import something."""
    return [node for node in statements(parsed(path).body) if isinstance(node, ast.Import | ast.ImportFrom)]


def statements(block):
    """Statements of a block, and those within them; a hundredth of what `ast.walk` goes through."""
    for node in block:
        yield node
        for part in ("body", "orelse", "finalbody", "handlers", "cases"):
            yield from statements(getattr(node, part, ()))


@cache
def imported(path):
    """The modules of ours that a source file imports, without the package's name, and the line."""
    return tuple(found(path))


def found(path):
    for node in imports(path):
        match node:
            case ast.Import():
                names = [alias.name for alias in node.names]
            case ast.ImportFrom(module=module, level=0):
                names = [f"{module}.{alias.name}" if is_module(module, alias.name) else module for alias in node.names]
            case _:
                names = ["rosetta_jit.<relative import>"]
        yield from ((name.removeprefix("rosetta_jit").lstrip("."), node.lineno) for name in names if name.split(".")[0] == "rosetta_jit")


@cache
def is_module(package, name):
    folder = PACKAGE.parent / package.replace(".", "/")
    return (folder / name).is_dir() or (folder / f"{name}.py").is_file()


def within(module, packages):
    return any(module == package or (package and module.startswith(f"{package}.")) for package in packages)


def test_what_a_line_allows_is_there():
    """A line of the table names modules and packages; a name that is gone would allow nothing, and nobody would notice."""
    assert set(MAY_IMPORT).union(*MAY_IMPORT.values()) <= set(modules())


@cache
def room(module):
    """The line of the table for a module: the longest that it is within."""
    return max((each for each in MAY_IMPORT if within(module, {each})), key=len, default="")


def test_every_folder_has_a_line():
    """A folder without one would be as free as the folder around it."""
    packages = {module for module, path in modules().items() if path.name == "__init__.py"}
    assert packages | {module.split(".")[0] for module in modules()} <= set(MAY_IMPORT)


@pytest.mark.parametrize("layer", MAY_IMPORT)
def test_imports_point_one_way(layer):
    wrong = [
        f"{path.relative_to(PACKAGE.parent)}:{line} imports {target or 'rosetta_jit'}"
        for module, path in modules().items()
        if room(module) == layer
        for target, line in imported(path)
        if room(target) not in MAY_IMPORT[layer] | {layer, "startup"} and not within(target, MAY_IMPORT[layer] - MAY_IMPORT.keys())
    ]
    assert not wrong, "\n".join(wrong)


def test_what_makes_no_code_is_imported_by_nothing_that_does():
    """Code in the cache is kept over changes of these packages."""
    graph = {module: {target for target, _ in imported(path)} & modules().keys() for module, path in modules().items()}
    makes_code = [module for module in modules() if within(module, {"api", "backends", "functions", "in_numba", "pipeline", "runtime"})]
    wrong = {other for module in makes_code for other in reach(graph, module) if within(other, NO_CODE)}
    assert not wrong


def test_readers_of_logs_know_no_compiler():
    """A reader gives bytes. What they mean is the business of `Channel` and `Log`."""
    above = {
        "api",
        "frameworks.base",
        "logs.log",
        "logs.file",
        "logs.channel",
        "logs.decoded_parts",
        "logs.tables",
        "logs.converting",
    }
    wrong = [
        f"{module} imports {target}"
        for module, path in modules().items()
        if module.startswith("logs.") and module.count(".") > 1 and not module.startswith("logs.converting.")
        for target, _ in imported(path)
        if within(target, above)
    ]
    assert not wrong, "\n".join(wrong)


def test_no_framework_knows_another():
    """What several share has a folder of its own, which is no framework."""
    shared = {"ros": {"ros1", "ros2"}, "omg": {"ros2", "corba"}}
    wrong = [
        f"{module} imports {target}"
        for module, path in modules().items()
        if module.startswith("frameworks.") and module.count(".") > 1
        for target, _ in imported(path)
        if target.startswith("frameworks.") and target.count(".") > 1 and target.split(".")[1] != module.split(".")[1]
        if module.split(".")[1] not in shared.get(target.split(".")[1], set())
    ]
    assert not wrong, "\n".join(wrong)


def test_transports_know_no_compiler_and_no_other_transport():
    """A transport moves bytes. What several share lies beside their folders; extras are imported by the folder of their transport."""
    wrong = [
        f"{module} imports {target}"
        for module, path in modules().items()
        if module.startswith("transports.") and module.count(".") > 1
        for target, _ in imported(path)
        if target.startswith("transports.") and target.count(".") > 1 and target.split(".")[1] != module.split(".")[1]
    ]
    assert not wrong, "\n".join(wrong)


def test_pyarrow_is_imported_when_somebody_asks_for_a_table():
    """It is an extra, and takes as long to import as numpy: its modules alone name it, and nothing imports those when it is imported."""
    own = {module for module in modules() if within(module, {"runtime.arrow"})}
    wrong = [module for module, path in modules().items() if module not in own and imports_pyarrow(path)]
    wrong += [module for module, path in modules().items() if module not in own and own & set(top_level(path))]
    assert not wrong


def imports_pyarrow(path):
    """Where that is more than the name of a type."""
    named = [node for node in imports(path) if any(name.split(".")[0] == "pyarrow" for name in names_of(node))]
    return bool(named) and not {id(node) for node in named} <= {
        id(each) for node in statements(parsed(path).body) if is_for_types(node) for each in statements([node])
    }


def names_of(node):
    return [node.module or ""] if isinstance(node, ast.ImportFrom) else [alias.name for alias in node.names]


def is_for_types(node):
    return isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"


def test_imports_for_types_alone_stand_apart_where_that_saves_loading():
    """Under TYPE_CHECKING is what a module would not load otherwise, and what is there for type checkers alone. All else has one place."""
    graph = {module: loaded(path) & modules().keys() | {module.rpartition(".")[0]} - {module} for module, path in modules().items()}
    wrong = [
        f"{path.relative_to(PACKAGE.parent)}:{node.lineno} imports {alias.name} for types alone"
        for module, path in modules().items()
        for node in for_types(path)
        if isinstance(node, ast.ImportFrom) and str(node.module).startswith("rosetta_jit")
        for alias in node.names
        for target in [target_of(node, alias)]
        if target in reach(graph, module) and alias.name not in names_for_types(modules()[target]) and alias.asname != alias.name
    ]
    assert not wrong, "\n".join(wrong)


def loaded(path):
    """What a module loads when it is imported: the modules, and the packages that they are in."""
    whole = set(top_level(path))
    return whole | {each[:at] for each in whole for at, letter in enumerate(each) if letter == "."}


def for_types(path):
    """Statements of a module that are under TYPE_CHECKING."""
    return [statement for node in parsed(path).body if is_for_types(node) for statement in node.body]


@cache
def names_for_types(path):
    """Names that a module has for type checkers alone."""
    stored = {
        each.id for node in for_types(path) for each in ast.walk(node) if isinstance(each, ast.Name) and isinstance(each.ctx, ast.Store)
    }
    return stored | {alias.asname or alias.name for node in for_types(path) if isinstance(node, ast.ImportFrom) for alias in node.names}


def test_nothing_is_imported_in_a_circle():
    """Also by imports inside functions and under TYPE_CHECKING: who reads a module need not have read one that needs it."""
    graph = {module: {target for target, _ in imported(path)} & modules().keys() - {module} for module, path in modules().items()}
    within_reach = {module: reach(graph, module) for module in graph}
    circles = {frozenset(each for each in within_reach[module] if module in within_reach[each]) for module in graph}
    assert not circles - {frozenset()}


def reach(graph, module):
    """What a module imports, directly or not."""
    seen, waiting = set(), [module]
    while waiting:
        new = graph[waiting.pop()] - seen
        seen |= new
        waiting += new
    return seen


def top_level(path):
    for node in parsed(path).body:
        match node:
            case ast.Import():
                yield from (alias.name.removeprefix("rosetta_jit.") for alias in node.names)
            case ast.ImportFrom(module=str(module)) if module.startswith("rosetta_jit"):
                yield from (target_of(node, alias) for alias in node.names)


def target_of(node, alias):
    """The module of ours that a name is imported from, or that it names."""
    short = node.module.removeprefix("rosetta_jit").lstrip(".")
    return f"{short}.{alias.name}".lstrip(".") if is_module(node.module, alias.name) else short
