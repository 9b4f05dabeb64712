"""Generated Lisp does what the library does."""

from __future__ import annotations

import re
import struct

import pytest

import rosetta_jit as rj
from rosetta_jit.api.options import request_of, type_request
from rosetta_jit.errors import SchemaError
from rosetta_jit.generate.build import generated
from rosetta_jit.generate.c.holder.lanes import Lane
from rosetta_jit.generate.lisp.lanes import lanes_of
from rosetta_jit.generate.lisp.language import codec
from rosetta_jit.generate.lisp.texts import broken, literal
from rosetta_jit.generate.lisp.words import Names, hyphenated, package_of, runtime_names, symbols
from tests.generate import lisp
from tests.generate.corpora import corpora, numbers_in_texts
from tests.generate.driver import harmed
from tests.generate.test_c import CALLING, HOSTILE, SUBJECTS, TORSO
from tests.generate.test_cpp import OUTER
from tests.golden import GOLDEN, check_golden

BOTH = ("decode", "encode")

FEW = ("lcm exlcm.example_t", "corba RTC::TimedWChar little", "protobuf rj.OneOf", "protobuf rj.Tree")


def compare(found: list[str], wanted: list[str], messages: list[bytes]) -> None:
    """All lines are the same; which lane of a message that asks for too much is found first may differ."""
    for line, right, message in zip(found, wanted, messages, strict=True):
        if "memory than its size allows" in line:
            line, right = line.split("[")[0].split()[0], right.split("[")[0].split()[0]  # noqa: PLW2901 - the same lines, shorter
        assert line == right, message.hex()


def subject(name):
    request, good = SUBJECTS[name]
    of = (rj.Decoder, rj.Encoder) if request.mapping else (rj.Decoder.of, rj.Encoder.of)
    programs = [make(request.mapping or request.type, encoding=request.encoding) for make in of]
    return request, programs, harmed(good, 12, name)


@lisp.needs_sbcl
def test_lisp_answers_as_the_library_does(tmp_path):
    """Values, bytes, and what is wrong with messages that are broken: of a mapping, of types, and of peers' messages."""
    request, programs, messages = numbers_in_texts()
    asked = [*(subject(name) for name in SUBJECTS), (request, programs, harmed(messages, 12, "numbers"))]
    asked += [(each.request, each.programs(), harmed(list(each.messages[:4]), 4, each.name)) for each in corpora() if each.name in FEW]
    found = lisp.answers(tmp_path, [(request, messages) for request, _, messages in asked])
    for lines, (request, programs, messages) in zip(found, asked, strict=True):
        compare(lines, lisp.expected(request, *programs, messages), messages)


@pytest.mark.campaign
@lisp.needs_sbcl
@pytest.mark.parametrize("framework", sorted({each.framework for each in corpora()}))
def test_all_messages_of_peers(framework, tmp_path):
    chosen = [each for each in corpora() if each.framework == framework]
    messages = [harmed(list(each.messages), 4, each.name) for each in chosen]
    found = lisp.answers(tmp_path, [(each.request, some) for each, some in zip(chosen, messages, strict=True)])
    for lines, each, some in zip(found, chosen, messages, strict=True):
        compare(lines, lisp.expected(each.request, *each.programs(), some), some)


def test_the_text_is_the_same_every_time():
    texts = generated(TORSO, "lisp", BOTH, "torso_state")
    assert list(texts) == ["torso-state.asd", "torso-state-runtime.lisp", "torso-state.lisp"]
    for name in ("torso-state.asd", "torso-state.lisp"):
        check_golden(GOLDEN / "generate" / name, texts[name])


def test_names_of_lisp():
    assert [hyphenated(name) for name in ("JointState", "frame_id", "HTTPHeader", "x", "_1", "été")] == [
        "joint-state",
        "frame-id",
        "http-header",
        "x",
        "v1",
        "t",
    ]
    names = Names(symbols())
    assert [names.symbol(name) for name in ("List", "a", "A", "a_", "T")] == ["list-2", "a", "a-2", "a-3", "t-2"]
    assert names.symbol("Multiple", "{}", "{}-value-bind") == "multiple-2"
    assert package_of("common_lisp") == "common-lisp-messages"


def test_texts_in_lisp():
    assert literal('a "b" \\') == '"a \\"b\\" \\\\"'
    assert literal("caf\u00e9\n)") == '(text "caf" 233 10 ")")'
    long = f'(setf (a-b object) (text-of (a-b object) "{")" * 60}" (codec.rows codec) (i64-at message 0) \'(1 #(2)) data))'
    assert re.sub(r"\s+", " ", " ".join(broken(long, 40))) == long
    assert all(len(line) <= 120 for line in broken(long, 20))


SYMBOLS = """
t nil pi list position array_rank_limit most_positive_fixnum function quote lambda declare setf let object codec row data before
value end count first index number char_code_limit string car class type condition print_object loop
"""
TYPES = "=" * 80 + "\nMSG: evil/Multiple\nint8 value_bind\n" + "=" * 80 + "\nMSG: evil/List\nint8 t\nint8 T\nint8 t_\nMultiple[] length\n"


@lisp.needs_sbcl
def test_a_hostile_schema_stays_in_its_place(tmp_path):
    """Its names are words of Lisp and of the runtime, and its comments end strings and forms; SBCL has nothing to say."""
    fields = "".join(f'int8 {name} # ") (sb-ext:exit :code 7) |# ;\n' for name in SYMBOLS.split())
    mine = type_request("decode", "evil/Defun", {"encoding": "ros1", "schema": f"{fields}List lists\nMultiple[2] array\n{TYPES}"})
    theirs = type_request("decode", "evil/Outer", {"encoding": "ros1", "schema": HOSTILE + OUTER})
    count = len(SYMBOLS.split())
    message = bytes(range(count)) + bytes([1, 2, 3]) + struct.pack("<I", 2) + bytes([4, 5]) + bytes([6, 7])
    inner = struct.pack("<If", 1, 2.5) + struct.pack("<I", 2) + b"ab" + bytes([7]) + struct.pack("<2q", -1, 1) + struct.pack("<I", 1) + b"x"
    outer = struct.pack("<id", 5, 0.5) + struct.pack("<I", 3) + b'*/"' + bytes([1, 0, 1, 1]) + struct.pack("<I", 2) + b"\0\1"
    both = [(mine, [message]), (theirs, [outer + inner + bytes(12)])]
    (one,), (other,) = lisp.answers(tmp_path, both)
    assert one == f"ok {message.hex()} ({' '.join(map(str, range(count)))} (1 2 3 [(4) (5)]) [(6) (7)])"
    assert other.startswith(f"ok {(outer + inner + bytes(12)).hex()} ")


ACCESSORS = "Make/failure Make/codec_state Collect/message Take/message Put/message Size/of_rows Encode/rows Site/detail I64/rem"
ENUMS = """syntax = "proto3"; package rj; enum header { seq = 0; stamp = 1; } message Header { uint32 stamp = 1; header seq = 2; }
message Outer { Header header = 1; oneof t { int32 nil = 2; string list = 3; }
optional bool allow_other_keys = 4; map<string, int32> pi = 5; }"""


@lisp.needs_sbcl
def test_types_and_enums_are_called_as_the_unit_calls_its_own(tmp_path):
    """`make-failure` would be the runtime's as well as the accessor of a field, `+header.seq+` a value as well as a place in a row."""
    pairs = [each.split("/") for each in ACCESSORS.split()]
    inner: dict[str, str] = {}
    for type_, name in pairs:
        inner[type_] = inner.get(type_, f"===\nMSG: evil/{type_}\n") + f"int16 {name}\n"
    fields = "".join(f"{type_} the_{type_}\n" for type_ in inner)
    ours = type_request("decode", "evil/Outer", {"encoding": "ros1", "schema": fields + "".join(inner.values())})
    message = struct.pack(f"<{len(pairs)}h", *range(len(pairs)))
    theirs = type_request("decode", "rj.Outer", {"encoding": "protobuf", "schema": {"o.proto": ENUMS}})
    theirs_message = b"\x0a\x04\x08\x07\x10\x01\x1a\x01x\x20\x01\x2a\x05\x0a\x01k\x10\x02"
    (one,), (other,) = lisp.answers(tmp_path, [(ours, [message]), (theirs, [theirs_message])])
    assert one == f"ok {message.hex()} ((0 1) (2) (3) (4) (5) (6) (7) (8))"
    assert other == f'ok {theirs_message.hex()} ((7 1) <list "120"> t {{"107":2}})'


@lisp.needs_sbcl
def test_names_of_the_runtime_are_known(tmp_path):
    """SBCL says what it defines, accessors and constructors of structures and what its macros make among them."""
    defined = "(do-symbols (symbol :runtime) (when (and (eq (symbol-package symbol) (find-package :runtime)) (is-defined symbol))"
    printed = lisp.run(*lisp.begun(), f'{defined} (format t "~(~A~)~%" symbol)))', cwd=tmp_path)
    found = {name for name in printed.split() if hyphenated(name) == name}
    assert "make-failure" in found
    assert found <= runtime_names()


@lisp.needs_sbcl
def test_units_are_called_as_systems_of_lisp_are(tmp_path):
    """With hyphens, where other languages have underscores: both names are of the same package."""
    request = type_request("decode", "std_msgs/Header", {"encoding": "ros1"})
    assert generated(request, "lisp", BOTH, "arm-lcm") == generated(request, "lisp", BOTH, "arm_lcm")
    package = lisp.write(tmp_path, generated(request, "lisp", BOTH, "arm-lcm"))
    assert package == "arm-lcm"
    said = lisp.run(
        *lisp.begun(), f'(unit "{tmp_path}/" "{package}")', "(print (length (arm-lcm:encode (arm-lcm:make-header))))", cwd=tmp_path
    )
    assert said.split() == ["16"]
    for language in ("c", "cpp", "python"):
        with pytest.raises(SchemaError, match="unusable-name"):
            generated(request, language, BOTH, "arm-lcm")
    for name in ("-arm", "7-arm", "arm lcm", "time"):
        with pytest.raises(SchemaError, match="digits, underscores and `-`"):
            generated(request, "lisp", BOTH, name)


@lisp.needs_sbcl
def test_a_unit_may_have_many_lanes(tmp_path):
    """SBCL runs out of stack where it compiles a function of some 300 keywords, as a constructor of them all would be."""
    lanes = lanes_of([Lane(f"field_{number}", f"field_{number}_used", 1, None) for number in range(400)], 400)
    (tmp_path / "lanes.lisp").write_text(f"(in-package :runtime)\n{codec(lanes)}(print (length (codec.field-399 (make-codec))))\n")
    forms = [*lisp.begun(), '(load-source "lanes.lisp")']
    assert lisp.run(*forms, cwd=tmp_path).split() == ["0"]


@lisp.needs_sbcl
def test_holders_are_classes(tmp_path):
    """They have `make-instance`, typed slots and methods; accessors read and set doubles without boxing them."""
    unit = lisp.write(tmp_path, generated(SUBJECTS["joints"][0], "lisp", BOTH, "joints"))
    wide = type_request("decode", "w.Part", {"encoding": "protobuf", "schema": {"w.proto": WIDE}})
    part = lisp.write(tmp_path, generated(wide, "lisp", BOTH, "part"))
    forms = [*lisp.begun(), f'(unit "{tmp_path}/" "{unit}")', f'(unit "{tmp_path}/" "{part}")']
    forms += [
        "(defgeneric sequence-of (message))",
        "(defmethod sequence-of ((message joints:header)) (joints:header-seq message))",
        "(defmethod sequence-of ((message joints:joint-state)) (sequence-of (slot-value message 'joints::header)))",
        "(defvar *made* (make-instance 'joints:joint-state :header (make-instance 'joints:header :seq 7) :name (vector \"a\")))",
        "(print (list (sequence-of *made*) (sequence-of (joints:decode (joints:encode *made*)))))",
        "(print (handler-case (make-instance 'joints:header :seq -1) (type-error () :type-error)))",
        "(print (handler-case (setf (joints:header-seq (joints:make-header)) (first '(1.5))) (type-error () :type-error)))",
        "(print (eq (joints:joint-state-header (joints:make-joint-state)) (joints:joint-state-header (joints:make-joint-state))))",
        "(print (documentation 'joints:header 'type))",
        "(defun next (part) (setf (part:part-x part) (+ 1 (part:part-x part)) (part:part-y part) (logxor 1 (part:part-y part))) part)",
        "(compile 'next)",
        "(defvar *part* (part:make-part :x 1.5d0 :y (1- (ash 1 64))))",
        LOOP.replace("%s", '(consed "next" (lambda () (next *part*)))'),
    ]
    assert lisp.run(*forms, cwd=tmp_path).split("\n")[1:] == [
        "(7 7) ",
        ":TYPE-ERROR ",
        ":TYPE-ERROR ",
        "NIL ",
        '"std_msgs/Header." next 0',
        "",
    ]


@lisp.needs_sbcl
def test_symbols_do_not_depend_on_how_a_program_prints_them(tmp_path):
    """Many an initialisation file sets ``*print-case*``, under which the unit and its runtime are compiled then."""
    header = type_request("decode", "std_msgs/Header", {"encoding": "ros1"})
    unit = lisp.write(tmp_path, generated(header, "lisp", BOTH, "joints"))
    files = [f'(load (compile-file "{tmp_path}/{name}.lisp"))' for name in (f"{unit}-runtime", unit)]
    shown = ["(setf *print-case* :upcase *print-pretty* nil)", "(print (joints:decode (joints:encode (joints:make-header :seq 7))))"]
    for case in (":upcase", ":downcase", ":capitalize"):
        found = lisp.run(f"(setf *print-case* {case})", *files, *shown, cwd=tmp_path)
        assert found.splitlines()[-1].startswith("#S(JOINTS:HEADER :SEQ 7 "), case


@lisp.needs_sbcl
def test_a_system_can_be_loaded_again(tmp_path):
    """A system that was generated anew is loaded into a running Lisp by the same form as the first time."""
    header = type_request("decode", "std_msgs/Header", {"encoding": "ros1"})
    unit = lisp.write(tmp_path, generated(header, "lisp", BOTH, "joints"))
    begin = ["(require :asdf)", f'(asdf:load-asd "{tmp_path}/{unit}.asd")', f'(asdf:load-system "{unit}")']
    shown = "(print (joints:header-seq (joints:decode (joints:encode (joints:make-header :seq 7)))))"
    assert lisp.run(*begin, f'(asdf:load-system "{unit}" :force t)', shown, cwd=tmp_path).splitlines()[-1].split() == ["7"]


WIDE = """syntax = "proto3"; package w; message Part { double x = 1; uint64 y = 2; }
message Wide { uint64 a = 1; sint64 b = 2; double c = 3; repeated uint64 d = 4; repeated Part parts = 5; string name = 6; }"""
WIDE_MESSAGE = (
    "08ffffffffffffffffff01" "10ffffffffffffffffff01" "190000000000000440" "2214ffffffffffffffffff01feffffffffffffffff01"
    "2a140900000000000008c010ffffffffffffffffff01" "3203c3a978"
)  # fmt: skip

LOOP = """(flet ((consed (name run)
                     (funcall run)
                     (let ((before (sb-ext:get-bytes-consed)))
                       (dotimes (i 100000)
                         (funcall run))
                       (format t "~A ~D~%" name (floor (- (sb-ext:get-bytes-consed) before) 100000)))))
             %s)"""


@lisp.needs_sbcl
def test_numbers_are_read_and_written_without_allocating(tmp_path):
    """With a codec and an object that are used again: doubles, 64-bit integers with the high bit, repeated structs, texts that stay."""
    asked = [
        (TORSO, [struct.pack("<ii3d", 266, 3, 10, 20, 30)]),
        SUBJECTS["joints"],
        (type_request("decode", "w.Wide", {"encoding": "protobuf", "schema": {"w.proto": WIDE}}), [bytes.fromhex(WIDE_MESSAGE)]),
    ]
    forms = lisp.begun()
    for number, (request, messages) in enumerate(asked):
        unit = lisp.write(tmp_path, generated(request, "lisp", BOTH, f"unit_{number}"))
        longest = max(messages, key=len)
        forms += [f'(unit "{tmp_path}/" "{unit}")', f'(defvar *octets-{number}* (octets-of "{longest.hex()}"))']
        forms += [f"(defvar *object-{number}* ({unit}:decode *octets-{number}*))", f"(defvar *codec-{number}* ({unit}:make-codec))"]
        read = f'(consed "{unit}" (lambda () ({unit}:decode *octets-{number}* :codec *codec-{number}* :before *object-{number}*)))'
        write = f'(consed "{unit}" (lambda () ({unit}:encode-into *octets-{number}* *object-{number}* :codec *codec-{number}*)))'
        forms += [LOOP.replace("%s", read), LOOP.replace("%s", write)]
    assert lisp.run(*forms, cwd=tmp_path).splitlines() == [f"unit-{number} 0" for number in (0, 0, 1, 1, 2, 2)]


@lisp.needs_sbcl
def test_functions_of_the_mapping_and_what_the_host_tells(tmp_path):
    (tmp_path / "calling.mapping").write_text(CALLING)
    calling = request_of("decode", {"encoding": "yarp3"}, mapping=str(tmp_path / "calling.mapping"))
    schema = {
        "a.bottle-schema": '"a" (("value" :int))',
        "b.proto": 'syntax = "proto3"; package b; message Number { int32 value = 1; int64 now = 2; }',
        "m.mapping": 'import "a.bottle-schema"\nimport "b.proto"\ndata-holder: b.Number\nwire-schema: a\nunpack-rules:\n'
        "  .value = int32(counter() + .value)\n  .now = now()\n",
    }
    telling = request_of("decode", {"schema": schema, "encoding": "yarp3"}, mapping="m.mapping")
    forms = lisp.begun()
    for name, request in (("calling", calling), ("telling", telling)):
        lisp.write(tmp_path, generated(request, "lisp", ("decode",), name))
        forms.append(f'(unit "{tmp_path}/" "{name}")')
    good, bad = (struct.pack("<ii3d", 266, 3, yaw, 0.0, 0.0).hex() for yaw in (90.0, -90.0))
    number = struct.pack("<iii", 257, 1, 40).hex()
    told = "(list (telling:number-message-value found) (telling:number-message-now found))"
    forms += [
        "(defun calling:halved (number) (if (minusp number) (error 'runtime:refused) (/ number 2)))",
        f'(print (calling:joint-angles-angles (calling:decode (octets-of "{good}"))))',
        f'(handler-case (calling:decode (octets-of "{bad}")) (runtime:decode-error (found) (print (runtime:message-error-kind found))))',
        "(setf runtime:*now* (constantly 17))",
        f'(defun told () (let ((found (telling:decode (octets-of "{number}")))) {told}))',
        "(dotimes (i 3) (print (told)))",
    ]
    assert lisp.run(*forms, cwd=tmp_path).split() == ["#(0.7853982)", ":REJECTED", "(40", "17)", "(41", "17)", "(42", "17)"]


def refused(form: str, shown: str = "(princ-to-string found)") -> str:
    """A form that signals an error of encoding, of which something is printed."""
    return f"(handler-case {form} (runtime:encode-error (found) (print {shown.replace('(message', '(runtime:message')})))"


@lisp.needs_sbcl
def test_objects_that_cannot_be_written(tmp_path):
    """Slots take no number that their field cannot hold; what is in vectors, and how long these are, is said when they are written."""
    unit = lisp.write(tmp_path, generated(SUBJECTS["joints"][0], "lisp", BOTH, "joints"))
    forms = [*lisp.begun(), f'(unit "{tmp_path}/" "{unit}")']
    forms += [
        "(handler-case (joints:make-header :seq -1) (type-error () (print :type-error)))",
        refused("(joints:encode (joints:make-joint-state :name (vector 1)))", "(message-error-kind found)"),
        refused('(joints:encode (joints:make-joint-state :name (vector "a" \'b)))'),
        refused("(joints:encode (joints:make-joint-state :header (joints:make-header :frame-id (string (code-char #xd800)))))"),
        refused("(joints:encode (joints:make-joint-state :name (vector (string (code-char #xd800)))))"),
        "(print (length (joints:encode (joints:make-joint-state))))",
        "(print (joints:message-size (joints:make-joint-state)))",
        refused('(joints:encode-into (octets-of "0000") (joints:make-joint-state))'),
    ]
    assert lisp.run(*forms, cwd=tmp_path).splitlines()[1:] == [
        ":TYPE-ERROR ",
        ":RANGE ",
        '"range at .name[1]: B is not of type STRING" ',
        '"range at .header.frame_id: U+D800 is no character" ',
        '"range at .name[0]: U+D800 is no character" ',
        "32 ",
        "32 ",
        '"length at .header.seq: no room for the message" ',
    ]
