"""LCM, by `lcm`."""
