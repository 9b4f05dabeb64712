"""Zenoh, by `eclipse-zenoh`; and ROS 2 over it, as rmw_zenoh names topics and types."""
