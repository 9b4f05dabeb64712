"""What ROS 1 and ROS 2 share: the line-oriented language of `.msg` files, with what differs between them as data (`Dialect`)."""
