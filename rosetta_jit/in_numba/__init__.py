"""Holders and kernels inside users' own numba functions: `decoder.kernel` fills a holder, whose fields are read by name.

    taking     what Python does: a holder is taken when a compiled function gets it, and given back when that returns
    types      numba's types of messages and of sequences of them
    reading    code that reads fields
    assigning  code that assigns numbers
    sequences  length, elements and iteration
    maps       keys, values and iteration
    boxing     from Python and back
    c_call     calls from compiled code into C functions
    calling    a kernel as a function for compiled code

Nothing here is imported before somebody asks for `decoder.kernel`: numba takes longer to import than everything else.
"""
