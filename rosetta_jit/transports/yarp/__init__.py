"""YARP: ports that are found through its name server, over tcp, fast_tcp and the text carriers, without YARP's own libraries."""
