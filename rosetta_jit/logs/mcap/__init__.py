"""MCAP: https://mcap.dev/spec."""
