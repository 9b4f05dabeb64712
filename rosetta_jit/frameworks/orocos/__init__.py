"""OROCOS: C++ headers and typelib's registries, RTT's and Rock's ways of writing C++ objects."""
