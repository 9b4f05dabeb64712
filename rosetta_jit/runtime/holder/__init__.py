"""Holders: where decoded data lives.

record      type and layout joined: what lies where in the lanes
arena       writing into lanes: spans, presence, emptiness
coerce      what may be assigned to a field
values      plain Python values of a field, and back
message     what holders and views into them are
undo        what a refused change leaves behind: nothing
access      getters and setters
sequence    arrays and maps that numpy cannot show
classes     what every holder can do
family      the class of a type, made once
manners     how holders of a framework behave
serialising holders that write and read themselves
objects     objects of other classes: taken into holders, and made of them
"""

from rosetta_jit.runtime.holder.classes import Holder
from rosetta_jit.runtime.holder.family import Family, holder_class, holder_class_of
from rosetta_jit.runtime.holder.manners import PLAIN, Manners

__all__ = ["PLAIN", "Family", "Holder", "Manners", "holder_class", "holder_class_of"]
