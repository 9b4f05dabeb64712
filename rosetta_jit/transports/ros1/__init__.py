"""ROS 1: topics and services over TCPROS, found by the master, without ROS's own libraries."""
