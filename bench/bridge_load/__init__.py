"""What a running bridge adds, and what it carries.

The bridge is a process of its own, pinned to one core; who sends and who receives are plain sockets in another process.
"""
