"""YARP: bottles in three dialects, their schemas, and their text form."""
