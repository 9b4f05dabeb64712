"""ROS 1 as a `Framework`: where its front ends, encodings and manners are found."""

from __future__ import annotations

from rosetta_jit.frameworks.base import ANY_BYTE, Framework

HERE = "rosetta_jit.frameworks.ros1"

FRAMEWORK = Framework(
    "ros1",
    features=f"{HERE}.features:PROBES",
    definition=f"{HERE}.definition:definition",
    announcement=f"{HERE}.announcement:announcement",
    texts="rosetta_jit.frameworks.ros.texts:file_of",
    idl=dict.fromkeys((".msg", ".srv", ".action"), f"{HERE}.idl:parse"),
    several={
        ".srv": ("Request", "Response"),
        ".action": ("ActionGoal", "ActionResult", "ActionFeedback", "Action", "Goal", "Result", "Feedback"),
    },
    encodings={"ros1": f"{HERE}.encoding:encode_type"},
    manners=f"{HERE}.manners:GENPY",
    files=("*ros1/*.msg", "*ros1-2012/*.msg"),
    leniencies={"ros1": {"bool": f"{ANY_BYTE} (genpy)", "text": "bytes that are no UTF-8 are kept (roscpp, genpy)"}},
)
