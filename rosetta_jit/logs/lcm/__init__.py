"""LCM's event logs: https://lcm-proj.github.io/lcm/content/log-file-format.html."""
