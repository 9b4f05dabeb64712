"""Protocol Buffers: .proto, the wire encoding, and the manners of its messages."""
