"""ROS 2 over DDS, by `cyclonedds`: messages as CDR, never decoded on the way."""
