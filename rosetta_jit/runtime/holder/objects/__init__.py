"""Objects of other classes: dataclasses, and those that a framework's own package makes.

foreign   what is particular about the objects of one framework
reading   an object as plain values: what it means to take one
shapes    which attributes a class has, and which classes stand behind them
source    functions that are written for one class, and then run
steps     how compiled code takes the objects of a class
taking    objects to holders, with a function for each class
giving    holders to objects, the same way

Objects are known by the names of their attributes alone. No framework's package is imported.
"""
