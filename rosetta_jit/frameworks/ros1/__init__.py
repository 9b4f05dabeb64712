"""ROS 1: `.msg` files as genmsg reads them, packed little-endian messages, and the manners of genpy."""
