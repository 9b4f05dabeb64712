"""Attributes of messages in compiled code: one getter and one setter a kind of field, whatever the type.

    shared/*.ll   what all accessors share: messages, rows, Python's numbers
    fields/*.ll   what reads and writes fields, by kinds; `scalar.ll` is a template for numbers
    holders/*.ll   how holders are made and end, attributes by their names, comparison
    programs/*.ll  methods that serialise, objects that are handed over as bytes
    objects/*.ll   objects of other classes, taken into messages
    code           that text as code: compiled in `groups` when it is first called, then from the cache
    groups         what is compiled at once
    places         what they must know of each field of a record: a table of words
    descriptors    attributes of a class that run them
    names          attributes by their names, found without asking all classes above
    sequences      arrays that are shown by them
    methods        methods that serialise, as calls of programs
    makers         what makes holders
    sameness       what is compared of two messages

They do what is common and ask Python for everything else, so that what a field means is said once: in `rosetta_jit.runtime.holder.access`.
Where Python is none that they know, that is all there is.
"""
