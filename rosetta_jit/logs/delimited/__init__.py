"""Protobuf messages one after the other, each behind its length: what `writeDelimitedTo` and its like write."""
