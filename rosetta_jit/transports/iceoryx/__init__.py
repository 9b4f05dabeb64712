"""Shared memory, by `iceoryx2`."""
