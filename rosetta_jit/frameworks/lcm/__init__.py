"""LCM: `.lcm`, fingerprints, the wire encoding, and the manners of lcm-gen's classes."""
