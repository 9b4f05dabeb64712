"""The limits of transports: what keeps memory and time bounded whatever peers send. docs/security.md prints them."""

from __future__ import annotations

# --- Messages ------------------------------------------------------------------------------------------------------------

MAX_MESSAGE_BYTES = 64 << 20
"""bytes of a message, where `max_message` says nothing else"""

MAX_HELD_BYTES = 1 << 30
"""bytes of incoming messages of all connections of a process together: a connection that needs more is closed"""

MAX_WAITING_BYTES = 16 << 20
"""bytes that wait for one slow peer; a message of any size may always begin to wait"""

MAX_SENDING_BYTES = 1 << 30
"""bytes that wait for all slow peers of a process together: what is more is not sent to a slow peer, and counted"""

MAX_QUEUE_BYTES = 256 << 20
"""bytes of the messages that wait in one queue, of a source, a server or a route; one message may always wait"""

MAX_CONNECTIONS = 512
"""connections of one listener: further ones are closed at once"""

MAX_REASONS = 50
"""reasons of refusals that an end counts apart"""

MAX_ALIKE = 4
"""of these, reasons that begin with the same three words; further ones of them are counted together"""

MAX_REASON = 400
"""characters of such a reason"""

MAX_DATAGRAM = 65_507
"""bytes of a datagram: 65,535 less the headers of IPv4 and UDP"""

# --- YARP ----------------------------------------------------------------------------------------------------------------

MAX_YARP_NAME_BYTES = 1000
"""bytes of the name of a YARP port or connection"""

MAX_ENVELOPE_BYTES = 4096
"""bytes of the envelope of a message of YARP"""

MAX_LINE_BYTES = 1 << 20
"""bytes of a line that YARP's text carriers send"""

MAX_BOTTLE_DEPTH = 100
"""lists within each other in a bottle of YARP's own commands"""

MAX_STAMP_DIGITS = 30
"""digits of a number in the envelope of a message of YARP"""

MAX_NAMES_BYTES = 4 << 20
"""bytes that YARP's name server answers"""

MAX_ADMIN_BYTES = 1 << 20
"""bytes that a YARP port answers to a command about its connections"""

MAX_ADMIN_WORDS = 8
"""words of such a command"""

MAX_OUTPUTS = 256
"""connections to others that one YARP port is asked to make"""

MAX_CONNECTING = 100
"""connections that one YARP port is asked to make and that are not made yet"""

MAX_DATAGRAM_INPUTS = 64
"""writers by udp and mcast of one YARP port: where one more comes, the one is closed that has been silent for the longest time"""

MAX_SKIPPED_BYTES = 1 << 16
"""bytes of the acknowledgement of a message of YARP, which are skipped"""

# --- RSB, ROS 1, and names of others -------------------------------------------------------------------------------------

MAX_SCOPE_CHARACTERS = 1000
"""characters of a scope of RSB"""

MAX_ENTRIES = 1000
"""causes, user infos and user times of one event of RSB"""

MAX_HEADER_BYTES = 1 << 20
"""bytes of the header of a connection of ROS 1, which holds the text of a type"""

MAX_TASKS = 10_000
"""connections that others name to a node of ROS 1 and that are not made yet"""

MAX_XML_BYTES = 4 << 20
"""bytes of a request or an answer of ROS 1's XML-RPC"""

MAX_REQUESTS = 32
"""requests that a node of ROS 1 answers at a time"""

MAX_TOPIC_BYTES = 65_535
"""bytes of a topic of MQTT"""

MAX_SERVICE_BYTES = 255
"""bytes of the name of a service of iceoryx"""

MAX_CHANNEL_BYTES = 63
"""bytes of the name of a channel of LCM"""
