"""Attributes of messages in compiled code: one getter and one setter a kind of field, whatever the type.

    *.ll         what the accessors do, as text of LLVM
    code         that text as code: compiled once a machine, then from the cache
    places       what they must know of each field of a record: a table of words
    descriptors  attributes of a class that run them
    names        attributes by their names, found without asking all classes above
    sequences    arrays that are shown by them
    methods      methods that serialise, as calls of programs
    makers       what makes holders
    sameness     what is compared of two messages

They do what is common and ask Python for everything else, so that what a field means is said once: in `rosetta_jit.runtime.holder.access`.
Where Python is none that they know, that is all there is.
"""
