"""ROS 2 as a `Framework`: where its front ends, encodings and manners are found."""

from __future__ import annotations

from rosetta_jit.frameworks.base import ANY_BYTE, Framework

HERE = "rosetta_jit.frameworks.ros2"
CDR = "rosetta_jit.frameworks.omg.cdr:encode_type"
DDS = {
    "bool": f"{ANY_BYTE} (Fast CDR)",
    "text": "bytes that are no UTF-8 are kept (Fast CDR)",
    "enum": "numbers that the enum does not name are kept (rosbags, Cyclone DDS in Python)",
    "bounds": "more than a bound allows is read and written (rosbags)",
    "trailing": "up to three bytes may be left over, announced or not, and whatever they are (rmw_serialize of rmw_fastrtps)",
}
RMW = {
    "padding": "zeros up to a multiple of four bytes are written behind a message; they are read anyway (rmw_cyclonedds)",
    "wstring": "wide strings have four bytes a unit, and units are counted, both ways (rmw_fastrtps, rmw_cyclonedds)",
}

FRAMEWORK = Framework(
    "ros2",
    features=f"{HERE}.features:PROBES",
    definition=f"{HERE}.definition:definition",
    announcement=f"{HERE}.announcement:announcement",
    texts="rosetta_jit.frameworks.ros.texts:file_of",
    idl=dict.fromkeys((".msg", ".srv", ".action"), f"{HERE}.idl:parse") | {".idl": f"{HERE}.idl:parse_idl"},
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
    follows={"ros1": f"{HERE}.successors:fields_of"},
    encodings={"cdr": CDR, "cdr2": CDR},
    manners=f"{HERE}.manners:RCLPY",
    files=("*/msg/*.msg", "*/msg/*.idl", "*/srv/*.srv", "*/action/*.action", "*ros2/*.*"),
    leniencies={"cdr": DDS | RMW, "cdr2": DDS},
    byte_orders=("cdr", "cdr2"),
)
