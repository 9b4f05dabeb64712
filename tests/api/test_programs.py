"""Decoders and encoders as users call them, in every backend."""

from __future__ import annotations

import gc
import struct
import subprocess
import sys
import threading
import weakref

import numpy as np
import pytest

import rosetta_jit as rj
from rosetta_jit.runtime.holder import Holder

TORSO = "yarp/icub/torso_state.mapping"
CAMERA = "yarp/icub/camera_image.mapping"
DEGREES = np.array([10.0, -20.0, 30.0])
MESSAGE = struct.pack("<ii3d", 266, 3, *DEGREES)
BACKENDS = ["numba", "llvm", "python", "interpreter"]


def image(width, height, quantum=8, high=1):
    row = -(-width * 3 // quantum) * quantum
    pixels = np.zeros((height, row), np.uint8)
    pixels[:, : width * 3] = np.random.default_rng(1).integers(0, 256, (height, width * 3), np.uint8)
    head = struct.pack("<iii4si4sii", 256, 4, 9, b"mat", 9, b"rgb", 257, 5)
    return (
        head
        + struct.pack("<iihhii", 3, row * height, quantum, high, width, height)
        + struct.pack("<ii", 12, row * height)
        + pixels.tobytes()
    )


@pytest.fixture(scope="module", params=BACKENDS)
def backend(request):
    return request.param


@pytest.fixture(scope="module")
def decode(backend):
    return rj.Decoder(TORSO, encoding="yarp3", backend=backend)


@pytest.mark.parametrize("kind", [bytes, bytearray, memoryview, lambda data: np.frombuffer(data, np.uint8)])
def test_any_bytes_like_object_fills_the_decoders_own_holder(decode, kind):
    angles = decode(kind(MESSAGE))
    assert angles is decode(kind(MESSAGE))
    assert angles.angles.dtype == np.float32
    assert np.array_equal(angles.angles, np.radians(DEGREES).astype(np.float32))


def test_into_a_holder_of_ones_own(decode):
    own, other = decode.new(), decode.new()
    assert decode.into(MESSAGE, own) is own
    decode.into(struct.pack("<ii3d", 266, 3, 1, 2, 3), other)
    assert np.array_equal(own.angles, np.radians(DEGREES).astype(np.float32))


def test_both_forms_of_a_list_are_read(decode):
    tagged = struct.pack("<ii", 256, 3) + b"".join(struct.pack("<id", 10, value) for value in DEGREES)
    assert np.array_equal(decode(tagged).angles, np.radians(DEGREES).astype(np.float32))


@pytest.mark.parametrize(
    ("message", "kind", "path", "offset"),
    [
        (b"", "truncated", "", 0),
        (MESSAGE[:6], "truncated", "", 4),
        (MESSAGE[:20], "truncated", ".roll", 16),
        (MESSAGE[:-1], "truncated", ".pitch", 24),
        (MESSAGE + b"\0", "trailing", "", 32),
        (struct.pack("<ii3d", 267, 3, 0, 0, 0), "tag", "", 0),
        (struct.pack("<ii3d", 266, 2, 0, 0, 0), "count", "", 4),
        (struct.pack("<ii3d", 266, -1, 0, 0, 0), "count", "", 4),
        (struct.pack("<ii3d", 266, 2**31 - 1, 0, 0, 0), "count", "", 4),
    ],
)
def test_bad_messages_say_what_and_where(decode, message, kind, path, offset):
    holder = decode.new()
    with pytest.raises(rj.DecodeError) as caught:
        decode.into(message, holder)
    assert (caught.value.kind, caught.value.path, caught.value.offset) == (kind, path, offset)
    with pytest.raises(rj.InvalidHolder):
        holder.angles  # noqa: B018 - reading raises
    decode.into(MESSAGE, holder)
    assert len(holder.angles) == 3


def test_the_built_in_does_what_the_decoder_does(decode):
    own, built_in = decode.new(), decode.builtin
    expected = np.radians(DEGREES).astype(np.float32)
    assert built_in(MESSAGE) is decode(MESSAGE)
    assert built_in(bytearray(MESSAGE), own) is own
    assert np.array_equal(own.angles, expected)
    for wrong in [(), (7,), (MESSAGE, object()), (MESSAGE, own, 3)]:
        with pytest.raises(TypeError):
            built_in(*wrong)
    with pytest.raises(TypeError):
        built_in(MESSAGE, holder=own)
    with pytest.raises(rj.DecodeError) as caught:
        built_in(MESSAGE[:20])
    assert (caught.value.path, caught.value.offset) == (".roll", 16)
    encode = rj.Encoder(TORSO, encoding="yarp3").builtin
    buffer = bytearray(40)
    assert encode(own, buffer, 4) == 36
    assert encode(own) == buffer[4:36]


def test_a_built_in_keeps_its_program(backend):
    decode = rj.Decoder(TORSO, encoding="yarp3", backend=backend)
    seen, built_in = weakref.ref(decode), decode.builtin
    assert decode.builtin == built_in
    del decode
    gc.collect()
    assert len(built_in(MESSAGE).angles) == 3
    del built_in
    gc.collect()
    assert seen() is None


def test_a_program_is_made_once(decode):
    with pytest.raises(TypeError, match="made already"):
        decode.__init__(CAMERA)
    assert len(decode(MESSAGE).angles) == 3


def test_wrong_objects_are_type_errors(decode):
    for wrong in (7, "text", None):
        with pytest.raises(TypeError):
            decode(wrong)
    with pytest.raises(TypeError):
        decode()
    with pytest.raises(TypeError):
        decode(MESSAGE, decode.new(), 3)
    with pytest.raises(TypeError, match="holder of"):
        decode.into(MESSAGE, object())
    with pytest.raises(BufferError):
        decode(memoryview(np.zeros((64, 64), np.uint8)[:, ::2]))


def test_many_gives_columns(decode):
    count = 50
    values = np.random.default_rng(0).uniform(-180, 180, (count, 3))
    buffer = b"".join(struct.pack("<ii3d", 266, 3, *row) for row in values)
    offsets = np.arange(count + 1) * 32
    batch = decode.many(buffer, offsets)
    assert len(batch) == count
    assert np.array_equal(batch.angles.to_numpy(), np.radians(values).astype(np.float32))
    assert np.array_equal(batch[7].angles, np.radians(values[7]).astype(np.float32))
    again = decode.many(buffer[: 32 * 10], offsets[:11], into=batch)
    assert again is batch
    assert len(again) == 10
    assert len(decode.many(b"", np.zeros(1, np.int64))) == 0


def test_many_names_the_message_that_is_bad(decode):
    offsets = np.array([0, 32, 60], np.int64)
    with pytest.raises(rj.DecodeError) as caught:
        decode.many(MESSAGE * 2, offsets)
    assert caught.value.path == "[1].pitch"
    for wrong in ([0, 32, 65], [0, 32, 16], [-1, 32]):
        with pytest.raises(ValueError, match="offsets"):
            decode.many(MESSAGE * 2, np.array(wrong, np.int64))
    with pytest.raises(ValueError, match="int64"):
        decode.many(MESSAGE, np.array([0.0, 32.0]))


@pytest.mark.parametrize("dialect", ["yarp2012", "yarp3", "yarp4"])
def test_encode_is_the_inverse(backend, decode, dialect):
    encode = rj.Encoder(TORSO, encoding=dialect, backend=backend)
    written = encode(decode(MESSAGE))
    assert len(written) == encode.size(decode(MESSAGE)) == 32
    values = struct.unpack("<ii3d", written)
    assert values[:2] == ((276 if dialect == "yarp4" else 266), 3)
    assert np.allclose(values[2:], DEGREES, rtol=1e-6)
    buffer = bytearray(40)
    assert encode.into(decode(MESSAGE), buffer, 4) == 36
    assert bytes(buffer[4:36]) == written
    assert encode.into(holder=decode(MESSAGE), buffer=buffer) == encode(decode(MESSAGE), offset=0, buffer=buffer) == 32
    for wrong in ({"buffer": buffer}, {"holder": decode(MESSAGE), "into": buffer}):
        with pytest.raises(TypeError):
            encode(**wrong)
    assert encode.into is encode.builtin  # no function of Python's in between
    assert np.allclose(np.degrees(rj.Decoder(TORSO, backend=backend)(written).angles), DEGREES, rtol=1e-6)


def test_a_bytearray_can_be_resized_after_each_call_whatever_came_of_it(backend, decode):
    encode = rj.Encoder(TORSO, encoding="yarp3", backend=backend)
    message = bytearray(b"..." + MESSAGE)
    del message[:3]  # its bytes begin behind those of its memory
    angles = decode(message)
    assert np.array_equal(angles.angles, np.radians(DEGREES).astype(np.float32))
    cut, small, empty, buffer = bytearray(MESSAGE[:-1]), bytearray(20), bytearray(), bytearray(40)
    for refused in (cut, empty):
        with pytest.raises(rj.DecodeError):
            decode(refused)
    decode(message)
    for offset, refused in ((0, small), (0, empty), (9, buffer), (41, buffer), (-1, buffer)):
        with pytest.raises(BufferError):
            encode(angles, refused, offset)
    assert encode(angles, buffer, 8) == 40
    assert np.array_equal(decode(buffer[8:]).angles, angles.angles)
    for exported in (message, cut, small, empty, buffer):
        exported.extend(b"more")
        exported.clear()


def test_encode_refuses_what_it_cannot_write(backend, decode):
    encode = rj.Encoder(TORSO, encoding="yarp3", backend=backend)
    angles = decode(MESSAGE)
    with pytest.raises(TypeError):
        encode(object())
    with pytest.raises(BufferError, match="32 bytes"):
        encode.into(angles, bytearray(31))
    with pytest.raises((BufferError, TypeError)):
        encode.into(angles, bytes(40))
    short = decode.new()
    with pytest.raises(rj.EncodeError) as caught:
        encode(short)
    assert caught.value.kind == "index"


def test_encode_many(backend, decode):
    encode = rj.Encoder(TORSO, encoding="yarp3", backend=backend)
    batch = decode.many(MESSAGE * 5, np.arange(6) * 32)
    buffer, offsets = encode.many(batch)
    assert offsets.tolist() == [0, 32, 64, 96, 128, 160]
    assert bytes(buffer[32:64]) == encode(decode(MESSAGE))


@pytest.mark.parametrize(("width", "height", "quantum"), [(320, 240, 8), (101, 37, 8), (1, 1, 8), (5, 2, 1), (0, 0, 0)])
def test_images_lose_their_padding(backend, width, height, quantum):
    message = image(width, height, quantum or 1)
    if not width:
        message = message[:40] + struct.pack("<hhii", 0, 1, 0, 0) + message[52:]
    decoder = rj.Decoder(CAMERA, encoding="yarp3", backend=backend)
    if backend in ("python", "interpreter") and width > 101:
        pytest.skip("a slow path; smaller images show the same")
    picture = decoder(message)
    row = len(message[60:]) // height if height else 0
    pixels = np.frombuffer(message, np.uint8, offset=60).reshape(height, row)[:, : width * 3]
    assert (picture.width, picture.height) == (width, height)
    assert np.array_equal(picture.view("data"), pixels.ravel())


def test_lanes_grow_without_a_word(backend):
    schema = {"x.bottle-schema": '"x" (("values" (:list :double)) ("name" :string))'}
    decoder = rj.Decoder.of("x", encoding="yarp4", schema=schema, backend=backend)
    encoder = rj.Encoder.of("x", encoding="yarp4", schema=schema, backend=backend)
    for count in (0, 1, 100, 3):
        holder = decoder.holder_type.from_dict({"values": [0.5] * count, "name": "n" * count})
        assert decoder(encoder(holder)).to_dict() == {"values": [0.5] * count, "name": "n" * count}


def test_views_outlive_decoder_and_growth():
    decoder = rj.Decoder.of("x", encoding="yarp4", schema={"x.bottle-schema": '"x" (("values" (:list :int)) )'})
    message = struct.pack("<iiii", 256, 1, 257, 2) + struct.pack("<ii", 7, 8)
    values = decoder(message).values
    decoder(struct.pack("<iiii", 256, 1, 257, 10_000) + bytes(40_000))
    del decoder
    gc.collect()
    assert values.tolist() == [7, 8] or values.tolist() == [0, 0]


def test_borrowed_bytes_keep_the_message_alive():
    decoder = rj.Decoder.of("rst.vision.Image", encoding="protobuf", borrow=True)
    encoder = rj.Encoder.of("rst.vision.Image", encoding="protobuf")
    plain = encoder.holder_type(data=b"pixels", width=2, height=1)
    message = bytearray(encoder(plain))
    picture = decoder(message)
    view = picture.view("data")
    assert bytes(view) == b"pixels"
    assert not view.flags.owndata
    with pytest.raises(BufferError):
        message.append(0)
    assert encoder(picture) == bytes(message)
    del message
    gc.collect()
    assert picture.data == b"pixels"


def test_two_threads_decode_many():
    decoder = rj.Decoder(TORSO, encoding="yarp3")
    offsets = np.arange(20_001) * 32
    batches = [decoder.many(MESSAGE * 10, offsets[:11]) for _ in range(2)]
    threads = [threading.Thread(target=decoder.many, args=(MESSAGE * 20_000, offsets), kwargs={"into": batch}) for batch in batches]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for batch in batches:
        assert np.allclose(np.degrees(batch.angles.to_numpy()), DEGREES, atol=1e-4)


def test_infer_and_decode_what_was_drafted():
    text = rj.infer([MESSAGE], name="x", encoding="yarp3")
    decoder = rj.Decoder.of("x", encoding="yarp3", schema={"x.bottle-schema": text})
    assert list(decoder(MESSAGE).to_dict().values()) == DEGREES.tolist()


@pytest.mark.parametrize("name", ["__import__", "class", "None", "self", "x' or 1", "a\\nb", "to_dict", "lanes_", "__class__", "if"])
def test_hostile_field_names_compile_or_are_refused(name):
    schema = {"x.bottle-schema": f'"x" (("{name}" :int))'}
    try:
        decoders = [rj.Decoder.of("x", encoding="yarp3", schema=schema, backend=backend) for backend in ("python", "llvm")]
    except rj.SchemaError:
        return
    for decoder in decoders:
        holder = decoder(struct.pack("<iii", 257, 1, 5))
        assert Holder.to_dict(holder) == {name: 5}  # a field may have the name of a method, and is seen before it


def test_a_protobuf_class_is_a_schema():
    from google.protobuf.timestamp_pb2 import Timestamp

    decoder, encoder = rj.Decoder.of(Timestamp), rj.Encoder.of(Timestamp)
    message = Timestamp(seconds=5, nanos=7).SerializeToString()
    assert decoder(message).seconds == 5
    assert encoder(decoder(message)) == message


def test_errors_of_making_programs():
    with pytest.raises(rj.MappingError, match=r"not found|no mapping|not on the search path"):
        rj.Decoder("no/such.mapping")
    with pytest.raises(rj.MappingError, match="unknown-encoding"):
        rj.Decoder(TORSO, encoding="yarp5")
    with pytest.raises(rj.SchemaError, match=r"`ros2` is the name of a framework, and no encoding\n.*choose one of cdr, cdr2"):
        rj.Decoder.of("std_msgs/String", encoding="ros2")
    with pytest.raises(rj.MappingError, match="ambiguous-encoding"):
        rj.Encoder(TORSO)
    with pytest.raises(rj.SchemaError, match="unknown-type"):
        rj.Decoder.of("rst.vision.Imag", imports=["rst/vision/Image.proto"])


@pytest.mark.parametrize(
    ("asked", "options", "meant"),
    [
        ("sensor_msgs/IMU", {"encoding": "ros1"}, "sensor_msgs/Imu"),
        ("IMU", {"encoding": "ros1"}, "sensor_msgs/Imu"),
        ("sig/VectorOfInt", {"encoding": "yarp3"}, "yarp.sig.VectorOfInt"),  # a file lies there that declares this
        ("sensor_msgs/msg/IMU", {"encoding": "cdr"}, "sensor_msgs/Imu"),
        ("jointangles", {"encoding": "protobuf"}, "rst.kinematics.JointAngles"),
        ("rst.kinematics.JointAngle", {"encoding": "protobuf"}, "rst.kinematics.JointAngles"),
        ("lab.Pt", {"schema": {"lab.proto": 'syntax = "proto3"; package lab; message PT { double x = 1; }'}}, "lab.PT"),
    ],
)
def test_a_type_that_there_is_not_is_told_from_one_like_it(asked, options, meant):
    with pytest.raises(rj.SchemaError, match=f"no file declares a message `{asked}`\n.*did you mean `{meant}`"):
        rj.Decoder.of(asked, **options)


def test_a_name_of_types_of_several_packages_and_a_file_are_told_as_such():
    with pytest.raises(rj.SchemaError) as error:
        rj.Decoder.of("Image")
    assert "`sensor_msgs/Image`" in str(error.value)
    assert "`rst.vision.Image` or " in str(error.value)
    with pytest.raises(rj.SchemaError, match=r'a file is imported, and a type in it is named: imports=\["sensor_msgs/msg/Imu\.msg"\]'):
        rj.Decoder.of("sensor_msgs/msg/Imu.msg")


def test_files_of_types_are_named_as_files_of_mappings_are(tmp_path, monkeypatch):
    (tmp_path / "lab.proto").write_text('syntax = "proto3"; package lab; message Point { double x = 1; }')
    monkeypatch.chdir(tmp_path)
    for name in ("lab.proto", "./lab.proto", str(tmp_path / "lab.proto")):
        assert rj.Decoder.of("lab.Point", imports=[name], backend="python")(b"").x == 0
    (tmp_path / "m.mapping").write_text("data-holder: lab.Point\nwire-schema: geometry_msgs/Point\nunpack-rules:\n  .x = .x\n")
    with pytest.raises(rj.MappingError, match=r"""`import "ros1/geometry_msgs/Point.msg"`"""):
        rj.Decoder("m.mapping")
    text = (tmp_path / "m.mapping").read_text()
    (tmp_path / "m.mapping").write_text(f'import "lab.proto"\nimport "ros1/geometry_msgs/Point.msg"\n{text}')
    assert rj.Decoder("m.mapping", backend="python").holder_type().to_dict() == {"x": 0.0}


AT_THE_END = """
import builtins, struct, sys
import rosetta_jit as rj

MESSAGE = struct.pack("<ii3d", 266, 3, 1, 2, 3)


class Last:
    def __init__(self, decode):
        self.decode, self.built_in = decode, decode.builtin

    def __del__(self):
        self.decode(MESSAGE)
        self.built_in(MESSAGE)
        print("decoded")


decode = rj.Decoder("yarp/icub/torso_state.mapping", encoding="yarp3")
decode(MESSAGE)  # the holder that it fills is made by the first message, which numpy cannot do so late
builtins.last, of_the_module, sys.modules["last"] = Last(decode), Last(decode), Last(decode)
in_a_cycle = Last(decode)
in_a_cycle.itself = in_a_cycle
"""


def test_what_python_clears_at_its_end_may_still_decode():
    ended = subprocess.run([sys.executable, "-c", AT_THE_END], check=False, capture_output=True, text=True)
    assert (ended.returncode, ended.stderr) == (0, "")
    assert ended.stdout.split() == ["decoded"] * 4


AT_ONCE = """
import sys, threading
import rosetta_jit as rj

sys.setswitchinterval(1e-6)
together, made = threading.Barrier(6), []


def make(program, name, encoding):
    together.wait()
    made.append(program.of(name, encoding=encoding))


names = [("sensor_msgs/Imu", "ros1"), ("sensor_msgs/msg/Imu", "cdr"), ("rst.kinematics.JointAngles", "protobuf")]
threads = [threading.Thread(target=make, args=(program, *each)) for each in names for program in (rj.Decoder, rj.Encoder)]
for each in threads:
    each.start()
for each in threads:
    each.join()
print(len(made), len({each.holder_type for each in made}))
"""


@pytest.mark.parametrize("_round", range(3))
def test_threads_of_a_new_process_make_programs_at_once(_round):
    ended = subprocess.run([sys.executable, "-c", AT_ONCE], check=False, capture_output=True, text=True)
    assert (ended.stdout.strip(), ended.stderr) == ("6 3", "")
