"""The functions of the mapping language: one record each (`rosetta_jit.language.function`), one file a family."""
