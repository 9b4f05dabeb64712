"""Recordings of this project: `rosetta_jit.recording`."""
