"""Which user's function it is: a digest of all that its compiled code depends on, or why there is none.

    bytecode.py     code → the globals and closure cells that it names, each with the attributes that follow
    content.py      a function → the digest of everything that it can reach: code, constants, tables, other functions
    kinds.py        enumerations, named tuples, arrays, scalars, numba's dispatchers, as plain values for `content`
    known.py        which objects belong to Python, numpy or numba, so that their versions say what they are
    environment.py  versions and settings that numba compiles with
    registered.py   what others than numba itself have taught numba in this process
    identity.py     all of these together

The world is closed: an object of a kind that is not listed there makes its function *uncertain*. A program that calls an uncertain function
is compiled anew in each process; the cache neither keeps it nor is asked for it.
"""
