"""ROS 2: `.msg` files as rosidl_adapter reads them, type hashes, and the manners of rclpy; the bytes are CDR."""
