"""CORBA as OpenRTM-aist uses it: its IDL and encoding are those of `rosetta_jit.frameworks.omg`."""
