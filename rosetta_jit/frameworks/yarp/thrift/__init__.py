"""YARP's Thrift: its language as yarpidl_thrift reads it, and how messages of its types are written."""
