"""Stubs: what a type checker and an editor must know of holders, decoders and encoders, as the text of a `.pyi` file.

names    identifiers for what schemas name
fields   annotations of fields
classes  the class of a struct, with what its framework's manners add
module   the whole text
"""
