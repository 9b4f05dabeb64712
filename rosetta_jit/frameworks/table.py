"""The frameworks that come with rosetta_jit."""

from __future__ import annotations

from rosetta_jit.frameworks.base import Framework

_HERE = "rosetta_jit.frameworks"
_BOTTLES = f"{_HERE}.yarp.encoding:encode_type"
_MESSAGES = f"{_HERE}.protobuf.encoding:encode_type"
_CDR = f"{_HERE}.omg.cdr:encode_type"
_OROCOS = f"{_HERE}.orocos.encoding:encode_type"
_TRUE = "every byte but 0 is true"
_DDS = {
    "bool": f"{_TRUE} (Fast CDR)",
    "text": "bytes that are no UTF-8 are kept (Fast CDR)",
    "enum": "numbers that the enum does not name are kept (rosbags, Cyclone DDS in Python)",
    "bounds": "more than a bound allows is read and written (rosbags)",
    "trailing": "up to three bytes may be left over, announced or not, and whatever they are (rmw_serialize of rmw_fastrtps)",
}
_ROS2 = {
    "padding": "zeros up to a multiple of four bytes are written behind a message; they are read anyway (rmw_cyclonedds)",
    "wstring": "wide strings have four bytes a unit, and units are counted, both ways (rmw_fastrtps, rmw_cyclonedds)",
}
_ROS_TEXTS = f"{_HERE}.ros.texts:file_of"
_IDL = f"{_HERE}.omg.idl:parse"

FRAMEWORKS = (
    Framework(
        "yarp",
        features=f"{_HERE}.yarp.features:PROBES",
        idl={".bottle-schema": f"{_HERE}.yarp.schema:parse", ".thrift": f"{_HERE}.yarp.thrift:parse"},
        manners=f"{_HERE}.yarp.manners:BOTTLE",
        encodings={"yarp": _BOTTLES, "yarp3": _BOTTLES, "yarp4": _BOTTLES, "yarp2012": _BOTTLES},
    ),
    Framework(
        "protobuf",
        features=f"{_HERE}.protobuf.features:PROBES",
        idl={".proto": f"{_HERE}.protobuf.idl:parse"},
        encodings={"protobuf": _MESSAGES, "protobuf-partial": _MESSAGES},
        manners=f"{_HERE}.protobuf.manners:PROTOBUF",
    ),
    Framework(
        "ros1",
        features=f"{_HERE}.ros1.features:PROBES",
        texts=_ROS_TEXTS,
        idl=dict.fromkeys((".msg", ".srv", ".action"), f"{_HERE}.ros1.idl:parse"),
        several={
            ".srv": ("Request", "Response"),
            ".action": ("ActionGoal", "ActionResult", "ActionFeedback", "Action", "Goal", "Result", "Feedback"),
        },
        encodings={"ros1": f"{_HERE}.ros1.encoding:encode_type"},
        manners=f"{_HERE}.ros1.manners:GENPY",
        files=("*ros1/*.msg", "*ros1-2012/*.msg"),
        leniencies={"ros1": {"bool": f"{_TRUE} (genpy)", "text": "bytes that are no UTF-8 are kept (roscpp, genpy)"}},
    ),
    Framework(
        "corba",
        features=f"{_HERE}.corba.features:PROBES",
        idl={".idl": _IDL},
        encodings={"cdr-giop": _CDR},
        manners=f"{_HERE}.corba.manners:OMNIORB",
        leniencies={
            "cdr-giop": {
                "bool": f"{_TRUE} (omniORB)",
                "text": "bytes that are no UTF-8 are kept (omniORB, whose char is ISO 8859-1)",
                "enum": "numbers that the enum does not name are kept (TAO)",
                "bounds": "more than a bound allows is read and written (TAO)",
                "trailing": "up to three bytes may be left over",
            }
        },
        byte_orders=("cdr-giop",),
    ),
    Framework(
        "ros2",
        features=f"{_HERE}.ros2.features:PROBES",
        texts=_ROS_TEXTS,
        idl=dict.fromkeys((".msg", ".srv", ".action"), f"{_HERE}.ros2.idl:parse") | {".idl": f"{_HERE}.ros2.idl:parse_idl"},
        several={
            ".srv": ("_Request", "_Response", "_Event", ""),
            ".action": (
                "_Goal",
                "_Result",
                "_Feedback",
                "_FeedbackMessage",
                *(f"_{service}{end}" for service in ("SendGoal", "GetResult") for end in ("_Request", "_Response", "_Event", "")),
                "",
            ),
        },
        encodings={"cdr": _CDR, "cdr2": _CDR},
        manners=f"{_HERE}.ros2.manners:RCLPY",
        files=("*/msg/*.msg", "*/msg/*.idl", "*/srv/*.srv", "*/action/*.action", "*ros2/*.*"),
        leniencies={"cdr": _DDS | _ROS2, "cdr2": _DDS},
        byte_orders=("cdr", "cdr2"),
    ),
    Framework(
        "lcm",
        features=f"{_HERE}.lcm.features:PROBES",
        idl={".lcm": f"{_HERE}.lcm.idl:parse"},
        encodings={"lcm": f"{_HERE}.lcm.encoding:encode_type"},
        manners=f"{_HERE}.lcm.manners:LCM_GEN",
        leniencies={"lcm": {"bool": f"{_TRUE} (lcm-gen)", "trailing": "bytes behind the message are left alone (lcm-gen)"}},
    ),
    Framework(
        "orocos",
        features=f"{_HERE}.orocos.features:PROBES",
        idl={".hpp": f"{_HERE}.orocos.header:parse", ".h": f"{_HERE}.orocos.header:parse", ".tlb": f"{_HERE}.orocos.typelib:parse"},
        encodings={"rtt-mqueue": _OROCOS, "typelib": _OROCOS, "native": _OROCOS},
        leniencies={each: {"bool": f"{_TRUE} (any C++ compiler)"} for each in ("rtt-mqueue", "typelib", "native")},
    ),
)
