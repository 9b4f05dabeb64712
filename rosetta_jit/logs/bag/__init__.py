"""ROS 1's bags: https://wiki.ros.org/Bags/Format/2.0."""
