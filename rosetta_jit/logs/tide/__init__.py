"""TIDE, the logs of RSB that rsbag writes: https://github.com/open-rsx/rsbag-cl."""
