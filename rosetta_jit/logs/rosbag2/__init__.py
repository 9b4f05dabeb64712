"""rosbag2: folders with metadata, files of SQLite or MCAP. https://github.com/ros2/rosbag2."""
